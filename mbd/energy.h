/* Energies and their sign: kinetic; potential of gravity (zero at the world's origin) and of springs. */
#ifndef MBD_ENERGY_H
#define MBD_ENERGY_H

#include "mbd/state.h"

/* Both at data->kin [J]. */
double mbd_kinetic_energy(const mbd_model *model, const mbd_data *data);
double mbd_potential_energy(const mbd_model *model, mbd_data *data);

#endif

/* Energies. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MECHANICS_ENERGY_H
#define MBD_MECHANICS_ENERGY_H

#include "mbd/mechanics/state.h"

/* at data->kin [J] */
typedef struct {
  double kinetic;
  double potential; /* of gravity, zero at the world's origin */
  double springs;   /* stored in forces */
} mbd_energies;

mbd_energies mbd_energies_at(const mbd_model *model, mbd_data *data);

#endif

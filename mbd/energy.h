/* Energies and work. */
#ifndef MBD_ENERGY_H
#define MBD_ENERGY_H

#include "mbd/state.h"

/* at data->kin [J] */
typedef struct {
  double kinetic;
  double potential; /* of gravity, zero at the world's origin */
  double springs;   /* stored in forces */
} mbd_energies;

mbd_energies mbd_energies_at(const mbd_model *model, mbd_data *data);

/* Power brought in by drivers, applied forces and the loads on coupled bodies, and turned into heat, at the unknowns y
 * (with lambda) and time t; changes data->kin. */
mbd_work mbd_power_at(const mbd_model *model, mbd_data *data, double t, const double *y);

/* Hands out the unknowns at time t inside the last step; NULL: none. */
typedef const double *(*mbd_unknowns_fn)(void *context, double t);

/* Sum of two works. */
mbd_work mbd_work_add(mbd_work a, mbd_work b);

/* Work from time `from` to `to` inside the last step, by Gauss' rule with three points (exact to order 5); nothing is
 * evaluated where nothing can do work. */
mbd_work mbd_work_over(const mbd_model *model, mbd_data *data, double from, double to, mbd_unknowns_fn unknowns,
                       void *context);

#endif

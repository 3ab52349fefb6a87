/* The normal force that a coefficient of friction multiplies, of the joint's own reaction.
 *
 * A joint's reaction is a force F and a moment M on its second body about its joint point there, axis a (of the first
 * body). The bearing takes it at its two ends, half its length L on either side of the point: they press with
 *   P = F'/2 +- (a x M)/L,   F' = F - a (a.F),
 * and rub by |P| each; a bearing without a length takes F' alone. Beside these the force along the axis and the moment
 * about it rub at their radii (model/force.h, `along` and `about`), and a preload whatever the reaction is.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MECHANICS_NORMAL_H
#define MBD_MECHANICS_NORMAL_H

#include "mbd/mechanics/state.h"

typedef struct {
  double normal;                                  /* [N], of a torque times the radius [N m] */
  int nrow;                                       /* of the joint */
  double by_lambda[MBD_ROWS_MAX], by_q[MBD_PAIR]; /* its derivatives by lambda of these and the pair's pose */
} mbd_normal;

/* The normal force of a friction at data->kin under the multipliers lambda (nrow); with derivatives if `second`. */
mbd_normal mbd_normal_at(const mbd_model *model, mbd_data *data, const mbd_force *force, const double *lambda,
                         bool second);

/* data->stick[].normal at data->kin under lambda (nrow); NULL: without any reaction. */
void mbd_normals(const mbd_model *model, mbd_data *data, const double *lambda);

#endif

/* The linear system of consistent states, in twist coordinates (Haug 1989, chapters 10 and 11):
 *
 *   [M G^T; G 0] [x; l] = [f; b]
 *
 * with (0, -g) for a correction of the positions, (0, -G V - g_t) for one of the velocities (both the smallest in the
 * sense of kinetic energy), and (Q, -Gdot V - g_tt) for accelerations and reactions. Sparse, factored by KLU.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_CONSISTENT_KKT_H
#define MBD_CONSISTENT_KKT_H

#include "mbd/mechanics/state.h"

/* what the right-hand side of the constraint rows holds */
typedef enum { MBD_POSITION, MBD_VELOCITY, MBD_ACCELERATION } mbd_level;

typedef struct mbd_kkt mbd_kkt;

mbd_kkt *mbd_kkt_create(const mbd_model *model); /* NULL: out of memory */
void mbd_kkt_destroy(mbd_kkt **kkt);

/* Forget what the matrix has learnt so that what follows does not depend on what was before. */
void mbd_kkt_reset(mbd_kkt *kkt);

/* Fill the matrix at data->kin with the independent rows (data->dependent), and b. */
bool mbd_kkt_fill(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, mbd_level level);

/* Fill it with all rows and a small negative diagonal, which makes it regular whatever the rank of G: the solution is
 * the least-squares one. For positions, before the rank is known. */
bool mbd_kkt_fill_all(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, mbd_level level);

/* b (nrow) of the last filling, to be changed before solving; dependent rows too. */
double *mbd_kkt_b(mbd_kkt *kkt);

/* Solve with f (6 nbody; NULL: zero), refined until every body's equations hold to rounding of their own largest term:
 * a light part beside heavy ones has its small forces right, too. The solution stays valid until the next: x (6 nbody),
 * then l (nrow), zero for dependent rows. NULL: singular. */
const double *mbd_kkt_solve(mbd_kkt *kkt, const double *f);

/* The smallest over the largest pivot of the last filling: tends to zero at a singular position. */
double mbd_kkt_spread(mbd_kkt *kkt);

/* Replace l (nrow) by the l of the same reaction G^T l that is smallest in the norm sum s_i l_i^2, where s_i is the
 * square of the length of row i of G, ways of rotations counted at the mechanism's size, so that forces and moments
 * compare: what a mechanism with dependent rows leaves undetermined is shared out, whatever the masses. Where rows
 * depend so nearly on each other that this cannot be had to rounding, l stays as it is, which is a solution too. At
 * data->kin of the last filling. false: out of memory. */
bool mbd_kkt_share(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, double *l);

#endif

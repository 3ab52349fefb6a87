/* What a constraint, or a coordinate of a pair of bodies, is at one instant: its violation and its derivatives. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_ROWS_H
#define MBD_MODEL_ROWS_H

#include "mbd/model/kin.h"

#include <stdbool.h>

enum { MBD_ROWS_MAX = 6 };

/* What one pair of bodies adds to the rows of a constraint. Set n (to 0), `second`, `part` and `turn` before use; the
 * rows are cleared as they are appended.
 * With them gdot = G V + g_t and gddot = G Vdot + V^T H V + g_tt: no row has a G that depends on the time. */
typedef struct {
  int n;
  bool second;                                /* fill H as well */
  int part;                                   /* which of the constraint's pairs of bodies is asked for, see mbd_part */
  double turn;                                /* the pair's joint angle a moment ago, counted over turns [rad] */
  int body[2];                                /* the pair; MBD_GROUND: the fixed world */
  int first;                                  /* place of row 0 among all rows of the model */
  double g[MBD_ROWS_MAX];                     /* violation [m], [1] or [rad] */
  double g_t[MBD_ROWS_MAX];                   /* partial derivatives of g by the time, 0 but for drivers */
  double g_tt[MBD_ROWS_MAX];                  /* the second */
  double G[MBD_ROWS_MAX][MBD_PAIR];           /* dg = G dq */
  double H[MBD_ROWS_MAX][MBD_PAIR][MBD_PAIR]; /* dG[k] = sum_j H[k][j] dq[j] */
} mbd_rows;

#endif

/* Constraint rows from which joints are built (primitives as in Haug 1989, chapter 9, here with rotations in world
 * axes).
 *
 * All arguments are world axes: arms from the centres of mass, body-fixed directions turned into the world.
 */
#ifndef MBD_ROWS_H
#define MBD_ROWS_H

#include "mbd/kin.h"

#include <stdbool.h>

enum { MBD_ROWS_MAX = 6 };

/* Zero n and set `second` before use; the rows are cleared as they are appended. */
typedef struct {
  int n;
  bool second;                                /* fill H as well */
  double g[MBD_ROWS_MAX];                     /* violation [m] or [1] */
  double G[MBD_ROWS_MAX][MBD_PAIR];           /* gdot = G V */
  double H[MBD_ROWS_MAX][MBD_PAIR][MBD_PAIR]; /* dG[k] = sum_j H[k][j] dq[j] */
} mbd_rows;

/* Three rows: the points at the ends of both arms coincide. */
void mbd_rows_point(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 arm_a, tdm_vec3 arm_b);

/* One row: a direction of the first and one of the second body are perpendicular. */
void mbd_rows_perpendicular(mbd_rows *rows, tdm_vec3 of_a, tdm_vec3 of_b);

/* One row: the vector from the first to the second body's point is perpendicular to a direction of the first body. */
void mbd_rows_plane(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 of_a, tdm_vec3 arm_a, tdm_vec3 arm_b);

#endif

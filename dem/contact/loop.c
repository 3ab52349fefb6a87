/* The contact loops, over pairs of particles and over particles and walls.
 *
 * One source, compiled once for each instruction set and normal law (DEM_LAW, set by the build), in it once for each
 * row of the table: the kernels are constants of an always-inlined function, so no call and no branch on a law is left
 * in a loop. With `all_terms` there is one pair of loops for a normal law, in which the scene's other laws are
 * switches. DEM_W contacts go at a time, one a lane, whether they touch or not; what does not touch adds nothing.
 * Forces are added lane after lane, in the order of the list, so the sums are those of a loop over one contact at a
 * time.
 *
 * law.h has what pairs and walls share, pair_loop.h and wall_loop.h the loops.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/pair_loop.h"
#include "dem/contact/wall_loop.h"

/* ---- the rows of this normal law ---- */

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define ROWS JOIN(DEM_LAWS_, DEM_LAW)

#define ROW(n, t)                                                                                 \
  ((row){dem_normal_##n, dem_tangential_##t, DEM_NORMAL_COLUMNS_##n + DEM_TANGENTIAL_COLUMNS_##t, \
         DEM_TANGENTIAL_COLUMNS_##t, false, DEM_TANGENTIAL_##t != DEM_TANGENTIAL_none, batch_##t})
#define X(n, t)                                                                    \
  static __attribute__((noinline)) void batch_##t(dem_loop_task *task, batch *b) { \
    wall_batch(task, b, ROW(n, t));                                                \
  }                                                                                \
  static void pairs_##t(dem_loop_task *task) {                                     \
    pair_loop(task, ROW(n, t));                                                    \
  }                                                                                \
  static void walls_##t(dem_loop_task *task) {                                     \
    wall_loop(task, ROW(n, t));                                                    \
  }
ROWS(X)
#undef X

#define ROW_ALL_TERMS ((row){JOIN(dem_normal_, DEM_LAW), tangential_of_scene, 0, 0, true, true, batch_all_terms})

static __attribute__((noinline)) void batch_all_terms(dem_loop_task *task, batch *b) {
  wall_batch(task, b, row_of(task->model, ROW_ALL_TERMS));
}

static void pairs_all_terms(dem_loop_task *task) {
  pair_loop(task, ROW_ALL_TERMS);
}

static void walls_all_terms(dem_loop_task *task) {
  wall_loop(task, ROW_ALL_TERMS);
}

const dem_law DEM_ISA(JOIN(dem_laws_, DEM_LAW))[] = {
#define X(n, t)                                                      \
  {DEM_NORMAL_##n, DEM_TANGENTIAL_##t, false, pairs_##t, walls_##t}, \
      {DEM_NORMAL_##n, DEM_TANGENTIAL_##t, true, pairs_all_terms, walls_all_terms},
    ROWS(X)
#undef X
        {0}};

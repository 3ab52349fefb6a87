/* Coupling schemes: who goes first in a window, and with which load.
 *
 * To add one: a file scheme/<name>.c with its equations at the head, one row in scheme/table.c, its key in
 * scenarios/scene.schema.json, its paragraph in coupler/README.md. A scheme moves the loop over one window with the
 * operations of window.h.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SCHEME_H
#define CPL_SCHEME_H

#include "protocol/wire/participant.h"

struct cpl_loop;

typedef struct cpl_scheme {
  const char *name;
  const char *summary;
  /* capabilities that each role's solver (cpl_role: mbd, dem) must announce, NULL-terminated; NULL: none. Of mbd,
   * "acceleration" and "mobility" are asked for in ASSIGN then. */
  const char *const *needs[2];
  /* Path of a body's position in a window that DEM is sent along, unless the scene says (coupling.interpolation). */
  tdm_interpolation interpolation;
  /* Order in H of the mismatch between the two solvers' ends of a window, loop->dem_end and loop->state_end, by which
   * "n": "auto" chooses H; 0: there is none. */
  int mismatch_order;
  /* What the scheme itself needs during a run: sets and frees loop->own. NULL: nothing. */
  tdm_status (*open)(struct cpl_loop *loop, tdm_error *err);
  void (*close)(struct cpl_loop *loop);
  /* Take the loop from the start of its window to the end: fills loop->state_end, pushes to loop->history. */
  tdm_status (*advance)(struct cpl_loop *loop, tdm_error *err);
} cpl_scheme;

extern const cpl_scheme *const cpl_schemes[]; /* NULL-terminated; the first is the default */

extern const cpl_scheme cpl_scheme_lommen, cpl_scheme_hold, cpl_scheme_dem_first, cpl_scheme_proxy,
    cpl_scheme_iterative;

#endif

/* Coupling schemes: who goes first in a window, and with which load. What a session and a loop know of them.
 *
 * To add one: a file scheme/<name>.c with its equations at the head, one row in session/schemes.c, its key in
 * scenarios/scene.schema.json, its paragraph in docs. A scheme moves the loop over one window with the operations of
 * loop/window.h. Its settings, statistics and notices are its own.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SESSION_SCHEME_H
#define CPL_SESSION_SCHEME_H

#include "protocol/base/scene.h"
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
  /* A scheme to advise where the exchange of this one makes too much energy; NULL: none is better. */
  const char *better;
  /* The scheme's settings: `read` takes the object coupling.<name> of the scene, which may be absent, into a block of
   * this size, which is loop->scheme_settings later. It is read whether or not the scheme is chosen, as scenes may hold
   * the settings of several. Errors go to own->err. NULL: the scheme has none, and coupling.<name> is refused. */
  size_t settings_size;
  void (*read)(void *settings, tdm_object *own);
  /* What the scheme itself needs during a run: sets and frees loop->own. NULL: nothing. */
  tdm_status (*open)(struct cpl_loop *loop, tdm_error *err);
  void (*close)(struct cpl_loop *loop);
  /* Take the loop from the start of its window to the end: fills loop->state_end, pushes to loop->history. */
  tdm_status (*advance)(struct cpl_loop *loop, tdm_error *err);
  /* Its statistics so far: keys of its own for summary.json, and a line for the terminal ("": none). NULL: nothing. */
  void (*enter)(const struct cpl_loop *loop, json_t *summary);
  void (*tell)(const struct cpl_loop *loop, char *line, size_t size);
} cpl_scheme;

enum { CPL_SCHEMES_MAX = 16 };

/* The table, NULL-terminated; the first is the default. */
extern const cpl_scheme *cpl_schemes[CPL_SCHEMES_MAX + 1];

/* Add a scheme that is not in the table, before any scene is read. The row must live on. False: the table is full, or
 * has the name. */
bool cpl_scheme_register(const cpl_scheme *scheme);

extern const cpl_scheme cpl_scheme_lommen, cpl_scheme_hold, cpl_scheme_dem_first, cpl_scheme_proxy,
    cpl_scheme_iterative;

#endif

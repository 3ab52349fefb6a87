/* Coupling schemes: who goes first in a window, and with which load.
 *
 * To add one: a file scheme/<name>.c with its equations at the head, one row in scheme/schemes.h, its key in
 * scenarios/scene.schema.json, its paragraph in docs/theory/coupling.md. A scheme moves the loop over one window with
 * the operations of loop/solve.h. It owns its settings, what it keeps, its remarks and what summary.json says of it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SETTINGS_SCHEME_H
#define CPL_SETTINGS_SCHEME_H

#include "coupler/settings/settings.h"

struct cpl_loop;

/* Capabilities that a scheme may need of a solver (PROTOCOL.md has them by these names), as flags. */
typedef enum {
  CPL_ACCELERATION = 1 << 0, /* mbd: RESULTs tell the bodies' accelerations */
  CPL_MOBILITY = 1 << 1,     /* mbd: ... and how loads on them change these */
  CPL_INTERFACE = 1 << 2,    /* dem: RESULTs tell the moments of the load */
  CPL_PROXY = 1 << 3,        /* dem: carries the mechanism through the window */
  CPL_RESTORE = 1 << 4,      /* both: SAVE and RESTORE */
  CPL_SENT_VELOCITY = 1 << 5 /* dem: contacts take the velocity that a body is sent with */
} cpl_need;

enum { CPL_NNEED = 6 };
extern const char *const cpl_need_names[CPL_NNEED]; /* by the flag's bit */

typedef struct cpl_scheme {
  const char *name;
  const char *summary;
  /* published.csv, beside a scene that follows a paper, has the paper's results with this scheme: `tandem sweep` shows
   * them beside its own */
  bool in_paper;
  const char *better; /* the scheme to take where this one's windows are too long for it; NULL: none is */
  /* what each role's solver must announce: flags of cpl_need. What RESULTs carry for it is asked for in ASSIGN. */
  unsigned needs[CPL_NROLE];
  /* what it needs of a role's solver beside that, as its settings are; NULL: nothing */
  unsigned (*needs_too)(const void *settings, cpl_role role);
  /* Path of a body's position in a window that DEM is sent along, unless the scene says (coupling.interpolation). */
  tdm_interpolation interpolation;
  /* Order in H of the mismatch between the two solvers' ends of a window, loop->dem_end and loop->state_end, by which
   * "n": "auto" chooses H; 0: there is none. */
  int mismatch_order;
  /* Order in H of the error of the bodies' motion, by which two runs tell it (trial/repeat.h); 0: not known, taken for
   * 1. */
  int order;
  /* The scheme's settings: `read` takes the object coupling.<name> of the scene, which may be absent, into a block of
   * this size that begins as zeros, loop->scheme_settings later; strings are borrowed. It is read whether or not the
   * scheme is chosen, as scenes may hold the settings of several. Errors go to own->err. NULL: the scheme has none, and
   * coupling.<name> is refused. */
  size_t settings_size;
  void (*read)(void *settings, tdm_object *own);
  /* Bytes, without pointers, that it keeps from window to window for so many bodies: loop->memory, zeros at first,
   * which goes back with the loop (cpl_loop_restore). NULL: none. */
  size_t (*memory)(int nbody);
  /* The start of the run: fills loop->memory; may set loop->own, which `close` (may be NULL) frees. NULL: nothing. */
  tdm_status (*open)(struct cpl_loop *loop, tdm_error *err);
  void (*close)(struct cpl_loop *loop);
  /* Take the loop from the start of its window to the end: fills loop->state_end. */
  tdm_status (*advance)(struct cpl_loop *loop, tdm_error *err);
  /* That window stays: with "n": "auto" it may also have been taken back, to be solved again, shorter. What is to be
   * told of windows is told here. NULL: nothing. */
  void (*keep)(struct cpl_loop *loop);
  /* What summary.json says of the windows, as keys of that object; and in one line for the terminal, "" for nothing to
   * say (size bytes). NULL: nothing. */
  void (*enter)(const struct cpl_loop *loop, json_t *summary);
  void (*tell)(const struct cpl_loop *loop, char *line, size_t size);
} cpl_scheme;

#endif

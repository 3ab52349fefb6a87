/* The server's part of a scene: the sections time, coupling and output. mbd and dem are handed on unread. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SETTINGS_SETTINGS_H
#define CPL_SETTINGS_SETTINGS_H

#include "protocol/output/outputs.h"
#include "protocol/scene/scene.h"
#include "protocol/wire/participant.h"

typedef enum { CPL_MBD, CPL_DEM, CPL_NROLE } cpl_role;

enum { CPL_BODIES_MAX = 10000 }; /* coupled bodies: the solvers' loading and messages stay within reason */

extern const char *const cpl_role_names[CPL_NROLE]; /* "mbd", "dem": also the names of their sections */

typedef enum { CPL_IPC, CPL_TCP, CPL_INPROC } cpl_transport_kind;

typedef enum { CPL_GUARD_STOP, CPL_GUARD_WARN, CPL_GUARD_OFF } cpl_guard_action;

/* What is done when energy appears from nowhere (observe/ledger.h). */
typedef struct {
  double energy; /* largest rise, as a share of the largest energy so far */
  cpl_guard_action action;
  double residual; /* of the work, that the exchange may make before a run is called inexact */
} cpl_guard;

typedef struct {
  const char *name[CPL_NROLE]; /* what each solver calls the body */
} cpl_body_names;

/* Windows whose length follows their own error (coupling.n is "auto"): state/mismatch.h. */
typedef struct {
  bool on;
  double tolerance; /* largest mismatch of a window, as a share of cpl_motion */
  double absolute;  /* and beside that [m] */
  long n_min, n_max;
} cpl_auto;

/* Strings are borrowed from the scene's JSON. */
typedef struct {
  double time_end; /* [s] */
  double dt;       /* DEM step [s] */
  long n;          /* DEM steps a window; of the longest, if it adapts */
  cpl_auto adapt;
  const struct cpl_scheme *const *schemes; /* that a scene may name, NULL-terminated; the first is the default */
  void **scheme_settings;                  /* what each of them has read, owned; NULL where it reads nothing */
  const struct cpl_scheme *scheme;
  const struct cpl_scheme *fallback; /* for solvers that lack what the scheme needs, NULL: none */
  cpl_guard guard;
  cpl_transport_kind transport;
  bool interpolates;                         /* the scene says how; else the scheme does */
  tdm_interpolation interpolation;           /* of positions inside a window, on the DEM side */
  double timeout;                            /* silence after which a solver counts as hanging [s] */
  double join_timeout;                       /* how long to wait for solvers that are started by hand [s] */
  const char *address;                       /* tcp: where to listen; the port may be "*" */
  const char *command[CPL_NROLE];            /* of a foreign solver, NULL: tandem's own */
  bool by_hand[CPL_NROLE];                   /* somebody else starts this solver */
  int ranks;                                 /* processes of tandem's own DEM engine (dem.ranks) */
  char solver_path[CPL_NROLE][TDM_PATH_MAX]; /* where the scene says so, "": it does not */
  int nbody;
  cpl_body_names *body;   /* (nbody), owned */
  double output_interval; /* of the time histories [s] */
  tdm_outputs_settings outputs;
} cpl_settings;

/* Whether a body of this name can have a file and a column: letters, digits, _ - . and no dot in front. */
bool cpl_name_fits_file(const char *name);

/* Whether the scene names a solver of its own for a role: then all else of the role's section is that solver's. */
bool cpl_is_foreign(const json_t *root, cpl_role role);

/* Read the server's sections. An error has its JSON path; tdm_scene_locate adds the place. */
tdm_status cpl_settings_read(cpl_settings *settings, const tdm_scene *scene, const struct cpl_scheme *const *schemes,
                             tdm_error *err);
void cpl_settings_free(cpl_settings *settings);

/* What a scheme has read of its own, NULL: nothing. */
const void *cpl_scheme_settings(const cpl_settings *settings, const struct cpl_scheme *scheme);

/* The names of the schemes that a test takes, as "a, b or c" in `out` (size bytes). Returns out. */
const char *cpl_scheme_names(const cpl_settings *settings, bool (*takes)(const struct cpl_scheme *scheme), char *out,
                             size_t size);

/* DEM steps of the whole run, and windows of n steps; the last window may be shorter. */
uint64_t cpl_total_steps(const cpl_settings *settings);

/* End of the first window [s]. */
double cpl_first_window(const cpl_settings *settings);
uint64_t cpl_total_windows(const cpl_settings *settings);

#endif

/* A scene of the machine, run by the multibody solver in memory, window by window and without particles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_TUMBLER_MACHINE_H
#define SCN_TUMBLER_MACHINE_H

#include "mbd/mbd.h"
#include "scenarios/tumbler/kinematics.h"

#include <stdbool.h>

/* how the barrel is moved: the scenes' parameter barrel_mode */
typedef enum { SCN_WITH_PLATE, SCN_NOT_TURNING, SCN_OSCILLATING, SCN_ON_SPRINGS, SCN_BARREL_MODES } scn_barrel_mode;
extern const char *const scn_barrel_mode_names[SCN_BARREL_MODES]; /* for cases of tables */

typedef struct {
  json_t *scene; /* with numbers alone */
  scn_tumbler law;
  scn_barrel_mode mode;
  mbd_engine *engine;
  const mbd_start *start;
  double window, t;       /* [s] */
  bool ahead;             /* the path is told */
  double *value;          /* (start->nchannel) channels at t */
  tdm_state state;        /* of the barrel's centre of mass at t */
  tdm_nodes path;         /* of the barrel, told for the window after t; the engine's */
  double acceleration[6]; /* of the same, without load [m/s2, rad/s2] */
} scn_machine;

/* Open a scene file with overrides "path=value" (NULL-terminated). The barrel is the coupled body, without load;
 * `ahead`: its path through the window to come is told, as a coupled run asks for it. Zero-initialise; close with
 * scn_machine_close, also after an error. */
tdm_status scn_machine_open(scn_machine *m, const char *file, const char *const *set, double window, bool ahead,
                            tdm_error *err);
void scn_machine_close(scn_machine *m);

/* Where DEM has the barrel at time t of the window to come: on the path that it is told, or, where that needs no nodes,
 * on the parabola. */
tdm_pose scn_machine_path(const scn_machine *m, double t);

/* One window further. */
tdm_status scn_machine_step(scn_machine *m, tdm_error *err);

/* A channel at t; NaN: there is none of that name. */
double scn_machine_channel(const scn_machine *m, const char *name);

/* The same times the window, summed over the windows of `turns` turns of the machine from t on: an integral by the
 * trapezoidal rule, exact to rounding for what is smooth and repeats; `values` (n) are those of the channels `names`.
 */
tdm_status scn_machine_integrate(scn_machine *m, int turns, int n, const char *const *names, double *values,
                                 tdm_error *err);

/* The number of a parameter. */
double scn_machine_parameter(const scn_machine *m, const char *name);

/* The barrel by the closed form at t, off rounded corners: its frame; the frame of its centre of mass. */
scn_tumbler_frame scn_machine_barrel(const scn_machine *m, double t);
tdm_state scn_machine_barrel_state(const scn_machine *m, double t);

/* Is t on a rounded corner of the oscillation? */
bool scn_machine_at_corner(const scn_machine *m, double t);

#endif

/* A mechanism's motion: a scene of bodies alone, run in memory by the multibody solver, and its samples. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_MOTION_H
#define SCN_MOTION_H

#include "coupler/verify/verify.h"
#include "mbd/mechanics/state.h"

/* How a scene is solved; other settings are the scene's. */
typedef struct {
  const char *name; /* in tables and plots: "index3 modified" */
  const char *formulation, *corrector;
} scn_method;

/* Zero-initialise; free with scn_motion_free, also after an error. */
typedef struct {
  int nchannel, nsample;
  tdm_channel *channel; /* (nchannel) */
  double *time;         /* (nsample) from 0 to the end [s] */
  double *value;        /* (nsample x nchannel) */
  int freedom;          /* degrees of freedom */
  mbd_stats stats;
  double wall; /* integration alone [s] */
} scn_motion;

/* The section mbd of a scene file (new reference), or of scenarios/mbd/NAME/scene.json; NULL and an error. */
json_t *scn_motion_section(const char *file, tdm_error *err);
json_t *scn_motion_scene(cpl_verify *v, const char *name, tdm_error *err);

/* Steps of the integrator that tell a run that does not get on from a good one, which takes a fraction of them. */
enum { SCN_MOST_STEPS = 300000 };

/* Solve the section `mbd` (borrowed, unchanged) from 0 to `end` with `nstep` equal intervals between samples, at a
 * relative tolerance; the absolute one is `absolute` times that.
 * TDM_ERR_LIMIT: it needs more than `most_steps` steps. */
tdm_status scn_motion_run(scn_motion *m, const json_t *mbd, const scn_method *method, double tolerance, double absolute,
                          double end, int nstep, long most_steps, tdm_error *err);
void scn_motion_free(scn_motion *m);

/* Samples of a channel: value[i * nchannel] for sample i. NULL: there is none of that name. */
const double *scn_motion_channel(const scn_motion *m, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Angle of a body that turns about the z axis alone, at each sample, counted over turns: into out (nsample) [rad]. A
 * sample interval is shorter than half a turn. false: no such body. */
bool scn_motion_angle(const scn_motion *m, const char *body, double *out);

/* Largest |E(t) - E(0) - work of the drivers| over max - min of the kinetic energy, or over the kinetic energy where it
 * is constant to 1e-3. */
double scn_motion_energy_drift(const scn_motion *m);

/* Largest violation of a joint over the whole run [m, rad]. */
double scn_motion_drift(const scn_motion *m);

#endif

/* A scene of bodies alone: `tandem-mbd run` and `tandem-mbd check`, from a scene file to a result directory.
 *
 *   channels.csv                            time histories of all channels
 *   mechanism_N.vtp, scene.pvd, frames.tdv  what there is to see, for ParaView and viewers
 *   motion, reactions, energies, drift.png  their plots
 *   scene.json, summary.json, mbd.log       the scene with all overrides; settings, counts, times; the log
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_APP_RUN_H
#define MBD_APP_RUN_H

#include "protocol/app/standalone.h"
#include "protocol/output/outputs.h"

/* the command line of tandem-mbd */
extern const tdm_standalone_program mbd_program;

/* What a run reads besides the section mbd. */
typedef struct {
  double end;      /* simulated time [s] */
  double window;   /* the integrator is stopped at its multiples [s] */
  double interval; /* of the time histories [s] */
  tdm_outputs_settings outputs;
} mbd_run_settings;

/* Read the sections time and output; refuse dem and coupling. */
tdm_status mbd_run_settings_read(mbd_run_settings *settings, const tdm_scene *scene, tdm_error *err);

#endif

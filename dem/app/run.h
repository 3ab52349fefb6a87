/* A scene of particles alone: `tandem-dem run` and `tandem-dem check`, from a scene file to a result directory.
 *
 *   channels.csv                         time histories, and channels.png: their plots
 *   particles_N.vtp, walls_N.vtp, scene.pvd, frames.tdv  what there is to see, for ParaView and viewers
 *   particles.xb, scene.str              for the viewers of MOLDYN (moldyn_files.h)
 *   picture_N.png, pictures.png          pictures
 *   scene.json, summary.json, dem.log    the scene with all overrides; settings, times, how it ended; the log
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_APP_RUN_H
#define DEM_APP_RUN_H

#include "protocol/app/standalone.h"
#include "protocol/output/outputs.h"
#include "protocol/scene/time_section.h"

/* the command line of tandem-dem, but for bench */
extern const tdm_standalone_program dem_program;

/* What a run reads besides the section dem. */
typedef struct {
  tdm_time time;
  double interval; /* of the time histories [s] */
  tdm_outputs_settings outputs;
  int ranks;        /* processes that the scene wants */
  bool xb, str;     /* files for the viewers of MOLDYN, at each frame */
  int repose_along; /* axis of the profile, 0: x, 1: y; -1: no angle of repose wanted */
} dem_run_settings;

/* Read the sections time and output; refuse mbd and coupling. Freed with dem_run_settings_free, also after an error. */
tdm_status dem_run_settings_read(dem_run_settings *settings, const tdm_scene *scene, tdm_error *err);
void dem_run_settings_free(dem_run_settings *settings);

#endif

/* What a run writes to be looked at, besides its time histories: frames.tdv (protocol/view/frames.h) and files for
 * ParaView (vtp.h). One object for runs of one solver and for coupled runs.
 *
 *   tdm_outputs_settings_read   the keys of the section output
 *   tdm_outputs_begin           the scenery, which the caller has filled in
 *   tdm_outputs_due             is something due at the state of time t?
 *   tdm_outputs_write           that state, into all that is due
 *   tdm_outputs_end
 *
 * Times lie on a grid from 0 on. A frame shows the state of a step or of a window's end: the first at or after its time
 * on the grid, and the last of the run; and it has the time of that state. A state that is the first after several
 * times of the grid is written once.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_OUTPUT_OUTPUTS_H
#define TDM_OUTPUT_OUTPUTS_H

#include "protocol/output/vtp.h"
#include "protocol/scene/scene.h"
#include "protocol/view/frames.h"
#include "protocol/wire/participant.h"

/* Keys of the section "output". */
typedef struct {
  double particles_interval; /* between frames [s], 0: none */
} tdm_outputs_settings;

/* Read them; `root` is the scene, `least` [s] the shortest interval: a step. Errors stick in output->err. */
void tdm_outputs_settings_read(tdm_outputs_settings *settings, tdm_object *output, const json_t *root, double least);

/* What is doubtful about them in a run until `end` [s], into *warning; false: nothing. */
bool tdm_outputs_doubt(const tdm_outputs_settings *settings, double end, tdm_warning *warning);

/* For people: how many frames there will be. */
double tdm_outputs_frames(const tdm_outputs_settings *settings, double end);

/* Zero-initialise; freed with tdm_outputs_end. */
typedef struct {
  const tdm_outputs_settings *settings; /* borrowed */
  const tdm_results *results;           /* borrowed */
  tdm_scenery scenery;                  /* the caller fills it, before tdm_outputs_begin */
  tdm_snapshot snapshot;                /* for the caller's use */
  double end;                           /* time of the last state [s] */
  double slack;                         /* times this near are the same [s] */
  uint64_t grid;                        /* number of the next time of the grid */
  double next;                          /* when the next frame is due [s]; INFINITY: never */
  FILE *frames;
  char path[4352]; /* of frames.tdv */
  tdm_view_bytes bytes;
  tdm_pvd pvd;
  tdm_vtp_parts parts;
} tdm_outputs;

/* Whether a run with these settings is looked at. */
bool tdm_outputs_wanted(const tdm_outputs_settings *settings);

/* Open the files; the scenery goes into frames.tdv. `end` is the time of the last state, `step` the time between two
 * states [s]. */
tdm_status tdm_outputs_begin(tdm_outputs *outputs, const tdm_outputs_settings *settings, const tdm_results *results,
                             double end, double step, tdm_error *err);

/* When something is due next [s]; INFINITY: never. */
double tdm_outputs_next(const tdm_outputs *outputs);
bool tdm_outputs_due(const tdm_outputs *outputs, double t);

/* Write the state into what is due at its time; of a frame all files are whole, or it is not listed. */
tdm_status tdm_outputs_write(tdm_outputs *outputs, const tdm_snapshot *snapshot, tdm_error *err);

/* Close and free. What was written is on the disk. */
void tdm_outputs_end(tdm_outputs *outputs);

#endif

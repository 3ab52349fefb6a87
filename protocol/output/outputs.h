/* What a run writes to be looked at, besides its time histories: frames.tdv (protocol/view/frames.h), files for
 * ParaView (vtp.h), the distribution of the contacts' forces (histogram.h) and pictures (protocol/draw/drawer.h). One
 * object for runs of one solver and for coupled runs.
 *
 *   tdm_outputs_settings_read   the keys of the section output
 *   tdm_outputs_begin           the scenery, which the caller has filled in
 *   tdm_outputs_due             is something due at the state of time t?
 *   tdm_outputs_write           that state, into all that is due
 *   tdm_outputs_finish          all pictures are there, or why not
 *   tdm_outputs_end
 *
 * Times lie on a grid from 0 on. A frame shows the state of a step or of a window's end: the first at or after its time
 * on the grid, and the last of the run; and it has the time of that state. A state that is the first after several
 * times of the grid is written once. A picture shows the first state at or after its time; there are as many as times.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_OUTPUT_OUTPUTS_H
#define TDM_OUTPUT_OUTPUTS_H

#include "protocol/draw/drawer.h"
#include "protocol/output/histogram.h"
#include "protocol/output/share.h"
#include "protocol/output/vtp.h"
#include "protocol/scene/scene.h"
#include "protocol/view/frames.h"
#include "protocol/wire/participant.h"

/* Keys of the section "output". */
typedef struct {
  double particles_interval; /* between frames [s], 0: none */
  bool contacts;             /* frames have the contacts */
  tdm_pictures pictures;
  json_t *pictures_json; /* as the scene has them; NULL: none */
} tdm_outputs_settings;

/* Read them; `root` is the scene, `least` [s] the shortest interval: a step, `end` [s] the run's. Errors stick in
 * output->err. Freed with tdm_outputs_settings_free, also after an error. */
void tdm_outputs_settings_read(tdm_outputs_settings *settings, tdm_object *output, const json_t *root, double least,
                               double end);
void tdm_outputs_settings_free(tdm_outputs_settings *settings);

/* What is doubtful about them in a run until `end` [s]: number k of it, from 0 on, into *warning; false: no more. */
bool tdm_outputs_doubt(const tdm_outputs_settings *settings, double end, int k, tdm_warning *warning);

/* For people: lines of how many frames and pictures there will be; nothing when there are none. */
void tdm_outputs_print(const tdm_outputs_settings *settings, double end);

/* Zero-initialise; freed with tdm_outputs_end. */
typedef struct {
  const tdm_outputs_settings *settings; /* borrowed */
  const tdm_results *results;           /* borrowed */
  tdm_scenery scenery;                  /* the caller fills it, before tdm_outputs_begin */
  tdm_snapshot snapshot;                /* for the caller's use */
  tdm_sharers sharers;                  /* who else has shares of snapshots; the caller sets it if there are some */
  double end;                           /* time of the last state [s] */
  double slack;                         /* times this near are the same [s] */
  uint64_t grid;                        /* number of the next time of the grid */
  double next;                          /* when the next frame is due [s]; INFINITY: never */
  FILE *frames;
  char path[4352]; /* of frames.tdv */
  tdm_view_bytes bytes;
  tdm_pvd pvd;
  tdm_vtp_parts parts;
  tdm_force_histogram histogram;
  tdm_drawer drawer;
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

/* Whether what is due at time t shows contacts; whether it needs all particles in one process: pictures do, the files
 * of a frame are content with shares. */
bool tdm_outputs_want_contacts(const tdm_outputs *outputs, double t);
bool tdm_outputs_want_all(const tdm_outputs *outputs, double t);

/* Write the state, or this process's share and then the others', into what is due at its time; of a frame all files are
 * whole, or it is not listed. */
tdm_status tdm_outputs_write(tdm_outputs *outputs, const tdm_snapshot *snapshot, tdm_error *err);

/* At the end of a run, also one that failed: wait for the pictures. What went wrong with them becomes a notice among
 * the remarks, of time t [s]. Does nothing the second time. */
void tdm_outputs_finish(tdm_outputs *outputs, double t);

/* Pictures so far. */
int tdm_outputs_pictures(const tdm_outputs *outputs);

/* Close and free. What was written is on the disk. */
void tdm_outputs_end(tdm_outputs *outputs);

#endif

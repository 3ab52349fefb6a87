/* An FMU's run on its solvers, in tandem-serve: from the inputs of a step to its outputs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_SERVE_PERFORM_H
#define CPL_EXPORT_SERVE_PERFORM_H

#include "coupler/export/guest/link.h"
#include "coupler/export/serve/stage.h"
#include "coupler/state/loop.h"

/* Where it is, between steps. */
typedef struct {
  uint64_t step, window; /* DEM steps and windows so far; dem and mbd */
  double t;              /* from the start [s] */
  tdm_state *at;         /* (nbody) dem: where its bodies are */
} cpl_performed;

typedef struct {
  cpl_stage *stage; /* borrowed */
  cpl_export_layout layout;
  bool inputs_at_end;
  cpl_loop loop; /* of the whole co-simulation */
  bool looping;
  cpl_performed now, kept[GUEST_SLOTS_MAX];
  tdm_state *start, *end; /* (nbody) of the path of a step */
  double *output;         /* of the last step */
  double *mobility;       /* (6 nbody x 6 nbody); NULL: none is told */
} cpl_performance;

/* Begin, with both solvers of the side READY: outputs at the start under the inputs. Freed also after an error. */
tdm_status cpl_perform_start(cpl_performance *p, cpl_stage *stage, bool inputs_at_end, const double *input,
                             tdm_error *err);
void cpl_perform_free(cpl_performance *p);

/* From t by h [s]. *refused: nothing was done, a step of another length may go; *err says why. */
tdm_status cpl_perform_step(cpl_performance *p, double t, double h, const double *input, bool *refused, tdm_error *err);

/* Keep the state under a slot, or go back to it. */
tdm_status cpl_perform_keep(cpl_performance *p, int slot, tdm_error *err);
tdm_status cpl_perform_restore(cpl_performance *p, int slot, tdm_error *err);

/* States from inputs (nbody) of motions, quaternions made unit; an error where one is none. */
tdm_status cpl_perform_states(const cpl_settings *settings, const double *input, tdm_state *out, tdm_error *err);

#endif

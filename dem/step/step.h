/* One DEM step, the table of contents of the engine.
 *
 * Whatever steps particles calls dem_step: a window of a co-simulation, a run of particles alone, settling, benchmarks.
 * The step stands above sources, sinks and the guard, because it ends with them.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STEP_STEP_H
#define DEM_STEP_STEP_H

#include "dem/proxy/proxy.h"
#include "dem/step/forces.h"
#include "dem/step/window_sums.h"

/* What a step is to do. All zero but for dt: particles under contacts and gravity, coupled bodies where they are, and
 * nobody looks. Pointers are borrowed for the step. */
typedef struct {
  double dt;            /* [s] */
  double time;          /* at its end, for sources, sinks and the guard [s] */
  bool settling;        /* with the contacts of the settle phase; driven bodies and the box stay as they are */
  bool flow;            /* sources and sinks act at its end */
  bool guard;           /* the guard looks at its end */
  const dem_path *path; /* (ncoupled) of the coupled bodies over the window; NULL: they stay where they are */
  dem_proxy *proxy; /* carries the coupled bodies instead of a path; NULL: none. Not with the multi-step integrator */
  uint64_t k, n;    /* with one of these or sums: the step leads from k - 1 to k (1 ... n) of the window's n */
  dem_window_sums *sums; /* what the loads of the window come to; NULL: not wanted */
} dem_step_task;

/* Errors: TDM_ERR_MEMORY; TDM_ERR_NUMERIC when the guard stops the run. The data is then at no step boundary. */
tdm_status dem_step(dem_data *data, const dem_step_task *task, tdm_error *err);

#endif

/* What the solver reports in READY: its figures, doubtful settings with the cure, and notes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_ADAPTER_REPORT_H
#define DEM_ADAPTER_REPORT_H

#include "dem/settle/settle.h"
#include "dem/watch/limits.h"

enum { DEM_WARNINGS_MAX = 16 };

typedef struct {
  json_t *json;      /* the figures; owned */
  dem_limits limits; /* of the step, at the speed to be expected */
  int nwarning;
  tdm_warning warning[DEM_WARNINGS_MAX];
} dem_report;

/* Of the state at the start of the run, after settling and before sources made anything. `nbehind` particles are behind
 * planes. report->json is the caller's, also after an error. All ranks make it, and dem_fill. Errors: TDM_ERR_MEMORY.
 */
tdm_status dem_report_make(dem_report *report, dem_data *data, const dem_settled *settled, int nbehind, tdm_error *err);

/* Warn of sources that found no room at the start. */
void dem_report_flow(dem_report *report, const dem_data *data);

/* Mass, centre of mass and inertia of all particles as they lie. */
typedef struct {
  double mass;      /* [kg] */
  tdm_vec3 com;     /* world [m]; 0 without particles */
  tdm_mat3 inertia; /* about com, world axes, with each particle's own 2/5 m R^2 [kg m2] */
} dem_fill;

dem_fill dem_fill_now(dem_data *data);

#endif

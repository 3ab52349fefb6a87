/* The section "time" of a scene, and the grid of the outputs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_SCENE_TIME_SECTION_H
#define TDM_SCENE_TIME_SECTION_H

#include "protocol/scene/scene.h"

#include <stdint.h>

typedef struct {
  double end; /* simulated time [s] */
  double dt;  /* DEM step [s] */
} tdm_time;

/* Read the section of the scene's root. */
tdm_time tdm_read_time(tdm_object *root);

/* DEM steps of the whole run; the last one may reach a little beyond the end. */
uint64_t tdm_total_steps(const tdm_time *time);

/* "interval" of an output [s], at least a step; `fallback` when it is missing. */
double tdm_read_interval(tdm_object *o, const char *key, double fallback, double dt);

#endif

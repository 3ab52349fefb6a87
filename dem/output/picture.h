/* Pictures by gnuplot: the particles as discs of their true radius, seen along an axis, in front of the walls.
 *
 * picture_NNN.png one time each, pictures.png all of them in a row; .gp and .dat are what they are made of.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_PICTURE_H
#define DEM_OUTPUT_PICTURE_H

#include "dem/output/view.h"
#include "protocol/results/results.h"
#include "protocol/scene/scene.h"

/* one row a way to colour a particle: its name in the scene, its label */
#define DEM_COLOR_LIST(X)               \
  X(speed, "speed [m/s]")               \
  X(id, "id")                           \
  X(radius, "radius [m]")               \
  X(material, "material")               \
  X(height0, "height at the start [m]") \
  X(across0, "place across at the start [m]")

typedef enum {
#define X(name, label) DEM_COLOR_##name,
  DEM_COLOR_LIST(X)
#undef X
} dem_color;

/* The key output.pictures. */
typedef struct {
  int ntime;
  int late;       /* times that are after the end of the run and left out */
  double *time;   /* (ntime) ascending [s] */
  int across, up; /* axes of the picture: 0, 1, 2 */
  dem_color color;
  double scale[2];        /* colours from … to; equal: chosen for the particles */
  bool has_limits;        /* low and high are given */
  double low[2], high[2]; /* across, up [m] */
} dem_picture_settings;

typedef struct {
  const dem_picture_settings *settings; /* borrowed */
  const tdm_results *results;           /* borrowed */
  double low[2], high[2];               /* shown: across, up [m] */
  int drawn;                            /* pictures so far */
  double *time;                         /* (drawn) of the states that they show [s] */
  int64_t nborn;                        /* particles whose start is known */
  size_t capacity;
  tdm_vec3 *born; /* (nborn) position of each id when first seen [m] */
} dem_pictures;

/* Read the key; without it there are no times. Freed with dem_picture_settings_free, also after an error. */
void dem_picture_settings_read(dem_picture_settings *settings, tdm_object *output, double time_end);
void dem_picture_settings_free(dem_picture_settings *settings);

/* Begin with the scene's bounds at the start. */
void dem_pictures_begin(dem_pictures *pictures, const dem_picture_settings *settings, const tdm_results *results,
                        const dem_bounds *bounds);

/* Note where new particles are. */
tdm_status dem_pictures_watch(dem_pictures *pictures, const tdm_snapshot *snapshot, tdm_error *err);

/* Draw the state of the time `t` [s], the step that the next time of the settings lies in or at. A missing gnuplot is
 * an error that the caller may take as a notice.
 */
tdm_status dem_picture_draw(dem_pictures *pictures, double t, const tdm_scenery *scenery, const tdm_snapshot *snapshot,
                            tdm_error *err);

/* pictures.png: all that were drawn, in a row. */
tdm_status dem_pictures_row(const dem_pictures *pictures, tdm_error *err);

void dem_pictures_free(dem_pictures *pictures);

#endif

/* The key output.pictures: one picture or a list of them, each a view of the run and the times at which it is drawn. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_SETTINGS_H
#define TDM_DRAW_SETTINGS_H

#include "protocol/scene/scene.h"

/* one row a way to colour: its name in the scene, its label; particles, but for contact_force */
#define TDM_COLOR_LIST(X)                     \
  X(speed, "speed [m/s]")                     \
  X(id, "order of creation")                  \
  X(radius, "radius [m]")                     \
  X(material, "material")                     \
  X(height0, "height at the start [m]")       \
  X(across0, "place across at the start [m]") \
  X(force, "force of contacts [N]")           \
  X(size_class, "size class of the sinks")    \
  X(contact_force, "normal force of a contact [N]")

/* What colours the particles; or contacts, which are then drawn as lines in their place. */
typedef enum {
#define X(name, label) TDM_COLOR_##name,
  TDM_COLOR_LIST(X)
#undef X
      TDM_COLOR_COUNT
} tdm_color;

/* How surfaces are drawn. Left to the view: flat views draw all behind the particles, views in space draw what stands
 * and the walls of containers translucent, and the faces of bodies that move solid. */
typedef enum { TDM_SURFACE_auto, TDM_SURFACE_solid, TDM_SURFACE_translucent, TDM_SURFACE_hidden } tdm_surface_look;

/* From where one looks. */
typedef struct {
  bool flat; /* along an axis, with axes and ticks; false: in space */

  int across, up_axis;    /* flat: axes of the picture, 0, 1, 2 */
  bool has_limits;        /* flat: low and high are given */
  double low[2], high[2]; /* flat: shown across and up [m] */

  bool has_from, has_at, has_up; /* in space: which of these are given; the others are chosen from what there is */
  tdm_vec3 from, at, up;         /* [m], [m], direction */
  double angle;                  /* in space: from the lower to the upper edge, perspective [deg]; 0: parallel */
  double height;                 /* in space, parallel: from the lower to the upper edge [m]; 0: all there is */
} tdm_view;

/* The pictures of one view. */
typedef struct {
  char name[64]; /* "": the only one without a name */
  int ntime;
  int late;     /* times that are after the end of the run and left out */
  double *time; /* (ntime) ascending [s] */
  tdm_view view;
  tdm_color color;
  double range[2]; /* colours from … to; equal: chosen for the particles */
  tdm_surface_look walls, bodies;
  bool cut;                       /* what is in front of a plane is left out */
  tdm_vec3 cut_point, cut_normal; /* of the plane [m], unit; world axes */
  bool mechanism;                 /* draw joints, springs and other lines, and marks */
  int size[2];                    /* pixels across, up; 0: chosen */
} tdm_picture;

/* All of a run. */
typedef struct {
  int count;
  tdm_picture *picture; /* (count) */
} tdm_pictures;

/* Read output.pictures; without it there are none. time_end [s]: later times are counted and left out. Errors stick in
 * output->err. Freed with tdm_pictures_free, also after an error. */
void tdm_pictures_read(tdm_pictures *pictures, tdm_object *output, double time_end);
void tdm_pictures_free(tdm_pictures *pictures);

/* A picture as output.pictures has it, but for its times, which are not asked for: what a command line gives. */
void tdm_picture_read(tdm_picture *picture, json_t *json, const char *path, tdm_error *err);

/* "picture" or "picture_NAME", with which the names of its files begin; "pictures.png" or "pictures_NAME.png", all in a
 * row; into out. Returns out. */
const char *tdm_picture_prefix(const tdm_picture *picture, char *out, size_t size);
const char *tdm_picture_row_name(const tdm_picture *picture, char *out, size_t size);

/* The name of a way to colour, as in the scene, and its label. */
const char *tdm_color_name(tdm_color color);
const char *tdm_color_label(tdm_color color);

/* Whether contacts are coloured, and drawn in place of particles. */
bool tdm_color_of_contacts(tdm_color color);

#endif

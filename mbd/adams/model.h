/* An Adams data set as a scene: what its statements are to each other.
 *
 *   adm_import          all of it: data set in, scene out
 *   adm_model           parts, markers, joints and splines by their identifiers; where they stand at the start
 *   adm_add_...         one statement as an element of the scene
 *
 * JOINT, MOTION and forces act from J to I: the first body of a scene's pair is the part of J, the second that of I. So
 * coordinates, forces and moments have the signs of Adams' on the I marker.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ADAMS_MODEL_H
#define MBD_ADAMS_MODEL_H

#include "mbd/adams/function.h"
#include "protocol/math/pose.h"

enum { ADM_NAME_MAX = 40 };

typedef struct {
  const adm_statement *of;
  bool ground;
  char name[ADM_NAME_MAX];
  tdm_pose pose;              /* of its axes, at the start [m] */
  double mass, inertia[6];    /* [kg]; xx yy zz xy xz yz, integrals of products, about IM, its axes [kg m2] */
  long cm, im, vm, wm;        /* markers */
  tdm_vec3 velocity, angular; /* along VM and WM [m/s, rad/s] */
  json_t *markers;            /* those that the scene needs, borrowed from its body */
} adm_part;

typedef struct {
  const adm_statement *of;
  int part;
  tdm_pose pose;      /* at the start, world [m] */
  tdm_euler313 euler; /* the same orientation [rad] */
  bool written;       /* its body has it */
} adm_marker;

/* A joint that the scene has. */
typedef struct {
  const adm_statement *of;
  char name[ADM_NAME_MAX];
  int marker[2];          /* I, J */
  bool turns, translates; /* coordinates */
} adm_joint;

typedef struct {
  double force, mass, length, time; /* N, kg, m, s a unit */
} adm_units;

typedef struct {
  adm_dataset dataset;
  adm_units units;
  tdm_vec3 gravity; /* [m/s2] */
  int npart, nmarker, njoint, nspline;
  adm_part *part;
  adm_marker *marker; /* (nmarker) by identifier, ascending */
  adm_joint *joint;
  adm_spline *spline;
  json_t *bodies, *joints, *drivers, *forces; /* of the scene */
  int nread, nshown;                          /* statements */
  json_t *left_out;                           /* strings, what may act, with their line */
  json_t *shown;                              /* strings, what does not */
  json_t *notes;                              /* strings */
} adm_model;

/* Read a data set into a scene (new reference in *scene) that runs to `end` [s], SI units. Zero-initialise the model,
 * which has the counts and what was left out, and free it, also after an error. */
tdm_status adm_import(adm_model *m, const char *file, double end, json_t **scene, tdm_error *err);
void adm_model_free(adm_model *m);

/* UNITS, ACCGRAV, PART, MARKER and SPLINE, wherever they stand. */
tdm_status adm_model_read(adm_model *m, tdm_error *err);

/* The marker of this identifier, which `of` names at `line`; -1 and an error if there is none. */
int adm_find_marker(const adm_model *m, const adm_statement *of, int line, long id, tdm_error *err);

/* A name for the element of a statement: that of Adams View or "prefix_ID"; none in `list` has it. */
void adm_name(const adm_statement *of, const char *prefix, const json_t *list, char name[ADM_NAME_MAX]);

/* "body.m12", "body.m12.z" of a marker on a part that moves, which its body has from now on; numbers on the ground.
 * axis: 0, 1, 2 for x, y, z; -1: the point. New reference. */
json_t *adm_place(adm_model *m, int marker, int axis);

/* World directions of the axes, as columns. */
static inline tdm_mat3 adm_axes(const adm_marker *marker) {
  return tdm_quat_to_matrix(marker->pose.orientation);
}
static inline tdm_vec3 adm_axis(const adm_marker *marker, int k) {
  const tdm_mat3 a = adm_axes(marker);
  return tdm_v3(a.m[0][k], a.m[1][k], a.m[2][k]);
}

/* Angle of I against J about the z axis of J at the start, from the x axes [rad]. */
double adm_angle(const adm_marker *i, const adm_marker *j);

/* [body of J, body of I]. */
json_t *adm_bodies(const adm_model *m, const int marker[2]);

/* Leave the statement out, with printf's reason; adm_note: something to know of one that is there. */
void adm_leave_out(adm_model *m, const adm_statement *of, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
void adm_note(adm_model *m, const adm_statement *of, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Attributes that no reader knows. */
void adm_note_unknown(adm_model *m, const adm_reader *r);

/* Read I and J of a statement into marker[2]; they must be on two parts, of which one moves. */
tdm_status adm_read_pair(const adm_model *m, const adm_reader *r, int marker[2]);

/* Read FUNCTION into *form; NULL or why it cannot be (also where there is none). */
const char *adm_read_function(const adm_reader *r, adm_form *form);

tdm_status adm_add_joint(adm_model *m, const adm_statement *of, tdm_error *err);   /* JOINT but RACKPIN, JPRIM */
tdm_status adm_add_gcon(adm_model *m, const adm_statement *of, tdm_error *err);    /* GCON */
tdm_status adm_add_coupled(adm_model *m, const adm_statement *of, tdm_error *err); /* COUPLER, RACKPIN */
tdm_status adm_add_motion(adm_model *m, const adm_statement *of, tdm_error *err);  /* MOTION */
tdm_status adm_add_force(adm_model *m, const adm_statement *of, tdm_error *err);   /* SFORCE */
tdm_status adm_add_spring(adm_model *m, const adm_statement *of, tdm_error *err);  /* SPRINGDAMPER */
tdm_status adm_add_bushing(adm_model *m, const adm_statement *of, tdm_error *err); /* BUSHING */

#endif

/* What there is to see of a run: the scenery, which stays as it is, and snapshots, each the state of one instant.
 *
 * Solvers fill them, the server puts those of two solvers together; ParaView files, pictures, the viewer's page and the
 * live view are made of them and of nothing else. Looking changes no bit of a run.
 *
 * A body's surfaces are polygons in its own axes: they are in the scenery, and a snapshot has the body's pose. Lines
 * (joints, springs) are in the scenery by name and kind; a snapshot has their points. SI units, world axes unless said
 * otherwise. Zero-initialise both before use ("= {0}"); arrays grow as needed and are the object's own.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_VIEW_VIEW_H
#define TDM_VIEW_VIEW_H

#include "protocol/base/status.h"
#include "protocol/math/pose.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
  TDM_VIEW_NAME_MAX = 64,
  TDM_VIEW_CORNERS_MAX = 12,    /* of a polygon */
  TDM_VIEW_COUNT_MAX = 1 << 28, /* of anything in a scenery or a snapshot */
};

/* ---- scenery ---- */

/* Something rigid with a pose. */
typedef struct {
  char name[TDM_VIEW_NAME_MAX]; /* as the scene calls it */
  bool dem, mbd;                /* who computes with it; both: a coupled body */
  bool still;                   /* never moves: ground, walls that stand */
  bool marked;                  /* has no surface: its centre of mass is drawn as a mark */
} tdm_view_body;

/* A flat piece of a body's surface. */
typedef struct {
  int body;    /* index among the bodies */
  bool solid;  /* a face of a solid body; false: a cut through a plane without end, or the wall of a container */
  int ncorner; /* 3 at least */
  tdm_vec3 corner[TDM_VIEW_CORNERS_MAX]; /* in order around it; body axes, from the centre of mass [m] */
} tdm_view_polygon;

/* one row a kind of line: name on the wire and in pages, text */
#define TDM_VIEW_LINE_LIST(X)            \
  X(joint, "joint")                      \
  X(spring, "spring or damper")          \
  X(cable, "cable")                      \
  X(cylinder, "cylinder or other drive") \
  X(bar, "bar of a body without a shape, from its centre of mass")

/* Kinds of lines. */
typedef enum {
#define X(name, text) TDM_VIEW_LINE_##name,
  TDM_VIEW_LINE_LIST(X)
#undef X
      TDM_VIEW_LINE_COUNT
} tdm_view_line_kind;

/* Something that is drawn as a line through points; a single point is drawn as a dot (a joint whose ends coincide). */
typedef struct {
  char name[TDM_VIEW_NAME_MAX]; /* as the scene calls it */
  tdm_view_line_kind kind;      /* what it is */
} tdm_view_line;

/* A material of particles. */
typedef struct {
  char name[TDM_VIEW_NAME_MAX]; /* as the scene calls it */
} tdm_view_material;

/* What stays as it is during a run. */
typedef struct {
  int nbody, npolygon, nline, nmaterial, nedge; /* numbers of what follows */
  tdm_view_body *body;                          /* (nbody) */
  tdm_view_polygon *polygon;                    /* (npolygon) */
  tdm_view_line *line;                          /* (nline) */
  tdm_view_material *material;                  /* (nmaterial) of the particles */
  double *edge;       /* (nedge) ascending radii between the size classes of the scene's sinks, nedge + 1 of them [m] */
  tdm_vec3 gravity;   /* [m/s2]; zeros: none, and up is +z */
  size_t capacity[5]; /* of the arrays, in their order */
} tdm_scenery;

/* Append one (copied). TDM_ERR_MEMORY. */
tdm_status tdm_scenery_add_body(tdm_scenery *scenery, const tdm_view_body *body, tdm_error *err);
tdm_status tdm_scenery_add_polygon(tdm_scenery *scenery, const tdm_view_polygon *polygon, tdm_error *err);
tdm_status tdm_scenery_add_line(tdm_scenery *scenery, const char *name, tdm_view_line_kind kind, tdm_error *err);
tdm_status tdm_scenery_add_material(tdm_scenery *scenery, const char *name, tdm_error *err);
tdm_status tdm_scenery_add_edge(tdm_scenery *scenery, double radius, tdm_error *err);
/* Empty it, with its memory kept; free it. */
void tdm_scenery_clear(tdm_scenery *scenery);
void tdm_scenery_free(tdm_scenery *scenery);

/* ---- snapshot ---- */

/* Every array of a particle, once: type, name, numbers each, unit, text. Copies, messages, files are made by this. */
#define TDM_VIEW_PARTICLE_LIST(X)                                              \
  X(int64_t, id, 1, "", "order of creation")                                   \
  X(int32_t, material, 1, "", "number of the material")                        \
  X(int32_t, size_class, 1, "", "size class of the scene's sinks, -1: none")   \
  X(double, radius, 1, "m", "radius")                                          \
  X(tdm_vec3, position, 3, "m", "place")                                       \
  X(tdm_vec3, velocity, 3, "m/s", "velocity")                                  \
  X(tdm_vec3, spin, 3, "rad/s", "angular velocity")                            \
  X(tdm_vec3, force, 3, "N", "force of contacts, at the end of the last step") \
  X(tdm_vec3, born, 3, "m", "place at which the particle was first seen")

/* Two that touch: of a particle and a mesh all its facets together. */
typedef struct {
  int64_t particle, other; /* ids; other: -1, a wall */
  tdm_vec3 from, to;       /* the particle's centre; that of the other's nearest image, or the place on the wall [m] */
  double force;            /* along the line between the centres, or the wall's normal; > 0: they repel [N] */
} tdm_view_contact;

/* Particles of a snapshot that are next to each other among all of the state, too. */
typedef struct {
  int first, count; /* place of the first among all; how many */
} tdm_view_range;

/* The state of one instant; or a share of it, where several processes have some of its particles each. */
typedef struct {
  double time; /* [s] */

  int nbody;      /* of the scenery */
  tdm_pose *pose; /* (nbody) centres of mass and orientations */

  int nline, npoint; /* lines of the scenery, and points of all lines */
  int32_t *line_end; /* (nline) the point after the last one of each line */
  tdm_vec3 *point;   /* (npoint) [m] */

  int nforce;         /* npolygon of the scenery, or 0: forces on polygons are not known */
  tdm_vec3 *force_on; /* (nforce) of the particles on each polygon, world [N]; NaN: not known for this one */

  bool oriented;         /* the scene keeps orientations of the particles */
  int norientation;      /* nparticle if oriented, else 0 */
  tdm_quat *orientation; /* (norientation) of the particles */

  int nparticle; /* arrays (nparticle), ascending by id */
#define X(type, name, n, unit, text) type *name;
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  int nall;              /* particles of the state: nparticle, or more of a share */
  int nrange;            /* which of all the particles are; not on the wire */
  tdm_view_range *range; /* (nrange) ascending; a whole snapshot has one, {0, nparticle} */

  bool with_contacts; /* set by who asks for a snapshot: contacts are wanted, which cost an evaluation of all forces */
  int ncontact;       /* number of contacts */
  tdm_view_contact *contact; /* (ncontact) in an order that means nothing */
  size_t capacity[8];        /* of bodies, lines, points, forces, particles, orientations, contacts, ranges */
} tdm_snapshot;

/* Make room for so many and set the counts; contents are undefined. Points and contacts are added one by one. */
tdm_status tdm_snapshot_resize(tdm_snapshot *snapshot, int nbody, int nline, int nforce, int nparticle, tdm_error *err);
/* Make room for an orientation of each particle; contents are undefined. */
tdm_status tdm_snapshot_orient(tdm_snapshot *snapshot, tdm_error *err);
/* The particles are a share of so many; which of them is to be added, range by range, ascending. */
void tdm_snapshot_share(tdm_snapshot *snapshot, int nall);
tdm_status tdm_snapshot_add_range(tdm_snapshot *snapshot, int first, int count, tdm_error *err);
/* Append a point; then say that line k ends there. Lines are to be filled in their order. */
tdm_status tdm_snapshot_add_point(tdm_snapshot *snapshot, tdm_vec3 point, tdm_error *err);
void tdm_snapshot_end_line(tdm_snapshot *snapshot, int k);
/* Append a contact (copied). */
tdm_status tdm_snapshot_add_contact(tdm_snapshot *snapshot, const tdm_view_contact *contact, tdm_error *err);
void tdm_snapshot_free(tdm_snapshot *snapshot);

/* ---- bytes ---- */

/* A growing buffer of bytes; *data is the caller's: tdm_view_bytes_free. */
typedef struct {
  uint8_t *data;         /* (size) what there is so far */
  size_t size, capacity; /* used, and allocated [bytes] */
} tdm_view_bytes;

/* Append scenery and snapshot as bytes, for messages and files: PROTOCOL.md, "What there is to see". With `single`
 * real numbers take four bytes instead of eight. TDM_ERR_MEMORY. */
tdm_status tdm_scenery_encode(const tdm_scenery *scenery, bool single, tdm_view_bytes *bytes, tdm_error *err);
/* Likewise. */
tdm_status tdm_snapshot_encode(const tdm_snapshot *snapshot, bool single, tdm_view_bytes *bytes, tdm_error *err);
/* How the record of a snapshot lies in memory: `before` bytes, the arrays of the particles one behind the other, each
 * of so many bytes a particle, and the rest. The record of a share has the counts of all, and the arrays of its own. */
enum { TDM_VIEW_ARRAYS_MAX = 16 };
typedef struct {
  size_t before;                     /* bytes in front of the arrays */
  int narray;                        /* number of arrays */
  size_t width[TDM_VIEW_ARRAYS_MAX]; /* (narray) bytes a particle */
} tdm_view_layout;

/* Of a snapshot's record, with numbers in single precision or not. */
tdm_view_layout tdm_snapshot_layout(const tdm_snapshot *snapshot, bool single);

/* Free the buffer; *bytes is as new. */
void tdm_view_bytes_free(tdm_view_bytes *bytes);

/* The first record in `size` bytes from anywhere: its kind and its length. TDM_ERR_PROTOCOL when it is none, or when
 * there are fewer bytes than it says. */
typedef enum { TDM_VIEW_SCENERY = 1, TDM_VIEW_SNAPSHOT = 2 } tdm_view_record;
tdm_status tdm_view_peek(const void *data, size_t size, tdm_view_record *record, size_t *length, tdm_error *err);

/* Decode one record (*scenery and *snapshot are reused); every count is checked against the bytes that are there. */
tdm_status tdm_scenery_decode(tdm_scenery *scenery, const void *data, size_t size, tdm_error *err);
tdm_status tdm_snapshot_decode(tdm_snapshot *snapshot, const void *data, size_t size, tdm_error *err);

/* A snapshot that came from elsewhere belongs to a scenery: as many bodies, lines and forces, line ends in order. */
tdm_status tdm_snapshot_check(const tdm_snapshot *snapshot, const tdm_scenery *scenery, tdm_error *err);

#ifdef __cplusplus
}
#endif

#endif

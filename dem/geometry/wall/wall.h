/* Walls, and what a shape is: a table of operations.
 *
 * Every entry of a body's "shapes" is read into walls, each with a surface of one shape: a box that the particles are
 * in becomes up to six planes, a sphere becomes one wall. A shape is one file with a row of operations (dem_shape) and
 * one line of the list in rows.h; a program can add its own with dem_shape_add. All else, the contact loops, neighbour
 * lists, limits, fingerprints and pictures, asks these operations.
 *
 * A wall's own axes: `point` is their origin and `turn` their orientation in the body's axes; an operation that takes a
 * place takes it in them. Its sizes are in the fields `half`, `radius` and `length`, whose meaning is the shape's, or
 * in `data`, which is the shape's own.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_WALL_WALL_H
#define DEM_GEOMETRY_WALL_WALL_H

#include "dem/geometry/part.h"
#include "dem/geometry/touch.h"
#include "dem/geometry/triangle.h"
#include "dem/geometry/wall/outline.h"
#include "protocol/scene/scene.h"

#include <stddef.h>

typedef struct dem_shape dem_shape;

typedef enum {
  DEM_HOLDS,          /* it acts, unless it has let go until clear */
  DEM_LETS_GO_HERE,   /* it does not act while the sphere is there */
  DEM_LETS_GO_FOR_ALL /* it does not act until the two are clear of each other */
} dem_letting;

typedef struct {
  const dem_shape *shape;
  int body;
  int material;      /* index among the scene's materials */
  int geometry;      /* of dem_model.geometry */
  tdm_vec3 point;    /* on the plane, centre of the box, middle of the end at z = 0; body axes, from the centre of mass
                        [m]. A mesh: 0 */
  tdm_quat turn;     /* the wall's own axes to body axes; all zeros: none */
  tdm_vec3 normal;   /* plane: unit, towards the particles; body axes */
  tdm_vec3 half;     /* box: half edge lengths [m] */
  double radius[2];  /* cylinder, cone: at z = 0 and at z = length of its own axes; ball: both;
                        disc: inner and outer [m] */
  double length;     /* of a piece [m] */
  bool inside;       /* the particles are inside */
  bool endless;      /* solid all the way behind its surface: it acts to a depth of one radius, and a particle that is
                        deeper went through */
  bool solid;        /* has an inside that is full: nothing can fall in it from its top to its bottom */
  bool plates;       /* a mesh that is made of a container's faces, no file */
  void *data;        /* the shape's own; of the wall: freed by shape->destroy */
  tdm_twist surface; /* motion of the surface in the wall (a belt), of the wall's own origin, own axes */
  bool moves;        /* the surface has a motion of its own */
} dem_wall;

/* A wall where it is now. */
typedef struct {
  tdm_vec3 point, normal; /* world */
  tdm_mat3 axes;          /* the wall's own axes to world; a mesh's own axes are the body's */
} dem_wall_place;

/* A container: a box shape seen from inside, and its lid if it has one. */
typedef struct {
  int body;
  tdm_vec3 center;       /* body axes [m] */
  tdm_quat turn;         /* the box's own axes to body axes */
  tdm_vec3 half;         /* own axes [m] */
  int lid;               /* wall that is the lid, -1: none */
  double gap;            /* of the lid above the highest particle [m] */
  double press;          /* force with which the lid is then pressed on the bed, 0: none [N] */
  int first_wall, nwall; /* its planes */
  bool unsaid;           /* some are, and the scene does not say that its walls are without end */
} dem_box;

/* Growing lists of walls and boxes. */
typedef struct {
  dem_wall *wall;
  int count;
  dem_box *box;
  int nbox;
  dem_part part;               /* of the body that is read now */
  const char *const *material; /* (nmaterial) names of the scene's materials */
  int nmaterial;
  int body_material; /* of the body that is read now */
} dem_wall_list;

/* What a wall needs to draw itself. */
typedef struct {
  const dem_wall_place *place;
  const tdm_pose *pose;     /* of its body */
  const dem_bounds *bounds; /* of the scene: what has no end is drawn so far */
  const dem_box *box;       /* (nbox) containers */
  int nbox;
  double lid; /* how far the wall, a lid, is moved outward [m] */
} dem_wall_view;

/* The operations of a shape. Required: number, and gap or half_space. An operation that is NULL is one that the shape
 * does without, as it says there. */
struct dem_shape {
  const char *type; /* in the scene; NULL: only readers of other shapes make walls of it */
  int number;       /* of the surface, in fingerprints of stored states: no two alike, and never changed */
  bool half_space;  /* a plane: its gap is taken along the normal of its place */

  /* Read the keys of a shape of `body` and append its walls (dem_walls_append). */
  void (*read)(tdm_object *o, int body, dem_wall_list *list);

  /* Signed distance of x from the surface (negative inside a solid) and the unit normal there, towards x. For a solid
   * the nearest point may lie on a face, an edge or a corner; a point inside leaves by the nearest face. Thin shells
   * have no inside: the distance is never negative. */
  double (*gap)(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal);

  /* The same for the centre of a sphere, of a shape that is another to spheres of another size: a screen that lets the
   * small ones through. It changes with x by no more than x does. NULL: as gap. */
  double (*sphere_gap)(const dem_wall *wall, tdm_vec3 x, double radius, tdm_vec3 *normal);

  /* Does the wall let a sphere go that touches it with its centre at x, so that it does not act on it? NULL: it lets
   * none go. Only of a shape with sphere_gap. */
  dem_letting (*lets_go)(const dem_wall *wall, tdm_vec3 x, double radius);

  /* The box around the wall, its own axes. NULL: it has no end. */
  void (*box)(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high);

  /* The following three take that box; a shape may know better. How far it reaches along the unit vector `up` (world),
   * the fastest of its belt (dem_wall_belt) [m/s], and what of it belongs into a picture (`frame`: its own axes to
   * world). */
  void (*extent)(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low, double *high);
  double (*belt_speed)(const dem_wall *wall);
  void (*bounds)(const dem_wall *wall, const tdm_pose *frame, dem_bounds *bounds);

  /* Append what is drawn, in the axes of the view; NULL: nothing. */
  void (*polygons)(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err);

  /* Of a wall with several parts (the triangles of a mesh), which a sphere may touch at several places; NULL: it
   * touches the wall where it is nearest. How many parts there are; those that are nearer to x than `range`, ascending
   * (returns their number; above `max`: out is of no use, call again with more room); the touches of a sphere,
   * ascending by part: part[0], part[stride] ... part[(n - 1) * stride] has all parts nearer than the radius, in any
   * order, and may have others (returns their number); does a contact that ended on part `from` go on as one that
   * begins on `to`? */
  int (*parts)(const dem_wall *wall);
  tdm_vec3 (*middle)(const dem_wall *wall, int part); /* of a part, own axes; NULL: lists of walls have it as one */
  int (*near)(const dem_wall *wall, int from, tdm_vec3 x, double range, int *out, int max);
  int (*touches)(const dem_wall *wall, const int *part, size_t stride, int n, tdm_vec3 x, double radius,
                 dem_touch out[DEM_TOUCHES_MAX]);
  bool (*passes)(const dem_wall *wall, int from, int to);

  /* Where `near` may begin (from) for places that are, with their ranges, in this box; -1: no part is there. NULL: 0,
   * with which it looks at all. */
  int (*within)(const dem_wall *wall, tdm_vec3 low, tdm_vec3 high);

  /* The parts, where they are triangles of which geometry/triangle.h holds; NULL: the loops always ask `touches`. */
  const dem_triangles *(*triangles)(const dem_wall *wall);

  /* Of a wall that is made of a file; NULL: it is not. The file's name; its figures for the report of the start (new
   * reference), with texts worth knowing appended to `notes`. */
  const char *(*file)(const dem_wall *wall);
  json_t *(*report)(const dem_wall *wall, json_t *notes);

  /* Of `data`: a number that depends on it, and freeing it. NULL: there is none. */
  unsigned long long (*hash)(const dem_wall *wall);
  void (*destroy)(void *data);
};

/* For readers: append a wall, which takes its data over; a container; "side" as a choice of sides[]. */
void dem_walls_append(dem_wall_list *list, dem_wall wall, tdm_error *err);
void dem_walls_append_box(dem_wall_list *list, dem_box box, tdm_error *err);
extern const char *const dem_sides[2]; /* "inside", "outside" */

/* Free what the wall owns. */
void dem_wall_release(dem_wall *wall);

/* Where a wall is when its body is at `pose`. */
dem_wall_place dem_wall_put(const dem_wall *wall, const tdm_pose *pose);

/* Signed distance of the point x from the wall's surface (negative inside) and the unit normal there, from the wall
 * towards x, both world. A wall with parts may have more touches than this nearest one: shape->touches. */
static inline double dem_wall_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, tdm_vec3 *normal);

/* The same for the centre of a sphere of this radius. */
static inline double dem_wall_sphere_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, double radius,
                                         tdm_vec3 *normal);

/* Is a sphere at this gap altogether behind the surface of a wall that has no end, where the wall does not act? */
static inline bool dem_wall_behind(const dem_wall *wall, double gap, double radius) {
  return wall->endless && gap <= -radius;
}

/* Does a sphere at this gap touch the wall? A solid that ends acts at any depth. */
static inline bool dem_wall_touches(const dem_wall *wall, double gap, double radius) {
  return gap < radius && !dem_wall_behind(wall, gap, radius);
}

/* Does the surface of a wall, of whatever shape, cut a sphere at this gap? That is where closed forms of contacts hold:
 * the overlap is between 0 and a diameter. */
static inline bool dem_surface_cuts(double gap, double radius) {
  return gap < radius && gap > -radius;
}

/* The point x (world) in the wall's own axes. */
static inline tdm_vec3 dem_wall_own(const dem_wall_place *place, tdm_vec3 x) {
  return tdm_m3_tmul(place->axes, tdm_sub(x, place->point));
}

/* The point x (own axes) in the world's. */
static inline tdm_vec3 dem_wall_world(const dem_wall_place *place, tdm_vec3 x) {
  return tdm_add(place->point, tdm_m3_mul(place->axes, x));
}

/* Velocity of the surface (a belt) relative to the body at `point`, where the unit normal is `normal`, world [m/s]. A
 * belt runs along its surface at its speed, whatever the slope: the velocity that the scene gives, turned into the
 * surface. Zero where the surface stands across that velocity to within DEM_BELT_ACROSS: there it has no direction. */
static inline tdm_vec3 dem_wall_surface(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 point,
                                        tdm_vec3 normal);

#define DEM_BELT_ACROSS 1e-3 /* [rad] */

/* Velocity that the scene gives the surface at a point of the wall's own axes, own axes [m/s]. */
static inline tdm_vec3 dem_wall_belt(const dem_wall *wall, tdm_vec3 own) {
  return tdm_add(wall->surface.velocity, tdm_cross(wall->surface.angular, own));
}

/* The fastest of the surface of a wall that has an end [m/s]. */
double dem_wall_belt_speed(const dem_wall *wall);

static inline bool dem_wall_ends(const dem_wall *wall) {
  return wall->shape->box != NULL;
}

/* Does the wall reach from `low` to `high` along the unit vector `up` (world)? False for walls without end. */
bool dem_wall_extent(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low, double *high);

/* Take the wall of a body at `pose` into the bounds of a picture, if it has a size. */
void dem_wall_bounds(const dem_wall *wall, const tdm_pose *pose, dem_bounds *bounds);

/* For drawing: a flat ring in the plane z = 0 of the wall's own axes, a face of a solid body or not. */
void dem_wall_draw_ring(const dem_wall *wall, const dem_wall_view *view, double inner, double outer, bool solid,
                        dem_polygons *all, tdm_error *err);

/* ---- inline ---- */

static inline tdm_vec3 dem_wall_surface(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 point,
                                        tdm_vec3 normal) {
  tdm_vec3 belt = tdm_m3_mul(place->axes, dem_wall_belt(wall, dem_wall_own(place, point)));
  tdm_vec3 along = tdm_axpy(-tdm_dot(belt, normal), normal, belt);
  double speed = tdm_norm(belt), left = tdm_norm(along);
  return left > DEM_BELT_ACROSS * speed ? tdm_scale(speed / left, along) : tdm_v3(0, 0, 0);
}

static inline double dem_wall_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, tdm_vec3 *normal) {
  if (wall->shape->half_space) {
    *normal = place->normal;
    return tdm_dot(tdm_sub(x, place->point), place->normal);
  }
  tdm_vec3 n;
  double gap = wall->shape->gap(wall, dem_wall_own(place, x), &n);
  *normal = tdm_m3_mul(place->axes, n);
  return gap;
}

static inline double dem_wall_sphere_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, double radius,
                                         tdm_vec3 *normal) {
  if (!wall->shape->sphere_gap)
    return dem_wall_gap(wall, place, x, normal);
  tdm_vec3 n;
  double gap = wall->shape->sphere_gap(wall, dem_wall_own(place, x), radius, &n);
  *normal = tdm_m3_mul(place->axes, n);
  return gap;
}

#endif

/* Walls: the primitives that every shape of a scene is made of.
 *
 * A plane is a half-space that is solid behind the plane. A box seen from inside is up to six planes; a box seen from
 * outside is one solid box. A cylinder without ends is solid behind its surface; a piece of a cylinder or a cone is a
 * thin shell when the particles are inside, so they can leave by its ends and meet it from behind, and a solid with
 * flat ends when they are outside. A mesh is a thin shell.
 *
 * A new shape is a row of DEM_SHAPE_LIST and a function that reads it into walls; a new primitive is a case of
 * dem_wall_gap.
 *
 * Planes have no edges: a box seen from inside acts as if its faces were infinite. With "edges" they are a mesh.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_WALL_SHAPE_H
#define DEM_GEOMETRY_WALL_SHAPE_H

#include "dem/geometry/frustum.h"
#include "dem/geometry/mesh.h"
#include "dem/geometry/part.h"
#include "protocol/base/scene.h"

typedef enum {
  DEM_PLANE,
  DEM_SOLID_BOX,
  DEM_CYLINDER,      /* without ends */
  DEM_SHELL,         /* curved surface of a piece of a cylinder or cone, felt from both sides */
  DEM_BALL,          /* a sphere: solid, or a container when the particles are inside */
  DEM_SOLID_FRUSTUM, /* a piece of a cylinder or cone with flat ends */
  DEM_MESH
} dem_primitive;

typedef struct {
  dem_primitive primitive;
  int body;
  int geometry;         /* of dem_model.geometry */
  tdm_vec3 point;       /* on the plane, centre of the box, middle of the end at z = 0; body axes, from the centre of
                           mass [m]. A mesh: 0 */
  tdm_quat turn;        /* the wall's own axes to body axes (box, cylinder, cone); all zeros: none */
  tdm_vec3 normal;      /* plane: unit, towards the particles; body axes */
  tdm_vec3 half;        /* box: half edge lengths [m] */
  double radius[2];     /* cylinder, cone: at z = 0 and at z = length of its own axes; ball: both [m] */
  double length;        /* of a piece [m] */
  bool inside;          /* cylinder, ball: the particles are inside */
  const dem_mesh *mesh; /* borrowed from the list; body axes */
  bool plates;          /* a mesh that is made of a container's faces, no file */
  tdm_twist surface;    /* motion of the surface in the wall (a belt), of the wall's own origin, own axes */
  bool moves;           /* the surface has a motion of its own */
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

/* Growing lists of walls, boxes and meshes. */
typedef struct {
  dem_wall *wall;
  int count;
  dem_box *box;
  int nbox;
  dem_mesh **mesh;
  int nmesh;
  dem_part part; /* of the body that is read now */
} dem_wall_list;

/* Read one entry of a body's "shapes", geometry `geometry`, and append its walls (the lists and the meshes are freed by
 * the owner). */
void dem_shape_read(json_t *json, const char *path, int body, int geometry, dem_wall_list *list, tdm_error *err);

/* Where a wall is when its body is at `pose`. */
dem_wall_place dem_wall_put(const dem_wall *wall, const tdm_pose *pose);

/* Signed distance of the point x from the wall's surface (negative inside) and the unit normal there, from the wall
 * towards x, both world. For a solid the nearest point may lie on a face, an edge or a corner; a point inside leaves by
 * the nearest face. Thin shells have no inside: the distance is never negative. A mesh may have more contacts than this
 * nearest one: dem_mesh_contacts, with x in the wall's own axes (dem_wall_own). */
static inline double dem_wall_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, tdm_vec3 *normal);

/* The point x (world) in the wall's own axes. */
static inline double dem_ball_gap(double radius, bool inside, tdm_vec3 c, tdm_vec3 *normal) {
  double from = tdm_norm(c);
  tdm_vec3 out = from > 0 ? tdm_scale(1 / from, c) : tdm_v3(0, 0, 1);
  *normal = inside ? tdm_scale(-1, out) : out;
  return inside ? radius - from : from - radius;
}

static inline tdm_vec3 dem_wall_own(const dem_wall_place *place, tdm_vec3 x);

/* Is the wall solid all the way behind its surface? It acts to a depth of one radius then; a particle that is deeper
 * went through. */
static inline bool dem_wall_endless(const dem_wall *wall);

/* Can something fall inside the wall from its top to its bottom? Not in a solid box or ball. */
static inline bool dem_wall_hollow(const dem_wall *wall) {
  return wall->primitive != DEM_SOLID_BOX && (wall->primitive != DEM_BALL || wall->inside);
}

/* Velocity of the surface (a belt) relative to the body at `point`, where the unit normal is `normal`, world [m/s]. A
 * belt runs along its surface at its speed, whatever the slope: the velocity that the scene gives, turned into the
 * surface. Zero where the surface stands across that velocity to within DEM_BELT_ACROSS: there it has no direction. */
static inline tdm_vec3 dem_wall_surface(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 point,
                                        tdm_vec3 normal);

#define DEM_BELT_ACROSS 1e-3 /* [rad] */

/* Velocity that the scene gives the surface at a point of the wall's own axes, own axes [m/s]. */
static inline tdm_vec3 dem_wall_belt(const dem_wall *wall, tdm_vec3 own);

/* The fastest of the surface of a wall that has an end; 0 for others, where it depends on the place [m/s]. */
double dem_wall_belt_speed(const dem_wall *wall);

/* Does the wall reach from `low` to `high` along the unit vector `up` (world)? False for walls without end. */
bool dem_wall_extent(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 up, double *low, double *high);

/* ---- inline ---- */

static inline double dem_box_gap(tdm_vec3 half, tdm_vec3 c, tdm_vec3 *normal) {
  tdm_vec3 q =
      tdm_v3(fmax(-half.x, fmin(half.x, c.x)), fmax(-half.y, fmin(half.y, c.y)), fmax(-half.z, fmin(half.z, c.z)));
  tdm_vec3 d = tdm_sub(c, q);
  double dist2 = tdm_dot(d, d);
  if (dist2 > 0) {
    double dist = sqrt(dist2);
    *normal = tdm_scale(1 / dist, d);
    return dist;
  }
  double gx = fabs(c.x) - half.x, gy = fabs(c.y) - half.y, gz = fabs(c.z) - half.z;
  double gap = fmax(gx, fmax(gy, gz));
  if (gap == gx)
    *normal = tdm_v3(c.x < 0 ? -1 : 1, 0, 0);
  else if (gap == gy)
    *normal = tdm_v3(0, c.y < 0 ? -1 : 1, 0);
  else
    *normal = tdm_v3(0, 0, c.z < 0 ? -1 : 1);
  return gap;
}

static inline tdm_vec3 dem_wall_own(const dem_wall_place *place, tdm_vec3 x) {
  return tdm_m3_tmul(place->axes, tdm_sub(x, place->point));
}

static inline bool dem_wall_endless(const dem_wall *wall) {
  return wall->primitive == DEM_PLANE ||
         ((wall->primitive == DEM_CYLINDER || wall->primitive == DEM_BALL) && wall->inside);
}

static inline tdm_vec3 dem_wall_belt(const dem_wall *wall, tdm_vec3 own) {
  return tdm_add(wall->surface.velocity, tdm_cross(wall->surface.angular, own));
}

static inline tdm_vec3 dem_wall_surface(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 point,
                                        tdm_vec3 normal) {
  tdm_vec3 belt = tdm_m3_mul(place->axes, dem_wall_belt(wall, dem_wall_own(place, point)));
  tdm_vec3 along = tdm_axpy(-tdm_dot(belt, normal), normal, belt);
  double speed = tdm_norm(belt), left = tdm_norm(along);
  return left > DEM_BELT_ACROSS * speed ? tdm_scale(speed / left, along) : tdm_v3(0, 0, 0);
}

static inline double dem_wall_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, tdm_vec3 *normal) {
  if (wall->primitive == DEM_PLANE) {
    *normal = place->normal;
    return tdm_dot(tdm_sub(x, place->point), place->normal);
  }
  tdm_vec3 n = {0, 0, 0}, own = dem_wall_own(place, x);
  double gap = INFINITY;
  switch (wall->primitive) {
  case DEM_SOLID_BOX:
    gap = dem_box_gap(wall->half, own, &n);
    break;
  case DEM_CYLINDER:
    gap = dem_cylinder_gap(wall->radius[0], wall->inside, own, &n);
    break;
  case DEM_BALL:
    gap = dem_ball_gap(wall->radius[0], wall->inside, own, &n);
    break;
  case DEM_SHELL:
    gap = dem_shell_gap(wall->radius, wall->length, own, &n);
    break;
  case DEM_SOLID_FRUSTUM:
    gap = dem_frustum_gap(wall->radius, wall->length, own, &n);
    break;
  case DEM_MESH:
    gap = dem_mesh_gap(wall->mesh, own, &n);
    break;
  case DEM_PLANE:
    break;
  }
  *normal = tdm_m3_mul(place->axes, n);
  return gap;
}

#endif

/* Walls: the primitives that every shape of a scene is made of.
 *
 * A plane is a half-space that is solid behind the plane. A box seen from inside is up to six planes; a box seen from
 * outside is one solid box. A new shape is a row of DEM_SHAPE_LIST and a function that reads it into walls; a new
 * primitive is a case of dem_wall_gap.
 *
 * Planes have no edges: a box seen from inside acts as if its faces were infinite.
 */
#ifndef DEM_GEOMETRY_SHAPE_H
#define DEM_GEOMETRY_SHAPE_H

#include "protocol/scene.h"

typedef enum { DEM_PLANE, DEM_SOLID_BOX } dem_primitive;

typedef struct {
  dem_primitive primitive;
  int body;
  tdm_vec3 point;  /* on the plane, or centre of the box; body axes, from the centre of mass [m] */
  tdm_vec3 normal; /* plane: unit, towards the particles; body axes */
  tdm_vec3 half;   /* box: half edge lengths [m] */
} dem_wall;

/* A wall where it is now. */
typedef struct {
  tdm_vec3 point, normal; /* world */
  tdm_mat3 axes;          /* box: body axes to world */
} dem_wall_place;

/* A container: a box shape seen from inside, and its lid if it has one. */
typedef struct {
  int body;
  tdm_vec3 center, half; /* body axes [m] */
  int lid;               /* wall that is the lid, -1: none */
  double gap;            /* of the lid above the highest particle [m] */
  double press;          /* force with which the lid is then pressed on the bed, 0: none [N] */
} dem_box;

/* Growing lists of walls and of boxes. */
typedef struct {
  dem_wall *wall;
  int count;
  dem_box *box;
  int nbox;
} dem_wall_list;

/* Read one entry of a body's "shapes" and append its walls (list->wall and list->box are freed by the
 * owner). */
void dem_shape_read(json_t *json, const char *path, int body, dem_wall_list *list, tdm_error *err);

/* Where a wall is when its body is at `pose`. */
dem_wall_place dem_wall_put(const dem_wall *wall, const tdm_pose *pose);

/* Signed distance of the point x from the wall's surface (negative inside) and the unit normal there, from the wall
 * towards x, both world. For a box the nearest point may lie on a face, an edge or a corner; a point inside leaves by
 * the nearest face. */
static inline double dem_wall_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, tdm_vec3 *normal);

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

static inline double dem_wall_gap(const dem_wall *wall, const dem_wall_place *place, tdm_vec3 x, tdm_vec3 *normal) {
  if (wall->primitive == DEM_PLANE) {
    *normal = place->normal;
    return tdm_dot(tdm_sub(x, place->point), place->normal);
  }
  tdm_vec3 n;
  double gap = dem_box_gap(wall->half, tdm_m3_tmul(place->axes, tdm_sub(x, place->point)), &n);
  *normal = tdm_m3_mul(place->axes, n);
  return gap;
}

#endif

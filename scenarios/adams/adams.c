/* 28 models of one joint, spring or actuator against Adams' own results: position, orientation, velocities,
 * accelerations and reactions, every 0.1 s and at the peaks, for 5 s. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/adams/adams.h"

#include "protocol/app/command_line.h"
#include "scenarios/mbd/mechanism.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const scn_adams_model[] = {"Cylindrical_Case01",
                                       "Cylindrical_Case02",
                                       "Cylindrical_Case03",
                                       "Distance_Case01",
                                       "Distance_Case02",
                                       "Distance_Case03",
                                       "LinActuator_Case01",
                                       "LinActuator_Case02",
                                       "Prismatic_Case01",
                                       "Prismatic_Case02",
                                       "Prismatic_Case03",
                                       "RevSpherical_Case01",
                                       "RevSpherical_Case02",
                                       "Revolute_Case01",
                                       "Revolute_Case02",
                                       "RotSpring_Case01",
                                       "RotSpring_Case02",
                                       "Spherical_Case01",
                                       "Spherical_Case02",
                                       "TranSpring_Case01",
                                       "TranSpring_Case02",
                                       "TranSpringCB_Case01",
                                       "TranSpringCB_Case02",
                                       "TranSpringCB_Case03",
                                       "TranSpringCB_Case04",
                                       "Universal_Case01",
                                       "Universal_Case02",
                                       "Universal_Case03",
                                       NULL};

static const double end = 5, tolerance = 1e-10; /* [s], [1] */
enum { STEPS = 500 };
/* Share of the table's own error that a difference may have: a tenth more, for the error of the run itself. */
static const double share_most = 1.1;
/* what counts as zero [SI units] */
static const double nothing = 1e-9;

/* a model's run, its scene, and Adams' results */
typedef struct {
  json_t *mbd;
  scn_motion motion;
  cpl_table table, error; /* results; per quantity the largest error of these */
} model;

/* ---- what the run has ---- */

static double channel(const model *m, int i, const char *kind, const char *name, const char *what) {
  const double *c = scn_motion_channel(&m->motion, "%s.%s.%s", kind, name, what);
  return c ? c[i * m->motion.nchannel] : NAN;
}

/* Force ('f') or moment ('m') of all joints and forces, on their second body. */
static tdm_vec3 reaction(const model *m, int i, char kind) {
  static const char *const list[] = {"joints", "forces"}, *const group[] = {"joint", "force"};
  double sum[3] = {0};
  for (int k = 0; k < 2; k++) {
    size_t n;
    json_t *element;
    json_array_foreach(json_object_get(m->mbd, list[k]), n, element) {
      for (int c = 0; c < 3; c++) {
        const char what[] = {kind, "xyz"[c], 0};
        sum[c] += channel(m, i, group[k], json_string_value(json_object_get(element, "name")), what);
      }
    }
  }
  return tdm_v3(sum[0], sum[1], sum[2]);
}

static json_t *first(const json_t *object, const char *list) {
  return json_array_get(json_object_get(object, list), 0);
}

/* 1 where the second bodies are the ground, -1 where they are the moving one: tables have what acts on the ground */
static double on_ground(const model *m) {
  json_t *of = first(m->mbd, "joints") ? first(m->mbd, "joints") : first(m->mbd, "forces");
  const char *second = json_string_value(json_array_get(json_object_get(of, "bodies"), 1));
  return second && strcmp(second, "ground") == 0 ? 1 : -1;
}

static tdm_vec3 numbers(const json_t *array) {
  double x[3];
  for (size_t k = 0; k < 3; k++)
    x[k] = json_number_value(json_array_get(array, k));
  return tdm_v3(x[0], x[1], x[2]);
}

static const char *body_name(const model *m) {
  return json_string_value(json_object_get(first(m->mbd, "bodies"), "name"));
}

static tdm_quat orientation(const model *m, int i) {
  const char *body = body_name(m);
  return (tdm_quat){channel(m, i, "body", body, "qw"), channel(m, i, "body", body, "qx"),
                    channel(m, i, "body", body, "qy"), channel(m, i, "body", body, "qz")};
}

/* from the ground's point of a revolute-spherical link to the body's, whose axes are the world's at the start */
static tdm_vec3 link(const model *m, int i) {
  const char *body = body_name(m);
  json_t *of = first(m->mbd, "bodies");
  tdm_vec3 tip = numbers(json_object_get(first(of, "markers"), "point")),
           start = numbers(json_object_get(of, "position"));
  tdm_vec3 now = {channel(m, i, "body", body, "x"), channel(m, i, "body", body, "y"), channel(m, i, "body", body, "z")};
  tdm_vec3 arm = tdm_quat_rotate(orientation(m, i), tdm_sub(tip, start));
  return tdm_sub(tdm_add(now, arm), numbers(first(first(m->mbd, "joints"), "points")));
}

/* A direction: numbers, or the axis "body.marker.z" of a marker with world axes at the start. */
static tdm_vec3 direction(const model *m, const json_t *place) {
  const char *name = json_string_value(place), *dot = name ? strchr(name, '.') : NULL;
  size_t k;
  json_t *marker;
  json_array_foreach(json_object_get(first(m->mbd, "bodies"), "markers"), k, marker) {
    const char *of = json_string_value(json_object_get(marker, "name"));
    const size_t n = strlen(of);
    if (!dot || strncmp(dot + 1, of, n) != 0 || strcmp(dot + 1 + n, ".z") != 0)
      continue;
    const tdm_vec3 e = numbers(json_object_get(json_object_get(marker, "orientation"), "euler313"));
    return tdm_quat_rotate(tdm_euler313_to_quat((tdm_euler313){e.x, e.y, e.z}), tdm_v3(0, 0, 1));
  }
  return numbers(place);
}

/* The quantity of a table's column "Vel.x" at sample i; NaN: unknown. */
static double value(const model *m, int i, const char *quantity, char component) {
  static const struct {
    const char *quantity, *prefix;
  } state[] = {{"Pos", ""}, {"Quat", "q"}, {"Vel", "v"}, {"Avel", "w"}, {"Acc", "a"}, {"Aacc", "alpha"}};
  char what[16];
  for (size_t k = 0; k < sizeof state / sizeof state[0]; k++)
    if (strcmp(quantity, state[k].quantity) == 0) {
      snprintf(what, sizeof what, "%s%c", state[k].prefix, component);
      return channel(m, i, "body", body_name(m), what);
    }
  const char *of = strncmp(quantity, "Rtorque", 7) == 0 ? quantity + 7 : quantity + 6;
  const bool torque = of == quantity + 7;
  tdm_vec3 x = tdm_scale(on_ground(m), reaction(m, i, torque ? 'm' : 'f'));
  if (strcmp(of, "_Body2") == 0) /* the link's ball */
    x = tdm_scale(-1, x);
  else if (strcmp(of, "_Body1") == 0 && torque) /* and its hinge */
    x = tdm_cross(link(m, i), tdm_scale(on_ground(m), reaction(m, i, 'f')));
  else if (strcmp(of, "A") == 0) { /* of the actuator on the body, along the axis of the guide */
    tdm_vec3 axis = tdm_unit(direction(m, json_object_get(first(m->mbd, "joints"), "axis")));
    x = tdm_scale(torque ? 0 : -on_ground(m) * channel(m, i, "driver", "motor", "force"), axis);
  } else if (strcmp(of, "") != 0 && strcmp(of, "P") != 0 && strcmp(of, "_Body1") != 0)
    return NAN;
  return component == 'x' ? x.x : component == 'y' ? x.y : x.z;
}

/* ---- what the table has ---- */

/* half a unit of the last of the six digits that Adams prints */
static double half_digit(double x) {
  return x == 0 ? 0 : 0.5 * pow(10, floor(log10(fabs(x))) - 5);
}

/* -1 where the table has the other one of the two quaternions of an orientation */
static double quaternion_sign(const model *m, int i, int row, tdm_error *err) {
  const tdm_quat q = orientation(m, i);
  const double of[4] = {q.w, q.x, q.y, q.z};
  double dot = 0;
  for (int k = 0; k < 4; k++) {
    char column[] = {'Q', 'u', 'a', 't', '.', "wxyz"[k], 0};
    const double *reference = cpl_table_column(&m->table, column, err);
    dot += reference ? of[k] * reference[row] : 0;
  }
  return dot < 0 ? -1 : 1;
}

/* The largest size of a quantity of a table, of all its components. */
static double largest(const cpl_table *table, const char *quantity) {
  double most = 0;
  const size_t n = strlen(quantity);
  for (int c = 1; c < table->ncolumn; c++)
    for (int row = 0; row < table->nrow && strncmp(table->name[c], quantity, n) == 0 && table->name[c][n] == '.'; row++)
      most = fmax(most, fabs(table->data[c * table->nrow + row]));
  return most;
}

/* Largest share over the rows of the table's column c; in *off the largest difference beyond the table's own error. */
static double column_share(const model *m, int c, char quantity[32], double *off, tdm_error *err) {
  const char *name = m->table.name[c], *dot = strchr(name, '.');
  snprintf(quantity, 32, "%.*s", dot ? (int)(dot - name) : 0, name);
  const double *t = cpl_table_column(&m->table, "t", err), *own = cpl_table_column(&m->error, quantity, err);
  double worst = *off = 0;
  for (int row = 0; row < m->table.nrow && t && own; row++) {
    const int i = (int)lround(t[row] / end * STEPS);
    const double reference = m->table.data[c * m->table.nrow + row];
    double x = value(m, i, quantity, dot[1]);
    x *= strcmp(quantity, "Quat") == 0 ? quaternion_sign(m, i, row, err) : 1;
    *off = fmax(*off, fabs(x - reference) - own[0]);
    double share = fabs(x - reference) / fmax(nothing, fmax(own[0], half_digit(reference)));
    if (!(share <= worst))
      worst = share;
  }
  return worst;
}

tdm_status scn_adams_compare(scn_adams_difference *d, const char *dir, double rtol, tdm_error *err) {
  model m = {0};
  char file[4096], quantity[32];
  *d = (scn_adams_difference){0};
  snprintf(file, sizeof file, "%s/scene.json", dir);
  m.mbd = scn_motion_section(file, err);
  snprintf(file, sizeof file, "%s/reference.csv", dir);
  if (m.mbd && cpl_table_read(&m.table, file, err) == TDM_OK) {
    snprintf(file, sizeof file, "%s/error.csv", dir);
    if (cpl_table_read(&m.error, file, err) == TDM_OK)
      scn_motion_run(&m.motion, m.mbd, &scn_methods[SCN_GGL], rtol, 0, end, STEPS, SCN_MOST_STEPS, err);
  }
  for (int c = 1; c < m.table.ncolumn && !err->status; c++) {
    double off, share = column_share(&m, c, quantity, &off, err), most = largest(&m.table, quantity);
    double *relative = strcmp(quantity, "Pos") == 0 ? &d->position : quantity[0] == 'R' ? &d->reaction : NULL;
    if (relative && most > nothing)
      *relative = fmax(*relative, off / most);
    if (!(share <= d->share)) {
      d->share = share;
      snprintf(d->quantity, sizeof d->quantity, "%s", quantity);
    }
  }
  d->wall = m.motion.wall;
  scn_motion_free(&m.motion);
  cpl_table_free(&m.table);
  cpl_table_free(&m.error);
  json_decref(m.mbd);
  return err->status;
}

tdm_status scn_adams(cpl_verify *v, tdm_error *err) {
  tdm_error first_error = {0};
  for (const char *const *name = scn_adams_model; *name && !tdm_interrupted; name++) {
    char dir[4096], label[80];
    scn_adams_difference d = {0};
    tdm_error failed = {0};
    if (cpl_verify_find(v, "adams", *name, dir, sizeof dir, &failed) == TDM_OK) {
      *strrchr(dir, '/') = 0;
      scn_adams_compare(&d, dir, tolerance, &failed);
    }
    cpl_verify_alone(v, CPL_MBD, failed.status ? 0 : end, d.wall);
    snprintf(label, sizeof label, "%s, %s", *name, failed.status ? failed.message : d.quantity);
    cpl_verify_measure(v, "of_adams_error", label, failed.status ? NAN : d.share, CPL_AT_MOST, share_most);
    if (failed.status && !first_error.status)
      tdm_fail(&first_error, failed.status, failed.path, "%s: %s", *name, failed.message);
  }
  if (tdm_interrupted)
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted");
  *err = first_error;
  return err->status;
}

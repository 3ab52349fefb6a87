/* Output channels: see channels.h.
 *
 * Blocks stand in the order of the outputs, one for each kind of object; each object of a block has the channels of its
 * rows. To add a channel: a row.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/engine/channels.h"

#include "mbd/assembly/balance.h"
#include "mbd/consistent/stick.h"
#include "mbd/joint/frame.h"
#include "mbd/mechanics/energy.h"

#include <stdio.h>
#include <string.h>

/* what the rows see: accelerations, reactions and kinematics at one instant are in data */
typedef struct {
  const mbd_model *model;
  mbd_data *data;
  const double *y;
  const mbd_force_value *force; /* of the force that the row is asked for */
  double Q[MBD_PAIR];           /* its wrenches */
} view;

typedef struct {
  const char *name, *unit;
} label;

typedef struct {
  int count; /* channels of an object */
  /* (count) names and units; NULL: `tell` has them, which depend on the object */
  const label *label;
  label (*tell)(const mbd_model *model, int object, int k);
  bool (*has)(const mbd_model *model, int object); /* NULL: every object has it */
  void (*value)(view *v, int object, double *out); /* (count) */
} row;

/* ---- joints ---- */

enum { WRENCH = 6, SIZES = 2, DRIVE = 4, STATE = 19, COMPONENTS = 6, ENERGIES = 6 };
static const label wrench[WRENCH] = {{"fx", "N"},   {"fy", "N"},   {"fz", "N"},
                                     {"mx", "N m"}, {"my", "N m"}, {"mz", "N m"}};

static const label sizes_label[SIZES] = {{"f", "N"}, {"m", "N m"}};

static int joints(const mbd_model *m) {
  return m->njoint;
}
static const char *joint_name(const mbd_model *m, int i) {
  return m->joint[i].name;
}

/* Force and moment of a joint on its second body at its joint point, world axes: -G^T lambda, its moment moved from the
 * centre of mass to the point. Parts add up. */
static void reaction(view *v, int object, double *out) {
  const mbd_joint *j = &v->model->joint[object];
  const double *lambda = v->data->lambda;
  memset(out, 0, WRENCH * sizeof *out);
  for (int i = 0; i < v->model->njointpart; i++) {
    if (v->model->part[i].joint != j)
      continue;
    const mbd_rows *rows = mbd_part_at(v->model, v->data, i, false);
    for (int side = 0; side < 2; side++) {
      if (rows->body[side] != j->body[1])
        continue;
      double of_part[6] = {0};
      for (int k = 0; k < rows->n; k++)
        for (int c = 0; c < 6; c++)
          of_part[c] -= rows->G[k][6 * side + c] * lambda[rows->first + k];
      tdm_vec3 force = mbd_get3(of_part), arm = mbd_joint_arm(j, 1, &v->data->kin[j->body[1] + 1]);
      mbd_put3(out, 1, force);
      mbd_put3(out + 3, 1, tdm_sub(mbd_get3(of_part + 3), tdm_cross(arm, force)));
    }
  }
}

static void reaction_sizes(view *v, int object, double *out) {
  double of_joint[WRENCH];
  reaction(v, object, of_joint);
  out[0] = tdm_norm(mbd_get3(of_joint));
  out[1] = tdm_norm(mbd_get3(of_joint + 3));
}

static label coordinate_label(mbd_coordinate which, int k) {
  const mbd_coordinate_words *w = &mbd_coordinate_table[which];
  return k == 0 ? (label){w->name, w->unit} : (label){w->rate, w->rate_unit};
}
static label angle_label(const mbd_model *m, int object, int k) {
  (void)m, (void)object;
  return coordinate_label(MBD_ANGLE, k);
}
static label translation_label(const mbd_model *m, int object, int k) {
  (void)m, (void)object;
  return coordinate_label(MBD_TRANSLATION, k);
}
static bool has_angle(const mbd_model *m, int i) {
  return (m->joint[i].ops->coordinates & MBD_HAS_ANGLE) != 0;
}
static bool has_translation(const mbd_model *m, int i) {
  return (m->joint[i].ops->coordinates & MBD_HAS_TRANSLATION) != 0;
}

static double row_rate(const mbd_data *data, const mbd_rows *rows) {
  double twist[MBD_PAIR], rate = 0;
  mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
  for (int k = 0; k < MBD_PAIR; k++)
    rate += rows->G[0][k] * twist[k];
  return rate;
}

/* A coordinate that a joint leaves free, and its rate. */
static void coordinate(view *v, int object, mbd_coordinate which, double *out) {
  const mbd_joint *j = &v->model->joint[object];
  double from = which == MBD_ANGLE ? v->data->turn[object] : 0;
  mbd_rows *rows = &v->data->rows;
  rows->n = 0;
  rows->second = false;
  memcpy(rows->body, j->body, sizeof rows->body);
  mbd_joint_coordinate(j, which, &v->data->kin[j->body[0] + 1], &v->data->kin[j->body[1] + 1], from, rows);
  out[0] = from + rows->g[0];
  out[1] = row_rate(v->data, rows);
}
static void angle(view *v, int object, double *out) {
  coordinate(v, object, MBD_ANGLE, out);
}
static void translation(view *v, int object, double *out) {
  coordinate(v, object, MBD_TRANSLATION, out);
}

/* ---- drivers ---- */

static int drivers(const mbd_model *m) {
  return m->ndriver;
}
static const char *driver_name(const mbd_model *m, int i) {
  return m->driver[i].name;
}
static label driver_label(const mbd_model *m, int object, int k) {
  const mbd_coordinate which = m->driver[object].ops->coordinate;
  const mbd_coordinate_words *w = &mbd_coordinate_table[which];
  return k == 0           ? (label){w->effort, w->effort_unit}
         : k == DRIVE - 1 ? (label){"power", "W"}
                          : coordinate_label(which, k - 1);
}

/* Effort on the second body, the coordinate where it is (not where it should be), its rate, and the power that the
 * driver gives. */
static void drive(view *v, int object, double *out) {
  const mbd_driver *d = &v->model->driver[object];
  const mbd_rows *rows = mbd_part_at(v->model, v->data, v->model->njointpart + object, false);
  out[0] = -v->data->lambda[d->row];
  out[1] = tdm_motion_at(&d->motion, v->data->now).value + rows->g[0];
  out[2] = row_rate(v->data, rows);
  out[3] = out[0] * out[2];
}

/* ---- forces ---- */

static const label component[COMPONENTS] = {{"ux", "m"},     {"uy", "m"},     {"uz", "m"},
                                            {"phix", "rad"}, {"phiy", "rad"}, {"phiz", "rad"}};
static const label rotation_label = {"rotation", "rad"}, sliding_label = {"sliding", "1"};

static int forces(const mbd_model *m) {
  return m->nforce;
}
static const char *force_name(const mbd_model *m, int i) {
  return m->force[i].name;
}
static bool turns(const mbd_model *m, int i) {
  return m->force[i].ops->turns;
}
static bool rubs(const mbd_model *m, int i) {
  return m->force[i].rubbing != NULL;
}

/* A force without units of its own has those of its joint's coordinate. */
static label force_label(const mbd_model *m, int object, int k) {
  const mbd_force *f = &m->force[object];
  const mbd_coordinate_words *w = f->ops->value_unit ? NULL : &mbd_coordinate_table[f->coordinate];
  if (k == 0)
    return (label){"value", w ? w->effort_unit : f->ops->value_unit};
  return w ? (label){w->name, w->unit} : (label){f->ops->coordinate_name, f->ops->coordinate_unit};
}

static void evaluate_force(view *v, int object) {
  v->force = mbd_force_at(v->model, v->data, object, false);
  memcpy(v->Q, v->force->Q, sizeof v->Q);
}

static void force_value(view *v, int object, double *out) {
  const mbd_force *f = &v->model->force[object];
  out[0] = f->rubbing ? mbd_stick_force(v->model, v->data, f->rubbing->stick, v->force) : v->force->value;
  out[1] = v->force->coordinate;
}
static void rotation(view *v, int object, double *out) {
  (void)object;
  *out = v->force->rotation;
}
static void components(view *v, int object, double *out) {
  (void)object;
  memcpy(out, v->force->rows.g, COMPONENTS * sizeof *out);
}
static void sliding(view *v, int object, double *out) {
  (void)object;
  *out = v->force->way;
}

/* Force and moment of a force on its second body at its point there, world axes. A friction that sticks has them from
 * its row. */
static void force_wrench(view *v, int object, double *out) {
  const mbd_model *model = v->model;
  mbd_data *data = v->data;
  const mbd_force *f = &model->force[object];
  const mbd_joint *frame = f->joint ? f->joint : &f->frame;
  double at_centre[6];
  memcpy(at_centre, v->Q + MBD_RB, sizeof at_centre);
  if (f->rubbing) {
    const mbd_rows *rows = mbd_part_at(model, data, model->njointpart + model->ndriver + f->rubbing->stick, false);
    for (int k = 0; k < 6; k++)
      at_centre[k] -= rows->G[0][MBD_RB + k] * data->lambda[f->rubbing->row];
  }
  tdm_vec3 force = mbd_get3(at_centre), arm = mbd_joint_arm(frame, 1, &data->kin[f->body[1] + 1]);
  mbd_set3(out, force);
  mbd_set3(out + 3, tdm_sub(mbd_get3(at_centre + 3), tdm_cross(arm, force)));
}

/* ---- bodies ---- */

static const label state_label[STATE] = {
    {"x", "m"},      {"y", "m"},           {"z", "m"},           {"qw", "1"},         {"qx", "1"},
    {"qy", "1"},     {"qz", "1"},          {"vx", "m/s"},        {"vy", "m/s"},       {"vz", "m/s"},
    {"wx", "rad/s"}, {"wy", "rad/s"},      {"wz", "rad/s"},      {"ax", "m/s2"},      {"ay", "m/s2"},
    {"az", "m/s2"},  {"alphax", "rad/s2"}, {"alphay", "rad/s2"}, {"alphaz", "rad/s2"}};

static int bodies(const mbd_model *m) {
  return m->nbody;
}
static const char *body_name(const mbd_model *m, int i) {
  return m->body[i].name;
}

/* The states of coupled bodies go to the partner, and are the server's to report. */
static bool is_alone(const mbd_model *m, int body) {
  for (int i = 0; i < m->ncoupled; i++)
    if (m->coupled[i] == body)
      return false;
  return true;
}

static void put_state(const tdm_state *s, double *out) {
  tdm_quat q = s->pose.orientation;
  mbd_set3(out, s->pose.position);
  out[3] = q.w, out[4] = q.x, out[5] = q.y, out[6] = q.z;
  mbd_set3(out + 7, s->twist.velocity);
  mbd_set3(out + 10, s->twist.angular);
}

static void state(view *v, int object, double *out) {
  tdm_state s = mbd_body_state(v->y, object);
  put_state(&s, out);
  memcpy(out + 13, v->data->acceleration + 6 * object, 6 * sizeof *out);
}

/* ---- markers that the scene wants ---- */

/* The i-th of them, and its body; the number of all of them where there is no such one. */
static int find_marker(const mbd_model *m, int i, int *body, const mbd_marker **marker) {
  int n = 0;
  for (int b = 0; b < m->nbody; b++)
    for (int k = 0; k < m->body[b].nmarker; k++)
      if (m->body[b].marker[k].output && n++ == i) {
        *body = b;
        *marker = &m->body[b].marker[k];
      }
  return n;
}

static int markers(const mbd_model *m) {
  return find_marker(m, -1, NULL, NULL);
}
static const char *marker_name(const mbd_model *m, int i) {
  int body;
  const mbd_marker *marker;
  find_marker(m, i, &body, &marker);
  return marker->channel;
}

/* As the state of a body, at the marker's point and with its axes. */
static void marker_state(view *v, int object, double *out) {
  int body;
  const mbd_marker *marker;
  find_marker(v->model, object, &body, &marker);
  tdm_state s = mbd_body_state(v->y, body);
  const double *dot = v->data->acceleration + 6 * body;
  const tdm_vec3 arm = tdm_quat_rotate(s.pose.orientation, marker->pose.position), w = s.twist.angular,
                 alpha = mbd_get3(dot + 3);
  const tdm_vec3 turning = tdm_add(tdm_cross(alpha, arm), tdm_cross(w, tdm_cross(w, arm)));
  s.pose.position = tdm_add(s.pose.position, arm);
  s.pose.orientation = tdm_quat_mul(s.pose.orientation, marker->pose.orientation);
  s.twist.velocity = tdm_add(s.twist.velocity, tdm_cross(w, arm));
  put_state(&s, out);
  mbd_set3(out + 13, tdm_add(mbd_get3(dot), turning));
  mbd_set3(out + 16, alpha);
}

/* ---- the whole ---- */

static const label energy_label[ENERGIES] = {{"kinetic", "J"},  {"potential", "J"},  {"springs", "J"},
                                             {"supplied", "J"}, {"dissipated", "J"}, {"balance", "J"}};
static const label drift_label = {"drift", "m"};

static int one(const mbd_model *m) {
  (void)m;
  return 1;
}

static void energies(view *v, int object, double *out) {
  (void)object;
  const mbd_data *data = v->data;
  mbd_energies e = mbd_energies_at(v->model, v->data);
  out[0] = e.kinetic;
  out[1] = e.potential;
  out[2] = e.springs;
  out[3] = data->work.supplied;
  out[4] = data->work.dissipated;
  out[5] = e.kinetic + e.potential + e.springs + data->work.dissipated - data->work.supplied - data->energy_start;
}

/* The largest violation since it was asked for last. */
static void drift(view *v, int object, double *out) {
  (void)object;
  *out = v->data->drift;
  v->data->drift = 0;
}

/* ---- the table ---- */

enum { ROWS_MAX = 5 };

static const struct {
  const char *group;                             /* "joint": the first part of a name */
  int (*count)(const mbd_model *model);          /* objects */
  const char *(*name)(const mbd_model *, int i); /* of object i, the second part of a name; NULL: there is none */
  void (*begin)(view *v, int object);            /* before the rows of an object; NULL: nothing */
  row row[ROWS_MAX];                             /* ended by a count of 0 */
} table[] = {
    {.group = "joint",
     .count = joints,
     .name = joint_name,
     .row = {{.count = WRENCH, .label = wrench, .value = reaction},
             {.count = SIZES, .label = sizes_label, .value = reaction_sizes}}},
    {.group = "joint",
     .count = joints,
     .name = joint_name,
     .row = {{.count = 2, .tell = angle_label, .has = has_angle, .value = angle},
             {.count = 2, .tell = translation_label, .has = has_translation, .value = translation}}},
    {.group = "driver",
     .count = drivers,
     .name = driver_name,
     .row = {{.count = DRIVE, .tell = driver_label, .value = drive}}},
    {.group = "force",
     .count = forces,
     .name = force_name,
     .begin = evaluate_force,
     .row = {{.count = 2, .tell = force_label, .value = force_value},
             {.count = 1, .label = &rotation_label, .has = turns, .value = rotation},
             {.count = COMPONENTS, .label = component, .has = turns, .value = components},
             {.count = 1, .label = &sliding_label, .has = rubs, .value = sliding},
             {.count = WRENCH, .label = wrench, .value = force_wrench}}},
    {.group = "body",
     .count = bodies,
     .name = body_name,
     .row = {{.count = STATE, .label = state_label, .has = is_alone, .value = state}}},
    {.group = "marker",
     .count = markers,
     .name = marker_name,
     .row = {{.count = STATE, .label = state_label, .value = marker_state}}},
    {.group = "energy", .count = one, .row = {{.count = ENERGIES, .label = energy_label, .value = energies}}},
    {.group = "constraint", .count = one, .row = {{.count = 1, .label = &drift_label, .value = drift}}},
};
enum { NBLOCK = sizeof table / sizeof table[0] };

/* The row k of a block if the object has it; NULL: it has not. *end: there are no more rows. */
static const row *row_of(const mbd_model *model, int block, int object, int k, bool *end) {
  const row *r = k < ROWS_MAX ? &table[block].row[k] : NULL;
  *end = !r || r->count == 0;
  return !*end && (!r->has || r->has(model, object)) ? r : NULL;
}

int mbd_channel_count(const mbd_model *model) {
  bool end;
  int n = 0;
  for (int b = 0; b < NBLOCK; b++)
    for (int i = 0; i < table[b].count(model); i++)
      for (int k = (end = false, 0); !end; k++) {
        const row *r = row_of(model, b, i, k, &end);
        n += r ? r->count : 0;
      }
  return n;
}

static tdm_channel *name_row(const mbd_model *model, int block, int object, const row *r, tdm_channel *c) {
  for (int k = 0; k < r->count; k++, c++) {
    const label l = r->tell ? r->tell(model, object, k) : r->label[k];
    const char *of = table[block].name ? table[block].name(model, object) : "";
    snprintf(c->name, sizeof c->name, "%s.%s%s%s", table[block].group, of, *of ? "." : "", l.name);
    snprintf(c->unit, sizeof c->unit, "%s", l.unit);
  }
  return c;
}

void mbd_channel_names(const mbd_model *model, tdm_channel *c) {
  bool end;
  for (int b = 0; b < NBLOCK; b++)
    for (int i = 0; i < table[b].count(model); i++)
      for (int k = (end = false, 0); !end; k++) {
        const row *r = row_of(model, b, i, k, &end);
        c = r ? name_row(model, b, i, r, c) : c;
      }
}

static void fill(view *v, double *out) {
  bool end;
  for (int b = 0; b < NBLOCK; b++)
    for (int i = 0; i < table[b].count(v->model); i++) {
      if (table[b].begin)
        table[b].begin(v, i);
      for (int k = (end = false, 0); !end; k++) {
        const row *r = row_of(v->model, b, i, k, &end);
        if (r)
          r->value(v, i, out);
        out += r ? r->count : 0;
      }
    }
}

tdm_status mbd_channel_values(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y,
                              double *out, tdm_error *err) {
  bool good = mbd_accelerations(model, data, kkt, t, y); /* sets data->kin and data->now */
  if (good && data->ndependent > 0)
    good = mbd_kkt_share(kkt, model, data, data->lambda);
  if (!good)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no accelerations and joint reactions at t = %.9g s: the mechanism is in a singular position", t);
  if (mbd_check_balance(model, data, err))
    return err->status;
  view v = {.model = model, .data = data, .y = y};
  fill(&v, out);
  return TDM_OK;
}

/* The promise of mbd/: a joint, a force and a motion law are one file each. Those here stand in this file alone; they
 * are registered without touching the sources, read by the scene's reader, and run by the engine against closed forms.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"
#include "mbd/force/table.h"
#include "mbd/joint/joint.h"
#include "mbd/joint/table.h"
#include "protocol/motion/motion.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#include <math.h>

/* ---- a joint: the second body's point slides on a plane that is inclined against the first body's axis ---- */

typedef struct {
  double angle; /* of the plane against the level across the axis [rad] */
} slope;

static void slope_read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  slope *own = joint->own;
  mbd_joint_read_frame(joint, o, model, true);
  own->angle = tdm_get_number(o, "angle", TDM_REQUIRED, TDM_POSITIVE);
}

static void slope_eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const slope *own = j->own;
  tdm_vec3 along = mbd_joint_axis(j, 0, 0, a), up = mbd_joint_axis(j, 0, 2, a);
  tdm_vec3 normal = tdm_axpy(-sin(own->angle), along, tdm_scale(cos(own->angle), up));
  mbd_rows_plane(rows, a, b, normal, mbd_joint_arm(j, 0, a), mbd_joint_arm(j, 1, b));
}

static const char *const slope_equation[] = {"slope"};
static const mbd_joint_ops slope_ops = {
    .name = "slope",
    .size = sizeof(slope),
    .nrow = 1,
    .equation = slope_equation,
    .read = slope_read,
    .eval = slope_eval,
};

/* At rest at first, the body goes down the slope with g sin(angle), and the plane bears m g cos(angle). */
START_TEST(a_joint) {
  run r;
  const double g = 9.81, angle = 0.4, m = 2, t = 0.8;
  run_open_good(&r,
                "{'bodies':[{'name':'box','mass':2,'inertia':[1,1,1],'position':[0,0,0]}],"
                "'joints':[{'name':'ramp','type':'slope','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1],"
                "'angle':0.4}]}",
                "");
  ck_assert_int_eq(r.ready.freedom, 5);
  run_on(&r, t, 0.1);
  double x = run_value(&r, "body.box.x"), y = run_value(&r, "body.box.y"), z = run_value(&r, "body.box.z");
  double fx = run_value(&r, "joint.ramp.fx"), fy = run_value(&r, "joint.ramp.fy"), fz = run_value(&r, "joint.ramp.fz");
  CLOSE(sqrt(x * x + y * y + z * z), 0.5 * g * sin(angle) * t * t, 1e-8);
  CLOSE(z, -0.5 * g * sin(angle) * sin(angle) * t * t, 1e-8);
  CLOSE(sqrt(fx * fx + fy * fy + fz * fz), m * g * cos(angle), 1e-8);
  run_close(&r);
}
END_TEST

START_TEST(its_keys) {
  run r;
  run_open(&r,
           "{'bodies':[{'name':'box','mass':2,'inertia':[1,1,1],'position':[0,0,0]}],"
           "'joints':[{'name':'ramp','type':'slope','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]}]}",
           "");
  ck_assert_int_eq(r.status, TDM_ERR_SCENE);
  ck_assert_str_eq(r.err.path, "mbd.joints[0].angle");
  run_close(&r);
}
END_TEST

/* ---- a force: a drag on a point, of its velocity against the other body ---- */

typedef struct {
  double drag; /* [N s/m] */
} drag;

static void drag_read(mbd_force *force, tdm_object *o, const mbd_model *model) {
  drag *own = force->own;
  mbd_force_read_points(force, o, model, false);
  own->drag = tdm_get_number(o, "drag", TDM_REQUIRED, TDM_NOT_NEGATIVE);
}

static void drag_eval(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const drag *own = force->own;
  double rate[3], f[3], by_x[9] = {0}, by_rate[9] = {0};
  mbd_rows_point(&out->rows, a, b, mbd_joint_arm(&force->frame, 0, a), mbd_joint_arm(&force->frame, 1, b));
  mbd_force_rates(out, a, b, rate);
  for (int k = 0; k < 3; k++) {
    f[k] = own->drag * rate[k];
    by_rate[4 * k] = own->drag;
    out->dissipated += f[k] * rate[k];
  }
  mbd_force_apply(out, a, b, f, by_x, by_rate);
  out->value = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
}

static const mbd_force_ops drag_ops = {
    .name = "drag",
    .size = sizeof(drag),
    .value_unit = "N",
    .coordinate_name = "length",
    .coordinate_unit = "m",
    .read = drag_read,
    .eval = drag_eval,
};

/* v = v0 exp(-c t/m), and all that is lost has become heat. */
START_TEST(a_force) {
  run r;
  const double m = 2, c = 3, v0 = 5, t = 0.7, decay = exp(-c * t / m);
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'box','mass':2,'inertia':[1,1,1],'position':[0,0,0],"
                "'velocity':[0,5,0]}],'forces':[{'name':'air','type':'drag','bodies':['ground','box'],"
                "'points':[[0,0,0],[0,0,0]],'drag':3}]}",
                "");
  run_on(&r, t, 0.1);
  CLOSE(run_value(&r, "body.box.vy"), v0 * decay, 1e-6);
  CLOSE(run_value(&r, "body.box.y"), v0 * m / c * (1 - decay), 1e-6);
  CLOSE(run_value(&r, "force.air.value"), c * v0 * decay, 1e-5);
  CLOSE(run_value(&r, "energy.dissipated"), 0.5 * m * v0 * v0 * (1 - decay * decay), 1e-5);
  run_close(&r);
}
END_TEST

/* ---- a motion law: x = way (1 - exp(-t/time)), which owns memory ---- */

typedef struct {
  double *number; /* way [m], time [s]; owned */
} settling;

static int cleared;

static void settling_read(void *own, tdm_object *o, tdm_motion_range *range) {
  settling *s = own;
  s->number = calloc(2, sizeof *s->number);
  ck_assert_ptr_nonnull(s->number);
  s->number[0] = tdm_get_number(o, "way", TDM_REQUIRED, TDM_ANY);
  s->number[1] = tdm_get_number(o, "time", TDM_REQUIRED, TDM_POSITIVE);
  range->first = 0;
}

static tdm_motion_value settling_at(const void *own, double t) {
  const settling *s = own;
  const double way = s->number[0], time = s->number[1], left = exp(-t / time);
  return (tdm_motion_value){way * (1 - left), way / time * left, -way / (time * time) * left};
}

static void settling_clear(void *own) {
  free(((settling *)own)->number);
  cleared++;
}

static const tdm_motion_ops settling_ops = {
    .name = "settling",
    .size = sizeof(settling),
    .read = settling_read,
    .at = settling_at,
    .clear = settling_clear,
};

START_TEST(a_motion_law) {
  run r;
  const double m = 2, way = 0.6, time = 0.5, t = 0.9;
  cleared = 0;
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'box','mass':2,'inertia':[1,1,1],'position':[0,0,0]}],"
                "'joints':[{'name':'guide','type':'prismatic','bodies':['ground','box'],'point':[0,0,0],"
                "'axis':[1,0,0]}],'drivers':[{'name':'motor','type':'linear_motor','joint':'guide',"
                "'motion':{'type':'settling','way':0.6,'time':0.5}}]}",
                "");
  run_on(&r, t, 0.1);
  CLOSE(run_value(&r, "body.box.x"), way * (1 - exp(-t / time)), 1e-9);
  CLOSE(run_value(&r, "driver.motor.force"), -m * way / (time * time) * exp(-t / time), 1e-8);
  run_close(&r);
  ck_assert_int_eq(cleared, 1);
}
END_TEST

/* ---- adding ---- */

START_TEST(names_are_taken_once) {
  tdm_error err = {0};
  ck_assert_int_eq(mbd_joint_add(&slope_ops, &err), TDM_ERR_ARGUMENT);
  ck_assert(strstr(err.message, slope_ops.name) && strstr(err.message, "already"));
  ck_assert_int_eq(mbd_force_add(&drag_ops, NULL), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(tdm_motion_add(&settling_ops, NULL), TDM_ERR_ARGUMENT);
}
END_TEST

static bool add_all(void) {
  tdm_error err = {0};
  mbd_joint_add(&slope_ops, &err);
  mbd_force_add(&drag_ops, &err);
  return tdm_motion_add(&settling_ops, &err) == TDM_OK;
}

int main(void) {
  const test_row rows[] = {{a_joint, 1}, {its_keys, 1}, {a_force, 1}, {a_motion_law, 1}, {names_are_taken_once, 1}};
  if (!add_all())
    return EXIT_FAILURE;
  return test_run("seam_joint", rows, sizeof rows / sizeof rows[0]);
}

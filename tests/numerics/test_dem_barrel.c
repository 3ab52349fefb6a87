/* A screening machine's vessels as DEM bodies: uniform and stepped barrels with decks, lids, windows and deflectors,
 * and a container with a nozzle above, all of a coupled body that gyrates. Nothing leaks. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/walls.h"
#include "test_dem_support.h"
#include "tests/test_main.h"

/* From top to bottom: a container, its cone down to the nozzle in the hole of the lid, the upper barrel with a deck at
 * 0.4 m, the lower barrel, as wide or narrower, with wires at 0.2 m and a floor at 0. Outlets on both decks and the
 * floor, with a deflector on the upper deck. */
typedef struct {
  double upper, lower; /* radii of the barrel [m] */
} machine;

static const machine machines[] = {{0.3, 0.3}, {0.3, 0.24}};

typedef struct {
  double angle[2], height[2]; /* height above the floor [m] */
} outlet;

static const outlet outlets[] = {{{-0.2, 0.2}, {0.4, 0.47}}, {{2.9, 3.4}, {0.2, 0.27}}, {{-1.8, -1.4}, {0, 0.07}}};

static const double nozzle = 0.05, step_height = 0.3, lid_height = 0.6;

static rig *machine_rig(const machine *m) {
  char barrel[2000];
  int n = snprintf(
      barrel, sizeof barrel,
      "{'type':'cylinder','side':'inside','radius':%g,'point':[0,0,0.3],'length':0.3,"
      "'windows':[{'angle':[-0.2,0.2],'height':[0.1,0.17]}]},"
      "{'type':'cylinder','side':'inside','radius':%g,'length':0.3,"
      "'windows':[{'angle':[2.9,-2.883185307179586],'height':[0.2,0.27]},{'angle':[-1.8,-1.4],'height':[0,0.07]}]},"
      "{'type':'screen','deck':'reduced','hole':0.03,'bar':0.006,'radius':%g,'center':[0,0,0.4],'zeta':0.2},"
      "{'type':'screen','deck':'wires','hole':0.022,'bar':0.006,'radius':%g,'center':[0,0,0.2]},"
      "{'type':'disc','radius':%g},{'type':'disc','radius':%g,'inner_radius':0.08,'center':[0,0,0.6]},"
      "{'type':'box','side':'outside','size':[0.1,0.004,0.05],'center':[0.24,0.05,0.425],"
      "'orientation':{'euler313':[0.6,0,0]}},",
      m->upper, m->lower, m->upper, m->lower, m->lower, m->upper);
  if (m->lower < m->upper)
    snprintf(barrel + n, sizeof barrel - (size_t)n, "{'type':'disc','radius':%g,'inner_radius':%g,'center':[0,0,0.3]},",
             m->upper, m->lower);
  tdm_assigned_body body = {.name = "machine", .mass = 200, .state = state_at(0, 0, 0)};
  body.inertia.m[0][0] = body.inertia.m[1][1] = body.inertia.m[2][2] = 20;
  return rig_make(
      scene_json("{'contact':{'normal':'hooke','tangential':'spring'},'materials':[{'name':'m','density':2700}],"
                 "'pairs':[{'materials':['m','m'],'restitution':0.5,'stiffness':2e4,'friction':0.2,"
                 "'tangential_stiffness':6e3}],"
                 "'bodies':[{'name':'machine','material':'m','shapes':[%s"
                 "{'type':'cone','side':'inside','radii':[%g,0.15],'point':[0,0,0.6],'length':0.1},"
                 "{'type':'cylinder','side':'inside','radius':0.15,'point':[0,0,0.7],'length':0.4}]}],"
                 "'particles':[{'type':'random','material':'m','count':60,'radius':[0.009,0.011],"
                 "'region':{'min':[-0.1,-0.1,0.72],'max':[0.1,0.1,0.8]}},"
                 "{'type':'random','material':'m','count':60,'radius':[0.012,0.014],"
                 "'region':{'min':[-0.1,-0.1,0.8],'max':[0.1,0.1,0.9]}},"
                 "{'type':'random','material':'m','count':60,'radius':[0.0155,0.018],"
                 "'region':{'min':[-0.1,-0.1,0.9],'max':[0.1,0.1,1.02]}}],"
                 "'sinks':[{'name':'out','type':'plane','point':[0,0,-0.8],'normal':[0,0,1]}]}",
                 barrel, nozzle),
      1e-4, 1, &body);
}

/* gyration by 20 mm at 150 rpm, tilted by a degree towards where it is */
static tdm_state motion_at(double t) {
  const double omega = 150 * M_PI / 30, shift = 0.02, tilt = M_PI / 180;
  tdm_vec3 towards = {cos(omega * t), sin(omega * t), 0}, across = {-sin(omega * t), cos(omega * t), 0};
  return (tdm_state){
      .pose = {.position = tdm_scale(shift, towards), .orientation = tdm_quat_from_rotvec(tdm_scale(tilt, across))}};
}

/* is a centre inside the walls, in the machine's axes? */
static bool inside(const machine *m, tdm_vec3 x) {
  double rho = hypot(x.x, x.y);
  if (x.z >= lid_height)
    return x.z > 0.7 ? rho < 0.15 : rho < nozzle + (x.z - lid_height); /* a cone of 45 degrees */
  return x.z > 0 && rho < (x.z > step_height ? m->upper : m->lower);
}

static bool in_outlet(tdm_vec3 x, double slack) {
  double angle = atan2(x.y, x.x), rho = hypot(x.x, x.y);
  for (size_t k = 0; k < sizeof outlets / sizeof *outlets; k++) {
    double from = remainder(angle - 0.5 * (outlets[k].angle[0] + outlets[k].angle[1]), 2 * M_PI);
    if (fabs(from) * rho < 0.5 * (outlets[k].angle[1] - outlets[k].angle[0]) * rho + slack &&
        x.z > outlets[k].height[0] - slack && x.z < outlets[k].height[1] + slack)
      return true;
  }
  return false;
}

/* All that leaves the machine does so by an outlet, all that was there is inside or was taken by the sink, and
 * particles come through nozzle, decks and outlets. */
START_TEST(nothing_leaks) {
  const machine *m = &machines[_i];
  rig *r = machine_rig(m);
  dem_data *d = r->data;
  const double dt = r->model->dt;
  const int start = d->state.nparticle;
  bool out[200] = {false};
  int by_outlet = 0, deepest = 0;
  ck_assert_int_le(start, 200);
  tdm_state before = motion_at(0);
  for (long k = 1; k <= 60000; k++) {
    tdm_state now = motion_at((double)k * dt);
    dem_path path = dem_path_make(&before, &now, dt, TDM_LINEAR);
    one_step(d, &path, dt);
    flow_now(d, (double)k * dt, dt);
    before = now;
    if (k < 10) /* the machine is put where its motion begins */
      continue;
    for (int i = 0; i < d->state.nparticle; i++) {
      tdm_vec3 from = tdm_sub(d->state.sphere[i].position, now.pose.position);
      tdm_vec3 x = tdm_quat_rotate(tdm_quat_conj(now.pose.orientation), from);
      deepest += x.z < 0.2;
      if (out[d->state.id[i]] || inside(m, x))
        continue;
      ck_assert_msg(in_outlet(x, 0.003), "particle %d of radius %g left at [%g, %g, %g], %g from the axis, in step %ld",
                    (int)d->state.id[i], d->state.sphere[i].radius, x.x, x.y, x.z, hypot(x.x, x.y), k);
      out[d->state.id[i]] = true;
      by_outlet++;
    }
  }
  ck_assert_int_eq(dem_count_lost(d), 0);
  ck_assert_int_eq((int)d->state.sink[0].removed + d->state.nparticle, start);
  ck_assert_int_gt(by_outlet, 10);
  ck_assert_int_gt(deepest, 1000);
  int left = 0; /* in the container */
  for (int i = 0; i < d->state.nparticle; i++)
    left += d->state.sphere[i].position.z > lid_height;
  ck_assert_int_lt(left, start / 2);
  rig_free(r);
}
END_TEST

TEST_MAIN_ROWS("dem_barrel", {nothing_leaks, 2})

/* Paths of particles in the axes of a body ([A07] Eq. 4.8-4.10): closed forms, differences, gaps, who is meant. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/dem.h"
#include "dem/flow/traces.h"
#include "tests/test_main.h"

/* ---- Eq. (4.8)-(4.10) ---- */

/* the machine of [A07]: geometry and tilts of the plate, speeds of the machine and the barrel */
static const double u = 0.3, e = 0.12, ecc = 0.05, alpha = 0.02, beta = 0.013, omega = 15.7;

static tdm_mat3 turn(int axis, double angle) {
  double v[3] = {0, 0, 0};
  v[axis] = angle;
  return tdm_quat_to_matrix(tdm_quat_from_rotvec(tdm_v3(v[0], v[1], v[2])));
}

static tdm_mat3 product(tdm_mat3 a, tdm_mat3 b) {
  tdm_mat3 c = {0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      for (int k = 0; k < 3; k++)
        c.m[i][j] += a.m[i][k] * b.m[k][j];
  return c;
}

/* the barrel, whose own speed is omega_b: A_lg = Rz(-(omega_b - omega) t) P Rz(-omega t), P = Ry(-beta) Rx(-alpha), and
 * r_oc = Rz(omega t) (r0 - P' r1) (errata 6) */
static tdm_state barrel(double omega_b, double t) {
  const tdm_mat3 plate = product(turn(1, -beta), turn(0, -alpha)), machine = turn(2, omega * t);
  const tdm_mat3 lg = product(turn(2, (omega - omega_b) * t), product(plate, turn(2, -omega * t)));
  const tdm_vec3 c0 = tdm_sub(tdm_v3(u, ecc - e, 0), tdm_m3_tmul(plate, tdm_v3(u, -e, 0)));
  const tdm_vec3 c = tdm_m3_mul(machine, c0);
  const tdm_vec3 own = tdm_m3_mul(machine, tdm_m3_tmul(plate, tdm_v3(0, 0, omega_b - omega)));
  return (tdm_state){{c, tdm_quat_conj(tdm_quat_from_matrix(lg))},
                     {tdm_cross(tdm_v3(0, 0, omega), c), tdm_add(tdm_v3(0, 0, omega), own)}};
}

/* a particle that flies */
static tdm_vec3 place(double t) {
  return tdm_v3(0.2 - 0.3 * t, 0.1 + 0.7 * t, 0.4 + 1.1 * t - 4.905 * t * t);
}

static tdm_vec3 velocity(double t) {
  return tdm_v3(-0.3, 0.7, 1.1 - 9.81 * t);
}

static dem_relative seen(double omega_b, double t) {
  const tdm_state b = barrel(omega_b, t);
  return dem_relative_to(&b.pose, &b.twist, place(t), velocity(t));
}

START_TEST(test_differences) {
  /* the velocity is the derivative of the place, for a barrel that turns along, stands, or turns otherwise: against
   * central differences of eighth order */
  static const double weight[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280}, speeds[] = {15.7, 0, 4, -40};
  const double h = 1e-3;
  for (int s = 0; s < 4; s++)
    for (int n = 0; n < 40; n++) {
      const double t = 0.037 * n;
      tdm_vec3 d = {0, 0, 0};
      for (int k = 0; k < 4; k++) {
        const tdm_vec3 after = seen(speeds[s], t + (k + 1) * h).position;
        d = tdm_axpy(weight[k] / h, tdm_sub(after, seen(speeds[s], t - (k + 1) * h).position), d);
      }
      ck_vector(seen(speeds[s], t).velocity, d, 1e-9);
    }
}
END_TEST

START_TEST(test_as_printed) {
  /* omega_b = omega: the matrices of Eq. (4.4), (4.14) and the vectors of (4.1), (4.11), as they are printed */
  for (int n = 0; n < 40; n++) {
    const double t = 0.041 * n, c = cos(omega * t), s = sin(omega * t);
    const double ca = cos(alpha), sa = sin(alpha), cb = cos(beta), sb = sin(beta);
    const tdm_mat3 A = {{{c * cb - s * sa * sb, s * cb + c * sa * sb, -ca * sb},
                         {-s * ca, c * ca, sa},
                         {c * sb + s * sa * cb, s * sb - c * sa * cb, ca * cb}}};
    const tdm_mat3 dA = {{{omega * (-s * cb - c * sa * sb), omega * (c * cb - s * sa * sb), 0},
                          {-omega * c * ca, -omega * s * ca, 0},
                          {omega * (-s * sb + c * sa * cb), omega * (c * sb + s * sa * cb), 0}}};
    const tdm_vec3 r = {u * c - u * c * cb + e * s - ecc * s + u * s * sa * sb - e * s * ca,
                        u * s - u * s * cb - e * c + ecc * c - u * c * sa * sb + e * c * ca, u * sb * ca + e * sa};
    const tdm_vec3 dr = {omega * (-u * s + u * s * cb + e * c - ecc * c + u * c * sa * sb - e * c * ca),
                         omega * (u * c - u * c * cb + e * s - ecc * s + u * s * sa * sb - e * s * ca), 0};
    const tdm_vec3 from = tdm_sub(place(t), r);
    const dem_relative now = seen(omega, t);
    ck_vector(now.position, tdm_m3_mul(A, from), 1e-12);
    ck_vector(now.velocity, tdm_add(tdm_m3_mul(A, tdm_sub(velocity(t), dr)), tdm_m3_mul(dA, from)), 1e-10);
  }
}
END_TEST

/* ---- channels ---- */

typedef struct {
  json_t *json;
  dem_engine *engine;
  const dem_start *start;
  double t, value[128];
} run;

static run *run_begin(json_t *json, double dt) {
  run *r = calloc(1, sizeof *r);
  r->json = json;
  const tdm_assignment a = {.scene = json, .time_end = 10, .dt = dt, .n = 1};
  tdm_error err = {0};
  dem_engine_create(&r->engine, &a, NULL, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s", err.path, err.message);
  r->start = dem_engine_start(r->engine);
  ck_assert_int_le(r->start->nchannel, 128);
  memcpy(r->value, r->start->initial, (size_t)r->start->nchannel * sizeof *r->value);
  return r;
}

static void run_end(run *r) {
  dem_engine_destroy(&r->engine);
  json_decref(r->json);
  free(r);
}

/* a window of n steps of dt, with an output at its end, or at `at` in it */
static void go(run *r, uint64_t n, double dt, double at) {
  const double t1 = r->t + (double)n * dt, sample = at > 0 ? at : t1;
  const dem_window w = {.t0 = r->t, .t1 = t1, .nstep = n, .nsample = 1, .sample_time = &sample};
  tdm_error err = {0};
  ck_assert_msg(dem_engine_advance(r->engine, &w, &(dem_outcome){.channel = r->value}, &err) == TDM_OK, "%s",
                err.message);
  r->t = t1;
}

static double value(const run *r, const char *path, const char *what) {
  char name[64];
  snprintf(name, sizeof name, "path.%s.%s", path, what);
  for (int c = 0; c < r->start->nchannel; c++)
    if (strcmp(r->start->channel[c].name, name) == 0) {
      ck_assert(r->start->channel[c].gaps);
      return r->value[c];
    }
  ck_abort_msg("no channel %s", name);
}

static tdm_vec3 vector(const run *r, const char *path, const char *stem) {
  const char *const of[] = {"x", "y", "z"};
  double v[3];
  for (int k = 0; k < 3; k++) {
    char name[8];
    snprintf(name, sizeof name, "%s%s", stem, of[k]);
    v[k] = value(r, path, name);
  }
  return tdm_v3(v[0], v[1], v[2]);
}

#define MATERIALS                                                                                         \
  "'gravity':[0,0,0],'materials':[{'name':'a','density':1000,'young_modulus':1e4,'poisson_ratio':0.25}]," \
  "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0}]"

START_TEST(test_body_that_turns_and_moves) {
  /* a particle that flies straight, seen from a body that turns and moves; also at times inside a step */
  const double dt = 1e-3, w = 3;
  run *r = run_begin(
      scene_json(
          "{" MATERIALS ",'bodies':[{'name':'b','material':'a','position':[0.1,0.2,0.3],'shapes':[{'type':"
          "'sphere','radius':0.01,'center':[5,0,0]}],'motion':{'velocity':[0.5,-0.2,0.1],'angular_velocity':"
          "[0,0,%g]}}],'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[1,0,0]],"
          "'velocity':[-0.3,0.4,0.2]}],'paths':[{'name':'p','particle':0,'body':'b'},{'name':'w','particle':0}]}",
          w),
      dt);
  for (int n = 0; n < 50; n++) {
    const double inside = n % 2 ? 0.3 * dt : 0, t = r->t - inside;
    const tdm_vec3 x = tdm_v3(1 - 0.3 * t, 0.4 * t, 0.2 * t), ux = tdm_v3(-0.3, 0.4, 0.2);
    const tdm_vec3 c = tdm_v3(0.1 + 0.5 * t, 0.2 - 0.2 * t, 0.3 + 0.1 * t);
    const tdm_vec3 from = tdm_sub(x, c), rate = tdm_sub(ux, tdm_v3(0.5, -0.2, 0.1));
    const double co = cos(w * t), si = sin(w * t);
    const tdm_vec3 l = tdm_v3(co * from.x + si * from.y, -si * from.x + co * from.y, from.z);
    const tdm_vec3 dl = tdm_v3(co * rate.x + si * rate.y + w * l.y, -si * rate.x + co * rate.y - w * l.x, rate.z);
    ck_vector(vector(r, "p", ""), l, inside > 0 ? 1e-9 : 1e-10);
    ck_vector(vector(r, "p", "v"), dl, inside > 0 ? 1e-5 : 1e-10); /* along a line inside a step */
    ck_vector(vector(r, "w", ""), x, 1e-10);
    ck_vector(vector(r, "w", "v"), ux, 1e-10);
    go(r, 20, dt, n % 2 ? 0 : r->t + 20 * dt - 0.3 * dt);
  }
  run_end(r);
}
END_TEST

START_TEST(test_gaps) {
  /* undefined until the particle is made and from when it has left; particles of a source are counted among their own,
   * others among all */
  const double dt = 1e-2;
  run *r = run_begin(
      scene_json("{" MATERIALS ",'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]]}],"
                 "'sources':[{'name':'s','material':'a','radius':0.01,'rate':10,'position':[0,1,0],'velocity':[1,0,0]},"
                 "{'name':'t','material':'a','radius':0.01,'rate':10,'start':0.05,'position':[0,2,0],"
                 "'velocity':[1,0,0]}],'sinks':[{'name':'k','type':'box','min':[0.495,-9,-9],'max':[9,9,9]}],"
                 "'paths':[{'name':'third','particle':3},{'name':'t1','particle':1,'source':'t'},"
                 "{'name':'first','particle':0}]}"),
      dt);
  /* ids: 0 at the start, 1 (s, t = 0), 2 (t, 0.05), 3 (s, 0.1), 4 (t, 0.15) */
  for (int n = 0; n < 90; n++) {
    const double t = dt * n;
    if (t > 0.1 - 1e-9 && t < 0.595)
      ck_vector(vector(r, "third", ""), tdm_v3(t - 0.1, 1, 0), 1e-10);
    else
      ck_assert(isnan(value(r, "third", "x")) && isnan(value(r, "third", "vz")));
    if (t > 0.15 - 1e-9 && t < 0.645)
      ck_vector(vector(r, "t1", ""), tdm_v3(t - 0.15, 2, 0), 1e-10);
    else
      ck_assert(isnan(value(r, "t1", "x")) && isnan(value(r, "t1", "vz")));
    ck_assert(value(r, "first", "x") == 0);
    go(r, 1, dt, 0);
  }
  run_end(r);
}
END_TEST

START_TEST(test_restored) {
  /* who the particle of a source is belongs to the state */
  const double dt = 1e-2;
  run *r = run_begin(scene_json("{" MATERIALS ",'sources':[{'name':'s','material':'a','radius':0.01,'rate':10,"
                                "'position':[0,1,0],'velocity':[1,0,0]}],'paths':[{'name':'p','particle':2,"
                                "'source':'s'}]}"),
                     dt);
  tdm_error err = {0};
  go(r, 15, dt, 0);
  ck_assert_int_eq(dem_engine_save(r->engine, 0, &err), TDM_OK);
  go(r, 15, dt, 0);
  const double x = value(r, "p", "x");
  ck_near(x, 0.1, 1e-10);
  ck_assert_int_eq(dem_engine_restore(r->engine, 0, &err), TDM_OK);
  r->t = 15 * dt;
  go(r, 1, dt, 0);
  ck_assert(isnan(value(r, "p", "x")));
  go(r, 14, dt, 0);
  ck_assert(value(r, "p", "x") == x);
  run_end(r);
}
END_TEST

START_TEST(test_refused) {
  static const struct {
    const char *paths, *path, *says;
  } bad[] = {
      {"{'name':'p'}", "dem.paths[0].particle", "missing"},
      {"{'particle':1}", "dem.paths[0].name", "missing"},
      {"{'name':'p','particle':-1}", "dem.paths[0].particle", "0"},
      {"{'name':'p','particle':1,'source':'so'}", "dem.paths[0].source", "none of dem.sources"},
      {"{'name':'p','particle':1,'body':'b'}", "dem.paths[0].body", "no body of dem.bodies"},
      {"{'name':'p','particle':1},{'name':'p','particle':2}", "dem.paths[1].name", "each its own"},
      {"{'name':'p','particle':1,'spin':true}", "dem.paths[0].spin", "unknown"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
    tdm_error err = rig_refused(scene_json("{" MATERIALS ",'paths':[%s]}", bad[k].paths), NULL);
    ck_assert_msg(strcmp(err.path, bad[k].path) == 0, "%zu: %s: %s", k, err.path, err.message);
    ck_assert_msg(strstr(err.message, bad[k].says), "%zu: %s: %s", k, err.path, err.message);
  }
}
END_TEST

TEST_MAIN("dem: paths", test_differences, test_as_printed, test_body_that_turns_and_moves, test_gaps, test_restored,
          test_refused)

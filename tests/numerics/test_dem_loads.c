/* Loads on bodies, geometries, triangles and fixed particles as channels; elastic force and energy by the scene's law;
 * steps that are refused. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/walls.h"
#include "dem/contact/law/theory.h"
#include "dem/watch/check.h"
#include "dem/watch/guard.h"
#include "test_dem_support.h"
#include "tests/test_main.h"

#include <unistd.h>

#define MATERIAL "'materials':[{'name':'a','density':2500,'young_modulus':1e7,'poisson_ratio':0.25}]"
#define PAIR "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}]"

/* ---- channels ---- */

typedef struct {
  json_t *json;
  tdm_ready ready;
  void *self;
  double dt, channel[96];
} session;

static session *open_session(json_t *json, double dt) {
  session *s = calloc(1, sizeof *s);
  tdm_assignment a = {.scene = json, .time_end = 1, .dt = dt, .n = 1};
  tdm_error err = {0};
  *s = (session){.json = json, .dt = dt};
  ck_assert_msg(!dem_solver_ops.create(&s->self, &a, &s->ready, NULL, &err), "%s: %s", err.path, err.message);
  ck_assert_int_le(s->ready.nchannel, 96);
  return s;
}

static void close_session(session *s) {
  dem_solver_ops.destroy(s->self);
  json_decref(s->json);
  free(s);
}

/* n steps from step k0, one sample at the end */
static void run(session *s, int k0, int n) {
  double t = (k0 + n) * s->dt;
  tdm_step step = {.t0 = k0 * s->dt, .t1 = t, .nstep = (uint64_t)n, .nsample = 1, .sample_time = &t};
  tdm_result result = {.nsample = 1, .nchannel = s->ready.nchannel, .channel = s->channel};
  tdm_error err = {0};
  ck_assert_msg(!dem_solver_ops.step(s->self, &step, &result, &err), "%s", err.message);
}

static int find(const session *s, const char *name) {
  for (int c = 0; c < s->ready.nchannel; c++)
    if (strcmp(s->ready.channel[c].name, name) == 0)
      return c;
  return -1;
}

static tdm_vec3 force_of(const session *s, const char *name) {
  char x[64];
  snprintf(x, sizeof x, "%s.fx", name);
  int c = find(s, x);
  ck_assert_msg(c >= 0, "no channel %s", x);
  return tdm_v3(s->channel[c], s->channel[c + 1], s->channel[c + 2]);
}

START_TEST(test_impulse) {
  /* A ball hits a block in free flight before and after: the mean of the load is the impulse. So for each integrator:
   * only multi-step sums forces of several kinds. A coupled or empty body has no channel. */
  static const char *const more[] = {"", ",'integrator':'multi-step','multi_step':{'substeps':3,'mass':1}"};
  for (int k = 0; k < 2; k++) {
    session *s = open_session(scene_json("{" MATERIAL "," PAIR
                                         ",'bodies':[{'name':'bl-ock_1','material':'a','shapes':[{'type':'box','side':"
                                         "'outside','size':[1,1,1],'center':[0,0,-0.5]}]},"
                                         "{'name':'empty','material':'a','shapes':[]}],'particles':[{'type':'list',"
                                         "'material':'a','radius':0.05,'mass':2,'positions':[[0.1,0,0.051]],"
                                         "'velocity':[1,0,-1]}]%s}",
                                         more[k]),
                              1e-5);
    ck_assert_int_eq(find(s, "body.empty.fx"), -1);
    ck_assert_str_eq(s->ready.channel[find(s, "body.bl-ock_1.mz")].unit, "N m");
    run(s, 0, 2000);
    double t = 2000 * s->dt;
    const dem_pace *after = &dem_solver_data(s->self)->state.pace[0];
    ck_assert(after->velocity.z > 0.1);
    tdm_vec3 mean = force_of(s, "body.bl-ock_1");
    ck_vector(tdm_scale(-t, mean), tdm_v3(2 * (after->velocity.x - 1), 0, 2 * (after->velocity.z + 1 + 9.81 * t)),
              1e-12);
    int my = find(s, "body.bl-ock_1.my");
    double arm = -s->channel[my] / mean.z; /* about the body's origin, on the surface: where the ball is */
    ck_assert(arm > 0.1 && arm < 0.12);
    run(s, 2000, 100);
    ck_assert(tdm_norm(force_of(s, "body.bl-ock_1")) == 0);
    close_session(s);
  }
}
END_TEST

START_TEST(test_fixed) {
  /* a ball bounces off fixed ones that touch each other; without them there are no channels */
  session *s = open_session(scene_json("{" MATERIAL "," PAIR
                                       ",'gravity':[0,0,0],'particles':[{'type':'list','material':'a','radius':0.05,"
                                       "'positions':[[0,0,0],[0.0999,0,0]],'fixed':true},{'type':'list','material':'a',"
                                       "'radius':0.05,'mass':2,'positions':[[0.05,0.01,0.09]],'velocity':[0,0,-1]}]}"),
                            1e-5);
  ck_assert_int_eq(find(s, "fixed.mx"), -1);
  run(s, 0, 3000);
  const dem_pace *after = &dem_solver_data(s->self)->state.pace[2];
  ck_assert(after->velocity.z > 0.1 && dem_solver_data(s->self)->state.ncontact == 0);
  ck_vector(tdm_scale(-3000 * s->dt, force_of(s, "fixed")), tdm_scale(2, tdm_sub(after->velocity, tdm_v3(0, 0, -1))),
            1e-12);
  close_session(s);
  s = open_session(scene_json("{" MATERIAL "," PAIR ",'particles':[{'type':'list','material':'a','radius':0.05,"
                              "'positions':[[0,0,0]]}]}"),
                   1e-5);
  ck_assert_int_eq(find(s, "fixed.fx"), -1);
  close_session(s);
}
END_TEST

/* ---- geometries and triangles ---- */

static const char *mesh_file(void) {
  static char path[256];
  snprintf(path, sizeof path, "%s/loads_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  return path;
}

/* a trough along y: floor of 8 x 8 quads and a slope of 45 degrees at x = 0, facing up */
static void write_trough(void) {
  FILE *f = fopen(mesh_file(), "w");
  ck_assert_ptr_nonnull(f);
  fputs("solid s\n", f);
  for (int slope = 0; slope < 2; slope++)
    for (int i = 0; i < 64; i++)
      for (int half = 0; half < 2; half++) {
        fputs("facet normal 0 0 1\nouter loop\n", f);
        static const int corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
        for (int k = 0; k < 3; k++) {
          double u = 0.0625 * (i % 8 + corner[half][k][0]), v = 0.0625 * (i / 8 + corner[half][k][1]);
          fprintf(f, "vertex %g %g %g\n", slope ? u - 0.5 : u, v, slope ? 0.5 - u : 0);
        }
        fputs("endloop\nendfacet\n", f);
      }
  fputs("endsolid s\n", f);
  fclose(f);
}

#define TROUGH "{'type':'mesh','file':'%s'}"
#define BLOCK "{'type':'box','side':'outside','size':[0.06,0.5,0.04],'center':[0.15,0.25,0.02]}"
#define PLANES                                                                           \
  "{'type':'box','side':'inside','size':[1,0.5,1],'center':[0,0.25,0.5],'open':['-z']}," \
  "{'type':'plane','normal':[-1,0,1],'point':[0.3,0,0]}"
#define GRAINS                                                                                                    \
  "'particles':[{'type':'random','material':'a','radius':[0.015,0.03],'count':%d,'seed':5,'region':{'min':[-0.1," \
  "0.01,0.2],'max':[0.4,0.49,0.9]}}]"

/* a bed that has fallen into the trough */
static rig *bed(const char *pair, const char *bodies, const char *more, int count, long steps) {
  char text[8192];
  snprintf(text, sizeof text, "{" MATERIAL ",'pairs':[{'materials':['a','a'],%s}],'bodies':[%s]%s," GRAINS "}", pair,
           bodies, more, count);
  rig *r = rig_make(scene_json("%s", text), 2e-4, 0, NULL);
  rig_steps(r, steps);
  return r;
}

START_TEST(test_geometries) {
  /* Each geometry has the load that it has as a body of its own; they add up; the run is the same bit by bit. */
  static const char *const more[] = {
      "", ",'geometry_loads':true", ",'geometry_loads':true,'energy':true,'threads':2",
      ",'geometry_loads':true,'integrator':'multi-step','multi_step':{'substeps':2,'mass':0.05}"};
  char one[2048], several[2048];
  snprintf(one, sizeof one, "{'name':'b','material':'a','shapes':[" TROUGH "," BLOCK "," PLANES "]}", mesh_file());
  snprintf(several, sizeof several,
           "{'name':'m','material':'a','shapes':[" TROUGH "]},{'name':'b','material':'a','shapes':[" BLOCK
           "]},{'name':'p','material':'a','shapes':[" PLANES "]}",
           mesh_file());
  write_trough();
  const char *pair = "'restitution':0.5,'friction':0.4";
  rig *plain = bed(pair, one, "", 200, 1500);
  for (int k = 1; k < 4; k++) {
    rig *r = bed(pair, one, more[k], 200, 1500), *own = bed(pair, several, k < 3 ? "" : more[k], 200, 1500);
    const tdm_wrench *load = r->data->state.body_load, *body = own->data->state.body_load;
    ck_assert_int_eq(r->model->nload, 5);
    double scale = 0;
    tdm_wrench sum = {0};
    for (int g = 1; g <= 4; g++) {
      scale += tdm_norm(load[g].force);
      sum.force = tdm_add(sum.force, load[g].force);
      sum.moment = tdm_add(sum.moment, load[g].moment);
    }
    ck_vector(sum.force, load[0].force, 1e-12 * scale);
    ck_vector(sum.moment, load[0].moment, 1e-12 * scale);
    for (int g = 1; g <= 2; g++) {
      ck_assert(tdm_norm(load[g].force) > 1);
      ck_vector(load[g].force, body[g - 1].force, 1e-12 * scale);
      ck_vector(load[g].moment, body[g - 1].moment, 1e-12 * scale);
    }
    ck_vector(tdm_add(load[3].force, load[4].force), body[2].force, 1e-12 * scale);
    if (k < 3)
      ck_assert_mem_eq(load, plain->data->state.body_load, sizeof *load);
    rig_free(r);
    rig_free(own);
  }
  rig_free(plain);
  unlink(mesh_file());
}
END_TEST

START_TEST(test_geometry_channels) {
  /* only of bodies that have several */
  session *s = open_session(scene_json("{" MATERIAL "," PAIR
                                       ",'geometry_loads':true,'bodies':[{'name':'one','material':'a','shapes':[" BLOCK
                                       "]},{'name':'two','material':'a','shapes':[{'type':'plane','normal':[0,0,1]},"
                                       "{'type':'plane','normal':[1,0,0]}]}],'particles':[{'type':'list','material':"
                                       "'a','radius':0.05,'positions':[[0.0499,0,0.0499]]}]}"),
                            1e-5);
  ck_assert_int_ge(find(s, "body.one.fx"), 0);
  ck_assert_int_eq(find(s, "body.one.shape0.fx"), -1);
  run(s, 0, 1);
  tdm_vec3 floor = force_of(s, "body.two.shape0"), side = force_of(s, "body.two.shape1");
  ck_assert(floor.z < 0 && fabs(floor.z) > 10 * fabs(floor.x));
  ck_assert(side.x < 0 && fabs(side.x) > 10 * fabs(side.z));
  ck_vector(tdm_add(floor, side), force_of(s, "body.two"), 1e-12);
  close_session(s);
}
END_TEST

START_TEST(test_triangles) {
  /* the forces on the triangles are the body's load, for laws with and without history, several contacts of a particle
   * and several steps in one; a run that asks is the same bit by bit */
  static const struct {
    const char *pair, *more;
  } cases[] = {
      {"'restitution':0.5,'friction':0.4", ""},
      {"'restitution':0.5,'friction':0.4", ",'contact':{'tangential':'coulomb'}"},
      {"'stiffness':2e4,'unloading_stiffness':4e4,'friction':0.4", ",'contact':{'normal':'hysteretic'}"},
      {"'restitution':0.5,'friction':0.4,'rolling_friction':0.1,'cohesion_density':1e4",
       ",'contact':{'rolling':'spring-dashpot','cohesion':'sjkr'},'threads':2"},
      {"'restitution':0.5,'friction':0.4", ",'integrator':'multi-step','multi_step':{'substeps':2,'mass':0.1}"},
  };
  char body[1024], more[512];
  snprintf(body, sizeof body,
           "{'name':'m','material':'a','shapes':[" TROUGH "]},{'name':'p','material':'a','shapes':[" PLANES "]}",
           mesh_file());
  write_trough();
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    snprintf(more, sizeof more, "%s,'triangle_forces':true", cases[k].more);
    rig *r = bed(cases[k].pair, body, more, 200, 2500);
    const dem_data *d = r->data;
    if (k == 0) {
      rig *plain = bed(cases[k].pair, body, cases[k].more, 200, 2500);
      ck_assert_mem_eq(d->state.body_load, plain->data->state.body_load, 2 * sizeof *d->state.body_load);
      rig_free(plain);
    }
    ck_assert_int_eq(r->model->ntriangle, 256);
    tdm_vec3 sum = {0, 0, 0};
    double scale = 0;
    int pressed[2] = {0, 0};
    for (int t = 0; t < 256; t++) {
      sum = tdm_add(sum, d->work.traction.force[t]);
      scale += tdm_norm(d->work.traction.force[t]);
      pressed[t >= 128] += tdm_norm(d->work.traction.force[t]) > 0;
    }
    ck_assert(pressed[0] > 20 && pressed[1] > 5);
    ck_vector(sum, d->state.body_load[0].force, 1e-12 * scale);
    rig_free(r);
  }
  unlink(mesh_file());
}
END_TEST

START_TEST(test_one_triangle) {
  /* a sphere in the corner: the floor's triangle carries what the floor carries, the slope's what the slope does */
  char body[512];
  snprintf(body, sizeof body, "'bodies':[{'name':'m','material':'a','shapes':[" TROUGH "]}]", mesh_file());
  write_trough();
  double x = 0.05 / tan(0.375 * M_PI), off = 1e-4; /* touches both; then off deeper into the floor */
  rig *r = rig_make(scene_json("{" MATERIAL "," PAIR ",%s,'triangle_forces':true,'particles':[{'type':'list',"
                               "'material':'a','radius':0.05,'positions':[[%.17g,0.26,%.17g]]}]}",
                               body, x, 0.05 - off),
                    1e-5, 0, NULL);
  int touched = 0;
  for (int t = 0; t < 256; t++) {
    tdm_vec3 f = r->data->work.traction.force[t];
    touched += tdm_norm(f) > 0;
    double e = r->model->pair[0].effective_young, overlap = t < 128 ? off : off * sqrt(0.5);
    if (tdm_norm(f) > 0)
      ck_relative(tdm_norm(f), 4.0 / 3 * e * sqrt(0.05 * overlap) * overlap, 1e-3);
  }
  ck_assert_int_eq(touched, 2);
  rig_free(r);
  unlink(mesh_file());
}
END_TEST

/* ---- the scene's law ---- */

static const struct {
  const char *pair, *contact;
} laws[] = {{"'restitution':0.5", "'normal':'hertz'"},
            {"'restitution':0.5,'stiffness':2e4", "'normal':'hooke'"},
            {"'restitution':0.5,'contact_time':1e-3", "'normal':'hooke'"},
            {"'restitution':0.5,'stiffness':1e6", "'normal':'hunt-crossley','exponent':1.4"},
            {"'stiffness':2e4,'unloading_stiffness':3e4", "'normal':'hysteretic'"}};

START_TEST(test_elastic) {
  /* what the theory says is stored is what the loops say, also on the way back of a law that remembers */
  for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++)
    for (int back = 0; back < 2; back++) {
      rig *r =
          rig_make(scene_json("{" MATERIAL ",'pairs':[{'materials':['a','a'],%s}],'contact':{%s,'tangential':'none'"
                              "},'energy':true,'gravity':[0,0,0],'particles':[{'type':'list','material':'a',"
                              "'radius':0.05,'positions':[[0,0,0],[0.0993,0,0]]}]}",
                              laws[k].pair, laws[k].contact),
                   1e-6, 0, NULL);
      dem_data *d = r->data;
      double overlap = 7e-4, deepest = overlap;
      if (back) {
        d->state.sphere[1].position.x += 2e-4;
        overlap -= 2e-4;
      }
      forces_now(d, false);
      dem_impact at = {.mass = 0.5 * d->state.mass[0], .radius = 0.025, .deepest = deepest};
      ck_relative(dem_normal_elastic(r->model, r->model->pair, at, overlap), dem_energy_elastic(&d->state.energy),
                  1e-9);
      ck_relative(dem_normal_force(r->model, r->model->pair, at, overlap), d->state.push[1].force.x, 1e-9);
      rig_free(r);
    }
}
END_TEST

START_TEST(test_lid) {
  /* the force on a lid at rest is the load, for each law, pressed and then let back */
  for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
    rig *r = rig_make(scene_json("{" MATERIAL ",'pairs':[{'materials':['a','a'],%s}],'contact':{%s,'tangential':'none'"
                                 "},'gravity':[0,0,0],'settle':{},'bodies':[{'name':'box','material':'a','shapes':[{"
                                 "'type':'box','side':'inside','size':[1,1,1],'lid':{'face':'+z','gap':0}}]}],"
                                 "'particles':[{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0],"
                                 "[0.2,0,-0.0001],[0.3,0.3,-0.3]]}]}",
                                 laws[k].pair, laws[k].contact),
                      1e-6, 0, NULL);
    dem_data *d = r->data;
    const dem_box *box = &r->model->box[0];
    ck_assert(dem_lids_place(d));
    double face = d->state.lid[box->lid];
    const double overlaps[] = {1e-4, 7e-4, 5e-4};
    for (int o = 0; o < 3; o++) {
      d->state.lid[box->lid] = face - overlaps[o];
      forces_now(d, true);
      ck_assert(d->state.body_load[0].force.z > 0.1);
      ck_relative(dem_lid_force(d, box), d->state.body_load[0].force.z, 1e-9);
    }
    rig_free(r);
  }
}
END_TEST

/* ---- the guard ---- */

START_TEST(test_guard_of_each_law) {
  /* a ball that bounces does not alarm it; the same ball given three times its speed does, with the amount */
  for (size_t k = 0; k < sizeof laws / sizeof laws[0]; k++) {
    rig *r = rig_make(scene_json("{" MATERIAL ",'pairs':[{'materials':['a','a'],%s}],'contact':{%s,'tangential':'none'"
                                 "},'gravity':[0,0,0],'guard':{'action':'stop','every':1,'energy':0.01},'bodies':[{"
                                 "'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                                 "'particles':[{'type':'list','material':'a','radius':0.05,'mass':2,'positions':["
                                 "[0,0,0.0505]],'velocity':[0,0,-1]}]}",
                                 laws[k].pair, laws[k].contact),
                      1e-5, 0, NULL);
    tdm_error err = rig_guarded(r, 5000, NULL);
    ck_assert_msg(err.status == TDM_OK, "%zu: %s", k, err.message);
    double v = r->data->state.pace[0].velocity.z;
    ck_assert(v > 0.1 && r->data->state.ncontact == 0);
    r->data->state.pace[0].velocity.z = 3 * v;
    err = rig_guarded(r, 5, NULL);
    char says[64];
    snprintf(says, sizeof says, "rose by %.3g J", 8 * v * v);
    ck_assert_msg(strstr(err.message, says) != NULL, "%zu: %s, not in: %s", k, says, err.message);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_guard_of_a_belt) {
  /* what a belt gives is no energy out of nothing */
  rig *r = rig_make(scene_json("{" MATERIAL "," PAIR ",'guard':{'action':'stop','every':1,'energy':0.01},'bodies':[{"
                               "'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1],"
                               "'surface_velocity':[1,0,0]}]}],'particles':[{'type':'list','material':'a','radius':"
                               "0.05,'positions':[[0,0,0.05]]}]}"),
                    1e-5, 0, NULL);
  tdm_error err = rig_guarded(r, 10000, NULL);
  ck_assert_msg(err.status == TDM_OK, "%s", err.message);
  ck_assert(r->data->state.pace[0].velocity.x > 0.1);
  rig_free(r);
}
END_TEST

/* ---- steps that are refused ---- */

static tdm_error create_error(json_t *json, double dt, tdm_warning *first) {
  tdm_assignment a = {.scene = json, .time_end = 10 * dt, .dt = dt, .n = 1};
  void *self = NULL;
  tdm_ready ready = {0};
  tdm_error err = {0};
  dem_solver_ops.create(&self, &a, &ready, NULL, &err);
  *first = (tdm_warning){0};
  if (!err.status && ready.nwarning > 0)
    *first = ready.warning[0];
  dem_solver_ops.destroy(self);
  json_decref(json);
  return err;
}

START_TEST(test_step) {
  /* a step longer than half a contact is refused, for each law and when it is overdamped, unless the guard is told to
   * warn; just below it is a warning; when the guard is told to stop a twentieth is the limit */
  static const char *const critical = "'damping':'critical','stiffness':2e4";
  tdm_warning warning;
  for (size_t k = 0; k <= sizeof laws / sizeof laws[0]; k++) {
    bool last = k == sizeof laws / sizeof laws[0];
    const char *format = "{" MATERIAL ",'pairs':[{'materials':['a','a'],%s}],'contact':{%s,'tangential':'none'},"
                         "'guard':{%s},'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':"
                         "[0,0,1]}]}],'particles':[{'type':'list','material':'a','radius':0.05,'positions':["
                         "[0,0,0.5]]}]}";
    const char *pair = last ? critical : laws[k].pair, *contact = laws[last ? 1 : k].contact;
    tdm_error err = create_error(scene_json(format, pair, contact, ""), 1, &warning);
    ck_assert_int_eq(err.status, TDM_ERR_SCENE);
    ck_assert_str_eq(err.path, "time.dt");
    ck_assert_ptr_nonnull(strstr(err.message, "half of the shortest contact, "));
    double time = strtod(strstr(err.message, "contact, ") + 9, NULL);
    err = create_error(scene_json(format, pair, contact, "'action':'stop'"), 0.51 * time, &warning);
    ck_assert_str_eq(err.path, "time.dt");
    /* "stop": [A07]'s rule, a twentieth */
    err = create_error(scene_json(format, pair, contact, "'action':'stop'"), 0.0501 * time, &warning);
    ck_assert_str_eq(err.path, "time.dt");
    ck_assert_ptr_nonnull(strstr(err.message, "a twentieth of the shortest contact, "));
    err = create_error(scene_json(format, pair, contact, "'action':'stop'"), 0.0499 * time, &warning);
    ck_assert_msg(err.status == TDM_OK, "%s", err.message);
    err = create_error(scene_json(format, pair, contact, ""), 0.49 * time, &warning);
    ck_assert_msg(err.status == TDM_OK, "%s", err.message);
    ck_assert_str_eq(warning.path, "time.dt");
    err = create_error(scene_json(format, pair, contact, "'action':'warn'"), 1, &warning);
    ck_assert_msg(err.status == TDM_OK, "%s", err.message);
    ck_assert_str_eq(warning.path, "time.dt");
  }
}
END_TEST

START_TEST(test_settle_step) {
  tdm_warning warning;
  const char *format = "{" MATERIAL "," PAIR ",'settle':{'dt':%g},'bodies':[{'name':'floor','material':'a','shapes':[{"
                       "'type':'plane','normal':[0,0,1]}]}],'particles':[{'type':'list','material':'a','radius':0.05,"
                       "'positions':[[0,0,0.05]]}]}";
  tdm_error err = create_error(scene_json(format, 1.0), 1e-5, &warning);
  ck_assert_int_eq(err.status, TDM_ERR_SCENE);
  ck_assert_str_eq(err.path, "dem.settle.dt");
  ck_assert_int_eq(create_error(scene_json(format, 1e-4), 1e-5, &warning).status, TDM_OK);
}
END_TEST

START_TEST(test_gravity_across) {
  tdm_warning warning;
  const char *format = "{" MATERIAL "," PAIR ",'gravity':%s,'dimension':2,'plane':'xz','particles':[{'type':'list',"
                       "'material':'a','radius':0.05,'positions':[[0,0,0]]}]}";
  ck_assert_int_eq(create_error(scene_json(format, "[1,2.5,-9.81]"), 1e-5, &warning).status, TDM_OK);
  ck_assert_str_eq(warning.path, "dem.gravity");
  ck_assert_ptr_nonnull(strstr(warning.message, "y component, 2.5"));
  ck_assert_int_eq(create_error(scene_json(format, "[1,0,-9.81]"), 1e-5, &warning).status, TDM_OK);
  ck_assert_str_eq(warning.path, "");
}
END_TEST

START_TEST(test_not_representable) {
  static const struct {
    const char *key, *path, *says;
  } cases[] = {
      {"'gravity':[0,0,1e308]", "dem.gravity", "too large"},
      {"'particles':[{'type':'list','material':'a','radius':0.05,'mass':1e-300,'positions':[[0,0,0]]}]",
       "dem.particles[0].mass", "1e-300 kg"},
      {"'particles':[{'type':'list','material':'a','radius':0.05,'total_mass':1e300,'positions':[[0,0,0]]}]",
       "dem.particles[0].total_mass", "1e+300 kg"},
      {"'particles':[{'type':'list','material':'a','radius':1e-80,'positions':[[0,0,0]]}]", "dem.particles[0].radius",
       "when squared or inverted"},
      {"'particles':[{'type':'list','material':'a','radius':0.05,'acceleration':[1e200,0,0],'positions':[]}]",
       "dem.particles[0].acceleration", "too large"},
      {"'sources':[{'name':'s','material':'a','radius':0.05,'mass':1e-200,'rate':1,'position':[0,0,0]}]",
       "dem.sources[0].mass", "1e-200 kg"},
      {"'sources':[{'name':'s','material':'a','radius':0.05,'rate':1,'position':[0,0,0],'velocity':[0,1e155,0]}]",
       "dem.sources[0].velocity", "too large"},
  };
  tdm_warning warning;
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    tdm_error err = create_error(scene_json("{" MATERIAL "," PAIR ",%s}", cases[k].key), 1e-5, &warning);
    ck_assert_msg(err.status == TDM_ERR_SCENE, "%s: %s", cases[k].key, err.message);
    ck_assert_str_eq(err.path, cases[k].path);
    ck_assert_msg(strstr(err.message, cases[k].says) != NULL, "%s", err.message);
  }
}
END_TEST

TEST_MAIN("dem loads", test_impulse, test_fixed, test_geometries, test_geometry_channels, test_triangles,
          test_one_triangle, test_elastic, test_lid, test_guard_of_each_law, test_guard_of_a_belt, test_step,
          test_settle_step, test_gravity_across, test_not_representable)

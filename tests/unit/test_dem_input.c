/* The solver through its operations: bad scenes are refused with their path, good ones report; windows and samples. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "../numerics/test_dem_support.h"
#include "../numerics/test_session_support.h"
#include "dem/adapter/solver.h"
#include "tests/test_main.h"

#define MATERIALS "'materials':[{'name':'grain','density':1000,'young_modulus':1e7,'poisson_ratio':0.2}]"
#define PAIRS "'pairs':[{'materials':['grain','grain'],'restitution':0.5,'friction':0.4}]"
#define BOX                                                                                                            \
  "'bodies':[{'name':'box','material':'grain','shapes':[{'type':'box','size':[1,1,1],'side':'inside','open':['+z']}]}" \
  "]"
#define ONE(x) "'particles':[{'type':'list','material':'grain','radius':0.05,'positions':[" x "]}]"

#define SOURCE(x) "{'name':'feed','material':'grain','radius':0.05," x "}"

typedef struct {
  const char *scene, *path, *says;
} bad;

static const bad bads[] = {
    {"{'materials':[{'name':'grain','density':-1,'young_modulus':1e7,'poisson_ratio':0.2}]}",
     "dem.materials[0].density", "greater than 0"},
    {"{'materials':[{'name':'grain','density':1,'young_modulus':1e7,'poisson_ratio':0.501}]}",
     "dem.materials[0].poisson_ratio", "at most 0.5"},
    {"{'materials':[{'name':'grain','density':'NaN','young_modulus':1e7,'poisson_ratio':0.2}]}",
     "dem.materials[0].density", "number"},
    {"{'materials':[{'name':'a','density':1,'young_modulus':1,'poisson_ratio':0},"
     "{'name':'a','density':1,'young_modulus':1,'poisson_ratio':0}]}",
     "dem.materials[1].name", "already"},
    {"{" MATERIALS ",'gravty':[0,0,0]}", "dem.gravty", "gravity"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'list','material':'grian','radius':1,'positions':[]}]}",
     "dem.particles[0].material", "grain"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'list','material':'grain','radius':0,'positions':[]}]}",
     "dem.particles[0].radius", "greater than 0"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'list','material':'grain','radius':1,'mass':-2,'positions':[]}]}",
     "dem.particles[0].mass", "greater than 0"},
    {"{" MATERIALS "," PAIRS "," ONE("[0,0]") "}", "dem.particles[0].positions[0]", "three"},
    {"{" MATERIALS "," ONE("[0,0,1],[1,0,1]") "}", "dem.pairs", "\"grain\" and \"grain\""},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'list','material':'grain','radii':[1,2],'positions':[[0,0,0]]}]}",
     "dem.particles[0].radii", "1 positions"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'list','material':'grain','radii':[-1],'positions':[[0,0,0]]}]}",
     "dem.particles[0].radii[0]", "greater than 0"},
    {"{" MATERIALS "," PAIRS
     ",'particles':[{'type':'list','material':'grain','radius':1,'radii':[1],'positions':[[0,0,0]]}]}",
     "dem.particles[0].radius", "excludes"},
    {"{" MATERIALS ",'pairs':[{'materials':['grain','steel'],'restitution':0.5,'friction':0}]}",
     "dem.pairs[0].materials[1]", "steel"},
    {"{" MATERIALS ",'pairs':[{'materials':['grain','grain'],'restitution':0,'friction':0}]}",
     "dem.pairs[0].restitution", "greater than 0"},
    {"{" MATERIALS ",'pairs':[{'materials':['grain','grain'],'restitution':1.5,'friction':0}]}",
     "dem.pairs[0].restitution", "between 0 and 1"},
    {"{" MATERIALS "," PAIRS ",'contact':{'tail':'cilp'}}", "dem.contact.tail", "clip"},
    {"{" MATERIALS "," PAIRS
     ",'bodies':[{'name':'b','material':'grain','shapes':[{'type':'plane','normal':[0,0,0]}]}]}",
     "dem.bodies[0].shapes[0].normal", "zero"},
    {"{" MATERIALS "," PAIRS
     ",'bodies':[{'name':'b','material':'grain','shapes':[{'type':'box','side':'inside','size':[1,0,1]}]}]}",
     "dem.bodies[0].shapes[0].size", "greater than 0"},
    {"{" MATERIALS "," PAIRS ",'bodies':[{'name':'b','material':'grain','shapes':[{'type':'box','side':'inside','size':"
     "[1,1,1],'open':['z']}]}]}",
     "dem.bodies[0].shapes[0].open[0]", "+z"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'random','material':'grain','radius':0.1,'count':100,"
     "'region':{'min':[0,0,0],'max':[1,1,0.4]}}]}",
     "dem.particles[0].region", "holds 50"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'random','material':'grain','radius':0.1,'count':100,"
     "'region':{'min':[0,0,0],'max':[1e12,1,0.4]}}]}",
     "dem.particles[0].region.max", "reaches 1e+12 m from the origin"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'random','material':'grain','radius':0.1,'count':100,"
     "'region':{'min':[-1e19,0,0],'max':[1,1,0.4]}}]}",
     "dem.particles[0].region.min", "reaches 1e+19 m from the origin"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'poured','material':'grain','radius':0.1,'count':100,"
     "'region':{'min':[0,0,0],'max':[1e30,1,0.4]}}]}",
     "dem.particles[0].region.max", "reaches 1e+30 m from the origin"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':9e15,'position':[0,0,0]") "]}", "dem.sources[0].rate",
     "particles in a step"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'mass_rate':1e300,'position':[0,0,0]") "]}",
     "dem.sources[0].mass_rate", "particles in a step"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,1e40,0]") "]}", "dem.sources[0].position",
     "reaches 1e+40 m from the origin"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'random','material':'grain','radius':0.1,'count':-1,"
     "'region':{'min':[0,0,0],'max':[1,1,0.4]}}]}",
     "dem.particles[0].count", "at least 0"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'block','material':'grain','radius':0.1,'count':[2,2,2],"
     "'spacing':0.1,'corner':[0,0,0]}]}",
     "dem.particles[0].spacing", "overlap"},
    {"{" MATERIALS "," PAIRS "," ONE("[0,0,0],[0,0,0.05]") "}", "dem.particles[0]", "overlaps"},
    {"{" MATERIALS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0]") "]}", "dem.pairs", "\"grain\" and \"grain\""},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'position':[0,0,0]") "]}", "dem.sources[0].rate", "mass_rate"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':0,'position':[0,0,0]") "]}", "dem.sources[0].rate",
     "greater than 0"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'mass_rate':2,'position':[0,0,0]") "]}",
     "dem.sources[0].mass_rate", "excludes"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1") "]}", "dem.sources[0].position", "region"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0],'region':{}") "]}",
     "dem.sources[0].region", "excludes"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'region':{'min':[0,0,0],'max':[1,-1,1]}") "]}",
     "dem.sources[0].region.max", "smaller than min"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0],'start':2,'end':2") "]}",
     "dem.sources[0].end", "after start"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0],'count':1.5") "]}",
     "dem.sources[0].count", "whole number"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0],'velocty':[0,0,0]") "]}",
     "dem.sources[0].velocty", "velocity"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0],'relative_to':{'body':'cube'}") "]}",
     "dem.sources[0].relative_to.body", "no body"},
    {"{" MATERIALS "," PAIRS
     ",'sources':[" SOURCE("'rate':1,'position':[0,0,0]") "," SOURCE("'rate':1,'position':[1,0,0]") "]}",
     "dem.sources[1].name", "already"},
    {"{" MATERIALS "," PAIRS ",'sources':[{'name':'a b'}]}", "dem.sources[0].name", "letters"},
    {"{" MATERIALS "," PAIRS ",'sources':[{'name':'a','material':'grain','radius':[0.2,0.1]}]}",
     "dem.sources[0].radius", "smallest, largest"},
    {"{" MATERIALS "," PAIRS ",'sources':[" SOURCE("'rate':1,'position':[0,0,0],'total_mass':0") "]}",
     "dem.sources[0].total_mass", "greater than 0"},
    {"{" MATERIALS "," PAIRS
     ",'sources':[{'name':'a','material':'grain','radius':{'distribution':'normal','mean':1}}]}",
     "dem.sources[0].radius.deviation", "missing"},
    {"{" MATERIALS "," PAIRS ",'particles':[{'type':'block','material':'grain','radius':[0.1,0.2],'count':[2,2,2],"
     "'spacing':0.3,'corner':[0,0,0]}]}",
     "dem.particles[0].spacing", "at least 0.4"},
    {"{" MATERIALS "," PAIRS ",'sinks':[{'name':'a','type':'box','min':[0,0,0],'max':[1,1,1],'classes':[]}]}",
     "dem.sinks[0].classes", "1 to 15"},
    {"{" MATERIALS "," PAIRS ",'sinks':[{'name':'a','type':'box','min':[0,0,0],'max':[1,1,1],'classes':[0.1,0.1]}]}",
     "dem.sinks[0].classes[1]", "greater than 0.1"},
    {"{" MATERIALS "," PAIRS ",'sinks':[{'name':'a','type':'bocks'}]}", "dem.sinks[0].type", "box"},
    {"{" MATERIALS "," PAIRS ",'sinks':[{'name':'a','type':'after_contact'}]}", "dem.sinks[0].body", "missing"},
    {"{" MATERIALS "," PAIRS ",'sinks':[{'name':'a','type':'plane','point':[0,0,0],'normal':[0,0,0]}]}",
     "dem.sinks[0].normal", "zero"},
    {"{" MATERIALS "," PAIRS ",'sinks':[{'name':'a','type':'box','min':[0,0,0],'max':[1,1,1],'body':'x'}]}",
     "dem.sinks[0].body", "no body"},
    {"{" MATERIALS "," PAIRS ",'bodies':[{'name':'b','material':'grain','shapes':[{'type':'box','side':'inside','size':"
     "[1,1,1],'open':['+z'],'lid':{'face':'+z','gap':0}}]}]}",
     "dem.bodies[0].shapes[0].lid.face", "open"},
    {"{" MATERIALS "," PAIRS ",'bodies':[{'name':'b','material':'grain','shapes':[{'type':'box','side':'inside','size':"
     "[1,1,1],'lid':{'face':'+z','gap':-1}}]}]}",
     "dem.bodies[0].shapes[0].lid.gap", "0 or greater"},
    {"{" MATERIALS "," PAIRS ",'bodies':[{'name':'b','material':'grain','shapes':[{'type':'box','side':'outside',"
     "'size':[1,1,1],'lid':{'face':'+z','gap':0}}]}]}",
     "dem.bodies[0].shapes[0].lid", "inside"},
    {"{" MATERIALS "," PAIRS ",'plane':'xz'}", "dem.plane", "\"dimension\": 2"},
    {"{" MATERIALS "," PAIRS ",'plane_at':0.1}", "dem.plane_at", "\"dimension\": 2"},
    {"{" MATERIALS "," PAIRS
     ",'domain':{'min':[0,0,0],'max':[1,1,1]},'sources':[" SOURCE("'rate':1,'position':[0.5,1.5,0.5]") "]}",
     "dem.sources[0]", "outside dem.domain in y"},
    {"{" MATERIALS ",'contact':{'tangential':'none'},'pairs':[{'materials':['grain','grain'],'restitution':0.5}],"
     "'settle':{'friction':0.1}}",
     "dem.settle.friction", "not read"},
    {"{" MATERIALS "," PAIRS ",'settle':{'store':''}}", "dem.settle.store", "empty"},
    {"{" MATERIALS "," PAIRS ",'expected_speed':0}", "dem.expected_speed", "greater than 0"},
};

static const bad bads_coupled[] = {
    {"{" MATERIALS "," PAIRS "," BOX "," ONE("[0,0,-0.5]") "}", "dem.particles[0]", "wall"},
    {"{" MATERIALS "," PAIRS ",'bodies':[{'name':'bxo','material':'grain','shapes':[]}]}", "coupling.bodies[0].dem",
     "did you mean \"bxo\""},
    {"{" MATERIALS "," PAIRS ",'bodies':[{'name':'box','position':[0,0,0],'material':'grain','shapes':[]}]}",
     "dem.bodies[0].position", "coupled"},
};

static tdm_assigned_body box_body(void) {
  return (tdm_assigned_body){.name = "box", .mass = 10, .state = state_at(0, 0, 0)};
}

/* create must fail as the row says */
static void refuse(const bad *row, int nbody) {
  tdm_assigned_body body = box_body();
  json_t *json = scene_json("%s", row->scene);
  tdm_assignment a = {.scene = json, .time_end = 1, .dt = 1e-4, .n = 1, .nbody = nbody, .body = &body};
  void *self = NULL;
  tdm_ready ready = {0};
  tdm_error err = {0};
  tdm_status status = dem_solver_ops.create(&self, &a, &ready, NULL, &err);
  ck_assert_msg(status == TDM_ERR_SCENE, "accepted: %s (%s)", row->scene, err.message);
  ck_assert_str_eq(err.path, row->path);
  ck_assert_msg(strstr(err.message, row->says) != NULL, "%s: %s", err.path, err.message);
  dem_solver_ops.destroy(self);
  json_decref(json);
}

START_TEST(test_bad_scenes) {
  for (size_t i = 0; i < sizeof bads / sizeof bads[0]; i++)
    refuse(&bads[i], 0);
  for (size_t i = 0; i < sizeof bads_coupled / sizeof bads_coupled[0]; i++)
    refuse(&bads_coupled[i], 1);
}
END_TEST

/* ---- the solver in windows ---- */

static session *open_session(const char *scene, double dt) {
  session *s = prepare_session(scene_json("%s", scene), box_body(), dt);
  start_session(s);
  ck_assert_msg(s->err.status == TDM_OK, "%s: %s", s->err.path, s->err.message);
  return s;
}

enum { SAMPLES = 4 };

typedef struct {
  tdm_wrench load, sample_load[SAMPLES];
  double channel[SAMPLES * 32];
} outcome;

/* one window of n steps from step k0, the box rising by `speed` */
static tdm_status window(session *s, long k0, long n, double speed, int nsample, const double *times, outcome *out) {
  double dt = s->assignment.dt, t0 = (double)k0 * dt, t1 = (double)(k0 + n) * dt;
  tdm_state ends[2] = {state_at(0, 0, speed * t0), state_at(0, 0, speed * t1)};
  tdm_step step = {.t0 = t0,
                   .t1 = t1,
                   .nstep = (uint64_t)n,
                   .nbody = 1,
                   .nstate = 1,
                   .nsample = nsample,
                   .start = ends,
                   .end = ends + 1,
                   .sample_time = times};
  *out = (outcome){0};
  tdm_result result = {.nbody = 1,
                       .nload = 1,
                       .nsample = nsample,
                       .nchannel = s->ready.nchannel,
                       .load = &out->load,
                       .sample_load = out->sample_load,
                       .channel = out->channel};
  tdm_error err = {0};
  return dem_solver_ops.step(s->self, &step, &result, &err);
}

#define BED                                                                               \
  "{" MATERIALS "," PAIRS "," BOX                                                         \
  ",'settle':{'speed':0.01},'particles':[{'type':'random','material':'grain','count':40," \
  "'radius':[0.04,0.05],'total_mass':30,'region':{'min':[-0.5,-0.5,-0.5],'max':[0.5,0.5,0.5]}}]}"

START_TEST(test_ready) {
  session *s = open_session(BED, 1e-4);
  ck_assert_int_eq(s->ready.nwarning, 0);
  ck_relative(s->ready.load[0].force.z, -30 * 9.81, 1e-2);
  ck_near(json_number_value(json_object_get(s->ready.report, "particle_mass")), 30, 1e-12);
  ck_assert_int_eq((int)json_integer_value(json_object_get(s->ready.report, "particles")), 40);
  ck_assert_str_eq(s->ready.channel[0].name, "particles.count");
  ck_near(s->ready.initial[0], 40, 0);
  close_session(s);

  s = open_session(BED, 2e-3); /* far above every limit */
  ck_assert_int_eq(s->ready.nwarning, 1);
  ck_assert_str_eq(s->ready.warning[0].path, "time.dt");
  close_session(s);
}
END_TEST

/* doubts about scenes that may be meant so: the path and a word of the only warning */
START_TEST(test_doubts) {
  static const bad doubts[] = {
      {"'bodies':[{'name':'box','material':'grain','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
       "'sources':[" SOURCE("'rate':1,'region':{'min':[0,0,-1],'max':[1,1,-0.06]}") "]",
       "dem.sources[0]", "behind a plane"},
      {"'bodies':[{'name':'box','material':'grain','shapes':[]},{'name':'b','material':'grain','position':[0.5,0.5,0.5]"
       ","
       "'shapes':[{'type':'box','side':'outside','size':[1,0.5,0.1]}]}],'gravity':[0,0,0],'domain':{'min':[0,0,0],'max'"
       ":[1,1,1],"
       "'x':'periodic'}," ONE("[0.5,0.5,0.8]"),
       "dem.bodies", "repeats in x"},
      {"'bodies':[{'name':'box','material':'grain','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
       "'expected_speed':60," ONE("[0,0,0.1]"),
       "dem.guard.overlap", "sinks in"},
      {"'bodies':[{'name':'box','material':'grain','shapes':[]},{'name':'b','material':'grain','shapes':[],"
       "'motion':{'oscillation':{'amplitude':[1,0,0],'frequency':1000}}}],'expected_speed':1," ONE("[0,0,0.1]"),
       "dem.bodies", "moves up to 0.628 m in a step"},
  };
  for (size_t k = 0; k < sizeof doubts / sizeof doubts[0]; k++) {
    char scene[2048];
    snprintf(scene, sizeof scene, "{" MATERIALS "," PAIRS ",%s}", doubts[k].scene);
    session *s = open_session(scene, 1e-4);
    bool told = false;
    for (int w = 0; w < s->ready.nwarning; w++)
      told = told || (strcmp(s->ready.warning[w].path, doubts[k].path) == 0 &&
                      strstr(s->ready.warning[w].message, doubts[k].says));
    ck_assert_msg(told, "%zu: %d warnings, %s: %s", k, s->ready.nwarning, s->ready.warning[0].path,
                  s->ready.warning[0].message);
    close_session(s);
  }
}
END_TEST

START_TEST(test_no_particles) {
  session *s = open_session("{" MATERIALS "," BOX ",'settle':{}}", 1e-4);
  ck_assert_int_eq(s->ready.nwarning, 0);
  outcome out;
  double t = 1e-3;
  ck_assert_int_eq(window(s, 0, 10, 1, 1, &t, &out), TDM_OK);
  ck_near(tdm_norm(out.load.force), 0, 0);
  ck_near(out.channel[0], 0, 0);
  close_session(s);
}
END_TEST

START_TEST(test_split_windows) {
  /* two windows of 50 or one of 100 on one straight path: the same but for round-off of the path; means add up */
  const double times[] = {2e-3, 3e-3, 7.5e-3, 1e-2};
  session *a = open_session(BED, 1e-4), *b = open_session(BED, 1e-4);
  outcome whole, first, second;
  ck_assert_int_eq(window(a, 0, 100, 0.2, 4, times, &whole), TDM_OK);
  ck_assert_int_eq(window(b, 0, 50, 0.2, 2, times, &first), TDM_OK);
  ck_assert_int_eq(window(b, 50, 50, 0.2, 2, times + 2, &second), TDM_OK);
  ck_relative(0.5 * (first.load.force.z + second.load.force.z), whole.load.force.z, 1e-9);
  for (int k = 0; k < 4; k++) {
    const outcome *part = k < 2 ? &first : &second;
    ck_relative(part->sample_load[k % 2].force.z, whole.sample_load[k].force.z, 1e-9);
    for (int c = 0; c < a->ready.nchannel; c++)
      ck_near(part->channel[k % 2 * a->ready.nchannel + c], whole.channel[k * a->ready.nchannel + c], 1e-9);
  }
  /* the samples' means, weighted with their steps, are the window's mean */
  double sum = 20 * whole.sample_load[0].force.z + 10 * whole.sample_load[1].force.z +
               45 * whole.sample_load[2].force.z + 25 * whole.sample_load[3].force.z;
  ck_relative(sum / 100, whole.load.force.z, 1e-12);
  ck_assert(fabs(whole.load.force.z) > 30 * 9.81); /* the rising floor pushes */
  close_session(a);
  close_session(b);
}
END_TEST

/* a bed with a source above it and a sink that skims it */
#define FLOW                                                                                                           \
  "{" MATERIALS "," PAIRS "," BOX ",'particles':[{'type':'random','material':'grain','count':40,'radius':[0.04,0.05]," \
  "'region':{'min':[-0.5,-0.5,-0.5],'max':[0.5,0.5,0.5]}}],"                                                           \
  "'sources':[{'name':'feed','material':'grain','radius':0.05,'mass':0.5,'rate':300,'start':1e-3,"                     \
  "'position':[0,0,1],'velocity':[60,0,0]},"                                                                           \
  "{'name':'stuck','material':'grain','radius':0.05,'mass':0.5,'rate':50,'position':[0,0,-0.5]}],"                     \
  "'sinks':[{'name':'right','type':'plane','point':[0.4,0,0],'normal':[-1,0,0],'classes':[0.045]}],'guard':{'overlap'" \
  ":9}}"

static double channel_of(const session *s, const outcome *out, int sample, const char *name) {
  for (int c = 0; c < s->ready.nchannel; c++)
    if (strcmp(s->ready.channel[c].name, name) == 0)
      return out->channel[sample * s->ready.nchannel + c];
  ck_abort_msg("no channel %s", name);
  return 0;
}

START_TEST(test_flow_channels) {
  /* the balance in the channels; the same however the run is cut into windows; a source without room is a warning */
  const double times[] = {2e-3, 3e-3, 7.5e-3, 1e-2};
  session *a = open_session(FLOW, 1e-4), *b = open_session(FLOW, 1e-4);
  ck_assert_int_eq(a->ready.nwarning, 1);
  ck_assert_str_eq(a->ready.warning[0].path, "dem.sources[1]");
  outcome whole, first, second;
  ck_assert_int_eq(window(a, 0, 100, 0, 4, times, &whole), TDM_OK);
  ck_assert_int_eq(window(b, 0, 50, 0, 2, times, &first), TDM_OK);
  ck_assert_int_eq(window(b, 50, 50, 0, 2, times + 2, &second), TDM_OK);
  size_t half = 2 * (size_t)a->ready.nchannel * sizeof(double);
  ck_assert_mem_eq(first.channel, whole.channel, half);
  ck_assert_mem_eq(second.channel, whole.channel + 2 * a->ready.nchannel, half);
  const double made[] = {1, 1, 2, 3}; /* at 1, 4.33, 7.67 ms */
  for (int k = 0; k < 4; k++) {
    double removed = channel_of(a, &whole, k, "sink.right.removed");
    double small = channel_of(a, &whole, k, "sink.right.class0.removed");
    ck_near(small + channel_of(a, &whole, k, "sink.right.class1.removed"), removed, 0);
    ck_near(channel_of(a, &whole, k, "sink.right.class0.mass") + channel_of(a, &whole, k, "sink.right.class1.mass"),
            channel_of(a, &whole, k, "sink.right.mass"), 1e-12);
    ck_near(channel_of(a, &whole, k, "source.feed.created"), made[k], 0);
    ck_near(channel_of(a, &whole, k, "source.feed.waiting"), 0, 0);
    ck_near(channel_of(a, &whole, k, "source.stuck.waiting"), 1, 0);
    ck_near(channel_of(a, &whole, k, "particles.count"), 40 + made[k] - removed, 0);
    ck_near(channel_of(a, &whole, k, "balance.number"), 0, 0);
    ck_near(channel_of(a, &whole, k, "balance.mass"), 0, 0);
    ck_assert(removed > 0);
  }
  double all = channel_of(a, &whole, 3, "particles.mass") + channel_of(a, &whole, 3, "sink.right.mass");
  ck_relative(all, json_number_value(json_object_get(a->ready.report, "particle_mass")) + 1.5, 1e-12);
  close_session(a);
  close_session(b);
}
END_TEST

START_TEST(test_repeatable) {
  outcome out[2];
  for (int k = 0; k < 2; k++) {
    double t = 0.02;
    session *s = open_session(BED, 1e-4);
    ck_assert_int_eq(window(s, 0, 200, 0.5, 1, &t, &out[k]), TDM_OK);
    close_session(s);
  }
  ck_assert_mem_eq(&out[0], &out[1], sizeof out[0]);
}
END_TEST

START_TEST(test_fill) {
  /* random filling: all inside, none touching, also at the highest density it can make; different seeds differ */
  rig *r = rig_make(scene_json("{" MATERIALS "," PAIRS ",'gravity':[0,0,0],'particles':["
                               "{'type':'random','material':'grain','count':1000,'radius':[0.03,0.05],"
                               " 'region':{'min':[0,0,0],'max':[1,1,1]},'seed':5},"
                               "{'type':'random','material':'grain','count':300,'radius':0.05,'total_mass':7,"
                               " 'region':{'min':[2,0,0],'max':[3,1,1]},'seed':5},"
                               "{'type':'block','material':'grain','count':[2,3,4],'radius':0.05,'spacing':0.2,"
                               " 'corner':[5,0,0],'mass':0.25}]}"),
                    1e-4, 0, NULL);
  ck_assert_int_eq(r->model->nparticle, 1000 + 300 + 24);
  ck_assert_int_eq(r->data->state.ncontact, 0);
  double mass = 0;
  for (int i = 0; i < 1300; i++) {
    double R = r->model->radius[i], low = i < 1000 ? 0 : 2;
    tdm_vec3 x = r->model->position[i];
    ck_assert(x.x >= low + R - 1e-12 && x.x <= low + 1 - R + 1e-12 && x.y >= R - 1e-12 && x.y <= 1 - R + 1e-12);
    ck_assert(x.z >= R - 1e-12 && x.z <= 1 - R + 1e-12);
    mass += i < 1000 ? 0 : r->model->mass[i];
  }
  ck_near(mass, 7, 1e-12);
  ck_near(r->model->mass[1300], 0.25, 0);
  ck_near(r->model->position[1323].z, 0.6, 1e-12);
  rig_free(r);
}
END_TEST

/* Far more cells than particles: they are not looked at one by one, and the particles are all over the region. */
START_TEST(a_wide_region) {
  static const char *const max[] = {"[1e7,1,1]", "[1e7,1e7,1]", "[1e7,1e7,1e7]"};
  for (int k = 0; k < 3; k++) {
    tdm_error err = {0};
    json_t *json = scene_json("{" MATERIALS "," PAIRS ",'particles':[{'type':'random','material':'grain','radius':0.1,"
                              "'count':100,'region':{'min':[0,0,0],'max':%s}}]}",
                              max[k]);
    tdm_assignment a = {.scene = json, .time_end = 1, .dt = 1e-4, .n = 1};
    void *self = NULL;
    tdm_ready ready = {0};
    ck_assert_msg(!dem_solver_ops.create(&self, &a, &ready, NULL, &err), "%s: %s", err.path, err.message);
    const dem_data *d = dem_solver_data(self);
    double sum = 0;
    ck_assert_int_eq(d->state.nparticle, 100);
    for (int i = 0; i < 100; i++) {
      tdm_vec3 x = d->state.sphere[i].position;
      ck_assert(x.x >= 0.1 && x.x <= 1e7 - 0.1);
      sum += x.x / 100;
      for (int j = 0; j < i; j++)
        ck_assert(tdm_norm(tdm_sub(x, d->state.sphere[j].position)) > 0.2);
    }
    ck_assert(sum > 3.5e6 && sum < 6.5e6); /* 5e6 with a deviation of 2.9e5 */
    dem_solver_ops.destroy(self);
    json_decref(json);
  }
}
END_TEST

TEST_MAIN("dem input", test_bad_scenes, test_ready, test_doubts, test_no_particles, test_split_windows, test_repeatable,
          test_fill, test_flow_channels, a_wide_region)

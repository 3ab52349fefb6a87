/* Stored states: a run that is saved and loaded goes on bit by bit; starts from a stored state; damage. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/flow/flow.h"
#include "dem/particles/particles.h"
#include "dem/store/state_file.h"
#include "tests/test_main.h"

#include <sys/stat.h>
#include <unistd.h>

/* grains that pour through a box that repeats, over a step, with sources and sinks, some pushed and some fixed */
static json_t *everything(int k, const char *more) {
  static const char *const integrators[] = {"verlet", "leap-frog", "stormer-verlet", "multi-step"};
  return scene_json(
      "{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],'pairs':[{'materials':['a',"
      "'a'],'restitution':0.5,'friction':0.4}],'integrator':'%s'%s,"
      "'bodies':[{'name':'b','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]},{'name':'c','material':'a',"
      "'shapes':[{'type':'box','side':'outside','size':[0.2,0.2,0.1],'center':[0.5,0.5,0]}]}],"
      "'domain':{'min':[0,0,-1],'max':[1,1,1],'x':'periodic','y':'periodic','strain_rate':[0.05,-0.05,0]},"
      "'particles':[{'type':'random','material':'a','count':150,'radius':[0.03,0.05],'region':{'min':[0,0,0.11],'max':"
      "[1,1,0.9]},'velocity':[1,2,-1]},{'type':'list','material':'a','radius':0.06,'positions':[[0.2,0.2,0.06]],"
      "'fixed':true},{'type':'list','material':'a','radius':0.04,'positions':[[0.8,0.8,0.05]],'force':[1,0,0]}],"
      "'sources':[{'name':'s','material':'a','radius':[0.01,0.03],'rate':400,'region':{'min':[0,0,0.9],'max':[1,1,0.95]"
      "}}"
      "],'sinks':[{'name':'k','type':'box','min':[0.3,0.3,0],'max':[0.35,0.35,1],'classes':[0.02,0.035]},{'name':'l','"
      "type':'after_contact',"
      "'body':'c'}]%s}",
      integrators[k], k == 3 ? ",'multi_step':{'substeps':3,'mass':0.1}" : "", more);
}

static void go_on(rig *r, int n) {
  for (int k = 0; k < n; k++) {
    rig_steps(r, 1);
    flow_now(r->data, (double)r->data->state.nstep * r->model->dt, r->model->dt);
  }
}

static void same(const dem_data *a, const dem_data *b) {
  size_t n = (size_t)a->state.nparticle;
  ck_assert_int_eq(a->state.nparticle, b->state.nparticle);
  ck_assert_mem_eq(a->state.id, b->state.id, n * sizeof *a->state.id);
  ck_assert_mem_eq(a->state.sphere, b->state.sphere, n * sizeof *a->state.sphere);
  ck_assert_mem_eq(a->state.pace, b->state.pace, n * sizeof *a->state.pace);
  ck_assert_mem_eq(a->state.push, b->state.push, n * sizeof *a->state.push);
  ck_assert_mem_eq(a->state.touched, b->state.touched, n * sizeof *a->state.touched);
  ck_assert_mem_eq(a->state.body_load, b->state.body_load, (size_t)a->model->nbody * sizeof *a->state.body_load);
  ck_assert_mem_eq(a->state.source, b->state.source, sizeof *a->state.source);
  ck_assert_mem_eq(a->state.sink, b->state.sink, 2 * sizeof *a->state.sink);
  ck_assert_mem_eq(&a->state.domain, &b->state.domain, sizeof a->state.domain);
  ck_assert_uint_eq(a->state.ledger.created, b->state.ledger.created);
  ck_assert_uint_eq(a->state.ledger.removed, b->state.ledger.removed);
  ck_assert_uint_eq(a->state.nstep, b->state.nstep);
  ck_assert_uint_eq(a->state.since_sort, b->state.since_sort);
  ck_assert_int_eq(a->state.ncontact, b->state.ncontact);
  ck_assert(dem_balance_number(b) == 0 && dem_balance_mass(b) == 0);
}

/* ---- the list of the state's members ---- */

/* Every byte of dem_state belongs to a member that has its row in fields.h. */
START_TEST(test_every_member_has_a_row) {
  static char listed[sizeof(dem_state)];
#define NUMBER(object, field, ...)                                                   \
  if (offsetof(dem_data, object.field) < offsetof(dem_data, lists))                  \
    memset(listed + offsetof(dem_data, object.field) - offsetof(dem_data, state), 1, \
           sizeof((dem_data *)0)->object.field);
#define ARRAY(field, ...)                                    \
  if (offsetof(dem_data, field) < offsetof(dem_data, lists)) \
    memset(listed + offsetof(dem_data, field) - offsetof(dem_data, state), 1, sizeof(void *));
  DEM_NUMBER_STATE(NUMBER)
  DEM_DERIVED_STATE(NUMBER)
  DEM_PARTICLE_STATE(ARRAY)
  DEM_FIXED_STATE(ARRAY)
  DEM_FORCE_STATE(ARRAY)
  for (size_t k = 0; k < sizeof listed; k++)
    ck_assert_msg(listed[k], "byte %zu of dem_state belongs to no row of fields.h", k);
}

/* bytes that no member has by chance; an array that the scene does not have is NULL */
static void scramble_array(void *array, size_t size) {
  if (array)
    memset(array, 0x5a, size);
}

static void scramble(dem_data *d) {
  size_t np = (size_t)d->state.nparticle, nb = (size_t)d->model->nbody, nw = (size_t)d->model->nwall,
         nl = (size_t)d->model->nload;
#define NUMBER_(object, field, ...) memset(&d->object.field, 0x5a, sizeof d->object.field);
#define PARTICLES_(field, n, name) scramble_array(d->field, np *(size_t)(n) * sizeof *d->field);
#define FIXED_(field, n) scramble_array(d->field, (n) * sizeof *d->field);
#define FORCES_(field, name) scramble_array(d->field, np * sizeof *d->field);
  DEM_NUMBER_STATE(NUMBER_)
  DEM_PARTICLE_STATE(PARTICLES_)
  DEM_FIXED_STATE(FIXED_)
  DEM_FORCE_STATE(FORCES_)
}

/* every member of the state, bit by bit */
static void same_members(const dem_data *a, const dem_data *d) {
  ck_assert_int_eq(a->state.nparticle, d->state.nparticle);
  size_t np = (size_t)d->state.nparticle, nb = (size_t)d->model->nbody, nw = (size_t)d->model->nwall,
         nl = (size_t)d->model->nload;
#define IS(at, field, size)                            \
  if (strncmp(#field, "state.", 6) == 0 && (size) > 0) \
    ck_assert_msg(memcmp(at a->field, at d->field, size) == 0, "%s is another one", #field);
#define NUMBER_IS(object, field, ...) IS(&, object.field, sizeof d->object.field)
#define PARTICLES_ARE(field, n, name) IS(, field, np *(size_t)(n) * sizeof *d->field)
#define FIXED_IS(field, n) IS(, field, (n) * sizeof *d->field)
#define FORCES_ARE(field, name) IS(, field, d->field ? np * sizeof *d->field : 0)
  DEM_NUMBER_STATE(NUMBER_IS)
  DEM_DERIVED_STATE(NUMBER_IS)
  DEM_PARTICLE_STATE(PARTICLES_ARE)
  DEM_FIXED_STATE(FIXED_IS)
  DEM_FORCE_STATE(FORCES_ARE)
}

START_TEST(test_every_member_comes_back) {
  for (int k = 0; k < 4; k++) {
    rig *r = rig_make(everything(k, ""), 1e-4, 0, NULL), *other = rig_make(everything(k, ""), 1e-4, 0, NULL);
    go_on(r, 503);
    void *bytes;
    size_t size;
    tdm_error err = {0};
    ck_assert_int_eq(dem_state_save(r->data, &bytes, &size), TDM_OK);
    scramble(other->data);
    ck_assert_msg(!dem_state_load(other->data, bytes, size, &err), "%s", err.message);
    same_members(r->data, other->data);
    dem_data *copy = dem_data_create(r->model);
    scramble(copy);
    ck_assert_int_eq(dem_data_copy(copy, r->data), TDM_OK);
    same_members(r->data, copy);
    dem_data_destroy(&copy);
    free(bytes);
    rig_free(r);
    rig_free(other);
  }
}

START_TEST(test_goes_on) {
  for (int k = 0; k < 4; k++) {
    rig *r = rig_make(everything(k, ""), 1e-4, 0, NULL), *other = rig_make(everything(k, ""), 1e-4, 0, NULL);
    go_on(r, 5003); /* no list begins just here */
    ck_assert_int_gt(r->data->state.ncontact, 20);
    ck_assert_uint_gt(r->data->state.ledger.removed, 5);
    ck_assert_uint_gt(r->data->state.sink[0].class_removed[0] + r->data->state.sink[0].class_removed[1], 0);
    void *bytes;
    size_t size;
    tdm_error err = {0};
    ck_assert_int_eq(dem_state_save(r->data, &bytes, &size), TDM_OK);
    ck_assert_msg(!dem_state_load(other->data, bytes, size, &err), "%s", err.message);
    same(r->data, other->data);
    go_on(r, 900);
    go_on(other, 900);
    same(r->data, other->data);
    free(bytes);
    rig_free(r);
    rig_free(other);
  }
}
END_TEST

START_TEST(test_many) {
  /* more than one chunk: the order of particles is part of the state, and when it is renewed */
  json_t *json[2];
  for (int n = 0; n < 2; n++)
    json[n] =
        scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],'pairs':[{"
                   "'materials':['a','a'],'restitution':0.5,'friction':0.4}],'bodies':[{'name':'b','material':'a',"
                   "'shapes':[{'type':'box','side':'inside','size':[1,1,1]}]}],'particles':[{'type':'random',"
                   "'material':'a','count':4500,'radius':[0.02,0.025],'region':{'min':[-0.5,-0.5,-0.5],'max':[0.5,"
                   "0.5,0.5]},'velocity':[1,2,-5]}]}");
  rig *r = rig_make(json[0], 1e-4, 0, NULL), *other = rig_make(json[1], 1e-4, 0, NULL);
  rig_steps(r, 1000); /* the next step sorts */
  ck_assert_uint_ge(r->data->state.since_sort, 1000);
  void *bytes;
  size_t size;
  tdm_error err = {0};
  ck_assert_int_eq(dem_state_save(r->data, &bytes, &size), TDM_OK);
  ck_assert_msg(!dem_state_load(other->data, bytes, size, &err), "%s", err.message);
  rig_steps(r, 50);
  rig_steps(other, 50);
  size_t n = (size_t)r->data->state.nparticle;
  ck_assert_uint_lt(r->data->state.since_sort, 100);
  ck_assert_mem_eq(r->data->state.id, other->data->state.id, n * sizeof *r->data->state.id);
  ck_assert_mem_eq(r->data->state.sphere, other->data->state.sphere, n * sizeof *r->data->state.sphere);
  ck_assert_mem_eq(r->data->state.pace, other->data->state.pace, n * sizeof *r->data->state.pace);
  free(bytes);
  rig_free(r);
  rig_free(other);
}
END_TEST

START_TEST(test_damage) {
  rig *r = rig_make(everything(0, ""), 1e-4, 0, NULL);
  go_on(r, 100);
  void *bytes;
  size_t size;
  ck_assert_int_eq(dem_state_save(r->data, &bytes, &size), TDM_OK);
  char *copy = malloc(size);
  for (size_t k = 0; k < 60; k++) { /* cut and changed at places all over */
    size_t at = k < 10 ? k * 8 : (k - 10) * (size - 1) / 49;
    memcpy(copy, bytes, size);
    copy[at] ^= 0x10;
    tdm_error err = {0};
    if (at < 16 || at >= 24) /* the bed's fingerprint is another matter */
      ck_assert_msg(dem_state_load(r->data, copy, size, &err) == TDM_ERR_FILE || (at >= 48 && at < 56), "%zu", at);
    err = (tdm_error){0};
    ck_assert_int_eq(dem_state_load(r->data, bytes, at, &err), TDM_ERR_FILE);
    ck_assert_ptr_nonnull(strstr(err.message, "cut short"));
  }
  /* of another scene */
  rig *other = rig_make(everything(0, ",'gravity':[0,0,-9]"), 1e-4, 0, NULL);
  tdm_error err = {0};
  ck_assert_int_eq(dem_state_load(other->data, bytes, size, &err), TDM_ERR_FILE);
  ck_assert_ptr_nonnull(strstr(err.message, "another scene"));
  rig_free(other);
  other = rig_make(everything(1, ""), 1e-4, 0, NULL);
  err = (tdm_error){0};
  ck_assert_int_eq(dem_state_load(other->data, bytes, size, &err), TDM_ERR_FILE);
  rig_free(other);
  /* and it still runs */
  go_on(r, 10);
  free(copy);
  free(bytes);
  rig_free(r);
}
END_TEST

static json_t *starter(const char *start, double friction, double young) {
  return scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':%g,'poisson_ratio':0.25}],'pairs':[{"
                    "'materials':['a','a'],'restitution':0.5,'friction':%g}],'bodies':[{'name':'b','material':'a',"
                    "'shapes':[{'type':'box','side':'inside','size':[0.4,0.4,1]}]}],'particles':[%s]%s%s%s}",
                    young, friction,
                    start
                        ? ""
                        : "{'type':'random','material':'a','count':60,'radius':[0.03,0.04],'region':{'min':[-0.2,-0.2,"
                          "-0.5],'max':[0.2,0.2,0.5]},'velocity':[0,0,-1]}",
                    start ? ",'start':'" : "", start ? start : "", start ? "'" : "");
}

/* a solver on this scene; TDM_OK or its error */
static tdm_status open_solver(json_t *json, void **self, tdm_ready *ready, tdm_error *err) {
  tdm_assignment a = {.scene = json, .time_end = 1, .dt = 1e-4, .n = 1};
  tdm_status status = dem_solver_ops.create(self, &a, ready, NULL, err);
  return status;
}

START_TEST(test_start) {
  char name[512];
  snprintf(name, sizeof name, "%s/test_dem_state.%ld.state", TANDEM_TEST_DIR, (long)getpid());
  rig *r = rig_make(starter(NULL, 0.4, 1e7), 1e-4, 0, NULL);
  rig_steps(r, 5000);
  tdm_error err = {0};
  ck_assert_int_eq(dem_state_write(r->data, name, "dem.start", NULL, 0, &err), TDM_OK);
  ck_assert_int_gt(r->data->state.ncontact, 60);

  /* another scene's run begins with its particles as they lie and move, without any of its own */
  rig *other = rig_make(starter(name, 0.1, 1e7), 1e-4, 0, NULL);
  ck_assert_int_eq(dem_state_read(other->data, DEM_STATE_START, name, "dem.start", NULL, 0, &err), TDM_OK);
  ck_assert_int_eq(other->data->state.nparticle, 60);
  ck_assert_mem_eq(other->data->state.pace, r->data->state.pace, 60 * sizeof *r->data->state.pace);
  ck_assert_uint_eq(other->data->state.nstep, 0);
  ck_assert_uint_eq(other->data->state.ledger.created, 60);
  dem_newcomer one = {.position = {0, 0, 0.4}, .radius = 0.01, .mass = 0.1};
  ck_assert_int_eq(dem_data_add(other->data, &one), TDM_OK);
  ck_assert_uint_eq(other->data->state.id[60], 60);
  ck_assert(dem_balance_number(other->data) == 0 && dem_balance_mass(other->data) == 0);
  rig_free(other);

  /* the same scene's goes on as the run itself does, but for the forces of one step that are evaluated anew */
  void *self = NULL;
  tdm_ready ready = {0};
  json_t *json = starter(name, 0.4, 1e7);
  ck_assert_msg(!open_solver(json, &self, &ready, &err), "%s: %s", err.path, err.message);
  ck_assert_int_eq(json_integer_value(json_object_get(ready.report, "particles")), 60);
  ck_assert_int_eq(json_integer_value(json_object_get(ready.report, "contacts")), r->data->state.ncontact);
  dem_solver_ops.destroy(self);
  json_decref(json);

  /* a pair of materials that only the file's particles need */
  json = starter(name, 0.4, 1e7);
  json_array_clear(json_object_get(json, "pairs"));
  self = NULL;
  ck_assert_int_eq(open_solver(json, &self, &ready, &err), TDM_ERR_SCENE);
  ck_assert_str_eq(err.path, "dem.pairs");
  ck_assert_ptr_nonnull(strstr(err.message, "dem.start brings particles"));
  dem_solver_ops.destroy(self);
  json_decref(json);

  /* what does not go together, and what is not there */
  static const char *const says[] = {"other contact laws, elastic constants", "cannot be read", "no stored state"};
  for (int k = 0; k < 3; k++) {
    const char *file = k == 1 ? "/no/such/file" : name;
    if (k == 2) {
      FILE *f = fopen(name, "wb");
      fprintf(f, "%0200d", 0);
      fclose(f);
    }
    json = starter(file, 0.4, k == 0 ? 2e7 : 1e7);
    err = (tdm_error){0};
    self = NULL;
    ck_assert_int_eq(open_solver(json, &self, &ready, &err), TDM_ERR_FILE);
    ck_assert_str_eq(err.path, "dem.start");
    ck_assert_msg(strstr(err.message, says[k]) != NULL, "%s", err.message);
    dem_solver_ops.destroy(self);
    json_decref(json);
  }
  unlink(name);
  rig_free(r);
}
END_TEST

TEST_MAIN("dem state", test_every_member_has_a_row, test_every_member_comes_back, test_goes_on, test_many, test_damage,
          test_start)

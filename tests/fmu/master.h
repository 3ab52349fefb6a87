/* What tests of exported FMUs share: a scene, and a tool that runs FMUs, by tandem's own reading of them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_FMU_MASTER_H
#define TEST_FMU_MASTER_H

#include "protocol/fmi/fmu.h"
#include "tests/command.h"

#include <math.h>

/* A plate on a spring, guided along z, and two particles on it. */
static const char plate[] =
    "{'title':'A plate & <two> particles','time':{'end':0.05,'dt':1e-4},\n"
    "'coupling':{'n':5,'scheme':'hold','interpolation':'hermite','bodies':[{'mbd':'deck','dem':'plate-1'}]},\n"
    "'output':{'interval':5e-4},'parameters':{'c':1,'radius':'=c/20'},\n"
    "'mbd':{'gravity':[0,0,-1],'bodies':[{'name':'deck','mass':2,'inertia':[0.1,0.2,0.3],'position':[0,0,0]}],\n"
    "'joints':[{'name':'guide','type':'prismatic','bodies':['ground','deck'],'point':[0,0,0],'axis':[0,0,1]}],\n"
    "'forces':[{'name':'spring','type':'spring_damper','bodies':['ground','deck'],'points':[[0,0,-1],[0,0,0]],\n"
    "'stiffness':500,'damping':'=c'}]},\n"
    "'dem':{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],\n"
    "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],\n"
    "'bodies':[{'name':'plate-1','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],\n"
    "'particles':[{'type':'list','material':'a','radius':'=radius','positions':[[0,0,0.0498],[0.2,0.1,0.0499]]}]}}\n";

static const char *dir;
static char file[128]; /* the FMU */

static inline void setup(void) {
  dir = directory_with_scene(plate);
  snprintf(file, sizeof file, "%s/m.fmu", dir);
}

static inline void teardown(void) {
  char unpacked[128];
  snprintf(unpacked, sizeof unpacked, "%s/tandem-", dir);
  WAIT_FOR(find_processes(unpacked, NULL) == 0);
  expect_nothing_left(dir);
  directory_remove(dir);
}

static inline void pack(const char *options) {
  ck_assert_msg(command("tandem export fmu %s/scene.json --out %s --force %s", dir, file, options) == 0, "%s",
                command_output);
}

/* ---- a master, by tandem's own reading of FMUs ---- */

typedef struct {
  tdm_fmu *fmu;
  tdm_error err;
  double t;
} master;

static inline uint32_t reference_of(const master *m, const char *name) {
  const tdm_fmi_variable *v = tdm_description_find(&m->fmu->description, name);
  ck_assert_msg(v != NULL, "no variable %s", name);
  return v->reference;
}

static inline void set(master *m, const char *name, double value) {
  const uint32_t reference = reference_of(m, name);
  ck_assert_msg(tdm_fmu_set(m->fmu, &reference, 1, &value, 1, &m->err) == TDM_OK, "%s", m->err.message);
}

static inline double get(master *m, const char *name) {
  const uint32_t reference = reference_of(m, name);
  double value = NAN;
  ck_assert_msg(m->fmu->version->get(m->fmu, &reference, 1, &value, 1) <= 1, "%s: %s", name, m->fmu->said);
  return value;
}

static inline void open_fmu(master *m) {
  *m = (master){0};
  ck_assert_msg(tdm_fmu_open(&m->fmu, file, &m->err) == TDM_OK, "%s", m->err.message);
  ck_assert_msg(tdm_fmu_instantiate(m->fmu, &m->err) == TDM_OK, "%s", m->err.message);
}

static inline void initialize(master *m, double stop) {
  const tdm_fmu_experiment experiment = {.start = 0, .stop = stop};
  ck_assert_msg(tdm_fmu_initialize(m->fmu, &experiment, &m->err) == TDM_OK, "%s", m->err.message);
}

static inline void step(master *m, double h) {
  ck_assert_msg(tdm_fmu_step(m->fmu, m->t, h, false, &m->err) == TDM_OK, "%s", m->err.message);
  m->t += h;
}

static inline void close_fmu(master *m) {
  tdm_fmu_close(&m->fmu);
}

#endif

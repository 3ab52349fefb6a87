/* Support for the tests of sources and sinks: steps with what comes and goes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_FLOW_SUPPORT_H
#define TEST_FLOW_SUPPORT_H

#include "dem/flow/flow.h"
#include "test_dem_support.h"

#define GRAIN                                                                           \
  "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}]," \
  "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}]"
#define FLOOR "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}]"

/* the start of the run, and steps k0 + 1 … k0 + n with what comes and goes */
static inline void begin(rig *r) {
  flow_now(r->data, r->model->time_start, r->model->dt);
}

static inline void balanced(const dem_data *d) {
  ck_assert(dem_balance_number(d) == 0);
  ck_assert(dem_balance_mass(d) == 0);
  uint64_t created = (uint64_t)d->model->nparticle, removed = 0;
  for (int s = 0; s < d->model->nsource; s++)
    created += d->state.source[s].made;
  for (int s = 0; s < d->model->nsink; s++)
    removed += d->state.sink[s].removed;
  ck_assert_uint_eq(created, removed + (uint64_t)d->state.nparticle);
  for (int i = 1; i < d->state.nparticle && d->state.nparticle <= DEM_CHUNK; i++) /* more are sorted by place */
    ck_assert(d->state.id[i] > d->state.id[i - 1]);
}

static inline void steps(rig *r, const dem_path *path, long n) {
  dem_data *d = r->data;
  for (long k = 0; k < n; k++) {
    one_step(d, path, r->model->dt);
    flow_now(d, r->model->time_start + (double)d->state.nstep * r->model->dt, r->model->dt);
    balanced(d);
  }
}

/* the same, with the balance at the end only */
static inline void many_steps(rig *r, long n) {
  dem_data *d = r->data;
  for (long k = 0; k < n; k++) {
    one_step(d, NULL, r->model->dt);
    flow_now(d, r->model->time_start + (double)d->state.nstep * r->model->dt, r->model->dt);
  }
  balanced(d);
}

static inline void same(const dem_data *a, const dem_data *b) {
  ck_assert_int_eq(a->state.nparticle, b->state.nparticle);
  size_t n = (size_t)a->state.nparticle;
  ck_assert_mem_eq(a->state.id, b->state.id, n * sizeof *a->state.id);
  ck_assert_mem_eq(a->state.mass, b->state.mass, n * sizeof *a->state.mass);
  ck_assert_mem_eq(a->state.sphere, b->state.sphere, n * sizeof *a->state.sphere);
  ck_assert_mem_eq(a->state.pace, b->state.pace, n * sizeof *a->state.pace);
  ck_assert_mem_eq(a->state.push, b->state.push, n * sizeof *a->state.push);
  ck_assert_mem_eq(a->state.body_load, b->state.body_load, (size_t)a->model->nbody * sizeof(tdm_wrench));
}

#endif

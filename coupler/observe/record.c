/* The record of a run: time histories of the coupled bodies and of both solvers' channels (observers.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/histories.h"
#include "coupler/observe/observers.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
  cpl_histories histories;
  int nbody, nchannel[CPL_NROLE];
  FILE **body;              /* (nbody) */
  FILE *channel[CPL_NROLE]; /* NULL when a solver has no channels */
} record;

const char *cpl_record_body_file(const char *body, char *out, size_t size) {
  snprintf(out, size, "body_%.200s.csv", body);
  return out;
}

static void write_body_row(FILE *f, double time, const tdm_state *state, const tdm_wrench *load) {
  double row[TDM_STATE_DOUBLES + TDM_WRENCH_DOUBLES];
  memcpy(row, state, sizeof *state);
  memcpy(row + TDM_STATE_DOUBLES, load, sizeof *load);
  tdm_write_row(f, time, row, TDM_STATE_DOUBLES + TDM_WRENCH_DOUBLES);
}

static tdm_status open_bodies(record *r, const cpl_session *s, tdm_error *err) {
  char name[256];
  for (int i = 0; i < r->nbody; i++) {
    cpl_record_body_file(s->settings->body[i].name[CPL_MBD], name, sizeof name);
    r->body[i] = cpl_histories_open(&r->histories, name, err);
    if (!r->body[i])
      return err->status;
    fputs("time [s],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],wy [rad/s],"
          "wz [rad/s],fx [N],fy [N],fz [N],mx [N m],my [N m],mz [N m]\n",
          r->body[i]);
    write_body_row(r->body[i], 0, &s->body[i].state, &s->load[i]);
  }
  return TDM_OK;
}

static tdm_status open_channels(record *r, const cpl_session *s, tdm_error *err) {
  char name[256];
  for (int role = 0; role < CPL_NROLE; role++) {
    const cpl_partner *p = &s->partner[role];
    r->nchannel[role] = p->nchannel;
    if (p->nchannel == 0)
      continue;
    snprintf(name, sizeof name, "%s.csv", cpl_role_names[role]);
    FILE *f = r->channel[role] = cpl_histories_open(&r->histories, name, err);
    if (!f)
      return err->status;
    fputs("time [s]", f);
    for (int c = 0; c < p->nchannel; c++)
      fprintf(f, ",%s [%s]", p->channel[c].name, p->channel[c].unit);
    fputc('\n', f);
    tdm_write_row(f, 0, p->initial, p->nchannel);
  }
  return TDM_OK;
}

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  (void)self;
  record *r = *own = calloc(1, sizeof *r);
  if (!r)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  r->histories.results = outlet->results;
  r->nbody = loop->nbody;
  r->body = calloc((size_t)r->nbody + 1, sizeof *r->body);
  if (!r->body)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (open_bodies(r, loop->session, err) != TDM_OK)
    return err->status;
  return open_channels(r, loop->session, err);
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  record *r = own;
  const tdm_result *mbd = &loop->result[CPL_MBD], *dem = &loop->result[CPL_DEM];
  for (int k = 0; k < loop->nsample; k++) {
    const double time = loop->row_time[k];
    for (int i = 0; i < r->nbody; i++)
      write_body_row(r->body[i], time, &mbd->sample_state[k * r->nbody + i], &dem->sample_load[k * r->nbody + i]);
    for (int role = 0; role < CPL_NROLE; role++)
      if (r->channel[role])
        tdm_write_row(r->channel[role], time, &loop->result[role].channel[k * r->nchannel[role]], r->nchannel[role]);
  }
  return loop->nsample > 0 ? cpl_histories_written(&r->histories, err) : TDM_OK;
}

static tdm_status end(void *own, tdm_error *err) {
  record *r = own;
  return r ? cpl_histories_close(&r->histories, err) : TDM_OK;
}

static void let_go(void *own) {
  record *r = own;
  if (r)
    free(r->body);
  free(r);
}

const cpl_observer cpl_observer_record = {
    .name = "record",
    .open = begin,
    .window = window,
    .close = end,
    .free = let_go,
};

/* The result directory of a run: see record.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/record.h"

#include "coupler/loop/loop.h"
#include "protocol/base/log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const double flush_interval = 1; /* [s] wall clock: what a reader of a running run lags behind */

tdm_status cpl_record_open(cpl_record *record, const tdm_results_def *def, tdm_error *err) {
  *record = (cpl_record){0};
  return tdm_results_open(&record->results, def, err);
}

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

FILE *cpl_record_file(cpl_record *record, const char *name, tdm_error *err) {
  if (record->nfile == record->room) {
    int room = 2 * record->room + 8;
    FILE **grown = realloc(record->file, (size_t)room * sizeof *grown);
    if (!grown) {
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
      return NULL;
    }
    record->file = grown;
    record->room = room;
  }
  FILE *f = tdm_results_file(&record->results, name, err);
  if (f)
    record->file[record->nfile++] = f;
  return f;
}

static tdm_status open_bodies(cpl_record *record, const cpl_session *s, tdm_error *err) {
  char name[256];
  for (int i = 0; i < s->settings->nbody; i++) {
    cpl_record_body_file(s->settings->body[i].name[CPL_MBD], name, sizeof name);
    FILE *f = cpl_record_file(record, name, err);
    if (!f)
      return err->status;
    fputs("time [s],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],wy [rad/s],"
          "wz [rad/s],fx [N],fy [N],fz [N],mx [N m],my [N m],mz [N m]\n",
          f);
    write_body_row(f, 0, &s->body[i].state, &s->load[i]);
    record->nbody++;
  }
  return TDM_OK;
}

static tdm_status open_channels(cpl_record *record, const cpl_session *s, tdm_error *err) {
  char name[16];
  for (int r = 0; r < CPL_NROLE; r++) {
    const cpl_partner *p = &s->partner[r];
    record->nchannel[r] = p->nchannel;
    if (p->nchannel == 0)
      continue;
    snprintf(name, sizeof name, "%s.csv", cpl_role_names[r]);
    FILE *f = record->channel[r] = cpl_record_file(record, name, err);
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

/* The run begins (tdm_results_start): open the time histories and write the row of t = 0. */
static tdm_status begin(const cpl_loop *loop, void **own, tdm_error *err) {
  cpl_record *record = *own = loop->record;
  if (tdm_results_start(&record->results, err) != TDM_OK || open_bodies(record, loop->session, err) != TDM_OK)
    return err->status;
  return open_channels(record, loop->session, err);
}

static tdm_status flush_all(cpl_record *record, tdm_error *err) {
  for (int i = 0; i < record->nfile; i++)
    if (fflush(record->file[i]) != 0 || ferror(record->file[i]))
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a time history cannot be written: %s; what is there stays readable",
                      record->results.dir, strerror(errno));
  return tdm_results_there(&record->results, err);
}

/* Rows for the output times of the window, from the results of both solvers. */
static tdm_status write_samples(const cpl_loop *loop, void *own, tdm_error *err) {
  cpl_record *record = own;
  const tdm_result *result = loop->result, *mbd = &result[CPL_MBD], *dem = &result[CPL_DEM];
  const int nsample = loop->nsample;
  for (int k = 0; k < nsample; k++) {
    const double time = loop->row_time[k];
    for (int i = 0; i < record->nbody; i++)
      write_body_row(record->file[i], time, &mbd->sample_state[k * record->nbody + i],
                     &dem->sample_load[k * record->nbody + i]);
    for (int r = 0; r < CPL_NROLE; r++)
      if (record->channel[r])
        tdm_write_row(record->channel[r], time, &result[r].channel[k * record->nchannel[r]], record->nchannel[r]);
  }
  if (nsample > 0) {
    double now = tdm_clock();
    if (now - record->last_flush > flush_interval) {
      record->last_flush = now;
      return flush_all(record, err);
    }
  }
  return TDM_OK;
}

tdm_status cpl_record_close(cpl_record *record, tdm_error *err) {
  tdm_error late = {0};
  if (record->nfile > 0)
    flush_all(record, &late);
  for (int i = 0; i < record->nfile; i++)
    fclose(record->file[i]);
  free(record->file);
  record->file = NULL;
  record->nfile = record->room = 0;
  return late.status == TDM_OK ? TDM_OK : tdm_fail(err, late.status, NULL, "%s", late.message);
}

const cpl_observer cpl_observer_record = {.name = "record", .open = begin, .window = write_samples};

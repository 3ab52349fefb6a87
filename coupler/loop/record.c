/* The result directory of a run: see record.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/record.h"

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

tdm_status cpl_record_begin(cpl_record *record, const cpl_session *s, tdm_error *err) {
  char name[256];
  if (tdm_results_start(&record->results, err) != TDM_OK)
    return err->status;
  record->body = calloc((size_t)s->settings->nbody + 1, sizeof *record->body);
  if (!record->body)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  record->nbody = s->settings->nbody;
  for (int i = 0; i < record->nbody; i++) {
    cpl_record_body_file(s->settings->body[i].name[CPL_MBD], name, sizeof name);
    record->body[i] = tdm_results_file(&record->results, name, err);
    if (!record->body[i])
      return err->status;
    fputs("time [s],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],wy [rad/s],"
          "wz [rad/s],fx [N],fy [N],fz [N],mx [N m],my [N m],mz [N m]\n",
          record->body[i]);
    write_body_row(record->body[i], 0, &s->body[i].state, &s->load[i]);
  }
  for (int r = 0; r < CPL_NROLE; r++) {
    const cpl_partner *p = &s->partner[r];
    record->nchannel[r] = p->nchannel;
    if (p->nchannel == 0)
      continue;
    snprintf(name, sizeof name, "%s.csv", cpl_role_names[r]);
    FILE *f = record->channel[r] = tdm_results_file(&record->results, name, err);
    if (!f)
      return err->status;
    fputs("time [s]", f);
    for (int c = 0; c < p->nchannel; c++)
      fprintf(f, ",%s [%s]", p->channel[c].name, p->channel[c].unit);
    fputc('\n', f);
    tdm_write_row(f, 0, p->initial, p->nchannel);
  }
  record->ledger = tdm_results_file(&record->results, "ledger.csv", err);
  return err->status;
}

/* every open file of the record, NULLs among them; index 0 … nbody + CPL_NROLE */
static FILE **file_at(cpl_record *record, int i) {
  int channel = i - record->nbody;
  return channel < 0 ? &record->body[i] : channel < CPL_NROLE ? &record->channel[channel] : &record->ledger;
}

static tdm_status flush_all(cpl_record *record, tdm_error *err) {
  for (int i = 0; i <= record->nbody + CPL_NROLE; i++) {
    FILE *f = *file_at(record, i);
    if (f && (fflush(f) != 0 || ferror(f)))
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a time history cannot be written: %s; what is there stays readable",
                      record->results.dir, strerror(errno));
  }
  return tdm_results_there(&record->results, err);
}

tdm_status cpl_record_samples(cpl_record *record, int nsample, const double *row_time, const tdm_result *result,
                              tdm_error *err) {
  const tdm_result *mbd = &result[CPL_MBD], *dem = &result[CPL_DEM];
  for (int k = 0; k < nsample; k++) {
    const double time = row_time[k];
    for (int i = 0; i < record->nbody; i++)
      write_body_row(record->body[i], time, &mbd->sample_state[k * record->nbody + i],
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
  if (record->body)
    flush_all(record, &late);
  for (int i = 0; record->body && i <= record->nbody + CPL_NROLE; i++)
    if (*file_at(record, i)) {
      fclose(*file_at(record, i));
      *file_at(record, i) = NULL;
    }
  free(record->body);
  record->body = NULL;
  return late.status == TDM_OK ? TDM_OK : tdm_fail(err, late.status, NULL, "%s", late.message);
}

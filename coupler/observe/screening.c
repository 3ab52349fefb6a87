/* What screening and containers come to: the last values of DEM's channels of them, in summary.json and on the terminal
 * (protocol/results/screening.h, protocol/output/figures.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/screening.h"
#include "coupler/observe/observers.h"
#include "protocol/output/figures.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
  const cpl_partner *dem;
  double *last; /* (dem->nchannel) of the last output */
  bool quiet;
} measures;

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  (void)self;
  const cpl_partner *dem = &loop->session->partner[CPL_DEM];
  measures *m = *own = calloc(1, sizeof *m);
  double *last = calloc((size_t)dem->nchannel + 1, sizeof *last);
  if (!m || !last) {
    free(last);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  if (dem->nchannel > 0)
    memcpy(last, dem->initial, (size_t)dem->nchannel * sizeof *last);
  *m = (measures){dem, last, outlet->quiet};
  return TDM_OK;
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  (void)err;
  measures *m = own;
  const size_t n = (size_t)m->dem->nchannel;
  if (loop->nsample > 0 && n > 0)
    memcpy(m->last, &loop->result[CPL_DEM].channel[(size_t)(loop->nsample - 1) * n], n * sizeof *m->last);
  return TDM_OK;
}

static void enter(const void *own, json_t *summary) {
  const measures *m = own;
  for (int c = 0; m && m->last && c < m->dem->nchannel; c++) {
    const tdm_channel *channel = &m->dem->channel[c];
    tdm_screening_enter(summary, channel->name, channel->unit, m->last[c]);
    tdm_figure_enter(summary, channel, m->last[c]);
  }
  if (m && !m->quiet)
    tdm_screening_print(stdout, summary);
}

static void let_go(void *own) {
  measures *m = own;
  if (m)
    free(m->last);
  free(m);
}

const cpl_observer cpl_observer_screening = {
    .name = "screening",
    .open = begin,
    .window = window,
    .enter = enter,
    .free = let_go,
};

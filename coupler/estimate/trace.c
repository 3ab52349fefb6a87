/* The trace of a coupled body: see trace.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/trace.h"

#include <stdlib.h>
#include <string.h>

/* The rate is off by less than it jumps: where loads answer those of the window before with the opposite sign, as with
 * explicit schemes at their limit, it goes by +a, -a, which are jumps of 2 a; and where DEM foresaw it from its slope,
 * it foresaw 3 a where -a came. */
static const double of_jump = 0.5, of_foresight = 0.25;

static void parts(tdm_vec3 linear, tdm_vec3 angular, double out[CPL_PARTS]) {
  const tdm_vec3 both[2] = {linear, angular};
  memcpy(out, both, sizeof both);
}

/* From one state to another. */
static void way_between(const tdm_state *from, const tdm_state *to, double out[CPL_PARTS]) {
  parts(tdm_sub(to->pose.position, from->pose.position), tdm_quat_turn(from->pose.orientation, to->pose.orientation),
        out);
}

bool cpl_trace_init(cpl_trace *t, const double mass[CPL_PARTS], const tdm_state *start) {
  *t = (cpl_trace){.stride = 1};
  memcpy(t->mass, mass, sizeof t->mass);
  t->row = malloc(CPL_TRACE_ROWS * sizeof *t->row);
  if (!t->row)
    return false;
  for (int i = 0; i < CPL_TRACE_ROWS; i++) /* a run takes its memory at the start, whatever its length */
    t->row[i].t = -1;
  parts(start->twist.velocity, start->twist.angular, t->last.rate);
  t->end = t->row[t->nrow++] = t->last;
  return true;
}

void cpl_trace_free(cpl_trace *t) {
  free(t->row);
  *t = (cpl_trace){0};
}

/* Every second row is left out; the first stays. */
static void thin(cpl_trace *t) {
  for (int i = 0; 2 * i < t->nrow; i++)
    t->row[i] = t->row[2 * i];
  t->nrow = (t->nrow + 1) / 2;
  t->stride *= 2;
}

static void keep(cpl_trace *t, const cpl_trace_row *row) {
  t->last = *row;
  if (++t->seen % t->stride != 0)
    return;
  if (t->nrow == CPL_TRACE_ROWS)
    thin(t);
  if (t->seen % t->stride == 0)
    t->row[t->nrow++] = *row;
}

/* What is summed up over windows, at the end of this one. */
static cpl_trace_row sum_up(cpl_trace *t, const cpl_trace_window *w) {
  const double h = w->t1 - w->t0;
  double way[CPL_PARTS], found[CPL_PARTS], given[CPL_PARTS], apart[CPL_PARTS] = {0}, late[CPL_PARTS] = {0};
  cpl_trace_row end = t->end;
  way_between(w->start, w->end, way);
  parts(w->found.force, w->found.moment, found);
  parts(w->given.force, w->given.moment, given);
  if (w->other_end) {
    way_between(w->other_end, w->end, apart);
    parts(tdm_sub(w->end->twist.velocity, w->other_end->twist.velocity),
          tdm_sub(w->end->twist.angular, w->other_end->twist.angular), late);
  }
  parts(w->end->twist.velocity, w->end->twist.angular, end.rate);
  for (int k = 0; k < CPL_PARTS; k++) {
    const double owed = h * (given[k] - found[k]);
    const double off = of_jump * owed / t->mass[k] + of_foresight * late[k];
    end.way[k] += way[k];
    end.given[k] += h * found[k];
    end.owed[k] += owed;
    end.late[k] += 0.5 * h * (late[k] + t->end_late[k]); /* what alternates from window to window is none of it */
    end.jolt[k] += h * off * off;
    end.slip[k] += h * of_foresight * of_foresight * apart[k] * apart[k];
  }
  end.t = w->t1;
  memcpy(t->end_late, late, sizeof late);
  return end;
}

/* The impulse until an output time. */
static void sample(cpl_trace *t, double time, const tdm_wrench *load) {
  double mean[CPL_PARTS];
  parts(load->force, load->moment, mean);
  for (int k = 0; k < CPL_PARTS; k++)
    t->sampled[k] += (time - t->sample_time) * mean[k];
  t->sample_time = time;
}

/* A row at an output time inside the window: the solvers' own values there, what is summed up in proportion. */
static cpl_trace_row row_inside(const cpl_trace *t, const cpl_trace_window *w, const cpl_trace_row *end, int i) {
  const tdm_state *state = &w->sample[i * w->stride];
  const double s = (w->sample_time[i] - w->t0) / (w->t1 - w->t0);
  double way[CPL_PARTS];
  cpl_trace_row row = t->end;
  way_between(w->start, state, way);
  parts(state->twist.velocity, state->twist.angular, row.rate);
  for (int k = 0; k < CPL_PARTS; k++) {
    row.way[k] += way[k];
    row.given[k] = t->sampled[k];
    row.owed[k] += s * (end->owed[k] - row.owed[k]);
    row.late[k] += s * (end->late[k] - row.late[k]);
    row.jolt[k] += s * (end->jolt[k] - row.jolt[k]);
    row.slip[k] += s * (end->slip[k] - row.slip[k]);
  }
  row.t = w->sample_time[i];
  return row;
}

void cpl_trace_add(cpl_trace *t, const cpl_trace_window *w) {
  const cpl_trace_row end = sum_up(t, w);
  for (int i = 0; i < w->nsample; i++) {
    sample(t, w->sample_time[i], &w->sample_load[i * w->stride]);
    if (w->nsample > 1) {
      const cpl_trace_row row = row_inside(t, w, &end, i);
      keep(t, &row);
    }
  }
  if (w->nsample <= 1)
    keep(t, &end);
  t->end = end;
  t->windows++;
}

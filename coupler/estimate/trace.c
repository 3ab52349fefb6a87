/* The trace of a coupled body: see trace.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/trace.h"

#include <gsl/gsl_eigen.h>
#include <stdlib.h>
#include <string.h>

/* The rate is off by less than it jumps: where loads answer those of the window before with the opposite sign, as with
 * explicit schemes at their limit, it goes by +a, -a, which are jumps of 2 a; and where DEM foresaw it from its slope,
 * it foresaw 3 a where -a came. */
static const double of_jump = 0.5, of_foresight = 0.25;

/* ---- parts ---- */

/* Turns principal axes of the body into world axes. */
static tdm_quat frame_at(const cpl_trace *t, tdm_quat orientation) {
  return tdm_quat_mul(orientation, t->axes);
}

static void parts(tdm_quat frame, tdm_vec3 linear, tdm_vec3 angular, double out[CPL_PARTS]) {
  const tdm_vec3 both[2] = {linear, tdm_quat_rotate(tdm_quat_conj(frame), angular)};
  memcpy(out, both, sizeof both);
}

/* From one state to another; the axis of the turn between them is the same in both frames. */
static void way_between(const cpl_trace *t, const tdm_state *from, const tdm_state *to, double out[CPL_PARTS]) {
  parts(frame_at(t, to->pose.orientation), tdm_sub(to->pose.position, from->pose.position),
        tdm_quat_turn(from->pose.orientation, to->pose.orientation), out);
}

/* ---- its life ---- */

/* Principal moments and their axes; an inertia that is diagonal keeps its axes. False: no memory. */
static bool principal(const tdm_mat3 *inertia, double moment[3], tdm_quat *axes) {
  tdm_mat3 a = *inertia, columns = tdm_m3_identity();
  gsl_matrix_view matrix = gsl_matrix_view_array(a.m[0], 3, 3), vectors = gsl_matrix_view_array(columns.m[0], 3, 3);
  gsl_vector_view values = gsl_vector_view_array(moment, 3);
  gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(3);
  if (!work)
    return false;
  gsl_eigen_symmv(&matrix.matrix, &values.vector, &vectors.matrix, work);
  gsl_eigen_symmv_free(work);
  const tdm_vec3 x = {columns.m[0][0], columns.m[1][0], columns.m[2][0]};
  const tdm_vec3 y = {columns.m[0][1], columns.m[1][1], columns.m[2][1]}, z = tdm_cross(x, y);
  *axes = tdm_quat_from_matrix((tdm_mat3){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}});
  return true;
}

/* What a load has to move. */
static bool inertia_of(cpl_trace *t, double mass, const tdm_mat3 *inertia) {
  double *moment = t->mass + 3, sum = 0;
  t->axes = tdm_quat_identity();
  if (tdm_is_inertia(inertia) && !principal(inertia, moment, &t->axes))
    return false;
  for (int k = 0; k < 3; k++) {
    t->mass[k] = isfinite(mass) && mass > 0 ? mass : 1;
    sum += moment[k];
  }
  for (int k = 0; k < 3; k++)
    if (!(moment[k] > 1e-14 * sum))
      moment[k] = sum > 0 ? sum / 2 : 1;
  return true;
}

bool cpl_trace_init(cpl_trace *t, double mass, const tdm_mat3 *inertia, const tdm_state *start) {
  *t = (cpl_trace){.stride = 1};
  t->row = malloc(CPL_TRACE_ROWS * sizeof *t->row);
  if (!t->row || !inertia_of(t, mass, inertia))
    return false;
  for (int i = 0; i < CPL_TRACE_ROWS; i++) /* a run takes its memory at the start, whatever its length */
    t->row[i].t = -1;
  parts(frame_at(t, start->pose.orientation), start->twist.velocity, start->twist.angular, t->last.rate);
  t->end = t->row[t->nrow++] = t->last;
  return true;
}

void cpl_trace_free(cpl_trace *t) {
  free(t->row);
  *t = (cpl_trace){0};
}

/* ---- rows ---- */

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

/* The impulse of MBD's load from the start of the window to its share s [N s, N m s]; the body's frame then. */
static void impulse_until(const cpl_trace_window *w, double s, tdm_quat frame, double out[CPL_PARTS]) {
  const double h = w->t1 - w->t0;
  tdm_vec3 force = {0}, moment = {0};
  double power = h * s;
  for (int j = 0; j < w->nload; j++, power *= s) {
    force = tdm_axpy(power / (j + 1), w->load[j].force, force);
    moment = tdm_axpy(power / (j + 1), w->load[j].moment, moment);
  }
  if (w->nload == 0) {
    force = tdm_scale(power, w->given.force);
    moment = tdm_scale(power, w->given.moment);
  }
  parts(frame, force, moment, out);
}

/* What is summed up over windows, at the end of this one. */
static cpl_trace_row sum_up(cpl_trace *t, const cpl_trace_window *w) {
  const double h = w->t1 - w->t0;
  double way[CPL_PARTS], found[CPL_PARTS], given[CPL_PARTS], got[CPL_PARTS], apart[CPL_PARTS] = {0},
                                                                             late[CPL_PARTS] = {0};
  const tdm_quat middle = tdm_quat_slerp(w->start->pose.orientation, w->end->pose.orientation, 0.5);
  const tdm_quat during = frame_at(t, middle), then = frame_at(t, w->end->pose.orientation);
  cpl_trace_row end = t->end;
  way_between(t, w->start, w->end, way);
  parts(during, w->found.force, w->found.moment, found);
  parts(during, w->given.force, w->given.moment, given);
  impulse_until(w, 1, during, got);
  if (w->other_end) {
    way_between(t, w->other_end, w->end, apart);
    parts(then, tdm_sub(w->end->twist.velocity, w->other_end->twist.velocity),
          tdm_sub(w->end->twist.angular, w->other_end->twist.angular), late);
  }
  parts(then, w->end->twist.velocity, w->end->twist.angular, end.rate);
  for (int k = 0; k < CPL_PARTS; k++) {
    const double owed = h * (given[k] - found[k]);
    const double off = of_jump * owed / t->mass[k] + of_foresight * late[k];
    end.way[k] += way[k];
    end.given[k] += h * found[k];
    end.owed[k] += owed;
    end.got[k] += got[k];
    end.late[k] += 0.5 * h * (late[k] + t->end_late[k]); /* what alternates from window to window is none of it */
    end.jolt[k] += h * off * off;
    end.slip[k] += h * of_foresight * of_foresight * apart[k] * apart[k];
  }
  end.made += w->made;
  end.t = w->t1;
  memcpy(t->end_late, late, sizeof late);
  return end;
}

/* The impulse until an output time; the body's frame then. */
static void sample(cpl_trace *t, double time, tdm_quat frame, const tdm_wrench *load) {
  double mean[CPL_PARTS];
  parts(frame, load->force, load->moment, mean);
  for (int k = 0; k < CPL_PARTS; k++)
    t->sampled[k] += (time - t->sample_time) * mean[k];
  t->sample_time = time;
}

/* A row at an output time inside the window: the solvers' own values there, what is summed up in proportion. */
static cpl_trace_row row_inside(const cpl_trace *t, const cpl_trace_window *w, const cpl_trace_row *end, int i) {
  const tdm_state *state = &w->sample[i * w->stride];
  const double s = (w->sample_time[i] - w->t0) / (w->t1 - w->t0);
  double way[CPL_PARTS], got[CPL_PARTS];
  cpl_trace_row row = t->end;
  way_between(t, w->start, state, way);
  impulse_until(w, s, frame_at(t, tdm_quat_slerp(w->start->pose.orientation, w->end->pose.orientation, 0.5)), got);
  parts(frame_at(t, state->pose.orientation), state->twist.velocity, state->twist.angular, row.rate);
  for (int k = 0; k < CPL_PARTS; k++) {
    row.way[k] += way[k];
    row.given[k] = t->sampled[k];
    row.got[k] += got[k];
    row.owed[k] += s * (end->owed[k] - row.owed[k]);
    row.late[k] += s * (end->late[k] - row.late[k]);
    row.jolt[k] += s * (end->jolt[k] - row.jolt[k]);
    row.slip[k] += s * (end->slip[k] - row.slip[k]);
  }
  row.made += s * (end->made - row.made);
  row.t = w->sample_time[i];
  return row;
}

void cpl_trace_add(cpl_trace *t, const cpl_trace_window *w) {
  const cpl_trace_row end = sum_up(t, w);
  for (int i = 0; i < w->nsample; i++) {
    sample(t, w->sample_time[i], frame_at(t, w->sample[i * w->stride].pose.orientation),
           &w->sample_load[i * w->stride]);
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

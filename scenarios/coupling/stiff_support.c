/* Stiff supports: the mechanism swings within the window by itself, with and without damping. A box of particles on a
 * spring, and on an arm with a torsional spring, 2 s.
 *
 * Each cell's reference is its run with n = 1: the fill is compliant, no rigid body. A fill that rattles is chaotic,
 * and two runs of it that differ by round-off agree to 0.998 only; so a lid presses it, as on the arm of `torsional`.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/table.h"
#include "scenarios/coupling/cell.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double least_nse = 0.999, end = 2; /* end [s] */

enum { WINDOWS = 3, RUNS = WINDOWS + 1, SUPPORTS_MAX = 27 };
static const int window[WINDOWS] = {10, 100, 1000}; /* steps of 1e-4 s */

typedef struct {
  double mass;               /* of the box [kg] */
  double stiffness, damping; /* [N/m], [N s/m]; about the hinge [N m/rad], [N m s/rad] */
} support;

/* What a scene is run with. */
typedef struct {
  const char *scene, *column; /* column of body_box.csv that is looked at */
  const char *fill[3];        /* settings of the fill, or NULL */
  int nmass, nstiffness, nhard;
  double mass[3], stiffness[4], damping[3];
  support hard[2]; /* without --full */
} family;

static const family slider = {.scene = "spring_damper",
                              .column = "z",
                              .fill = {"dem.materials[0].young_modulus=1e7", "dem.pairs[0].restitution=0.5",
                                       "dem.bodies[0].shapes[0].lid={\"face\":\"+z\",\"gap\":1e-3,\"press\":5000}"},
                              .nmass = 3,
                              .nstiffness = 3,
                              .nhard = 2,
                              .mass = {20, 50, 250},
                              .stiffness = {500, 5e4, 5e5},
                              .damping = {0, 50, 5000},
                              .hard = {{20, 5e4, 0}, {20, 5e5, 0}}};
static const family hinge = {.scene = "torsional",
                             .column = "y",
                             .nmass = 1,
                             .nstiffness = 4,
                             .nhard = 1,
                             .mass = {50},
                             .stiffness = {2.3e3, 2.3e4, 2.3e5, 2.3e6},
                             .damping = {0, 50, 1000},
                             .hard = {{50, 2.3e6, 0}}};

static int list(const cpl_verify *v, const family *f, support *out) {
  int n = 0;
  for (int i = 0; i < f->nhard && !cpl_verify_full(v); i++)
    out[n++] = f->hard[i];
  for (int m = 0; m < f->nmass && cpl_verify_full(v); m++)
    for (int k = 0; k < f->nstiffness; k++)
      for (int c = 0; c < 3; c++)
        out[n++] = (support){f->mass[m], f->stiffness[k], f->damping[c]};
  return n;
}

/* The runs of a support: n = 1, then the windows. */
static void prepare(const family *f, const support *s, cpl_verify_case run[RUNS]) {
  for (int i = 0; i < RUNS; i++) {
    char more[48];
    snprintf(more, sizeof more, "m=%g k=%g c=%g", s->mass, s->stiffness, s->damping);
    const scn_cell cell = {.scheme = "proxy", .dt = "1e-4", .n = i > 0 ? window[i - 1] : 1, .more = more};
    scn_cell_prepare(&cell, f->scene, &run[i]);
    cpl_verify_case_set(&run[i], "mbd.bodies[0].mass=%.17g", s->mass);
    cpl_verify_case_set(&run[i], "mbd.forces[0].stiffness=%.17g", s->stiffness);
    cpl_verify_case_set(&run[i], "mbd.forces[0].damping=%.17g", s->damping);
    cpl_verify_case_set(&run[i], "time.end=%g", end);
    for (int k = 0; k < 3 && f->fill[k]; k++)
      cpl_verify_case_set(&run[i], "%s", f->fill[k]);
  }
}

static tdm_status read(const cpl_verify_case *run, cpl_table *table, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/body_box.csv", run->dir);
  return cpl_table_read(table, file, err);
}

/* nse of the column against the run with n = 1; NaN when the run did not reach its end. */
static double agreement(const family *f, const cpl_verify_case *run, const cpl_table *reference) {
  tdm_error err = {0};
  cpl_table t = {0};
  double nse = NAN;
  if (run->err.status == TDM_OK && read(run, &t, &err) == TDM_OK && t.nrow == reference->nrow)
    nse = cpl_nse(cpl_table_column(&t, f->column, &err), cpl_table_column(reference, f->column, &err), t.nrow);
  cpl_table_free(&t);
  return nse;
}

static tdm_status measure(cpl_verify *v, const family *f, const cpl_verify_case run[RUNS], tdm_error *err) {
  cpl_table reference = {0};
  char name[32];
  for (int i = 0; i < RUNS; i++) /* one that blows up is a result, one that is refused is an error */
    if (run[i].err.status != TDM_OK && (i < 1 || run[i].err.status != TDM_ERR_NUMERIC))
      return tdm_fail(err, run[i].err.status, NULL, "%.100s: %.800s", run[i].name, run[i].err.message);
  snprintf(name, sizeof name, "nse_%s", f->column);
  if (read(&run[0], &reference, err) == TDM_OK && cpl_table_column(&reference, f->column, err))
    for (int i = 1; i < RUNS; i++) {
      cpl_verify_about(v, &run[i]);
      cpl_verify_measure(v, name, run[i].name, agreement(f, &run[i], &reference), CPL_AT_LEAST, least_nse);
    }
  cpl_table_free(&reference);
  return err->status;
}

static tdm_status verify(cpl_verify *v, const family *f, tdm_error *err) {
  support at[SUPPORTS_MAX];
  const int n = list(v, f, at);
  cpl_verify_case *run = calloc((size_t)n * RUNS, sizeof *run);
  tdm_error first = {0};
  if (!run)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < n; i++)
    prepare(f, &at[i], run + i * RUNS);
  cpl_verify_run_many(v, n * RUNS, run, 0, err);
  for (int i = 0; i < n && err->status == TDM_OK; i++) {
    tdm_error own = {0};
    if (measure(v, f, run + i * RUNS, &own) != TDM_OK && first.status == TDM_OK)
      first = own;
  }
  free(run);
  if (err->status == TDM_OK)
    *err = first;
  return err->status;
}

tdm_status scn_coupling_stiff_support(cpl_verify *v, tdm_error *err) {
  return verify(v, &slider, err);
}

tdm_status scn_coupling_stiff_hinge(cpl_verify *v, tdm_error *err) {
  return verify(v, &hinge, err);
}

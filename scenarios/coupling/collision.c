/* [L18] Table I with scheme `proxy` at several windows: a particle hits a cube, six mass ratios; and the error over the
 * DEM step.
 *
 * The scene's particle touches the cube exactly at the end of a step; the first overlap is then a whole step's, which
 * is the worst place that there is: the range over all places is measured beside. Young's modulus is 4e7 Pa (E* =
 * 2.1e7 Pa), for contacts of some more steps.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/collision/collision.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double limit_percent = 0.1;
static const int steps[] = {1, 2, 5, 10, 20};
static const char *const dts[] = {"2.5e-6", "5e-6", "1e-5", "2e-5", "5e-5", "1e-4"};
enum {
  NSTEPS = sizeof steps / sizeof steps[0],
  NDT = sizeof dts / sizeof dts[0],
  NPHASE = 10,
  TABLE = NSTEPS * SCN_COLLISION_CASES, /* first the table, then the error over the step, then over the place in it */
  NRUN = TABLE + 2 * NDT + NPHASE
};

static void prepare(cpl_verify_case *run, double m_p, int n, const char *dt, double phase) {
  double step = scn_collision_speed * strtod(dt, NULL);
  *run = (cpl_verify_case){.scene = "collision"};
  cpl_verify_case_set(run, "coupling.scheme=proxy");
  cpl_verify_case_set(run, "coupling.n=%d", n);
  cpl_verify_case_set(run, "time.dt=%s", dt);
  cpl_verify_case_set(run, "output.interval=%s", dt);
  cpl_verify_case_set(run, "dem.particles[0].mass=%g", m_p);
  cpl_verify_case_set(run, "dem.materials[0].young_modulus=4e7");
  cpl_verify_case_set(run, "dem.particles[0].positions=[[%.12g,0,0]]", -0.01 - step * (floor(5e-4 / step) + phase));
}

static void prepare_all(cpl_verify_case *run) {
  for (int i = 0; i < TABLE; i++, run++) {
    double m_p = scn_collision_mass[i / NSTEPS];
    prepare(run, m_p, steps[i % NSTEPS], "5e-6", 0);
    snprintf(run->name, sizeof run->name, "m_p=%g scheme=proxy n=%d", m_p, steps[i % NSTEPS]);
  }
  for (int i = 0; i < 2 * NDT; i++, run++) {
    prepare(run, 10, i < NDT ? 1 : 20, dts[i % NDT], 0);
    snprintf(run->name, sizeof run->name, "m_p=10 scheme=proxy n=%d dt=%s", i < NDT ? 1 : 20, dts[i % NDT]);
  }
  for (int i = 0; i < NPHASE; i++, run++) {
    prepare(run, 0.01, 1, "5e-6", 0.1 * i);
    snprintf(run->name, sizeof run->name, "m_p=0.01 scheme=proxy n=1 phase=%.1f", 0.1 * i);
  }
}

/* Write the rows of the plots: m_c/m_p or Δt, then both errors, a file for each n. */
static void write_rows(cpl_verify *v, const scn_collision_errors *error) {
  char file[4352];
  for (int k = 0; k < NSTEPS; k++) {
    snprintf(file, sizeof file, "%s/ratio_n=%d.csv", cpl_verify_dir(v), steps[k]);
    FILE *f = fopen(file, "w");
    for (int i = 0; f && i < SCN_COLLISION_CASES; i++)
      fprintf(f, "%s%g,%.6g,%.6g\n", i ? "" : "m_c/m_p [-],particle [%],body [%]\n",
              scn_collision_body_mass / scn_collision_mass[i], error[i * NSTEPS + k].particle,
              error[i * NSTEPS + k].body);
    if (f)
      fclose(f);
  }
  for (int k = 0; k < 2; k++) {
    snprintf(file, sizeof file, "%s/step_n=%d.csv", cpl_verify_dir(v), k ? 20 : 1);
    FILE *f = fopen(file, "w");
    for (int i = 0; f && i < NDT; i++)
      fprintf(f, "%s%s,%.6g,%.6g\n", i ? "" : "dt [s],particle [%],body [%]\n", dts[i],
              error[TABLE + k * NDT + i].particle, error[TABLE + k * NDT + i].body);
    if (f)
      fclose(f);
  }
}

static void plot(cpl_verify *v) {
  static const char setup[] = "set logscale x\nset logscale y\nset format '%g'\nset key outside right top\n";
  static const tdm_curve particle[] = {{"ratio_n=1.csv", "1:(abs($2))", "n = 1", "linespoints pt 7"},
                                       {"ratio_n=5.csv", "1:(abs($2))", "n = 5", "linespoints pt 5"},
                                       {"ratio_n=20.csv", "1:(abs($2))", "n = 20", "linespoints pt 9"}};
  static const tdm_curve body[] = {{"ratio_n=1.csv", "1:(abs($3))", "n = 1", "linespoints pt 7"},
                                   {"ratio_n=5.csv", "1:(abs($3))", "n = 5", "linespoints pt 5"},
                                   {"ratio_n=20.csv", "1:(abs($3))", "n = 20", "linespoints pt 9"}};
  static const tdm_curve step[] = {{"step_n=1.csv", "1:(abs($2))", "particle, n = 1", "linespoints pt 7"},
                                   {"step_n=1.csv", "1:(abs($3))", "cube, n = 1", "linespoints pt 6"},
                                   {"step_n=20.csv", "1:(abs($2))", "particle, n = 20", "linespoints pt 9"},
                                   {"step_n=20.csv", "1:(abs($3))", "cube, n = 20", "linespoints pt 8"}};
  const tdm_plot plots[] = {
      {
          .title = "Error of the particle's velocity after the collision, proxy",
          .xlabel = "m_c/m_p",
          .ylabel = "|error| [%]",
          .setup = setup,
          .ncurve = 3,
          .curve = particle,
      },
      {
          .title = "Error of the cube's velocity after the collision, proxy",
          .xlabel = "m_c/m_p",
          .ylabel = "|error| [%]",
          .setup = setup,
          .ncurve = 3,
          .curve = body,
      },
      {
          .title = "Error over the DEM step, m_c = m_p",
          .xlabel = "dt [s]",
          .ylabel = "|error| [%]",
          .setup = setup,
          .ncurve = 4,
          .curve = step,
      },
  };
  cpl_verify_plot(v, "collision", 3, plots);
}

tdm_status scn_coupling_collision(cpl_verify *v, tdm_error *err) {
  cpl_verify_case *run = calloc(NRUN, sizeof *run);
  scn_collision_errors error[NRUN] = {0};
  if (!run)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  prepare_all(run);
  cpl_verify_run_many(v, NRUN, run, 0, err);
  for (int i = 0; err->status == TDM_OK && i < NRUN; i++) {
    double m_p = i < TABLE ? scn_collision_mass[i / NSTEPS] : i < TABLE + 2 * NDT ? 10 : 0.01;
    *err = run[i].err;
    if (err->status != TDM_OK || scn_collision_read(run[i].dir, m_p, &error[i], err) != TDM_OK)
      break;
    cpl_limit_kind kind = i < TABLE || i >= TABLE + 2 * NDT ? CPL_AT_MOST : CPL_NO_LIMIT;
    cpl_verify_about(v, &run[i]);
    cpl_verify_measure(v, "error_particle_percent", run[i].name, error[i].particle, kind, limit_percent);
    cpl_verify_measure(v, "error_body_percent", run[i].name, error[i].body, kind, limit_percent);
  }
  free(run);
  if (err->status == TDM_OK) {
    write_rows(v, error);
    plot(v);
  }
  return err->status;
}

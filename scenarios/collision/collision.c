/* Particle against cube, [L18] Section 3.1 and Table I: velocities after the collision against momentum and
 * restitution.
 *
 *   v_c = (m_p u_p + m_c u_c + m_p e (u_p - u_c)) / (m_p + m_c)                                          [L18] Eq. 17
 *   v_p = (m_p u_p + m_c u_c + m_c e (u_c - u_p)) / (m_p + m_c)                                          [L18] Eq. 18
 *   error = 100 (v_simulation / v_theory - 1) %                                                          [L18] Eq. 19
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/collision/collision.h"

#include "coupler/results/table.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

/* as in scene.json */
const double scn_collision_body_mass = 10, scn_collision_speed = 2;
static const double restitution = 0.5;
static const double limit_percent = 0.2, limit_ratio = 100; /* the limit holds where m_c/m_p is at least this */

enum { NCASE = SCN_COLLISION_CASES };
const double scn_collision_mass[NCASE] = {0.01, 0.02, 0.1, 1, 2, 10};

/* [L18] Table I, printed velocities, with three misprints corrected: of 0.1 kg v_p (-9.74e-2) and v_c (2.94e-2, which
 * is not the printed +0.783 %), of 2 kg v_c (-5.10e-1) */
static const struct {
  double v_p, v_c;
} paper[NCASE] = {{-9.98e-1, 3.02e-3}, {-9.95e-1, 6.03e-3}, {-9.74e-1, 2.99e-2},
                  {-7.56e-1, 2.75e-1}, {-5.54e-1, 5.10e-1}, {3.87e-1, 1.62}};

static void theory(double m_p, double *v_p, double *v_c) {
  double sum = m_p + scn_collision_body_mass;
  *v_c = m_p * scn_collision_speed * (1 + restitution) / sum;
  *v_p = (m_p - scn_collision_body_mass * restitution) * scn_collision_speed / sum;
}

/* The velocities, beside theory. */
static void judge(double m_p, double v_p, double v_c, scn_collision_errors *out) {
  double expected_p, expected_c;
  theory(m_p, &expected_p, &expected_c);
  out->particle = 100 * (v_p / expected_p - 1);
  out->body = 100 * (v_c / expected_c - 1);
  out->restitution = (v_c - v_p) / scn_collision_speed;
  out->momentum = (m_p * v_p + scn_collision_body_mass * v_c) / (m_p * scn_collision_speed);
}

/* Velocities after the collision, and the rows in which the cube feels a load: one row is one step here. */
tdm_status scn_collision_read(const char *dir, double m_p, scn_collision_errors *out, tdm_error *err) {
  *out = (scn_collision_errors){0};
  char file[4096];
  cpl_table body = {0}, dem = {0};
  snprintf(file, sizeof file, "%s/body_cube.csv", dir);
  cpl_table_read(&body, file, err);
  snprintf(file, sizeof file, "%s/dem.csv", dir);
  if (err->status == TDM_OK)
    cpl_table_read(&dem, file, err);
  const double *v_c = err->status == TDM_OK ? cpl_table_column(&body, "vx", err) : NULL;
  const double *load = v_c ? cpl_table_column(&body, "fx", err) : NULL;
  const double *v_p = load ? cpl_table_column(&dem, "particles.velocity.x", err) : NULL;
  if (v_p) {
    judge(m_p, v_p[dem.nrow - 1], v_c[body.nrow - 1], out);
    for (int i = 0; i < body.nrow; i++)
      out->steps += load[i] != 0;
    if (load[body.nrow - 1] != 0)
      tdm_fail(err, TDM_ERR_NUMERIC, NULL, "%s: still in contact at the end; raise time.end", dir);
  }
  cpl_table_free(&body);
  cpl_table_free(&dem);
  return err->status;
}

/* literal: the paper's exchange to the letter, one value of the load held and the velocity as it was sent, with the
 * wall mass of its DEM code */
typedef enum { LOMMEN, PROXY, WALL_MASS, LITERAL, NSERIES } series;

static const struct {
  const char *name, *scheme, *wall_mass, *lommen;
  bool limited;
} kind[NSERIES] = {
    [LOMMEN] = {"", "lommen", "body", "{}", true},
    [PROXY] = {" scheme=proxy", "proxy", "body", "{}", true},
    [WALL_MASS] = {" wall_mass=1e8", "lommen", "1e8", "{}", false},
    [LITERAL] = {" literal", "lommen", "edem", "{\"load\": \"end-held\", \"wall_velocity\": \"sent\"}", false},
};

static void name_case(cpl_verify_case *c, int i, series what) {
  snprintf(c->name, sizeof c->name, "m_p=%g%s", scn_collision_mass[i], kind[what].name);
  cpl_verify_case_set(c, "dem.particles[0].mass=%g", scn_collision_mass[i]);
  cpl_verify_case_set(c, "coupling.scheme=%s", kind[what].scheme);
  cpl_verify_case_set(c, "coupling.lommen=%s", kind[what].lommen);
  cpl_verify_case_set(c, "dem.contact.wall_mass=%s", kind[what].wall_mass);
}

static scn_collision_errors of_paper(int i) {
  scn_collision_errors e = {0};
  judge(scn_collision_mass[i], paper[i].v_p, paper[i].v_c, &e);
  return e;
}

static void measure_paper(cpl_verify *v, const cpl_verify_case *c, int i) {
  const scn_collision_errors e = of_paper(i);
  cpl_verify_measure(v, "paper_particle_percent", c->name, e.particle, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "paper_body_percent", c->name, e.body, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "paper_restitution", c->name, e.restitution, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "paper_momentum", c->name, e.momentum, CPL_NO_LIMIT, 0);
}

static tdm_status measure_case(cpl_verify *v, const cpl_verify_case *c, int i, series what, scn_collision_errors *e,
                               tdm_error *err) {
  if (c->err.status != TDM_OK) {
    *err = c->err;
    return err->status;
  }
  if (scn_collision_read(c->dir, scn_collision_mass[i], e, err) != TDM_OK)
    return err->status;
  const bool light = scn_collision_body_mass / scn_collision_mass[i] >= limit_ratio;
  const cpl_limit_kind limit = kind[what].limited && light ? CPL_AT_MOST : CPL_NO_LIMIT;
  cpl_verify_about(v, c);
  cpl_verify_measure(v, "error_particle_percent", c->name, e->particle, limit, limit_percent);
  cpl_verify_measure(v, "error_body_percent", c->name, e->body, limit, limit_percent);
  if (kind[what].limited) {
    cpl_verify_measure(v, "steps_per_contact", c->name, e->steps, CPL_NO_LIMIT, 0);
    return TDM_OK;
  }
  cpl_verify_measure(v, "restitution", c->name, e->restitution, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "momentum", c->name, e->momentum, CPL_NO_LIMIT, 0);
  if (what == WALL_MASS)
    measure_paper(v, c, i);
  return TDM_OK;
}

static tdm_status write_table(cpl_verify *v, scn_collision_errors result[NSERIES][NCASE], tdm_error *err) {
  char file[4096];
  snprintf(file, sizeof file, "%s/table.csv", cpl_verify_dir(v));
  FILE *f = fopen(file, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written", file);
  fputs("m_c/m_p [-],particle [%],body [%],particle wall_mass [%],body wall_mass [%],particle paper [%],body paper [%],"
        "particle literal [%],body literal [%],restitution literal,restitution paper,momentum literal,momentum paper\n",
        f);
  for (int i = 0; i < NCASE; i++) {
    const scn_collision_errors *own = &result[LOMMEN][i], *heavy = &result[WALL_MASS][i], *as = &result[LITERAL][i];
    const scn_collision_errors printed = of_paper(i);
    fprintf(f, "%g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n",
            scn_collision_body_mass / scn_collision_mass[i], own->particle, own->body, heavy->particle, heavy->body,
            printed.particle, printed.body, as->particle, as->body, as->restitution, printed.restitution, as->momentum,
            printed.momentum);
  }
  fclose(f);
  return TDM_OK;
}

static void plot(cpl_verify *v) {
  static const char setup[] = "set logscale x\nset logscale y\nset format x '%g'\nset format y '%g'\n"
                              "set key bottom left\n";
  static const tdm_curve particle[] = {
      {"table.csv", "1:(abs($2))", "true effective mass", "linespoints pt 7"},
      {"table.csv", "1:(abs($4))", "wall mass 1e8 kg", "linespoints pt 5"},
      {"table.csv", "1:(abs($8))", "exchange to the letter", "points pt 6 ps 1.5"},
      {"table.csv", "1:(abs($6))", "[L18] Table I (opposite sign)", "points pt 2 ps 1.5"},
  };
  static const tdm_curve body[] = {
      {"table.csv", "1:(abs($3))", "true effective mass", "linespoints pt 7"},
      {"table.csv", "1:(abs($5))", "wall mass 1e8 kg", "linespoints pt 5"},
      {"table.csv", "1:(abs($9))", "exchange to the letter", "points pt 6 ps 1.5"},
      {"table.csv", "1:(abs($7))", "[L18] Table I", "points pt 2 ps 1.5"},
  };
  static const tdm_curve velocity[] = {
      {"m_p=10/dem.csv", "1:6", "particle", "lines lw 2"},
      {"m_p=10/body_cube.csv", "1:9", "cube", "lines lw 2"},
      {"m_p=10/dem.csv", "1:(0.5)", "particle after, theory", "lines dt 2 lc rgb 'black'"},
      {"m_p=10/dem.csv", "1:(1.5)", "cube after, theory", "lines dt 3 lc rgb 'black'"},
  };
  const tdm_plot plots[] = {
      {
          .title = "Error of the particle's velocity after the collision",
          .xlabel = "m_c/m_p",
          .ylabel = "|error| [%]",
          .setup = setup,
          .ncurve = 4,
          .curve = particle,
      },
      {
          .title = "Error of the cube's velocity after the collision",
          .xlabel = "m_c/m_p",
          .ylabel = "|error| [%]",
          .setup = setup,
          .ncurve = 4,
          .curve = body,
      },
      {
          .title = "Velocities, m_p = m_c = 10 kg",
          .xlabel = "time [s]",
          .ylabel = "velocity [m/s]",
          .setup = "unset logscale\nset format '%g'\nset key bottom right\n",
          .ncurve = 4,
          .curve = velocity,
      },
  };
  cpl_verify_plot(v, "collision", 3, plots);
}

tdm_status scn_collision(cpl_verify *v, tdm_error *err) {
  cpl_verify_case run[NSERIES * NCASE] = {0};
  scn_collision_errors result[NSERIES][NCASE] = {0};
  for (int k = 0; k < NSERIES * NCASE; k++)
    name_case(&run[k], k % NCASE, (series)(k / NCASE));
  cpl_verify_run_many(v, NSERIES * NCASE, run, 0, err);
  for (int k = 0; err->status == TDM_OK && k < NSERIES * NCASE; k++)
    measure_case(v, &run[k], k % NCASE, (series)(k / NCASE), &result[k / NCASE][k % NCASE], err);
  if (err->status == TDM_OK && write_table(v, result, err) == TDM_OK)
    plot(v);
  return err->status;
}

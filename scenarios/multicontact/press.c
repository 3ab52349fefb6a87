/* [G21] Section 4: beds pressed together by a plate with the classical law, mc-strain and mc-stress: 514 balls of
 * hydrogel, down and up again (Fig. 11), and of rubber (Fig. 15), 1921 of hydrogel (Fig. 14), 17 glass beads (Fig.
 * 16). Stress-strain curves, and the distributions of normal forces at the start and at the largest strain. The plate's
 * way down is half a cosine, so it begins and ends at rest. Each press runs twice as fast, too: by how much that moves
 * the curve is what the rate does, with the scatter of balls that find other places. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"
#include "scenarios/table.h"

#include "coupler/cells/jobs.h"
#include "dem/output/contacts.h"
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"
#include "protocol/output/histogram.h"
#include "protocol/parameters/load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

enum { SAMPLES = 200, PRESSES = 8 };

/* The beds: scenes in which body 0 is the plate. */
enum { BALLS, MIXTURE, BEADS };
static const struct {
  const char *file;
  double area; /* of the plate on the bed [m2] */
} beds[] = {[BALLS] = {"multicontact/hydrogel.json", 0.165 * 0.165},
            [MIXTURE] = {"multicontact/mixture.json", 0.218 * 0.218},
            [BEADS] = {"multicontact/glass.json", 0.006 * 0.006 * M_PI}};

typedef struct {
  const char *name;
  int bed, material, law;
  double factor, strain;
  double stroke; /* time of the plate's way down [s] */
  double dt;     /* [s] */
  bool back;     /* up again, in the same time */
  bool no_rest;  /* the law has no state of rest at this strain: how the curve moves has no limit */
} press;

/* Plain data: it comes from a process of its own. */
typedef struct {
  tdm_error err;
  double peak;              /* largest force on the plate [N] */
  double end;               /* at the largest strain [N] */
  double lost;              /* work that is not given back, share of that put in */
  double force[SAMPLES];    /* over the strain, on the way down, at k/SAMPLES of it [N] */
  double kinetic;           /* energy at most, share of the work put in */
  tdm_force_bins forces[2]; /* of the contacts at the start, and at the largest strain */
  double simulated, wall;   /* [s] */
} result;

/* the section dem of the scene of a press; NULL and an error */
static json_t *section(cpl_verify *v, const press *s, tdm_error *err) {
  char file[4096], strain[64], stroke[64];
  if (cpl_verify_find_file(v, beds[s->bed].file, file, sizeof file, err))
    return NULL;
  snprintf(strain, sizeof strain, "parameters.strain=%.17g", s->strain);
  snprintf(stroke, sizeof stroke, "parameters.stroke=%.17g", s->stroke);
  const char *const set[] = {strain, stroke, NULL};
  tdm_scene scene = {0};
  if (tdm_scene_load(&scene, file, set, err))
    return NULL;
  json_t *dem = json_incref(json_object_get(scene.root, "dem"));
  tdm_scene_destroy(&scene);
  const scn_soft *of = &scn_softs[s->material];
  json_t *material = json_array_get(json_object_get(dem, "materials"), 0);
  json_t *pair = json_array_get(json_object_get(dem, "pairs"), 0), *contact = json_object();
  json_object_set_new(material, "density", json_real(of->density));
  json_object_set_new(material, "young_modulus", json_real(of->young));
  json_object_set_new(material, "poisson_ratio", json_real(of->poisson));
  json_object_set_new(pair, "restitution", json_real(of->restitution));
  json_object_set_new(pair, "friction", json_real(of->friction));
  json_object_del(pair, "beta");
  if (s->law == SCN_STRAIN)
    json_object_set_new(pair, "gamma", json_real(s->factor));
  if (s->law == SCN_STRESS)
    json_object_set_new(pair, "beta", json_real(s->factor));
  if (s->law != SCN_CLASSICAL)
    json_object_set_new(contact, "multi_contact", json_string(scn_multi_names[s->law]));
  json_object_set_new(dem, "contact", contact);
  return dem;
}

/* the distribution of the forces now */
static tdm_status take_forces(const scn_rig *rig, tdm_force_bins *out, tdm_error *err) {
  tdm_snapshot now = {0};
  if (dem_contacts_look(rig->data, &now, err) == TDM_OK)
    *out = tdm_force_bins_of(&now);
  tdm_snapshot_free(&now);
  return err->status;
}

/* What a press has come to so far. */
typedef struct {
  double put, back;     /* work put in, and given back [J] */
  double force, strain; /* at the step before */
  double kinetic;       /* energy at most [J] */
} progress;

/* The state after a step; `down`: on the way to the largest strain. */
static void look(const press *s, const scn_rig *rig, double height, bool down, progress *p, result *out) {
  const double force = rig->data->state.body_load[0].force.z;
  const double strain = (height - rig->data->state.pose[0].position.z) / height;
  const double work = 0.5 * (force + p->force) * height * (strain - p->strain);
  *(work > 0 ? &p->put : &p->back) += work;
  out->peak = fmax(out->peak, force);
  if (down) {
    for (int q = (int)ceil(p->strain / s->strain * SAMPLES); q < SAMPLES && q <= strain / s->strain * SAMPLES; q++)
      out->force[q] = force;
    out->end = force;
  }
  p->force = force, p->strain = strain;
}

/* All steps of a press, with 400 rows into f. */
static tdm_status go(const press *s, scn_rig *rig, FILE *f, result *out, tdm_error *err) {
  progress p = {0};
  const long way = lround(s->stroke / s->dt), steps = s->back ? 2 * way : way;
  const double height = rig->data->state.pose[0].position.z;
  take_forces(rig, &out->forces[0], err);
  for (long k = 1; k <= steps && err->status == TDM_OK && scn_rig_steps(rig, 1, err) == TDM_OK; k++) {
    look(s, rig, height, k <= way, &p, out);
    if (k == way)
      take_forces(rig, &out->forces[1], err);
    if (k % (steps / 400) != 0)
      continue;
    p.kinetic = fmax(p.kinetic, scn_rig_kinetic(rig));
    fprintf(f, "%.9g,%.9g,%.9g\n", p.strain, p.force / beds[s->bed].area, p.force);
  }
  out->lost = p.put > 0 ? 1 + p.back / p.put : NAN;
  out->kinetic = p.kinetic / p.put;
  return err->status;
}

static void run(cpl_verify *v, const press *s, const char *file, result *out) {
  tdm_error *err = &out->err;
  json_t *dem = section(v, s, err);
  char *text = dem ? json_dumps(dem, JSON_REAL_PRECISION(17)) : NULL;
  FILE *f = text ? scn_curve(v, file, err) : NULL;
  scn_rig rig = {0};
  json_decref(dem);
  if (dem && !text)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a scene");
  if (f) {
    fputs("strain,stress [Pa],force [N]\n", f);
    if (scn_rig_open(&rig, v, s->dt, err, "%s", text) == TDM_OK)
      go(s, &rig, f, out, err);
    out->simulated = rig.time;
    out->wall = tdm_clock() - rig.begin;
    scn_rig_close(&rig);
    fclose(f);
  }
  free(text);
}

/* ---- side by side ---- */

/* Presses of one picture, each also twice as fast: piece n + k is press k so. */
typedef struct {
  cpl_verify *v;
  const char *name;
  const press *s;
  int n;
  result *r; /* (2 n) in shared memory */
} work;

static void file_of(const work *w, int piece, char *out, size_t size) {
  snprintf(out, size, "%s_%d%s.csv", w->name, piece % w->n, piece < w->n ? "" : "_fast");
}

static bool begin_press(void *context, int piece) {
  const work *w = context;
  tdm_fail(&w->r[piece].err, TDM_ERR_LOST, NULL, "%s: its process ended without a word", w->s[piece % w->n].name);
  return true;
}

static int do_press(void *context, int piece) {
  const work *w = context;
  char file[64];
  press s = w->s[piece % w->n];
  result own = {0};
  if (piece >= w->n)
    s.stroke /= 2, s.back = false;
  file_of(w, piece, file, sizeof file);
  run(w->v, &s, file, &own);
  w->r[piece] = own;
  return 0;
}

static void end_press(void *context, int piece, int status, double seconds) {
  const work *w = context;
  (void)status, (void)seconds;
  cpl_verify_alone(w->v, CPL_DEM, w->r[piece].simulated, w->r[piece].wall);
}

/* By how much two curves differ at equal strain, share of the largest force: root mean square, and at most. A slip of
 * the bed a little sooner or later makes the second large. */
static void compare(const result *a, const result *b, double *rms, double *most) {
  double sum = 0;
  *most = 0;
  for (int k = 0; k < SAMPLES; k++) {
    const double off = (a->force[k] - b->force[k]) / a->end;
    sum += off * off;
    scn_worst(most, off);
  }
  *rms = sqrt(sum / SAMPLES);
}

static void measure(cpl_verify *v, const press *s, const result *r, const result *fast) {
  double rms, most;
  compare(r, fast, &rms, &most);
  cpl_verify_measure(v, "force_at_strain [N]", s->name, r->end, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "peak_force [N]", s->name, r->peak, CPL_NO_LIMIT, 0);
  if (s->back)
    cpl_verify_measure(v, "lost_share_of_work", s->name, r->lost, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "kinetic/work", s->name, r->kinetic, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "moves_when_twice_as_fast", s->name, rms, s->no_rest ? CPL_NO_LIMIT : CPL_AT_MOST, 0.02);
  cpl_verify_measure(v, "moves_at_most", s->name, most, CPL_NO_LIMIT, 0);
}

static void plot(const work *w, const char *title) {
  char file[PRESSES][64];
  tdm_curve curves[PRESSES];
  for (int k = 0; k < w->n; k++) {
    file_of(w, k, file[k], sizeof file[k]);
    curves[k] = (tdm_curve){file[k], "1:2", w->s[k].name, "lines lw 2"};
  }
  const tdm_plot plot = {.title = title, .xlabel = "strain", .ylabel = "stress [Pa]", .ncurve = w->n, .curve = curves};
  cpl_verify_plot(w->v, w->name, 1, &plot);
}

/* NAME_forces.csv and its plot: at the start, and at the largest strain */
static tdm_status plot_forces(const work *w, const char *title, tdm_error *err) {
  static const char *const density[] = {"probability density, at the start", "at the largest strain"};
  char file[64], picture[64], using[2][PRESSES][64];
  tdm_curve curves[2][PRESSES];
  tdm_plot plots[2];
  snprintf(picture, sizeof picture, "%s_forces", w->name);
  snprintf(file, sizeof file, "%s.csv", picture);
  FILE *f = scn_curve(w->v, file, err);
  if (!f)
    return err->status;
  fputs("force/mean,density,mean [N],contacts,run,0: start 1: largest strain\n", f);
  for (int t = 0; t < 2; t++) {
    for (int k = 0; k < w->n; k++) {
      const tdm_force_bins *b = &w->r[k].forces[t];
      for (int q = 0; q < TDM_FORCE_BINS; q++)
        fprintf(f, "%.9g,%.9g,%.9g,%ld,%d,%d\n", (q + 0.5) * b->width, b->density[q], b->mean, b->n, k, t);
      snprintf(using[t][k], sizeof using[t][k], "($5==%d && $6==%d && $2>0 ? $1 : 1/0):2", k, t);
      curves[t][k] = (tdm_curve){file, using[t][k], w -> s[k].name, "linespoints lw 2 pt 7 ps 0.5"};
    }
    plots[t] = (tdm_plot){.title = title,
                          .xlabel = "normal force of a contact over the mean",
                          .ylabel = density[t],
                          .setup = "set logscale y\n",
                          .ncurve = w->n,
                          .curve = curves[t]};
  }
  fclose(f);
  cpl_verify_plot(w->v, picture, 2, plots);
  return TDM_OK;
}

/* The presses of a picture, and what is measured of each; r (n). */
static tdm_status presses(cpl_verify *v, const char *name, const char *title, const press *s, int n, result *r,
                          tdm_error *err) {
  const size_t size = 2 * (size_t)n * sizeof *r;
  result *all = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (all == MAP_FAILED)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  work w = {v, name, s, n, all};
  cpl_jobs_run(&(cpl_jobs){2 * n, cpl_verify_jobs(v), &w, begin_press, do_press, end_press});
  for (int k = 2 * n - 1; k >= 0; k--)
    if (all[k].err.status != TDM_OK)
      *err = all[k].err;
  if (err->status == TDM_OK) {
    memcpy(r, all, (size_t)n * sizeof *r);
    for (int k = 0; k < n; k++)
      measure(v, &s[k], &r[k], &all[n + k]);
    plot(&w, title);
    plot_forces(&w, title, err);
  }
  munmap(all, size);
  return tdm_interrupted ? tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted") : err->status;
}

/* ---- the cases ---- */

/* the force of one law over that of another at the largest strain */
static void order(cpl_verify *v, const char *name, const char *case_name, const result *a, const result *b,
                  cpl_limit_kind kind) {
  cpl_verify_measure(v, name, case_name, a->end / b->end, kind, 1);
}

tdm_status scn_multi_hydrogel(cpl_verify *v, tdm_error *err) {
  static const press s[] = {
      {"hydrogel classical", BALLS, SCN_HYDROGEL, SCN_CLASSICAL, 0, 0.134, 8, 1e-4, true, false},
      {"hydrogel mc-strain 1.12", BALLS, SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.134, 8, 1e-4, true, false},
      {"hydrogel mc-stress 1.65", BALLS, SCN_HYDROGEL, SCN_STRESS, 1.65, 0.134, 8, 1e-4, true, false},
      {"hydrogel mc-strain 1", BALLS, SCN_HYDROGEL, SCN_STRAIN, 1, 0.134, 8, 1e-4, true, false},
      {"hydrogel mc-stress 1", BALLS, SCN_HYDROGEL, SCN_STRESS, 1, 0.134, 8, 1e-4, true, false},
  };
  enum { N = sizeof s / sizeof *s };
  result r[N];
  if (presses(v, "hydrogel", "514 hydrogel balls to 13.4 % and back", s, N, r, err) != TDM_OK)
    return err->status;
  order(v, "strain/classical", "hydrogel 1.12", &r[1], &r[0], CPL_AT_LEAST);
  order(v, "stress/classical", "hydrogel 1.65", &r[2], &r[0], CPL_AT_LEAST);
  order(v, "stress/strain", "hydrogel 1.65, 1.12", &r[2], &r[1], CPL_NO_LIMIT);
  order(v, "stress/classical", "hydrogel 1", &r[4], &r[0], CPL_AT_LEAST);
  order(v, "strain/stress", "hydrogel 1, 1", &r[3], &r[4], CPL_AT_LEAST);
  return TDM_OK;
}

tdm_status scn_multi_rubber(cpl_verify *v, tdm_error *err) {
  static const press s[] = {
      {"rubber classical", BALLS, SCN_RUBBER, SCN_CLASSICAL, 0, 0.28, 2, 5e-5, false, false},
      {"rubber mc-strain 0.55", BALLS, SCN_RUBBER, SCN_STRAIN, 0.55, 0.28, 2, 5e-5, false, false},
      {"rubber mc-stress 1.71", BALLS, SCN_RUBBER, SCN_STRESS, 1.71, 0.28, 2, 5e-5, false, false},
      {"rubber mc-strain 1.12", BALLS, SCN_RUBBER, SCN_STRAIN, 1.12, 0.28, 2, 5e-5, false, true},
      {"rubber mc-stress 1.65", BALLS, SCN_RUBBER, SCN_STRESS, 1.65, 0.28, 2, 5e-5, false, false},
  };
  enum { N = sizeof s / sizeof *s };
  result r[N];
  if (presses(v, "rubber", "514 rubber balls to 28 %", s, N, r, err) != TDM_OK)
    return err->status;
  order(v, "strain/classical", "rubber 0.55", &r[1], &r[0], CPL_AT_LEAST);
  order(v, "stress/strain", "rubber 1.71, 0.55", &r[2], &r[1], CPL_AT_LEAST);
  order(v, "stress/strain", "rubber 1.65, 1.12", &r[4], &r[3], CPL_NO_LIMIT);
  return TDM_OK;
}

/* a bed with the classical law, mc-strain, mc-stress */
static tdm_status three_laws(cpl_verify *v, const char *name, const char *title, const press s[3], tdm_error *err) {
  result r[3];
  if (presses(v, name, title, s, 3, r, err) != TDM_OK)
    return err->status;
  order(v, "strain/classical", name, &r[1], &r[0], CPL_AT_LEAST);
  order(v, "stress/classical", name, &r[2], &r[0], CPL_AT_LEAST);
  order(v, "stress/strain", name, &r[2], &r[1], CPL_NO_LIMIT);
  return TDM_OK;
}

tdm_status scn_multi_mixture(cpl_verify *v, tdm_error *err) {
  static const press s[] = {
      {"mixture classical", MIXTURE, SCN_HYDROGEL, SCN_CLASSICAL, 0, 0.102, 2, 1e-4, false, false},
      {"mixture mc-strain 1.12", MIXTURE, SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.102, 2, 1e-4, false, false},
      {"mixture mc-stress 1.65", MIXTURE, SCN_HYDROGEL, SCN_STRESS, 1.65, 0.102, 2, 1e-4, false, false},
  };
  return three_laws(v, "mixture", "1573 and 348 hydrogel balls to 10.2 %", s, err);
}

tdm_status scn_multi_glass(cpl_verify *v, tdm_error *err) {
  static const press s[] = {
      {"glass classical", BEADS, SCN_GLASS, SCN_CLASSICAL, 0, 0.0264, 0.05, 2e-7, false, false},
      {"glass mc-strain 4.5", BEADS, SCN_GLASS, SCN_STRAIN, 4.5, 0.0264, 0.05, 2e-7, false, false},
      {"glass mc-stress 5.17", BEADS, SCN_GLASS, SCN_STRESS, 5.17, 0.0264, 0.05, 2e-7, false, false},
  };
  return three_laws(v, "glass", "17 glass beads to 2.64 %", s, err);
}

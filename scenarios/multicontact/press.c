/* [G21] Section 4: beds pressed together by a plate with the classical law, mc-strain and mc-stress: 514 balls of
 * hydrogel, down and up again (Fig. 11), and of rubber (Fig. 15), 1921 of hydrogel (Fig. 14), 17 glass beads (Fig.
 * 16). Stress-strain curves, and the distributions of normal forces at the largest strain. A stroke is half a cosine,
 * so the plate begins and ends at rest. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"
#include "scenarios/table.h"

#include "dem/output/contacts.h"
#include "protocol/output/histogram.h"
#include "protocol/parameters/load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLES = 200 };

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
  double factor, strain, period, dt; /* period: down and up again */
  bool half;                         /* the way down only */
} stroke;

typedef struct {
  double peak;           /* largest force on the plate [N] */
  double end;            /* at the largest strain [N] */
  double loop;           /* work that is not given back, share of that put in */
  double force[SAMPLES]; /* over the strain, on the way down, at k/SAMPLES of it */
  double fastest;        /* kinetic energy at most, share of the work put in */
  tdm_force_bins forces; /* of the contacts at the largest strain */
} result;

/* the section dem of the scene for a stroke; NULL and an error */
static json_t *section(cpl_verify *v, const stroke *s, tdm_error *err) {
  char file[4096], strain[64], period[64];
  if (cpl_verify_find_file(v, beds[s->bed].file, file, sizeof file, err))
    return NULL;
  snprintf(strain, sizeof strain, "parameters.strain=%.17g", s->strain);
  snprintf(period, sizeof period, "parameters.period=%.17g", s->period);
  const char *const set[] = {strain, period, NULL};
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
static tdm_status take_forces(const scn_rig *rig, result *out, tdm_error *err) {
  tdm_snapshot now = {0};
  if (dem_contacts_look(rig->data, &now, err) == TDM_OK)
    out->forces = tdm_force_bins_of(&now);
  tdm_snapshot_free(&now);
  return err->status;
}

/* What a stroke has come to so far. */
typedef struct {
  double put, back;     /* work put in, and given back [J] */
  double force, strain; /* at the step before */
  double fastest;       /* kinetic energy at most [J] */
} progress;

/* The state after a step; `down`: on the way to the largest strain. */
static void look(const stroke *s, const scn_rig *rig, double height, bool down, progress *p, result *out) {
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

static tdm_status run(cpl_verify *v, const stroke *s, FILE *f, int number, result *out, tdm_error *err) {
  json_t *dem = section(v, s, err);
  char *text = dem ? json_dumps(dem, JSON_REAL_PRECISION(17)) : NULL;
  json_decref(dem);
  *out = (result){0};
  if (!text)
    return err->status ? err->status : tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a scene");
  scn_rig rig;
  progress p = {0};
  const long way = lround(s->period / s->dt / 2), steps = s->half ? way : 2 * way;
  if (scn_rig_open(&rig, v, s->dt, err, "%s", text) == TDM_OK) {
    const double height = rig.data->state.pose[0].position.z;
    for (long k = 1; k <= steps && scn_rig_steps(&rig, 1, err) == TDM_OK; k++) {
      look(s, &rig, height, k <= way, &p, out);
      if (k == way && take_forces(&rig, out, err) != TDM_OK)
        break;
      if (k % (steps / 400) != 0)
        continue;
      p.fastest = fmax(p.fastest, scn_rig_kinetic(&rig));
      fprintf(f, "%.9g,%.9g,%.9g,%d\n", p.strain, p.force / beds[s->bed].area, p.force, number);
    }
  }
  fputs("\n\n", f);
  out->loop = p.put > 0 ? 1 + p.back / p.put : NAN;
  out->fastest = p.fastest / p.put;
  free(text);
  scn_rig_close(&rig);
  return err->status;
}

static void measure(cpl_verify *v, const stroke *s, const result *r) {
  cpl_verify_measure(v, "force_at_strain [N]", s->name, r->end, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "peak_force [N]", s->name, r->peak, CPL_NO_LIMIT, 0);
  if (!s->half)
    cpl_verify_measure(v, "lost_share_of_work", s->name, r->loop, CPL_NO_LIMIT, 0);
}

static void plot(cpl_verify *v, const char *name, const char *title, const stroke *s, int n) {
  char using[8][64], file[64];
  tdm_curve curves[8];
  snprintf(file, sizeof file, "%s.csv", name);
  for (int k = 0; k < n; k++) {
    snprintf(using[k], sizeof using[k], "1:($4==%d?$2:1/0)", k);
    curves[k] = (tdm_curve){file, using[k], s[k].name, "lines lw 2"};
  }
  const tdm_plot plot = {.title = title, .xlabel = "strain", .ylabel = "stress [Pa]", .ncurve = n, .curve = curves};
  cpl_verify_plot(v, name, 1, &plot);
}

/* NAME_forces.csv and its plot */
static tdm_status plot_forces(cpl_verify *v, const char *name, const char *title, const stroke *s, int n,
                              const result *r, tdm_error *err) {
  char file[64], picture[64], using[8][64];
  tdm_curve curves[8];
  snprintf(picture, sizeof picture, "%s_forces", name);
  snprintf(file, sizeof file, "%s.csv", picture);
  FILE *f = scn_curve(v, file, err);
  if (!f)
    return err->status;
  fputs("force/mean,density,mean [N],contacts,run\n", f);
  for (int k = 0; k < n; k++) {
    const tdm_force_bins *b = &r[k].forces;
    for (int q = 0; q < TDM_FORCE_BINS; q++)
      fprintf(f, "%.9g,%.9g,%.9g,%ld,%d\n", (q + 0.5) * b->width, b->density[q], b->mean, b->n, k);
    snprintf(using[k], sizeof using[k], "($5==%d && $2>0 ? $1 : 1/0):2", k);
    curves[k] = (tdm_curve){file, using[k], s[k].name, "linespoints lw 2 pt 7 ps 0.5"};
  }
  fclose(f);
  const tdm_plot plot = {.title = title,
                         .xlabel = "normal force of a contact over the mean",
                         .ylabel = "probability density",
                         .setup = "set logscale y\n",
                         .ncurve = n,
                         .curve = curves};
  cpl_verify_plot(v, picture, 1, &plot);
  return TDM_OK;
}

/* strokes of one picture */
static tdm_status strokes(cpl_verify *v, const char *name, const char *title, const stroke *s, int n, result *r,
                          tdm_error *err) {
  char file[64];
  snprintf(file, sizeof file, "%s.csv", name);
  FILE *f = scn_curve(v, file, err);
  if (!f)
    return err->status;
  fputs("strain,stress [Pa],force [N],run\n", f);
  for (int k = 0; k < n && err->status == TDM_OK; k++)
    if (run(v, &s[k], f, k, &r[k], err) == TDM_OK)
      measure(v, &s[k], &r[k]);
  fclose(f);
  if (err->status != TDM_OK)
    return err->status;
  plot(v, name, title, s, n);
  return plot_forces(v, name, title, s, n, r, err);
}

/* by how much two curves differ at most, share of the largest force */
static double difference(const result *a, const result *b) {
  double most = 0;
  for (int k = SAMPLES / 10; k < SAMPLES; k++)
    scn_worst(&most, (a->force[k] - b->force[k]) / a->end);
  return most;
}

tdm_status scn_multi_hydrogel(cpl_verify *v, tdm_error *err) {
  static const stroke s[] = {
      {"hydrogel classical", BALLS, SCN_HYDROGEL, SCN_CLASSICAL, 0, 0.134, 4, 1e-4, false},
      {"hydrogel mc-strain 1.12", BALLS, SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.134, 4, 1e-4, false},
      {"hydrogel mc-stress 1.65", BALLS, SCN_HYDROGEL, SCN_STRESS, 1.65, 0.134, 4, 1e-4, false},
      {"hydrogel mc-strain 1", BALLS, SCN_HYDROGEL, SCN_STRAIN, 1, 0.134, 4, 1e-4, false},
      {"hydrogel mc-stress 1", BALLS, SCN_HYDROGEL, SCN_STRESS, 1, 0.134, 4, 1e-4, false},
      {"hydrogel mc-strain 1.12, twice as fast", BALLS, SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.134, 2, 1e-4, true},
  };
  enum { N = sizeof s / sizeof *s };
  result r[N];
  if (strokes(v, "hydrogel", "514 hydrogel balls to 13.4 % and back", s, N, r, err) != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "strain/classical", "hydrogel 1.12", r[1].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/classical", "hydrogel 1.65", r[2].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "curve_moves_when_twice_as_fast", "hydrogel 1.12", difference(&r[1], &r[5]), CPL_AT_MOST, 0.02);
  cpl_verify_measure(v, "kinetic/work", "hydrogel 1.12", r[1].fastest, CPL_NO_LIMIT, 0);
  return TDM_OK;
}

tdm_status scn_multi_rubber(cpl_verify *v, tdm_error *err) {
  static const stroke s[] = {
      {"rubber classical", BALLS, SCN_RUBBER, SCN_CLASSICAL, 0, 0.28, 4, 5e-5, true},
      {"rubber mc-strain 0.55", BALLS, SCN_RUBBER, SCN_STRAIN, 0.55, 0.28, 4, 5e-5, true},
      {"rubber mc-stress 1.71", BALLS, SCN_RUBBER, SCN_STRESS, 1.71, 0.28, 4, 5e-5, true},
      {"rubber mc-strain 1.12", BALLS, SCN_RUBBER, SCN_STRAIN, 1.12, 0.28, 4, 5e-5, true},
      {"rubber mc-stress 1.65", BALLS, SCN_RUBBER, SCN_STRESS, 1.65, 0.28, 4, 5e-5, true},
      {"rubber mc-stress 1.71, twice as fast", BALLS, SCN_RUBBER, SCN_STRESS, 1.71, 0.28, 2, 5e-5, true},
  };
  enum { N = sizeof s / sizeof *s };
  result r[N];
  if (strokes(v, "rubber", "514 rubber balls to 28 %", s, N, r, err) != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "strain/classical", "rubber 0.55", r[1].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/classical", "rubber 1.71", r[2].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/strain", "rubber 1.71, 0.55", r[2].end / r[1].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "curve_moves_when_twice_as_fast", "rubber 1.71", difference(&r[2], &r[5]), CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "stress/strain", "rubber 1.65, 1.12", r[4].end / r[3].end, CPL_NO_LIMIT, 0);
  return TDM_OK;
}

/* a bed with the classical law, mc-strain, mc-stress, and the last twice as fast */
static tdm_status three_laws(cpl_verify *v, const char *name, const char *title, const stroke s[4], tdm_error *err) {
  result r[4];
  if (strokes(v, name, title, s, 4, r, err) != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "strain/classical", name, r[1].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/classical", name, r[2].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/strain", name, r[2].end / r[1].end, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "curve_moves_when_twice_as_fast", name, difference(&r[2], &r[3]), CPL_NO_LIMIT, 0);
  return TDM_OK;
}

tdm_status scn_multi_mixture(cpl_verify *v, tdm_error *err) {
  static const stroke s[] = {
      {"mixture classical", MIXTURE, SCN_HYDROGEL, SCN_CLASSICAL, 0, 0.102, 4, 1e-4, true},
      {"mixture mc-strain 1.12", MIXTURE, SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.102, 4, 1e-4, true},
      {"mixture mc-stress 1.65", MIXTURE, SCN_HYDROGEL, SCN_STRESS, 1.65, 0.102, 4, 1e-4, true},
      {"mixture mc-stress 1.65, twice as fast", MIXTURE, SCN_HYDROGEL, SCN_STRESS, 1.65, 0.102, 2, 1e-4, true},
  };
  return three_laws(v, "mixture", "1573 and 348 hydrogel balls to 10.2 %", s, err);
}

tdm_status scn_multi_glass(cpl_verify *v, tdm_error *err) {
  static const stroke s[] = {
      {"glass classical", BEADS, SCN_GLASS, SCN_CLASSICAL, 0, 0.0264, 0.1, 2e-7, true},
      {"glass mc-strain 4.5", BEADS, SCN_GLASS, SCN_STRAIN, 4.5, 0.0264, 0.1, 2e-7, true},
      {"glass mc-stress 5.17", BEADS, SCN_GLASS, SCN_STRESS, 5.17, 0.0264, 0.1, 2e-7, true},
      {"glass mc-stress 5.17, twice as fast", BEADS, SCN_GLASS, SCN_STRESS, 5.17, 0.0264, 0.05, 2e-7, true},
  };
  return three_laws(v, "glass", "17 glass beads to 2.64 %", s, err);
}

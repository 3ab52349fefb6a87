/* [G21] Section 4: 514 balls in a box pressed together by a plate and let go (Fig. 11, 15), hydrogel and rubber, with
 * the classical law, mc-strain and mc-stress; and LIGGGHTS' own example of the same bed. The scene is hydrogel.json; a
 * stroke is half a cosine, so the plate begins and ends at rest. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"
#include "scenarios/table.h"

#include "dem/watch/energy_balance.h"
#include "protocol/parameters/load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLES = 200 };

typedef struct {
  const char *name;
  int material, law;
  double factor, strain, period, dt; /* period: down and up again */
  bool half;                         /* the way down only */
} stroke;

typedef struct {
  double peak;           /* largest force on the plate [N] */
  double end;            /* at the largest strain [N] */
  double loop;           /* work that is not given back, share of that put in */
  double force[SAMPLES]; /* over the strain, on the way down, at k/SAMPLES of it */
  double fastest;        /* kinetic energy at most, share of the work put in */
} result;

/* the section dem of the scene for a stroke; NULL and an error */
static json_t *section(cpl_verify *v, const stroke *s, tdm_error *err) {
  char file[4096], strain[64], period[64];
  if (cpl_verify_find_file(v, "multicontact/hydrogel.json", file, sizeof file, err))
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

/* the plate is body 0; strain and force now */
static double strain_of(const scn_rig *rig, double height) {
  return (height - rig->data->state.pose[0].position.z) / height;
}

static tdm_status run(cpl_verify *v, const stroke *s, FILE *f, int number, result *out, tdm_error *err) {
  const double height = 0.167, area = 0.165 * 0.165;
  json_t *dem = section(v, s, err);
  char *text = dem ? json_dumps(dem, JSON_REAL_PRECISION(17)) : NULL;
  json_decref(dem);
  *out = (result){0};
  if (!text)
    return err->status ? err->status : tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a scene");
  scn_rig rig;
  double put = 0, back = 0, before = 0, at = 0, fastest = 0;
  const long steps = lround(s->period / s->dt * (s->half ? 0.5 : 1));
  if (scn_rig_open(&rig, v, s->dt, err, "%s", text) == TDM_OK)
    for (long k = 1; k <= steps && scn_rig_steps(&rig, 1, err) == TDM_OK; k++) {
      const double force = rig.data->state.body_load[0].force.z, strain = strain_of(&rig, height);
      const double work = 0.5 * (force + before) * height * (strain - at);
      *(work > 0 ? &put : &back) += work;
      out->peak = fmax(out->peak, force);
      if (2 * k <= steps * (s->half ? 2 : 1)) {
        for (int q = (int)ceil(at / s->strain * SAMPLES); q < SAMPLES && q <= strain / s->strain * SAMPLES; q++)
          out->force[q] = force;
        out->end = force;
      }
      if (k % (steps / 400) == 0) {
        fastest = fmax(fastest, scn_rig_kinetic(&rig));
        fprintf(f, "%.9g,%.9g,%.9g,%d\n", strain, force / area, force, number);
      }
      before = force, at = strain;
    }
  fputs("\n\n", f);
  out->loop = put > 0 ? 1 + back / put : NAN;
  out->fastest = fastest / put;
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
  if (err->status == TDM_OK)
    plot(v, name, title, s, n);
  return err->status;
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
      {"hydrogel classical", SCN_HYDROGEL, SCN_CLASSICAL, 0, 0.134, 4, 1e-4, false},
      {"hydrogel mc-strain 1.12", SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.134, 4, 1e-4, false},
      {"hydrogel mc-stress 1.65", SCN_HYDROGEL, SCN_STRESS, 1.65, 0.134, 4, 1e-4, false},
      {"hydrogel mc-strain 1", SCN_HYDROGEL, SCN_STRAIN, 1, 0.134, 4, 1e-4, false},
      {"hydrogel mc-stress 1", SCN_HYDROGEL, SCN_STRESS, 1, 0.134, 4, 1e-4, false},
      {"hydrogel mc-strain 1.12, twice as fast", SCN_HYDROGEL, SCN_STRAIN, 1.12, 0.134, 2, 1e-4, true},
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
      {"rubber classical", SCN_RUBBER, SCN_CLASSICAL, 0, 0.28, 4, 5e-5, true},
      {"rubber mc-strain 0.55", SCN_RUBBER, SCN_STRAIN, 0.55, 0.28, 4, 5e-5, true},
      {"rubber mc-stress 1.71", SCN_RUBBER, SCN_STRESS, 1.71, 0.28, 4, 5e-5, true},
      {"rubber mc-strain 1.12", SCN_RUBBER, SCN_STRAIN, 1.12, 0.28, 4, 5e-5, true},
      {"rubber mc-stress 1.65", SCN_RUBBER, SCN_STRESS, 1.65, 0.28, 4, 5e-5, true},
  };
  enum { N = sizeof s / sizeof *s };
  result r[N];
  if (strokes(v, "rubber", "514 rubber balls to 28 %", s, N, r, err) != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "strain/classical", "rubber 0.55", r[1].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/classical", "rubber 1.71", r[2].end / r[0].end, CPL_AT_LEAST, 1);
  cpl_verify_measure(v, "stress/strain", "rubber 1.71, 0.55", r[2].end / r[1].end, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "stress/strain", "rubber 1.65, 1.12", r[4].end / r[3].end, CPL_NO_LIMIT, 0);
  return TDM_OK;
}

tdm_status scn_multi_liggghts(cpl_verify *v, tdm_error *err) {
  static const stroke s[] = {
      {"liggghts classical", SCN_HYDROGEL, SCN_CLASSICAL, 0, 0.18, 4, 1e-4, true},
      {"liggghts mc-strain 1.125", SCN_HYDROGEL, SCN_STRAIN, 1.125, 0.18, 4, 1e-4, true},
  };
  enum { N = sizeof s / sizeof *s };
  result r[N];
  if (strokes(v, "liggghts", "LIGGGHTS' hydrogel example, strain 18 %", s, N, r, err) != TDM_OK)
    return err->status;
  cpl_verify_measure(v, "off_6.69_N", "liggghts classical", r[0].peak / 6.69 - 1, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "off_15.49_N", "liggghts mc-strain", r[1].peak / 15.49 - 1, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "strain/classical", "liggghts", r[1].peak / r[0].peak, CPL_NO_LIMIT, 0);
  return TDM_OK;
}

/* Support for the tests of contacts that act on each other: scenes of one material, Hertz's force, runs side by side.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_MULTI_SUPPORT_H
#define TEST_MULTI_SUPPORT_H

#include "protocol/math/random.h"
#include "test_dem_support.h"

static const double radius = 0.01, young = 23300, poisson = 0.46;
#define VOLUME (4.0 / 3 * M_PI * radius * radius * radius)

/* one material of particles and walls; %s: poisson ratio, keys of the pair, keys of contact, what there is */
#define SCENE                                                                                                \
  "{'gravity':[0,0,0],%s'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':%s}]," \
  "'pairs':[{'materials':['a','a'],%s}],'contact':{%s},%s}"

static inline rig *make(const char *more, const char *nu, const char *pair, const char *contact, const char *there,
                        double dt) {
  return rig_make(scene_json(SCENE, more, nu, pair, contact, there), dt, 0, NULL);
}

/* "particles": a lattice of nx, ny, nz spheres from the origin on; `more`: further entries */
static inline const char *lattice(const int n[3], double spacing, const char *more) {
  static char text[400000];
  size_t at =
      (size_t)snprintf(text, sizeof text, "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[");
  for (int k = 0; k < n[0] * n[1] * n[2]; k++)
    at += (size_t)snprintf(text + at, sizeof text - at, "%s[%.17g,%.17g,%.17g]", k > 0 ? "," : "", spacing * (k % n[0]),
                           spacing * (k / n[0] % n[1]), spacing * (k / n[0] / n[1]));
  snprintf(text + at, sizeof text - at, "]}%s]", more);
  return text;
}

static inline double hertz(double effective_radius, double overlap) {
  double effective_young = young / (2 * (1 - poisson * poisson));
  return 4.0 / 3 * effective_young * sqrt(effective_radius * overlap) * overlap;
}

#define ELASTIC "'restitution':1"
#define FREE "'tangential':'none'"

/* Steps that leave both with the same bits, and an end of both. */
static inline void ck_same_run(rig *a, rig *b, long steps) {
  size_t n = (size_t)a->data->state.nparticle;
  for (long k = 0; k < steps; k++) {
    rig_steps(a, 1);
    rig_steps(b, 1);
    ck_assert_mem_eq(a->data->state.sphere, b->data->state.sphere, n * sizeof *a->data->state.sphere);
    ck_assert_mem_eq(a->data->state.rotor, b->data->state.rotor, n * sizeof *a->data->state.rotor);
  }
  rig_free(a);
  rig_free(b);
}

/* 514 of several sizes, pressed together and into two walls */
static inline rig *heap(const char *more, const char *law, double factor, double dt) {
  json_t *scene = scene_json(
      "{'gravity':[0,0,0],%s'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':0.46}],"
      "'pairs':[{'materials':['a','a'],'restitution':1,%s:%.17g}],'contact':{'tangential':'none',%s},"
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-0.0095]},"
      "{'type':'plane','normal':[1,0,0],'point':[-0.0095,0,0]}]}],'particles':[]}",
      more, strstr(law, "strain") ? "'gamma'" : "'beta'", factor, law);
  json_t *all = json_object_get(scene, "particles");
  for (int i = 0; i < 514; i++) {
    double x[3];
    const int at[] = {i % 8, i / 8 % 8, i / 64};
    for (int a = 0; a < 3; a++)
      x[a] = 0.0193 * at[a] + 0.001 * (tdm_random(3, (uint64_t)i, (uint64_t)a) - 0.5);
    json_array_append_new(all,
                          json_pack("{s:s, s:s, s:f, s:[[f,f,f]], s:[f,f,f]}", "type", "list", "material", "a",
                                    "radius", 0.0095 + 0.001 * tdm_random(3, (uint64_t)i, 7), "positions", x[0], x[1],
                                    x[2], "velocity", 0.1 * sin(3.0 * i), 0.1 * cos(5.0 * i), 0.1 * sin(7.0 * i)));
  }
  return rig_make(scene, dt, 0, NULL);
}

#endif

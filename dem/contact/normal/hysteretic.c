/* Normal law hysteretic: [A07] Eq. 2.41-2.49. Loading on slope k_l, unloading and reloading on k_un, down to the
 * adhesive line:
 *   F = max(k_un (delta - delta_0), -k_ad delta),   delta_0 = (1 - k_l/k_un) delta_max
 *
 * History: delta_max. It grows with delta; on the adhesive line it shrinks so that delta_0 = delta (1 + k_ad/k_un), so
 * reloading from there climbs on slope k_un. While settling a contact keeps its unloading stiffness unless dem.settle
 * names a restitution: its history would mean another force with another one.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/contact.h"
#include "dem/contact/law/law.h"

/* of pair.normal; pair.stiffness is k_l */
enum {
  UNLOADING, /* k_un [N/m] */
  PLASTIC,   /* delta_0/delta_max = 1 - k_l/k_un */
  ADHESION   /* k_ad [N/m] */
};

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  vd unloading = DEM_OF(c, normal[UNLOADING]), line = -DEM_OF(c, normal[ADHESION]) * c->overlap,
     plastic = DEM_OF(c, normal[PLASTIC]);
  vd deepest = vd_max(history[0], c->overlap);
  vd branch = unloading * (c->overlap - plastic * deepest);
  vm adhesive = vm_less(branch, line);
  history[0] = vd_pick(adhesive, (c->overlap - line / unloading) / plastic, deepest);
  c->force = vd_pick(adhesive, line, branch);
  c->stiffness = unloading;
  c->damping = vd_sqrt(c->stiffness / c->inverse_mass);
  c->elastic = vd_set(0.5) * c->force * c->force / unloading;
}

#define DEM_LAW hysteretic
#define DEM_LAW_KERNEL kernel
#define DEM_LAW_COLUMNS 1
#include "dem/contact/loop/loops.h"

#if DEM_SIMD == 0

static tdm_status damp(const dem_model *m, dem_pair *p) {
  (void)m;
  p->normal[UNLOADING] = p->stiffness / (p->restitution * p->restitution);
  p->normal[PLASTIC] = 1 - p->stiffness / p->normal[UNLOADING];
  return TDM_OK;
}

static void read(const dem_model *m, tdm_object *o, dem_pair *p) {
  double *of = p->normal;
  p->stiffness = dem_need(o, "stiffness", "normal", "hysteretic", TDM_POSITIVE);
  if (dem_one_of(o, "restitution", "unloading_stiffness", "hysteretic"))
    dem_read_restitution(m, o, p);
  else
    of[UNLOADING] = tdm_get_number(o, "unloading_stiffness", TDM_REQUIRED, TDM_POSITIVE);
  if (of[UNLOADING] < p->stiffness)
    tdm_object_fail(o, "unloading_stiffness", "is %g N/m but must be at least the stiffness %g N/m", of[UNLOADING],
                    p->stiffness);
  of[PLASTIC] = 1 - p->stiffness / of[UNLOADING];
  of[ADHESION] = tdm_get_number(o, "adhesion_stiffness", 0, TDM_NOT_NEGATIVE);
}

/* ---- closed forms ---- */

/* [A07] Eq. 2.45, without adhesion */
static double time_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return M_PI / 2 * (sqrt(i.mass / p->stiffness) + sqrt(i.mass / p->normal[UNLOADING]));
}

static double overlap_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return i.speed * sqrt(i.mass / p->stiffness);
}

/* what is left after unloading to delta_0, over the tip at delta_ad ([A07] Eq. 2.49) and along the adhesive line */
static double restitution_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m, (void)i;
  double share = p->stiffness / p->normal[UNLOADING], open = 1 - share; /* epsilon^2; delta_0/delta_max */
  double tip = open * p->stiffness / (p->stiffness + share * p->normal[ADHESION]);
  double left = share - p->normal[ADHESION] * tip * open / p->stiffness;
  return left > 0 ? sqrt(left) : 0;
}

static double force_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m;
  double branch = p->normal[UNLOADING] * (overlap - p->normal[PLASTIC] * fmax(i.deepest, overlap));
  return fmax(branch, -p->normal[ADHESION] * overlap);
}

static double stiffness_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m, (void)i, (void)overlap;
  return p->normal[UNLOADING];
}

static double elastic_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  double force = force_of(m, p, i, overlap);
  return 0.5 * force * force / p->normal[UNLOADING];
}

const dem_normal_law dem_normal_hysteretic = {
    .head = {.name = "hysteretic",
             .ncolumn = DEM_LAW_COLUMNS,
             .keys = {{.name = "stiffness", .example = 1e4},
                      {.name = "unloading_stiffness"},
                      {.name = "adhesion_stiffness"}}},
    .plastic = true,
    .keeps_deepest = true,
    .settles_as_it_is = true,
    .tangential = "spring",
    .why_not_clip = "which has no damping: only adhesion_stiffness attracts",
    .read = read,
    .damp = damp,
    .time = time_of,
    .overlap = overlap_of,
    .restitution = restitution_of,
    .force = force_of,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = DEM_LAW_LOOPS,
};
#endif

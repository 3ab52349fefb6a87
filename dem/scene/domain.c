/* Reading the space that particles have: the box dem.domain, and two dimensions. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/scene/keys.h"

#include <stdio.h>

static const char axes[3][2] = {"x", "y", "z"};

void dem_domain_read(dem_model *m, tdm_object *section) {
  static const char *const kinds[] = {"open", "periodic"};
  dem_domain_def *box = &m->domain;
  box->wanted = tdm_has(section, "domain");
  if (!box->wanted)
    return;
  tdm_object o = tdm_get_object(section, "domain", true);
  tdm_vec3 low = tdm_get_vec3(&o, "min", NULL), high = tdm_get_vec3(&o, "max", NULL);
  tdm_vec3 rate = tdm_get_vec3(&o, "strain_rate", &(tdm_vec3){0, 0, 0});
  for (int a = 0; a < 3; a++) {
    box->periodic[a] = tdm_get_choice(&o, axes[a], kinds, 2, 0) == 1;
    box->repeats = box->repeats || box->periodic[a];
    box->open = box->open || !box->periodic[a];
    box->low[a] = (&low.x)[a];
    box->length[a] = (&high.x)[a] - (&low.x)[a];
    box->rate[a] = (&rate.x)[a];
    box->strained = box->strained || box->rate[a] != 0;
    if (!(box->length[a] > 0))
      tdm_object_fail(&o, "max", "is %g m in %s but must be greater than min, %g m", (&high.x)[a], axes[a],
                      box->low[a]);
    if (box->rate[a] != 0 && !box->periodic[a])
      tdm_object_fail(&o, "strain_rate", "is %g 1/s in %s, which is open; only periodic directions can be strained",
                      box->rate[a], axes[a]);
  }
  tdm_object_close(&o);
}

static void check_planes(const dem_model *m, int axis, tdm_error *err) {
  for (int w = 0; w < m->nwall; w++) {
    const dem_body *body = &m->body[m->wall[w].body];
    tdm_vec3 n = tdm_quat_rotate(body->start.pose.orientation, m->wall[w].normal);
    if (m->wall[w].shape->half_space && fabs((&n.x)[axis]) > 1e-12)
      tdm_fail(err, TDM_ERR_SCENE, "dem.domain",
               "is periodic in %s, across which a plane of \"%s\" stands (normal [%g, %g, %g]); remove the plane, or "
               "make %s open",
               axes[axis], body->name, n.x, n.y, n.z, axes[axis]);
  }
}

/* a source from which everything would leave at once */
static void check_sources(const dem_model *m, tdm_error *err) {
  const dem_domain_def *box = &m->domain;
  for (int s = 0; s < m->nsource && !err->status; s++)
    for (int a = 0; a < 3; a++) {
      double low = (&m->source[s].low.x)[a], high = (&m->source[s].high.x)[a], end = box->low[a] + box->length[a];
      char path[TDM_PATH_MAX];
      snprintf(path, sizeof path, "dem.sources[%d]", s);
      if (!box->periodic[a] && a != m->flat && (high < box->low[a] || low > end)) {
        tdm_fail(err, TDM_ERR_SCENE, path,
                 "\"%s\" is outside dem.domain in %s (%g to %g m; the box is from %g to %g m), so that its particles "
                 "would leave at once; move one of them",
                 m->source[s].name, axes[a], low, high, box->low[a], end);
        return;
      }
    }
}

void dem_domain_check(const dem_model *m, double largest_radius, tdm_error *err) {
  const dem_domain_def *box = &m->domain;
  double skin = m->skin > 0 ? m->skin : 0.05 * m->mean_radius;
  double least = 2 * (2 * largest_radius + skin), t = fmax(0, m->time_end - m->time_start);
  for (int a = 0; a < 3 && !err->status; a++) {
    if (!box->periodic[a])
      continue;
    double last = box->length[a] * (1 + box->rate[a] * t);
    if (!(fmin(box->length[a], last) >= least))
      tdm_fail(err, TDM_ERR_SCENE, "dem.domain",
               "is %g m wide in %s (%g m at the end of the run) but a periodic direction needs at least twice the "
               "largest diameter and dem.skin (%g m), %g m; make it wider",
               box->length[a], axes[a], last, skin, least);
    check_planes(m, a, err);
  }
  if (box->wanted)
    check_sources(m, err);
}

void dem_read_dimension(dem_model *m, tdm_object *section) {
  static const char *const planes[] = {"yz", "xz", "xy"}; /* by the axis that is left out */
  long dimension = tdm_get_integer(section, "dimension", 3, 2);
  if (dimension > 3)
    tdm_object_fail(section, "dimension", "is %ld; give 3, or 2 for particles in a plane", dimension);
  m->flat = -1;
  static const char *const keys[] = {"plane", "plane_at"};
  for (int k = 0; k < 2 && dimension != 2; k++)
    if (tdm_has(section, keys[k]))
      tdm_object_fail(section, keys[k], "is for \"dimension\": 2 only; remove it, or give that");
  if (dimension != 2)
    return;
  m->driven = true;
  m->flat = tdm_get_choice(section, "plane", planes, 3, 1);
  m->flat_at = tdm_get_number(section, "plane_at", 0, TDM_ANY);
}

/* Colours of particles: see color.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/color.h"

#include <stdio.h>
#include <stdlib.h>

/* viridis (S. van der Walt and N. Smith for matplotlib, public domain by CC0), at eighths */
static const tdm_rgb viridis[] = {{68, 1, 84},    {71, 44, 122}, {59, 81, 139},  {44, 113, 142}, {33, 144, 141},
                                  {39, 173, 129}, {92, 200, 99}, {170, 220, 50}, {253, 231, 37}};
enum { STEPS = sizeof viridis / sizeof viridis[0] - 1 };

/* kinds next to each other differ in hue and in brightness; after Okabe and Ito (2008), Color Universal Design */
static const tdm_rgb kinds[] = {{0, 114, 178},  {230, 159, 0}, {0, 158, 115},  {204, 121, 167},
                                {86, 180, 233}, {213, 94, 0},  {240, 228, 66}, {90, 70, 140}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

tdm_rgb tdm_color_map(double s) {
  double x = STEPS * fmin(1, fmax(0, isnan(s) ? 0 : s));
  int k = x >= STEPS ? STEPS - 1 : (int)x;
  double f = x - k;
  const tdm_rgb *a = &viridis[k], *b = &viridis[k + 1];
  return (tdm_rgb){(uint8_t)(a->r + f * (b->r - a->r) + 0.5), (uint8_t)(a->g + f * (b->g - a->g) + 0.5),
                   (uint8_t)(a->b + f * (b->b - a->b) + 0.5)};
}

tdm_rgb tdm_color_of_kind(int kind) {
  return kind < 0 ? (tdm_rgb){150, 150, 150} : kinds[kind % KINDS];
}

int tdm_color_count(tdm_color color, const tdm_snapshot *s) {
  return tdm_color_of_contacts(color) ? s->ncontact : s->nparticle;
}

bool tdm_color_has_kinds(tdm_color color) {
  return color == TDM_COLOR_material || color == TDM_COLOR_size_class;
}

int tdm_color_kinds(tdm_color color, const tdm_scenery *s) {
  return color == TDM_COLOR_material ? s->nmaterial : s->nedge > 0 ? s->nedge + 1 : 0;
}

const char *tdm_color_kind_name(tdm_color color, const tdm_scenery *s, int kind, char *out, size_t size) {
  if (color == TDM_COLOR_material)
    snprintf(out, size, "%s", kind < s->nmaterial ? s->material[kind].name : "?");
  else if (kind < 0)
    snprintf(out, size, "none");
  else if (kind == 0)
    snprintf(out, size, "r < %g m", s->edge[0]);
  else if (kind < s->nedge)
    snprintf(out, size, "%g to %g m", s->edge[kind - 1], s->edge[kind]);
  else
    snprintf(out, size, "r \xe2\x89\xa5 %g m", s->edge[s->nedge - 1]);
  return out;
}

double tdm_color_value(tdm_color color, const tdm_snapshot *s, int i, const tdm_camera *camera, tdm_vec3 up) {
  switch (color) {
  case TDM_COLOR_speed:
    return tdm_norm(s->velocity[i]);
  case TDM_COLOR_id:
    return (double)s->id[i];
  case TDM_COLOR_radius:
    return s->radius[i];
  case TDM_COLOR_material:
    return s->material[i];
  case TDM_COLOR_height0:
    return tdm_dot(s->born[i], camera->flat ? camera->up : up);
  case TDM_COLOR_across0:
    return tdm_dot(s->born[i], camera->right);
  case TDM_COLOR_force:
    return tdm_norm(s->force[i]);
  case TDM_COLOR_size_class:
    return s->size_class[i];
  case TDM_COLOR_contact_force:
    return s->contact[i].force;
  case TDM_COLOR_COUNT:
    break;
  }
  return 0;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

tdm_status tdm_color_widen(double range[2], tdm_color color, const tdm_snapshot *s, const tdm_camera *camera,
                           tdm_vec3 up, tdm_error *err) {
  const int count = tdm_color_count(color, s);
  double *value = malloc(((size_t)count + 1) * sizeof *value);
  int n = 0;
  if (!value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the colours of %d particles or contacts", count);
  for (int i = 0; i < count; i++) {
    value[n] = tdm_color_value(color, s, i, camera, up);
    n += isfinite(value[n]);
  }
  const bool forces = color == TDM_COLOR_force || color == TDM_COLOR_contact_force;
  if (forces) {
    qsort(value, (size_t)n, sizeof *value, ascending);
    n -= n / 100;
  }
  for (int i = 0; i < n; i++) {
    range[0] = fmin(range[0], value[i]);
    range[1] = fmax(range[1], value[i]);
  }
  if (n > 0 && (color == TDM_COLOR_speed || forces))
    range[0] = fmin(range[0], 0);
  free(value);
  return TDM_OK;
}

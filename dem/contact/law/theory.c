/* Closed forms of normal impacts: see theory.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/theory.h"

#include <math.h>

/* ---- Hertz ---- */

double dem_contact_time(double mass, double radius, double young, double speed) {
  /* 4 sqrt(pi) Gamma(2/5) / (5 Gamma(9/10)) (15/16)^(2/5) */
  return 2.8682656992 * pow(mass * mass / (radius * young * young * speed), 0.2);
}

/* ---- by the scene's laws ---- */

double dem_normal_contact_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  return dem_normal_of(m, p)->time(m, p, i);
}

double dem_normal_step_time(const dem_model *m, const dem_pair *p, dem_impact i) {
  const dem_normal_law *law = dem_normal_of(m, p);
  return law->step_time ? law->step_time(m, p, i) : law->time(m, p, i);
}

double dem_normal_overlap(const dem_model *m, const dem_pair *p, dem_impact i) {
  return dem_normal_of(m, p)->overlap(m, p, i);
}

double dem_normal_restitution(const dem_model *m, const dem_pair *p, dem_impact i) {
  return dem_normal_of(m, p)->restitution(m, p, i);
}

double dem_normal_force(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return dem_normal_of(m, p)->force(m, p, i, overlap);
}

double dem_normal_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return dem_normal_of(m, p)->stiffness(m, p, i, overlap);
}

double dem_normal_elastic(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return dem_normal_of(m, p)->elastic(m, p, i, overlap);
}

double dem_tangential_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return m->tangential->stiffness ? m->tangential->stiffness(m, p, i, overlap) : 0;
}

double dem_rolling_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return m->rolling->stiffness ? m->rolling->stiffness(m, p, i, overlap) : 0;
}

double dem_twisting_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  return m->twisting->stiffness ? m->twisting->stiffness(m, p, i, overlap) : 0;
}

/* ---- among others ---- */

double dem_stiffness_among(const struct dem_data *d, const dem_model *m, const dem_among *c) {
  return m->multi->stiffness ? m->multi->stiffness(d, c) : dem_normal_stiffness(m, c->pair, c->at, c->overlap);
}

double dem_elastic_among(const struct dem_data *d, const dem_model *m, const dem_among *c) {
  return m->multi->elastic ? m->multi->elastic(d, c) : dem_normal_elastic(m, c->pair, c->at, c->overlap);
}

double dem_overlap_among(const struct dem_data *d, const dem_model *m, const dem_among *c) {
  return m->multi->overlap ? m->multi->overlap(d, c) : c->overlap;
}

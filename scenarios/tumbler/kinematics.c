/* The tumbler screening machine's motion: see kinematics.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/tumbler/kinematics.h"

#include <math.h>
#include <stdbool.h>

/* ---- closed form ---- */

static tdm_mat3 about_x(double a) {
  const double c = cos(a), s = sin(a);
  return (tdm_mat3){{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
}

static tdm_mat3 about_y(double a) {
  const double c = cos(a), s = sin(a);
  return (tdm_mat3){{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
}

static tdm_mat3 about_z(double a) {
  const double c = cos(a), s = sin(a);
  return (tdm_mat3){{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
}

/* A turns with the angular velocity w of its frame: dA = -A [w]. */
static void set_rate(scn_tumbler_frame *f) {
  const tdm_mat3 turn = tdm_m3_mat(f->A, tdm_m3_skew(f->w));
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      f->dA.m[i][j] = -turn.m[i][j];
}

/* From axes of the holder to those of the plate: Eq. (4.17) at t = 0. */
static tdm_mat3 tilt(const scn_tumbler *m) {
  return tdm_m3_mat(about_y(-m->beta), about_x(-m->alpha));
}

/* c in axes of the holder: a point of the plate at (-u, e, 0) from it is the holder's (u, eccentricity - e, 0). */
static tdm_vec3 foot(const scn_tumbler *m) {
  return tdm_sub(tdm_v3(m->u, m->eccentricity - m->e, 0), tdm_m3_tmul(tilt(m), tdm_v3(m->u, -m->e, 0)));
}

scn_tumbler_frame scn_tumbler_holder(const scn_tumbler *m, double t) {
  scn_tumbler_frame f = {.A = about_z(-m->omega * t), .w = {0, 0, m->omega}};
  set_rate(&f);
  return f;
}

scn_tumbler_frame scn_tumbler_plate(const scn_tumbler *m, double t) {
  return scn_tumbler_barrel(m, t, m->omega * t, m->omega);
}

scn_tumbler_frame scn_tumbler_barrel(const scn_tumbler *m, double t, double psi, double rate) {
  const tdm_vec3 turning = {0, 0, m->omega};
  scn_tumbler_frame f = {.r = tdm_m3_mul(about_z(m->omega * t), foot(m))};
  f.A = tdm_m3_mat(about_z(m->omega * t - psi), tdm_m3_mat(tilt(m), about_z(-m->omega * t)));
  f.v = tdm_cross(turning, f.r);
  f.w = tdm_axpy(rate - m->omega, tdm_m3_tmul(f.A, tdm_v3(0, 0, 1)), turning);
  set_rate(&f);
  return f;
}

void scn_tumbler_triangle(double omega_b, double period, double t, double *psi, double *rate) {
  const double s = t - floor(t / period) * period;
  const bool up = s <= 0.5 * period;
  *psi = omega_b * (up ? s : period - s);
  *rate = up ? omega_b : -omega_b;
}

tdm_vec3 scn_tumbler_relative_place(const scn_tumbler_frame *f, tdm_vec3 place) {
  return tdm_m3_mul(f->A, tdm_sub(place, f->r));
}

tdm_vec3 scn_tumbler_relative_velocity(const scn_tumbler_frame *f, tdm_vec3 place, tdm_vec3 velocity) {
  return tdm_add(tdm_m3_mul(f->A, tdm_sub(velocity, f->v)), tdm_m3_mul(f->dA, tdm_sub(place, f->r)));
}

/* ---- as printed ---- */

/* the symbols of the equations */
#define SYMBOLS                                                                                                 \
  const double u = m->u, e = m->e, ecc = m->eccentricity, w = m->omega, sa = sin(m->alpha), ca = cos(m->alpha), \
               sb = sin(m->beta), cb = cos(m->beta), s = sin(w * t), c = cos(w * t);                            \
  (void)u, (void)e, (void)ecc, (void)sa, (void)ca, (void)sb, (void)cb, (void)s, (void)c

tdm_vec3 scn_tumbler_eq_4_1(const scn_tumbler *m, double t) {
  SYMBOLS;
  return tdm_v3(u * c - u * c * cb + e * s - ecc * s + u * s * sa * sb - e * s * ca,
                u * s - u * s * cb - e * c + ecc * c - u * c * sa * sb + e * c * ca, u * sb * ca + e * sa);
}

tdm_mat3 scn_tumbler_eq_4_3(const scn_tumbler *m, double t, double omega_b) {
  SYMBOLS;
  const double S = sin((omega_b - w) * t), C = cos((omega_b - w) * t);
  return (tdm_mat3){
      {{C * c * cb - C * s * sa * sb - S * s * ca, C * s * cb + C * c * sa * sb + S * c * ca, -C * ca * sb + S * sa},
       {-S * c * cb + S * s * sa * sb - C * s * ca, -S * s * cb - S * c * sa * sb + C * c * ca, S * ca * sb + C * sa},
       {c * sb + s * sa * cb, s * sb - c * sa * cb, ca * cb}}};
}

tdm_mat3 scn_tumbler_eq_4_4(const scn_tumbler *m, double t) {
  SYMBOLS;
  return (tdm_mat3){{{c * cb - s * sa * sb, s * cb + c * sa * sb, -ca * sb},
                     {-s * ca, c * ca, sa},
                     {c * sb + s * sa * cb, s * sb - c * sa * cb, ca * cb}}};
}

tdm_mat3 scn_tumbler_eq_4_5(const scn_tumbler *m, double t) {
  SYMBOLS;
  return (tdm_mat3){
      {{c * c * cb - s * c * sa * sb + s * s * ca, s * c * cb + c * c * sa * sb - s * c * ca, -c * ca * sb - s * sa},
       {s * c * cb - s * s * sa * sb - s * c * ca, s * s * cb + s * c * sa * sb + c * c * ca, -s * ca * sb + c * sa},
       {c * sb + s * sa * cb, s * sb - c * sa * cb, ca * cb}}};
}

tdm_vec3 scn_tumbler_eq_4_11(const scn_tumbler *m, double t) {
  SYMBOLS;
  return tdm_scale(w, tdm_v3(-u * s + u * s * cb + e * c - ecc * c + u * c * sa * sb - e * c * ca,
                             u * c - u * c * cb + e * s - ecc * s + u * s * sa * sb - e * s * ca, 0));
}

tdm_mat3 scn_tumbler_eq_4_13(const scn_tumbler *m, double t, double omega_b) {
  SYMBOLS;
  const double d = omega_b - w, S = sin(d * t), C = cos(d * t);
  return (tdm_mat3){
      {{(-w * C * s - d * C * c) * cb - (w * C * c - d * S * s) * sa * sb - (w * S * c + d * C * s) * ca,
        (w * C * c - d * S * s) * cb + (-w * C * s - d * C * c) * sa * sb + (-w * S * s + d * C * c) * ca,
        d * S * ca * sb + d * C * sa},
       {-(-w * S * s + d * C * c) * cb + (w * S * c + d * C * s) * sa * sb - (w * C * c - d * S * s) * ca,
        -(w * S * c + d * C * s) * cb - (-w * S * s + d * C * c) * sa * sb + (-w * C * s - d * C * c) * ca,
        d * C * ca * sb - d * S * sa},
       {-w * s * sb + w * c * sa * cb, w * c * sb + w * s * sa * cb, 0}}};
}

tdm_mat3 scn_tumbler_eq_4_14(const scn_tumbler *m, double t) {
  SYMBOLS;
  return (tdm_mat3){{{w * (-s * cb - c * sa * sb), w * (c * cb - s * sa * sb), 0},
                     {-w * c * ca, -w * s * ca, 0},
                     {w * (-s * sb + c * sa * cb), w * (c * sb + s * sa * cb), 0}}};
}

tdm_mat3 scn_tumbler_eq_4_15(const scn_tumbler *m, double t) {
  SYMBOLS;
  const double s2 = sin(2 * w * t), c2 = cos(2 * w * t);
  return (tdm_mat3){
      {{-w * c2 * sa * sb + w * s2 * (ca - cb), -w * s2 * sa * sb - w * c2 * (ca - cb), w * s * ca * sb - w * c * sa},
       {-w * s2 * sa * sb - w * c2 * (ca - cb), w * c2 * sa * sb - w * s2 * (ca - cb), -w * c * ca * sb - w * s * sa},
       {-w * s * sb + w * c * sa * cb, w * c * sb + w * s * sa * cb, 0}}};
}

tdm_mat3 scn_tumbler_eq_4_19(const scn_tumbler *m, double t) {
  SYMBOLS;
  return (tdm_mat3){{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}};
}

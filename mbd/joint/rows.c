/* Constraint rows from which joints are built: see rows.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/rows.h"

#include <assert.h>
#include <string.h>

/* Clear the next row and return its index. */
static int next_row(mbd_rows *rows) {
  assert(rows->n < MBD_ROWS_MAX);
  int i = rows->n++;
  rows->g_t[i] = rows->g_tt[i] = 0;
  memset(rows->G[i], 0, sizeof rows->G[i]);
  if (rows->second)
    memset(rows->H[i], 0, sizeof rows->H[i]);
  return i;
}

/* g = (r_b + s_b) - (r_a + s_a);  gdot = v_b + w_b x s_b - v_a - w_a x s_a */
void mbd_rows_point(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 arm_a, tdm_vec3 arm_b) {
  const tdm_vec3 e[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tdm_vec3 g = tdm_sub(tdm_add(b->r, arm_b), tdm_add(a->r, arm_a));
  for (int k = 0; k < 3; k++) {
    int i = next_row(rows);
    rows->g[i] = tdm_dot(e[k], g);
    mbd_put3(rows->G[i] + MBD_RA, -1, e[k]);
    mbd_put3(rows->G[i] + MBD_TA, -1, tdm_cross(arm_a, e[k]));
    mbd_put3(rows->G[i] + MBD_RB, 1, e[k]);
    mbd_put3(rows->G[i] + MBD_TB, 1, tdm_cross(arm_b, e[k]));
    if (!rows->second)
      continue;
    /* d(s x e) = (dtheta x s) x e = [e][s] dtheta */
    mbd_put33(rows->H[i], MBD_TA, MBD_TA, -1, mbd_skew2(e[k], arm_a));
    mbd_put33(rows->H[i], MBD_TB, MBD_TB, 1, mbd_skew2(e[k], arm_b));
  }
}

/* g = a . b;  gdot = (w_b - w_a) . n with n = b x a */
void mbd_rows_perpendicular(mbd_rows *rows, tdm_vec3 of_a, tdm_vec3 of_b) {
  int i = next_row(rows);
  tdm_vec3 n = tdm_cross(of_b, of_a);
  rows->g[i] = tdm_dot(of_a, of_b);
  mbd_put3(rows->G[i] + MBD_TA, -1, n);
  mbd_put3(rows->G[i] + MBD_TB, 1, n);
  if (!rows->second)
    return;
  /* dn = [a][b] dtheta_b - [b][a] dtheta_a */
  tdm_mat3 by_b = mbd_skew2(of_a, of_b), by_a = mbd_skew2(of_b, of_a);
  mbd_put33(rows->H[i], MBD_TB, MBD_TB, 1, by_b);
  mbd_put33(rows->H[i], MBD_TB, MBD_TA, -1, by_a);
  mbd_put33(rows->H[i], MBD_TA, MBD_TB, -1, by_b);
  mbd_put33(rows->H[i], MBD_TA, MBD_TA, 1, by_a);
}

/* g = a . d with d = (r_b + s_b) - (r_a + s_a);  gdot = a . (v_b - v_a) + w_b . (s_b x a) - w_a . (u x a), u = d + s_a
 */
void mbd_rows_plane(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 of_a, tdm_vec3 arm_a, tdm_vec3 arm_b) {
  int i = next_row(rows);
  tdm_vec3 u = tdm_sub(tdm_add(b->r, arm_b), a->r);
  rows->g[i] = tdm_dot(of_a, tdm_sub(u, arm_a));
  mbd_put3(rows->G[i] + MBD_RA, -1, of_a);
  mbd_put3(rows->G[i] + MBD_TA, -1, tdm_cross(u, of_a));
  mbd_put3(rows->G[i] + MBD_RB, 1, of_a);
  mbd_put3(rows->G[i] + MBD_TB, 1, tdm_cross(arm_b, of_a));
  if (!rows->second)
    return;
  tdm_mat3 skew = tdm_m3_skew(of_a), skew_arm = mbd_skew2(of_a, arm_b);
  /* da = -[a] dtheta_a */
  mbd_put33(rows->H[i], MBD_RA, MBD_TA, 1, skew);
  mbd_put33(rows->H[i], MBD_RB, MBD_TA, -1, skew);
  /* d(s_b x a) = [a][s_b] dtheta_b - [s_b][a] dtheta_a */
  mbd_put33(rows->H[i], MBD_TB, MBD_TB, 1, skew_arm);
  mbd_put33(rows->H[i], MBD_TB, MBD_TA, -1, mbd_skew2(arm_b, of_a));
  /* d(u x a) = -[a](dr_b - dr_a) + [a][s_b] dtheta_b - [u][a] dtheta_a */
  mbd_put33(rows->H[i], MBD_TA, MBD_RB, 1, skew);
  mbd_put33(rows->H[i], MBD_TA, MBD_RA, -1, skew);
  mbd_put33(rows->H[i], MBD_TA, MBD_TB, -1, skew_arm);
  mbd_put33(rows->H[i], MBD_TA, MBD_TA, 1, mbd_skew2(u, of_a));
}

/* g = atan2(s, c) - angle with s = a2 . b1 - a1 . b2 and c = a1 . b1 + a2 . b2, twice the sine and cosine of the angle
 * for parallel axes. ds = S . d and dc = C . d with d = dtheta_b - dtheta_a, so dg = n . d, n = (c S - s C)/(s2 + c2),
 * which is the axis itself for parallel axes. */
void mbd_rows_angle(mbd_rows *rows, tdm_vec3 a1, tdm_vec3 a2, tdm_vec3 b1, tdm_vec3 b2, double angle) {
  int i = next_row(rows);
  double s = tdm_dot(a2, b1) - tdm_dot(a1, b2), c = tdm_dot(a1, b1) + tdm_dot(a2, b2), w = 1 / (s * s + c * c);
  tdm_vec3 S = tdm_sub(tdm_cross(b1, a2), tdm_cross(b2, a1)), C = tdm_add(tdm_cross(b1, a1), tdm_cross(b2, a2));
  tdm_vec3 n = tdm_scale(w, tdm_sub(tdm_scale(c, S), tdm_scale(s, C)));
  /* the angle between the pointers and where they should be: no wrap over turns */
  rows->g[i] = atan2(s * cos(angle) - c * sin(angle), c * cos(angle) + s * sin(angle));
  mbd_put3(rows->G[i] + MBD_TA, -1, n);
  mbd_put3(rows->G[i] + MBD_TB, 1, n);
  if (!rows->second)
    return;
  /* d(b x a) = [a][b] dtheta_b - [b][a] dtheta_a, which gives P dtheta_b - P^T dtheta_a in dn;
   * the factors s, c and w give D d */
  tdm_vec3 q = tdm_add(tdm_scale(s, S), tdm_scale(c, C));
  tdm_mat3 s1 = mbd_skew2(a2, b1), s2 = mbd_skew2(a1, b2), c1 = mbd_skew2(a1, b1), c2 = mbd_skew2(a2, b2), by_a, by_b;
  const double Sv[3] = {S.x, S.y, S.z}, Cv[3] = {C.x, C.y, C.z}, nv[3] = {n.x, n.y, n.z}, qv[3] = {q.x, q.y, q.z};
  for (int k = 0; k < 3; k++)
    for (int l = 0; l < 3; l++) {
      double P = c * (s1.m[k][l] - s2.m[k][l]) - s * (c1.m[k][l] + c2.m[k][l]);
      double Pt = c * (s1.m[l][k] - s2.m[l][k]) - s * (c1.m[l][k] + c2.m[l][k]);
      double D = Sv[k] * Cv[l] - Cv[k] * Sv[l] - 2 * nv[k] * qv[l];
      by_b.m[k][l] = w * (P + D);
      by_a.m[k][l] = -w * (Pt + D);
    }
  mbd_put33(rows->H[i], MBD_TB, MBD_TB, 1, by_b);
  mbd_put33(rows->H[i], MBD_TB, MBD_TA, 1, by_a);
  mbd_put33(rows->H[i], MBD_TA, MBD_TB, -1, by_b);
  mbd_put33(rows->H[i], MBD_TA, MBD_TA, -1, by_a);
}

/* g = |d| - L, e = d/|d|; G = e . d(d)/dq. dG adds (1 - e e^T)/|d| between the changes of d to the derivative of e . d,
 * which is that of a point row along the fixed direction e. */
void mbd_rows_distance(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 arm_a, tdm_vec3 arm_b,
                       double length) {
  int i = next_row(rows);
  tdm_vec3 d = tdm_sub(tdm_add(b->r, arm_b), tdm_add(a->r, arm_a)), e = tdm_unit(d);
  double l = tdm_norm(d);
  rows->g[i] = l - length;
  mbd_put3(rows->G[i] + MBD_RA, -1, e);
  mbd_put3(rows->G[i] + MBD_TA, -1, tdm_cross(arm_a, e));
  mbd_put3(rows->G[i] + MBD_RB, 1, e);
  mbd_put3(rows->G[i] + MBD_TB, 1, tdm_cross(arm_b, e));
  if (!rows->second || !(l > 0))
    return;
  /* dd = P dq with P = [-1 | [s_a] | 1 | -[s_b]] */
  const tdm_mat3 one = tdm_m3_identity(), sa = tdm_m3_skew(arm_a), sb = tdm_m3_skew(arm_b);
  double P[3][MBD_PAIR];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      P[r][MBD_RA + c] = -one.m[r][c];
      P[r][MBD_TA + c] = sa.m[r][c];
      P[r][MBD_RB + c] = one.m[r][c];
      P[r][MBD_TB + c] = -sb.m[r][c];
    }
  for (int r = 0; r < MBD_PAIR; r++)
    for (int c = 0; c < MBD_PAIR; c++) {
      double dot = P[0][r] * P[0][c] + P[1][r] * P[1][c] + P[2][r] * P[2][c];
      rows->H[i][r][c] += (dot - rows->G[i][r] * rows->G[i][c]) / l;
    }
  mbd_put33(rows->H[i], MBD_TA, MBD_TA, -1, mbd_skew2(e, arm_a));
  mbd_put33(rows->H[i], MBD_TB, MBD_TB, 1, mbd_skew2(e, arm_b));
}

static tdm_vec3 column(const tdm_mat3 *m, int k) {
  return tdm_v3(m->m[0][k], m->m[1][k], m->m[2][k]);
}

/* beta(x) = (1 - x/2 cot(x/2))/x^2 of the inverse of the left Jacobian of SO(3), and beta'(x)/x */
static void left_inverse(double x, double *beta, double *slope) {
  if (x < 0.05) {
    double x2 = x * x;
    *beta = 1.0 / 12 + x2 / 720 + x2 * x2 / 30240;
    *slope = 1.0 / 360 + x2 / 7560 + x2 * x2 / 201600;
    return;
  }
  double h = 0.5 * x, cot = 1 / tan(h), csc2 = 1 + cot * cot;
  *beta = (1 - h * cot) / (x * x);
  *slope = ((h * csc2 - cot) / 2 - 2 * x * *beta) / (x * x * x);
}

/* R = A^T B = exp([phi]), dphi = Jl^-1(phi) A^T (dtheta_b - dtheta_a), Jl^-1 = 1 - [phi]/2 + beta [phi]^2
 * (Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2, 2012, 10.3). Row k: n_k = A Jl^-T e_k and
 * dn_k = dtheta_a x n_k + A M_k dphi. */
void mbd_rows_rotation(mbd_rows *rows, tdm_mat3 triad_a, tdm_mat3 triad_b) {
  const tdm_vec3 e[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  tdm_mat3 At = tdm_m3_transpose(triad_a);
  tdm_vec3 phi = tdm_quat_to_rotvec(tdm_quat_from_matrix(tdm_m3_mat(At, triad_b)));
  const double g[3] = {phi.x, phi.y, phi.z};
  double beta, slope;
  left_inverse(tdm_norm(phi), &beta, &slope);
  tdm_mat3 cross = tdm_m3_skew(phi), cross2 = tdm_m3_mat(cross, cross), inverse_t, to_phi;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      inverse_t.m[i][j] = (i == j) + 0.5 * cross.m[i][j] + beta * cross2.m[i][j];
  to_phi = tdm_m3_mat(tdm_m3_transpose(inverse_t), At); /* dphi by dtheta_b */
  for (int k = 0; k < 3; k++) {
    int i = next_row(rows);
    tdm_vec3 n = tdm_m3_mul(triad_a, column(&inverse_t, k));
    rows->g[i] = g[k];
    mbd_put3(rows->G[i] + MBD_TA, -1, n);
    mbd_put3(rows->G[i] + MBD_TB, 1, n);
    if (!rows->second)
      continue;
    tdm_mat3 ek = tdm_m3_skew(e[k]), pe = tdm_m3_skew(tdm_m3_mul(cross, e[k])), p_ek = tdm_m3_mat(cross, ek), M;
    tdm_vec3 c2 = column(&cross2, k);
    const double c2v[3] = {c2.x, c2.y, c2.z};
    for (int r = 0; r < 3; r++)
      for (int c = 0; c < 3; c++)
        M.m[r][c] = -0.5 * ek.m[r][c] - beta * (pe.m[r][c] + p_ek.m[r][c]) + slope * c2v[r] * g[c];
    tdm_mat3 by_b = tdm_m3_mat(triad_a, tdm_m3_mat(M, to_phi)), skew = tdm_m3_skew(n);
    mbd_put33(rows->H[i], MBD_TB, MBD_TB, 1, by_b);
    mbd_put33(rows->H[i], MBD_TB, MBD_TA, -1, by_b);
    mbd_put33(rows->H[i], MBD_TB, MBD_TA, -1, skew);
    mbd_put33(rows->H[i], MBD_TA, MBD_TB, -1, by_b);
    mbd_put33(rows->H[i], MBD_TA, MBD_TA, 1, by_b);
    mbd_put33(rows->H[i], MBD_TA, MBD_TA, 1, skew);
  }
}

void mbd_rows_zero(mbd_rows *rows) {
  rows->g[next_row(rows)] = 0;
}

void mbd_rows_scale(mbd_rows *rows, double factor) {
  int i = rows->n - 1;
  rows->g[i] *= factor;
  for (int k = 0; k < MBD_PAIR; k++) {
    rows->G[i][k] *= factor;
    for (int l = 0; l < MBD_PAIR && rows->second; l++)
      rows->H[i][k][l] *= factor;
  }
}

void mbd_rows_merge(mbd_rows *rows, double factor) {
  assert(rows->n >= 2);
  int from = --rows->n, to = from - 1;
  rows->g[to] += factor * rows->g[from];
  for (int k = 0; k < MBD_PAIR; k++) {
    rows->G[to][k] += factor * rows->G[from][k];
    for (int l = 0; l < MBD_PAIR && rows->second; l++)
      rows->H[to][k][l] += factor * rows->H[from][k][l];
  }
}

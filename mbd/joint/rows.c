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

/* Translational spring-damper between two points: tension f = k (l - l0) + c ldot + preload along the line through
 * them.
 *
 * With d the vector from the first to the second point, e = d/l and N = f e, the second point feels -N, the first +N.
 * Q = -P^T N with ddot = P V, P = [-1, [s_a], 1, -[s_b]].
 */
#include "mbd/force/force.h"
#include "mbd/load.h"

static void load(mbd_force *f, tdm_object *o, const mbd_model *model) {
  tdm_vec3 point[2];
  mbd_load_bodies(o, model, f->body);
  mbd_load_points(o, model, NULL, "points", point);
  double length = tdm_norm(tdm_sub(point[1], point[0]));
  if (!o->err->status && !(length > 1e-9))
    tdm_object_fail(o, "points", "coincide, so that the spring has no direction; move one of them");
  f->stiffness = tdm_get_number(o, "stiffness", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  f->damping = tdm_get_number(o, "damping", 0, TDM_NOT_NEGATIVE);
  f->free = tdm_get_number(o, "free_length", length, TDM_NOT_NEGATIVE);
  f->preload = tdm_get_number(o, "preload", 0, TDM_ANY);
  for (int side = 0; side < 2; side++)
    f->arm[side] = mbd_model_arm(model, f->body[side], point[side]);
}

/* P and its change with the rotations, Pdot = d(ddot)/dq */
static void point_jacobian(double P[3][MBD_PAIR], double D[3][MBD_PAIR], const mbd_kin *a, const mbd_kin *b,
                           tdm_vec3 arm_a, tdm_vec3 arm_b) {
  tdm_mat3 sa = tdm_m3_skew(arm_a), sb = tdm_m3_skew(arm_b), da = mbd_skew2(a->w, arm_a), db = mbd_skew2(b->w, arm_b);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      P[i][MBD_RA + j] = -(double)(i == j);
      P[i][MBD_RB + j] = i == j;
      P[i][MBD_TA + j] = sa.m[i][j];
      P[i][MBD_TB + j] = -sb.m[i][j];
      D[i][MBD_RA + j] = D[i][MBD_RB + j] = 0;
      D[i][MBD_TA + j] = da.m[i][j];
      D[i][MBD_TB + j] = -db.m[i][j];
    }
}

/* K = -P^T (dN/dd P + dN/dddot D) - (dP^T) N,  C = -P^T dN/dddot P */
static void derivatives(mbd_force_value *out, const mbd_kin *a, const mbd_kin *b, tdm_vec3 arm_a, tdm_vec3 arm_b,
                        tdm_mat3 by_d, tdm_mat3 by_ddot, tdm_vec3 N) {
  double P[3][MBD_PAIR], D[3][MBD_PAIR];
  point_jacobian(P, D, a, b, arm_a, arm_b);
  for (int j = 0; j < MBD_PAIR; j++) {
    double dq[3] = {0}, dv[3] = {0};
    for (int i = 0; i < 3; i++)
      for (int l = 0; l < 3; l++) {
        dq[i] += by_d.m[i][l] * P[l][j] + by_ddot.m[i][l] * D[l][j];
        dv[i] += by_ddot.m[i][l] * P[l][j];
      }
    for (int k = 0; k < MBD_PAIR; k++) {
      out->K[k][j] -= P[0][k] * dq[0] + P[1][k] * dq[1] + P[2][k] * dq[2];
      out->C[k][j] -= P[0][k] * dv[0] + P[1][k] * dv[1] + P[2][k] * dv[2];
    }
  }
  mbd_put33(out->K, MBD_TA, MBD_TA, 1, mbd_skew2(N, arm_a));
  mbd_put33(out->K, MBD_TB, MBD_TB, -1, mbd_skew2(N, arm_b));
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, double near, mbd_force_value *out) {
  (void)near;
  tdm_vec3 sa = tdm_m3_mul(a->A, f->arm[0]), sb = tdm_m3_mul(b->A, f->arm[1]);
  tdm_vec3 d = tdm_sub(tdm_add(b->r, sb), tdm_add(a->r, sa));
  tdm_vec3 ddot = tdm_sub(tdm_add(b->v, tdm_cross(b->w, sb)), tdm_add(a->v, tdm_cross(a->w, sa)));
  double l = tdm_norm(d);
  tdm_vec3 e = tdm_unit(d);
  double ldot = tdm_dot(e, ddot), stretch = l - f->free;
  double tension = f->stiffness * stretch + f->damping * ldot + f->preload;
  tdm_vec3 N = tdm_scale(tension, e);
  mbd_put3(out->Q + MBD_RA, 1, N);
  mbd_put3(out->Q + MBD_TA, 1, tdm_cross(sa, N));
  mbd_put3(out->Q + MBD_RB, -1, N);
  mbd_put3(out->Q + MBD_TB, -1, tdm_cross(sb, N));
  out->value = tension;
  out->coordinate = l;
  out->rate = ldot;
  out->potential = 0.5 * f->stiffness * stretch * stretch + f->preload * stretch;
  if (!out->second || !(l > 0))
    return;

  /* dN/dd = e (k e + c (ddot - ldot e)/l)^T + f (1 - e e^T)/l,  dN/dddot = c e e^T */
  const double ev[3] = {e.x, e.y, e.z};
  tdm_vec3 across = tdm_scale(f->damping / l, tdm_axpy(-ldot, e, ddot));
  const double cv[3] = {across.x, across.y, across.z};
  tdm_mat3 by_d, by_ddot;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      by_d.m[i][j] = ev[i] * (f->stiffness * ev[j] + cv[j]) + tension / l * ((i == j) - ev[i] * ev[j]);
      by_ddot.m[i][j] = f->damping * ev[i] * ev[j];
    }
  derivatives(out, a, b, sa, sb, by_d, by_ddot, N);
}

extern const mbd_force_ops mbd_force_spring_damper;
const mbd_force_ops mbd_force_spring_damper = {"spring_damper", "N", "length", "m", load, eval};

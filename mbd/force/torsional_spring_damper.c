/* Torsional spring-damper: torque k (theta - theta0) + c thetadot + preload about an axis of the first body.
 *
 * theta is the rotation of the second body about the axis since the start, measured between e1 of the first body and
 * the pointer of the second, and counted on over full turns. A positive torque turns the second body back.
 */
#include "mbd/force/force.h"
#include "mbd/load.h"

#include <string.h>

/* Bodies and axis of the revolute joint that "joint" names. */
static void load_joint(mbd_force *f, tdm_object *o, const mbd_model *model) {
  const mbd_joint *j = mbd_load_joint(o, "joint", model, MBD_HAS_ANGLE, ", or give \"bodies\" and \"axis\"");
  if (!j)
    return;
  memcpy(f->body, j->body, sizeof f->body);
  f->axes = j->axes[0];
  f->pointer = tdm_v3(j->axes[1].m[0][0], j->axes[1].m[1][0], j->axes[1].m[2][0]);
}

static void load_axis(mbd_force *f, tdm_object *o, const mbd_model *model) {
  mbd_load_bodies(o, model, f->body);
  tdm_vec3 axis = tdm_get_vec3(o, "axis", NULL);
  if (o->err->status)
    return;
  if (tdm_norm(axis) < 1e-12) {
    tdm_object_fail(o, "axis", "is zero; give the direction of the spring's axis");
    return;
  }
  tdm_mat3 triad = mbd_triad(tdm_unit(axis));
  tdm_mat3 A = tdm_quat_to_matrix(mbd_model_pose(model, f->body[0]).orientation);
  f->axes = tdm_m3_mat(tdm_m3_transpose(A), triad);
  f->pointer = mbd_model_direction(model, f->body[1], tdm_v3(triad.m[0][0], triad.m[1][0], triad.m[2][0]));
}

static void load(mbd_force *f, tdm_object *o, const mbd_model *model) {
  if (tdm_has(o, "joint"))
    load_joint(f, o, model);
  else
    load_axis(f, o, model);
  f->stiffness = tdm_get_number(o, "stiffness", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  f->damping = tdm_get_number(o, "damping", 0, TDM_NOT_NEGATIVE);
  f->free = tdm_get_number(o, "free_angle", 0, TDM_ANY);
  f->preload = tdm_get_number(o, "preload", 0, TDM_ANY);
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, double near, mbd_force_value *out) {
  const tdm_mat3 e = tdm_m3_mat(a->A, f->axes);
  tdm_vec3 e1 = {e.m[0][0], e.m[1][0], e.m[2][0]}, e2 = {e.m[0][1], e.m[1][1], e.m[2][1]};
  tdm_vec3 e3 = {e.m[0][2], e.m[1][2], e.m[2][2]}, pointer = tdm_m3_mul(b->A, f->pointer);
  double s = tdm_dot(e2, pointer), c = tdm_dot(e1, pointer), angle = atan2(s, c);
  angle += 2 * M_PI * round((near - angle) / (2 * M_PI));
  tdm_vec3 spin = tdm_sub(b->w, a->w);
  double rate = tdm_dot(e3, spin), turn = angle - f->free;
  double torque = f->stiffness * turn + f->damping * rate + f->preload;
  mbd_put3(out->Q + MBD_TA, torque, e3);
  mbd_put3(out->Q + MBD_TB, -torque, e3);
  out->value = torque;
  out->coordinate = angle;
  out->rate = rate;
  out->potential = 0.5 * f->stiffness * turn * turn + f->preload * turn;
  if (!out->second)
    return;

  /* dtheta = n . (dtheta_b - dtheta_a), n = pointer x (c e2 - s e1)/(s2 + c2); d(rate) = (e3 x spin) . dtheta_a + e3 .
   * dspin; d(e3) = -[e3] dtheta_a */
  double r2 = s * s + c * c;
  tdm_vec3 n = tdm_scale(1 / r2, tdm_cross(pointer, tdm_sub(tdm_scale(c, e2), tdm_scale(s, e1))));
  tdm_vec3 by_a = tdm_axpy(f->damping, tdm_cross(e3, spin), tdm_scale(-f->stiffness, n));
  const double ev[3] = {e3.x, e3.y, e3.z}, nv[3] = {n.x, n.y, n.z}, av[3] = {by_a.x, by_a.y, by_a.z};
  tdm_mat3 skew = tdm_m3_skew(e3);
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      double ka = ev[i] * av[j] - torque * skew.m[i][j], kb = f->stiffness * ev[i] * nv[j];
      double cd = f->damping * ev[i] * ev[j];
      out->K[MBD_TA + i][MBD_TA + j] += ka;
      out->K[MBD_TB + i][MBD_TA + j] -= ka;
      out->K[MBD_TA + i][MBD_TB + j] += kb;
      out->K[MBD_TB + i][MBD_TB + j] -= kb;
      out->C[MBD_TA + i][MBD_TA + j] -= cd;
      out->C[MBD_TB + i][MBD_TA + j] += cd;
      out->C[MBD_TA + i][MBD_TB + j] += cd;
      out->C[MBD_TB + i][MBD_TB + j] -= cd;
    }
}

extern const mbd_force_ops mbd_force_torsional_spring_damper;
const mbd_force_ops mbd_force_torsional_spring_damper = {"torsional_spring_damper", "N m", "angle", "rad", load, eval};

/* Driven bodies: see driven.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/model/driven.h"

dem_drive dem_drive_read(tdm_object *body, const tdm_pose *pose) {
  static const tdm_vec3 zero = {0, 0, 0};
  dem_drive d = {.given = tdm_has(body, "motion")};
  tdm_object o = tdm_get_object(body, "motion", false);
  d.velocity = tdm_get_vec3(&o, "velocity", &zero);
  d.angular = tdm_get_vec3(&o, "angular_velocity", &zero);
  d.center = tdm_get_vec3(&o, "center", &pose->position);
  d.start = tdm_get_number(&o, "start", 0, TDM_ANY);
  d.end = tdm_get_number(&o, "end", INFINITY, TDM_ANY);
  if (!o.err->status && !(d.end > d.start))
    tdm_object_fail(&o, "end", "is %g s but must be after start, %g s", d.end, d.start);
  bool oscillates = tdm_has(&o, "oscillation");
  if (oscillates) {
    tdm_object swing = tdm_get_object(&o, "oscillation", true);
    d.amplitude = tdm_get_vec3(&swing, "amplitude", NULL);
    d.swing.amplitude = 1;
    d.swing.omega = 2 * M_PI * tdm_get_number(&swing, "frequency", TDM_REQUIRED, TDM_POSITIVE);
    d.swing.phase = tdm_get_number(&swing, "phase", 0, TDM_ANY);
    tdm_object_close(&swing);
  }
  if (d.given && !tdm_has(&o, "velocity") && !tdm_has(&o, "angular_velocity") && !oscillates)
    tdm_object_fail(&o, NULL, "moves nothing; give \"velocity\", \"angular_velocity\" or \"oscillation\"");
  if (tdm_has(&o, "center") && !tdm_has(&o, "angular_velocity"))
    tdm_object_fail(&o, "center", "is the centre of a rotation; give \"angular_velocity\" too, or remove it");
  tdm_object_close(&o);
  return d;
}

tdm_state dem_driven_state(const dem_drive *d, const tdm_state *at_start, double t) {
  tdm_state now = {.pose = at_start->pose};
  if (!d->given || t < d->start)
    return now;
  bool moves = t < d->end;
  double tau = (moves ? t : d->end) - d->start;
  tdm_motion_value swing = tdm_harmonic_at(&d->swing, tau);
  tdm_vec3 center = tdm_axpy(tau, d->velocity, d->center);
  center = tdm_axpy(swing.value - tdm_harmonic_at(&d->swing, 0).value, d->amplitude, center);
  tdm_quat turn = tdm_quat_from_rotvec(tdm_scale(tau, d->angular));
  tdm_vec3 arm = tdm_quat_rotate(turn, tdm_sub(at_start->pose.position, d->center));
  now.pose.position = tdm_add(center, arm);
  now.pose.orientation = tdm_quat_mul(turn, at_start->pose.orientation);
  if (moves) {
    now.twist.velocity = tdm_axpy(swing.rate, d->amplitude, tdm_add(d->velocity, tdm_cross(d->angular, arm)));
    now.twist.angular = d->angular;
  }
  return now;
}

double dem_drive_speed(const dem_drive *d, double reach) {
  return tdm_norm(d->velocity) + d->swing.omega * tdm_norm(d->amplitude) + tdm_norm(d->angular) * reach;
}

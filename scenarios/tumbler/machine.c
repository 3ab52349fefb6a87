/* The machine alone in memory: see machine.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/tumbler/machine.h"

#include "protocol/parameters/load.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const scn_barrel_mode_names[SCN_BARREL_MODES] = {"with the plate", "does not turn", "oscillates",
                                                             "on springs"};

double scn_machine_parameter(const scn_machine *m, const char *name) {
  const json_t *value = json_object_get(json_object_get(m->scene, "parameters"), name);
  return value ? json_number_value(value) : NAN;
}

static void read_law(scn_machine *m) {
  const double deg = M_PI / 180;
  m->mode = (scn_barrel_mode)lrint(scn_machine_parameter(m, "barrel_mode"));
  m->law = (scn_tumbler){.omega = scn_machine_parameter(m, "omega"),
                         .alpha = deg * scn_machine_parameter(m, "alpha_deg"),
                         .beta = deg * scn_machine_parameter(m, "beta_deg"),
                         .eccentricity = scn_machine_parameter(m, "eccentricity"),
                         .u = scn_machine_parameter(m, "u"),
                         .e = scn_machine_parameter(m, "e")};
}

tdm_status scn_machine_open(scn_machine *m, const char *file, const char *const *set, double window, bool ahead,
                            tdm_error *err) {
  tdm_scene scene = {0};
  if (tdm_scene_load(&scene, file, set, err) == TDM_OK)
    m->scene = json_incref(scene.root);
  tdm_scene_locate(&scene, err);
  tdm_scene_destroy(&scene);
  if (err->status)
    return err->status;
  read_law(m);
  m->window = window;
  m->ahead = ahead;
  json_t *mbd = tdm_scene_section(m->scene, "mbd");
  tdm_assigned_body barrel = {.name = "barrel", .scale = 1};
  const tdm_assignment assignment = {.scene = mbd,
                                     .time_end = 1e3,
                                     .dt = window,
                                     .n = 1,
                                     .nbody = 1,
                                     .body = &barrel,
                                     .acceleration = ahead,
                                     .ahead = ahead ? window : 0};
  mbd_engine_create(&m->engine, &assignment, NULL, err);
  json_decref(mbd);
  if (err->status)
    return err->status;
  m->start = mbd_engine_start(m->engine);
  m->state = m->start->body[0].state;
  m->path = m->start->path ? *m->start->path : (tdm_nodes){0};
  if (ahead)
    memcpy(m->acceleration, m->start->acceleration, sizeof m->acceleration);
  m->value = calloc((size_t)m->start->nchannel, sizeof *m->value);
  if (!m->value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  memcpy(m->value, m->start->initial, (size_t)m->start->nchannel * sizeof *m->value);
  return TDM_OK;
}

void scn_machine_close(scn_machine *m) {
  mbd_engine_destroy(&m->engine);
  json_decref(m->scene);
  free(m->value);
  *m = (scn_machine){0};
}

tdm_status scn_machine_step(scn_machine *m, tdm_error *err) {
  const double t1 = m->window * (rint(m->t / m->window) + 1);
  const mbd_window window = {
      .t0 = m->t, .t1 = t1, .nsample = 1, .sample_time = &t1, .ahead = m->ahead ? t1 + m->window : 0};
  mbd_outcome outcome = {.state = &m->state, .channel = m->value};
  if (m->ahead) {
    outcome.path = &m->path;
    outcome.acceleration = m->acceleration;
  }
  m->t = t1;
  return mbd_engine_advance(m->engine, &window, &outcome, err);
}

tdm_pose scn_machine_path(const scn_machine *m, double t) {
  const double h = t - m->t, *a = m->acceleration;
  if (m->path.nnode > 0)
    return tdm_nodes_at(&m->path, 0, &m->state, m->t, t).pose;
  const tdm_vec3 way = tdm_axpy(0.5 * h * h, tdm_v3(a[0], a[1], a[2]), tdm_scale(h, m->state.twist.velocity));
  const tdm_vec3 turn = tdm_axpy(0.5 * h * h, tdm_v3(a[3], a[4], a[5]), tdm_scale(h, m->state.twist.angular));
  return (tdm_pose){tdm_add(m->state.pose.position, way), tdm_quat_turned(m->state.pose.orientation, turn)};
}

double scn_machine_channel(const scn_machine *m, const char *name) {
  for (int i = 0; i < m->start->nchannel; i++)
    if (strcmp(m->start->channel[i].name, name) == 0)
      return m->value[i];
  return NAN;
}

tdm_status scn_machine_integrate(scn_machine *m, int turns, int n, const char *const *names, double *values,
                                 tdm_error *err) {
  const long steps = lrint(turns * 2 * M_PI / m->law.omega / m->window);
  memset(values, 0, (size_t)n * sizeof *values);
  for (long i = 0; i < steps && scn_machine_step(m, err) == TDM_OK; i++)
    for (int k = 0; k < n; k++)
      values[k] += m->window * scn_machine_channel(m, names[k]);
  return err->status;
}

/* ---- the closed form ---- */

bool scn_machine_at_corner(const scn_machine *m, double t) {
  const double half = 0.5 * scn_machine_parameter(m, "oscillation_period"), nearest = rint(t / half);
  return m->mode == SCN_OSCILLATING && nearest > 0 &&
         fabs(t - nearest * half) <= (0.5 + 1e-9) * scn_machine_parameter(m, "oscillation_corner");
}

scn_tumbler_frame scn_machine_barrel(const scn_machine *m, double t) {
  double psi = 0, rate = 0;
  if (m->mode == SCN_WITH_PLATE)
    psi = m->law.omega * t, rate = m->law.omega;
  if (m->mode == SCN_OSCILLATING)
    scn_tumbler_triangle(scn_machine_parameter(m, "oscillation_factor") * m->law.omega,
                         scn_machine_parameter(m, "oscillation_period"), t, &psi, &rate);
  return scn_tumbler_barrel(&m->law, t, psi, rate);
}

tdm_state scn_machine_barrel_state(const scn_machine *m, double t) {
  const scn_tumbler_frame f = scn_machine_barrel(m, t);
  const tdm_vec3 centre = {scn_machine_parameter(m, "barrel_offset"), 0, scn_machine_parameter(m, "barrel_height")};
  const tdm_vec3 arm = tdm_m3_tmul(f.A, centre);
  tdm_state s = {.pose.position = tdm_add(f.r, arm)};
  s.pose.orientation = tdm_quat_from_matrix(tdm_m3_transpose(f.A));
  s.twist.velocity = tdm_add(f.v, tdm_cross(f.w, arm));
  s.twist.angular = f.w;
  return s;
}

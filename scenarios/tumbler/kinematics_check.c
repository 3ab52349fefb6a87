/* The machine's motion against its closed form: `tandem verify tumbler_kinematics`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/base/log.h"
#include "scenarios/table.h"
#include "scenarios/tumbler/machine.h"

#include <math.h>
#include <stdio.h>

static const double limit = 1e-10, end = 2; /* [m, 1, m/s, rad/s], [s] */

/* the largest differences so far; of the path: that which DEM follows in the windows */
typedef struct {
  double place, orientation, velocity, spin;
  double path, turn;
} worst;

static double largest(tdm_vec3 a) {
  return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
}

static tdm_vec3 channels(const scn_machine *m, const char *marker, const char *const name[3]) {
  double value[3];
  for (int i = 0; i < 3; i++) {
    char channel[64];
    snprintf(channel, sizeof channel, "marker.%s.%s", marker, name[i]);
    value[i] = scn_machine_channel(m, channel);
  }
  return tdm_v3(value[0], value[1], value[2]);
}

/* A marker's state against a frame; what is not a number stays. */
static void compare(worst *w, const scn_machine *m, const char *marker, const scn_tumbler_frame *f) {
  char channel[64];
  snprintf(channel, sizeof channel, "marker.%s.qw", marker);
  const tdm_vec3 axis = channels(m, marker, (const char *[]){"qx", "qy", "qz"});
  const tdm_mat3 A = tdm_quat_to_matrix((tdm_quat){scn_machine_channel(m, channel), axis.x, axis.y, axis.z});
  const double off[] = {largest(tdm_sub(channels(m, marker, (const char *[]){"x", "y", "z"}), f->r)),
                        largest(tdm_sub(channels(m, marker, (const char *[]){"vx", "vy", "vz"}), f->v)),
                        largest(tdm_sub(channels(m, marker, (const char *[]){"wx", "wy", "wz"}), f->w))};
  double turned = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      turned = fabs(A.m[j][i] - f->A.m[i][j]) > turned || isnan(A.m[j][i]) ? fabs(A.m[j][i] - f->A.m[i][j]) : turned;
  w->place = off[0] <= w->place ? w->place : off[0];
  w->velocity = off[1] <= w->velocity ? w->velocity : off[1];
  w->spin = off[2] <= w->spin ? w->spin : off[2];
  w->orientation = turned <= w->orientation ? w->orientation : turned;
}

/* The rotor turns by the belt's ratio in its place. */
static scn_tumbler_frame rotor(const scn_machine *m, double t) {
  const scn_tumbler turning = {.omega = m->law.omega * scn_machine_parameter(m, "belt_ratio")};
  scn_tumbler_frame f = scn_tumbler_holder(&turning, t);
  f.r = tdm_v3(scn_machine_parameter(m, "rotor_x"), 0, scn_machine_channel(m, "marker.rotor.o.z"));
  return f;
}

/* The path that DEM follows in the window to come, against the closed form. */
static void compare_path(worst *w, const scn_machine *m) {
  enum { LOOKS = 16 };
  for (int i = 1; i <= LOOKS; i++) {
    const double t = m->t + i * m->window / LOOKS;
    if (scn_machine_at_corner(m, t))
      continue;
    const tdm_pose is = scn_machine_path(m, t), should = scn_machine_barrel_state(m, t).pose;
    w->path = fmax(w->path, tdm_norm(tdm_sub(is.position, should.position)));
    w->turn = fmax(w->turn, tdm_norm(tdm_quat_turn(is.orientation, should.orientation)));
  }
}

static tdm_status run(worst *w, const char *scene, const char *const *set, double window, tdm_error *err) {
  scn_machine m = {0};
  *w = (worst){0};
  scn_machine_open(&m, scene, set, window, true, err);
  while (!err->status && m.t < end - 0.5 * window) {
    compare_path(w, &m);
    if (scn_machine_step(&m, err) != TDM_OK || scn_machine_at_corner(&m, m.t))
      continue;
    const scn_tumbler_frame holder = scn_tumbler_holder(&m.law, m.t), plate = scn_tumbler_plate(&m.law, m.t),
                            barrel = scn_machine_barrel(&m, m.t), motor = rotor(&m, m.t);
    compare(w, &m, "rotor.o", &motor);
    compare(w, &m, "holder.o", &holder);
    compare(w, &m, "plate.c", &plate);
    compare(w, &m, "barrel.c", &barrel);
  }
  scn_machine_close(&m);
  return err->status;
}

static void merge(worst *all, const worst *w) {
  all->place = fmax(all->place, w->place);
  all->orientation = fmax(all->orientation, w->orientation);
  all->velocity = fmax(all->velocity, w->velocity);
  all->spin = fmax(all->spin, w->spin);
  all->path = fmax(all->path, w->path);
  all->turn = fmax(all->turn, w->turn);
}

/* Scenes, how they are solved, and the first of the speeds: IDA takes a hundred steps for a corner. Its iteration for
 * the constraints stops at a share of the tolerance, so it gets a tighter one than the default. */
static const struct {
  const char *scene, *formulation;
  double tolerance, window;
  int first_speed;
} cases[] = {{"five_deck", "one_step", 1e-8, 1e-3, 0},
             {"two_deck", "one_step", 1e-8, 2e-3, 0},
             {"two_deck", "ggl", 1e-10, 5e-3, 2}};
enum { NCASE = sizeof cases / sizeof cases[0], NSPEED = 3, NTILT = 3 };
static const int speeds[NSPEED] = {50, 180, 250};
static const double tilts[NTILT][2] = {{1, 0.65}, {0, 0}, {-2, 5}}; /* alpha, beta [deg] */

/* one barrel mode of case k at all speeds and tilts */
static tdm_status verify_mode(cpl_verify *v, const char *scene, int k, int mode, tdm_error *err) {
  worst all = {0};
  char name[128];
  for (int s = cases[k].first_speed; s < NSPEED; s++)
    for (int i = 0; i < NTILT; i++) {
      char set[6][64];
      snprintf(set[0], sizeof set[0], "parameters.barrel_mode=%d", mode);
      snprintf(set[1], sizeof set[1], "parameters.rpm=%d", speeds[s]);
      snprintf(set[2], sizeof set[2], "parameters.alpha_deg=%g", tilts[i][0]);
      snprintf(set[3], sizeof set[3], "parameters.beta_deg=%g", tilts[i][1]);
      snprintf(set[4], sizeof set[4], "mbd.formulation=%s", cases[k].formulation);
      snprintf(set[5], sizeof set[5], "mbd.solver.relative_tolerance=%g", cases[k].tolerance);
      const char *const sets[] = {set[0], set[1], set[2], set[3], set[4], set[5], NULL};
      worst w;
      if (run(&w, scene, sets, cases[k].window, err) != TDM_OK)
        return err->status;
      merge(&all, &w);
    }
  snprintf(name, sizeof name, "%s, %s, %g ms, %s", cases[k].scene, cases[k].formulation, 1e3 * cases[k].window,
           scn_barrel_mode_names[mode]);
  cpl_verify_measure(v, "position off [m]", name, all.place, CPL_AT_MOST, limit);
  cpl_verify_measure(v, "orientation off", name, all.orientation, CPL_AT_MOST, limit);
  cpl_verify_measure(v, "velocity off [m/s]", name, all.velocity, CPL_AT_MOST, limit);
  cpl_verify_measure(v, "spin off [rad/s]", name, all.spin, CPL_AT_MOST, limit);
  cpl_verify_measure(v, "path off [m]", name, all.path, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "path off [rad]", name, all.turn, CPL_NO_LIMIT, 0);
  return TDM_OK;
}

tdm_status scn_tumbler_kinematics(cpl_verify *v, tdm_error *err) {
  const double begin = tdm_clock();
  double simulated = 0;
  for (int k = 0; k < NCASE; k++) {
    char file[4096], of[64];
    snprintf(of, sizeof of, "tumbler/%s.json", cases[k].scene);
    if (cpl_verify_find_file(v, of, file, sizeof file, err) != TDM_OK)
      return err->status;
    for (int mode = SCN_WITH_PLATE; mode < SCN_ON_SPRINGS; mode++) {
      if (verify_mode(v, file, k, mode, err) != TDM_OK)
        return err->status;
      simulated += (NSPEED - cases[k].first_speed) * NTILT * end;
    }
  }
  cpl_verify_alone(v, CPL_MBD, simulated, tdm_clock() - begin);
  return TDM_OK;
}

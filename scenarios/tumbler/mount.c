/* The empty barrel on its mounting springs: `tandem verify tumbler_mount`. How far it oscillates about its axis at a
 * speed over the stiffness of the springs, against the oscillator that it is to first order: its centre of mass, a way
 * d beside its axis, goes round with the eccentricity and drags it to and fro, I psi'' + c psi' + k psi = M sin(omega
 * t),  I = I_z + m d^2, k = 4 k_s R^2, c = 4 c_s R^2 + c_b, M = m d omega^2 r with springs across the radius R and the
 * foot of the barrel's shaft going round on the radius r. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/base/log.h"
#include "protocol/results/results.h"
#include "scenarios/table.h"
#include "scenarios/tumbler/machine.h"

#include <math.h>
#include <stdio.h>

static const double window = 2e-3, damping = 100; /* [s], [N s/m] */
static const int turns = 40;

/* half the range of the barrel's turn in the second half of the run [rad], and that of the oscillator */
static tdm_status oscillation(const char *file, double stiffness, int rpm, double *is, double *oscillator,
                              tdm_error *err) {
  char set[3][64];
  snprintf(set[0], sizeof set[0], "parameters.spring_stiffness=%.9g", stiffness);
  snprintf(set[1], sizeof set[1], "parameters.spring_damping=%g", damping);
  snprintf(set[2], sizeof set[2], "parameters.rpm=%d", rpm);
  const char *const sets[] = {
      set[0], set[1], set[2], "parameters.barrel_mode=3", "parameters.alpha_deg=0", "parameters.beta_deg=0", NULL};
  scn_machine m = {0};
  scn_machine_open(&m, file, sets, window, false, err);
  const double end = err->status ? 0 : turns * 2 * M_PI / m.law.omega;
  double least = INFINITY, most = -INFINITY;
  while (err->status == TDM_OK && m.t < end && scn_machine_step(&m, err) == TDM_OK) {
    const double psi = scn_machine_channel(&m, "joint.auxiliary_shaft.angle") + m.law.omega * m.t;
    least = m.t > 0.5 * end ? fmin(least, psi) : least;
    most = m.t > 0.5 * end ? fmax(most, psi) : most;
  }
  *is = 0.5 * (most - least);
  if (err->status == TDM_OK) {
    const double mass = scn_machine_parameter(&m, "barrel_mass"), w = m.law.omega,
                 offset = scn_machine_parameter(&m, "barrel_offset"),
                 radius = scn_machine_parameter(&m, "barrel_radius"), arm = scn_machine_parameter(&m, "spring_radius");
    const scn_tumbler_frame plate = scn_tumbler_plate(&m.law, 0);
    const double inertia = mass * (0.8 * radius * radius + offset * offset), k = 4 * stiffness * arm * arm,
                 c = 4 * damping * arm * arm + scn_machine_parameter(&m, "bearing_damping");
    *oscillator = mass * offset * w * w * hypot(plate.r.x, plate.r.y) / hypot(k - inertia * w * w, c * w);
  }
  scn_machine_close(&m);
  return err->status;
}

tdm_status scn_tumbler_mount(cpl_verify *v, tdm_error *err) {
  static const double stiffness[] = {400, 1600, 6400, 9600, 12800, 15300, 18000, 25600, 51200};
  enum { N = sizeof stiffness / sizeof stiffness[0] };
  const double begin = tdm_clock();
  char file[4096], path[4352];
  if (cpl_verify_find_file(v, "tumbler/five_deck.json", file, sizeof file, err) != TDM_OK ||
      tdm_make_directory(cpl_verify_dir(v), err) != TDM_OK)
    return err->status;
  snprintf(path, sizeof path, "%s/mount.csv", cpl_verify_dir(v));
  FILE *f = fopen(path, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, path, "cannot be written; check that the directory is there and writable");
  fputs("stiffness [N/m],amplitude [deg],oscillator [deg]\n", f);
  double worst = 0, simulated = 0;
  for (int i = 0; i < N && err->status == TDM_OK; i++) {
    double is = NAN, oscillator = NAN;
    if (oscillation(file, stiffness[i], 150, &is, &oscillator, err) != TDM_OK)
      break;
    char name[64];
    snprintf(name, sizeof name, "springs of %g N/m", stiffness[i]);
    cpl_verify_measure(v, "amplitude of the barrel [deg]", name, is * 180 / M_PI, CPL_NO_LIMIT, 0);
    fprintf(f, "%.9g,%.9g,%.9g\n", stiffness[i], is * 180 / M_PI, oscillator * 180 / M_PI);
    worst = fmax(worst, fabs(is / oscillator - 1));
    simulated += turns * 0.4;
  }
  fclose(f);
  if (err->status)
    return err->status;
  cpl_verify_measure(v, "amplitude off the oscillator's", "", worst, CPL_AT_MOST, 0.1);
  const tdm_curve curve[] = {{"mount.csv", "1:2", "machine", "points pt 7"},
                             {"mount.csv", "1:3", "oscillator", "lines lw 2"}};
  const tdm_plot plot = {.title = "Oscillation of the empty barrel on its springs, 150 rpm",
                         .xlabel = "stiffness of a spring [N/m]",
                         .ylabel = "amplitude [\u00b0]",
                         .setup = "set logscale xy\n",
                         .ncurve = 2,
                         .curve = curve};
  cpl_verify_plot(v, "mount", 1, &plot);
  cpl_verify_alone(v, CPL_MBD, simulated, tdm_clock() - begin);
  return TDM_OK;
}

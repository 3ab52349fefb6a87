/* The load on the drive of the empty machine: `tandem verify tumbler_drive`. At rest and in steady motion bearings bear
 * what weights and centrifugal forces make of them; over whole turns the drives give no work but what springs and
 * bearings turn into heat. Plots: power and reactions over a turn, the trace of the barrel. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/base/log.h"
#include "protocol/results/results.h"
#include "scenarios/table.h"
#include "scenarios/tumbler/machine.h"

#include <math.h>
#include <stdio.h>

static const double exact = 1e-9, gravity = 9.81; /* share; [m/s2] */

#define SET(...) ((const char *const[]){__VA_ARGS__, NULL})

static double relative(double value, double should, double size) {
  return fabs(value - should) / size;
}

/* ---- at rest ---- */

/* Moment of a weight about the point o, of which the components across the axis n are a bearing's [N m]. */
static tdm_vec3 moment_of(double mass, tdm_vec3 centre, tdm_vec3 o) {
  return tdm_cross(tdm_sub(centre, o), tdm_v3(0, 0, -mass * gravity));
}

static tdm_vec3 across(tdm_vec3 moment, tdm_vec3 n) {
  return tdm_axpy(-tdm_dot(moment, n), n, moment);
}

static tdm_status at_rest(cpl_verify *v, const char *file, tdm_error *err) {
  scn_machine m = {0};
  scn_machine_open(&m, file,
                   SET("parameters.rpm=0", "parameters.barrel_mode=0", "parameters.balance=0.5",
                       "parameters.alpha_deg=3", "parameters.beta_deg=-2"),
                   1e-3, false, err);
  if (err->status == TDM_OK) {
    const scn_tumbler_frame plate = scn_tumbler_plate(&m.law, 0);
    const double barrel = scn_machine_parameter(&m, "barrel_mass"), disc = scn_machine_parameter(&m, "plate_mass"),
                 holder = scn_machine_parameter(&m, "holder_mass"), weight = gravity * (barrel + disc + holder);
    const tdm_vec3 n = tdm_m3_tmul(plate.A, tdm_v3(0, 0, 1)), centre = scn_machine_barrel_state(&m, 0).pose.position,
                   o = {0, 0, 0}, of_barrel = moment_of(barrel, centre, plate.r);
    const tdm_vec3 holder_centre = {0, -0.5 * (disc + barrel) * plate.r.y / holder, -0.05};
    const tdm_vec3 all = tdm_add(tdm_add(moment_of(barrel, centre, o), moment_of(disc, plate.r, o)),
                                 moment_of(holder, holder_centre, o));
    const double lever = tdm_norm(all);
    double off = relative(scn_machine_channel(&m, "joint.auxiliary_shaft.f"), barrel * gravity, weight);
    off = fmax(off, relative(scn_machine_channel(&m, "joint.main_shaft.f"), weight, weight));
    off =
        fmax(off, relative(scn_machine_channel(&m, "joint.auxiliary_shaft.m"), tdm_norm(across(of_barrel, n)), lever));
    off = fmax(off,
               relative(scn_machine_channel(&m, "joint.main_shaft.m"), tdm_norm(across(all, tdm_v3(0, 0, 1))), lever));
    off = fmax(off, relative(scn_machine_channel(&m, "driver.barrel_drive.torque"), -tdm_dot(of_barrel, n), lever));
    cpl_verify_measure(v, "loads at rest off", "", off, CPL_AT_MOST, exact);
  }
  scn_machine_close(&m);
  return err->status;
}

/* ---- in steady motion, without tilt: the barrel goes round on a circle and does not turn ---- */

static tdm_status in_motion(cpl_verify *v, const char *file, tdm_error *err) {
  scn_machine m = {0};
  scn_machine_open(&m, file,
                   SET("parameters.rpm=200", "parameters.barrel_mode=1", "parameters.alpha_deg=0",
                       "parameters.beta_deg=0", "parameters.barrel_offset=0"),
                   1e-3, false, err);
  for (int i = 0; i < 20 && err->status == TDM_OK; i++)
    scn_machine_step(&m, err);
  if (err->status == TDM_OK) {
    const double barrel = scn_machine_parameter(&m, "barrel_mass"), disc = scn_machine_parameter(&m, "plate_mass"),
                 holder = scn_machine_parameter(&m, "holder_mass"), w = m.law.omega, arm = m.law.eccentricity,
                 height = scn_machine_parameter(&m, "barrel_height"), pull = barrel * arm * w * w,
                 rub = scn_machine_parameter(&m, "bearing_damping") * w;
    /* the holder's unbalance cancels the others' (balance: 1), but below them */
    const double tip = pull * height + barrel * gravity * arm + disc * gravity * arm - gravity * (disc + barrel) * arm +
                       0.05 * (disc + barrel) * arm * w * w;
    double off = relative(scn_machine_channel(&m, "joint.auxiliary_shaft.f"), hypot(pull, barrel * gravity), pull);
    off = fmax(off, relative(scn_machine_channel(&m, "joint.auxiliary_shaft.m"), pull * height, pull * height));
    off = fmax(off, relative(scn_machine_channel(&m, "joint.main_shaft.f"), gravity * (barrel + disc + holder), pull));
    off = fmax(off, relative(scn_machine_channel(&m, "joint.main_shaft.m"), tip, pull * height));
    /* the barrel's drive turns it against the bearing on the plate: the motor feels nothing of both */
    off = fmax(off, relative(scn_machine_channel(&m, "driver.barrel_drive.torque"), -rub, rub));
    off = fmax(off, relative(scn_machine_channel(&m, "driver.barrel_drive.power"), rub * w, rub * w));
    off = fmax(off, relative(scn_machine_channel(&m, "driver.motor.torque"), 0, rub));
    cpl_verify_measure(v, "loads in motion off", "", off, CPL_AT_MOST, exact);
  }
  scn_machine_close(&m);
  return err->status;
}

/* ---- over turns ---- */

static double stored(const scn_machine *m) {
  return scn_machine_channel(m, "energy.kinetic") + scn_machine_channel(m, "energy.potential") +
         scn_machine_channel(m, "energy.springs");
}

/* Work of the drives and heat over whole turns, of what the drives move to and fro. */
static tdm_status over_turns(cpl_verify *v, const char *file, int mode, tdm_error *err) {
  enum { TURNS = 2 };
  scn_machine m = {0};
  char barrel_mode[64];
  snprintf(barrel_mode, sizeof barrel_mode, "parameters.barrel_mode=%d", mode);
  /* 0.4 s a turn, of 20 oscillations and 800 windows */
  scn_machine_open(&m, file, SET(barrel_mode, "parameters.rpm=150", "parameters.bearing_damping=0"), 5e-4, false, err);
  if (err->status)
    return err->status;
  const double before = stored(&m);
  double least = 0, most = 0, slip = 0;
  for (int i = 0; i < TURNS * 800 && scn_machine_step(&m, err) == TDM_OK; i++) {
    const double second = scn_machine_channel(&m, "driver.barrel_drive.power");
    const double power = scn_machine_channel(&m, "driver.motor.power") + (isnan(second) ? 0 : second);
    const double belt = scn_machine_channel(&m, "joint.belt.mz") / scn_machine_parameter(&m, "belt_ratio");
    slip = fmax(slip, fabs(belt - scn_machine_channel(&m, "driver.motor.torque")));
    least = fmin(least, power);
    most = fmax(most, power);
  }
  if (err->status == TDM_OK) {
    const double work = scn_machine_channel(&m, "energy.supplied"), heat = scn_machine_channel(&m, "energy.dissipated");
    const double gain = mode == SCN_ON_SPRINGS ? stored(&m) - before : 0; /* it swings in, the others repeat */
    const double moved = fmax(1e-3, most - least) * m.t;
    const char *name = scn_barrel_mode_names[mode];
    cpl_verify_measure(v, "belt less motor [N m]", name, slip / fmax(1, most), CPL_AT_MOST, exact);
    cpl_verify_measure(v, "largest power [W]", name, most, CPL_NO_LIMIT, 0);
    cpl_verify_measure(v, "work less heat", name, (work - heat - gain) / moved, CPL_AT_MOST, 1e-3);
  }
  scn_machine_close(&m);
  return err->status;
}

/* ---- plots ---- */

static FILE *open_csv(cpl_verify *v, const char *name, const char *head, tdm_error *err) {
  char path[4352];
  snprintf(path, sizeof path, "%s/%s", cpl_verify_dir(v), name);
  FILE *f = fopen(path, "w");
  if (!f)
    tdm_fail(err, TDM_ERR_FILE, path, "cannot be written; check that the directory is there and writable");
  else
    fprintf(f, "%s\n", head);
  return f;
}

/* Loads of the machine over a turn at 150 rpm, the barrel held or on springs. */
static tdm_status plot_loads(cpl_verify *v, const char *file, tdm_error *err) {
  static const char *const files[] = {"held.csv", "springs.csv"};
  for (int k = 0; k < 2; k++) {
    scn_machine m = {0};
    FILE *f = open_csv(v, files[k], "turn,power [W],auxiliary shaft [N],spring [N]", err);
    if (f)
      scn_machine_open(&m, file, SET(k ? "parameters.barrel_mode=3" : "parameters.barrel_mode=1", "parameters.rpm=150"),
                       1e-3, false, err);
    for (int i = 0; f && i < 800 && err->status == TDM_OK && scn_machine_step(&m, err) == TDM_OK; i++)
      if (i >= 399)
        fprintf(f, "%.9g,%.9g,%.9g,%.9g\n", m.t / 0.4 - 1, scn_machine_channel(&m, "driver.motor.power"),
                scn_machine_channel(&m, "joint.auxiliary_shaft.f"), scn_machine_channel(&m, "force.spring_east.value"));
    scn_machine_close(&m);
    if (f)
      fclose(f);
    if (err->status)
      return err->status;
  }
#define CURVES(column)                                        \
  (const tdm_curve[]) {                                       \
    {"held.csv", "1:" column, "barrel held", "lines lw 2"}, { \
      "springs.csv", "1:" column, "on springs", "lines lw 2"  \
    }                                                         \
  }
  const tdm_plot plots[] = {{.title = "Power of the motor, empty machine, 150 rpm",
                             .xlabel = "turns",
                             .ylabel = "power [W]",
                             .ncurve = 2,
                             .curve = CURVES("2")},
                            {.title = "Force of the auxiliary shaft's bearing",
                             .xlabel = "turns",
                             .ylabel = "force [N]",
                             .ncurve = 2,
                             .curve = CURVES("3")},
                            {.title = "Force of a mounting spring",
                             .xlabel = "turns",
                             .ylabel = "force [N]",
                             .ncurve = 1,
                             .curve = (const tdm_curve[]){{"springs.csv", "1:4", "on springs", "lines lw 2"}}}};
  cpl_verify_plot(v, "drive", 3, plots);
#undef CURVES
  return TDM_OK;
}

/* The trace that a recorder on the barrel draws: a point of its upper rim over a turn, from the middle of its path. */
static tdm_status plot_trace(cpl_verify *v, const char *file, tdm_error *err) {
  static const double tilts[][2] = {{0, 0.65}, {1, 0}, {1, 0.65}, {2, 0.65}}; /* alpha, beta [deg] */
  enum { N = 4, STEPS = 400 };
  tdm_curve curve[N];
  char name[N][32], title[N][64];
  for (int k = 0; k < N; k++) {
    scn_machine m = {0};
    char alpha[64], beta[64];
    double x[STEPS], z[STEPS], middle_x = 0, middle_z = 0;
    snprintf(name[k], sizeof name[k], "trace_%d.csv", k);
    snprintf(title[k], sizeof title[k], "\u03b1 = %g\u00b0, \u03b2 = %g\u00b0", tilts[k][0], tilts[k][1]);
    snprintf(alpha, sizeof alpha, "parameters.alpha_deg=%g", tilts[k][0]);
    snprintf(beta, sizeof beta, "parameters.beta_deg=%g", tilts[k][1]);
    FILE *f = open_csv(v, name[k], "across [mm],up [mm]", err);
    if (f)
      scn_machine_open(&m, file, SET(alpha, beta, "parameters.rpm=150", "parameters.barrel_mode=1"), 1e-3, false, err);
    for (int i = 0; f && i < STEPS && err->status == TDM_OK && scn_machine_step(&m, err) == TDM_OK; i++) {
      x[i] = 1e3 * scn_machine_channel(&m, "marker.barrel.rim.x");
      z[i] = 1e3 * scn_machine_channel(&m, "marker.barrel.rim.z");
      middle_x += x[i] / STEPS;
      middle_z += z[i] / STEPS;
    }
    for (int i = 0; f && i <= STEPS && err->status == TDM_OK; i++)
      fprintf(f, "%.9g,%.9g\n", x[i % STEPS] - middle_x, z[i % STEPS] - middle_z);
    scn_machine_close(&m);
    if (f)
      fclose(f);
    if (err->status)
      return err->status;
    curve[k] = (tdm_curve){name[k], "1:2", title[k], "lines lw 2"};
  }
  const tdm_plot plot = {.title = "Trace of the barrel's upper rim over a turn",
                         .xlabel = "radially [mm]",
                         .ylabel = "up [mm]",
                         .setup = "set size ratio -1\nset key outside\n",
                         .ncurve = N,
                         .curve = curve};
  cpl_verify_plot(v, "trace", 1, &plot);
  return TDM_OK;
}

tdm_status scn_tumbler_drive(cpl_verify *v, tdm_error *err) {
  char file[4096];
  const double begin = tdm_clock();
  if (cpl_verify_find_file(v, "tumbler/five_deck.json", file, sizeof file, err) != TDM_OK ||
      tdm_make_directory(cpl_verify_dir(v), err) != TDM_OK || at_rest(v, file, err) != TDM_OK ||
      in_motion(v, file, err) != TDM_OK)
    return err->status;
  for (int mode = 0; mode < SCN_BARREL_MODES; mode++)
    if (over_turns(v, file, mode, err) != TDM_OK)
      return err->status;
  if (plot_loads(v, file, err) != TDM_OK || plot_trace(v, file, err) != TDM_OK)
    return err->status;
  cpl_verify_alone(v, CPL_MBD, 6.4, tdm_clock() - begin);
  return TDM_OK;
}

/* The scenarios that `tandem verify` knows.
 *
 * To add one: a folder <name>/ with scene.json, README.md and its C file (reference solution and measures), one row in
 * table.c, its files in CMakeLists.txt.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_TABLE_H
#define SCN_TABLE_H

#include "coupler/verify/verify.h"

extern const cpl_scenario scn_table[]; /* ended by a NULL name */

tdm_status scn_collision(cpl_verify *v, tdm_error *err);
tdm_status scn_spring_damper(cpl_verify *v, tdm_error *err);
tdm_status scn_spring_damper_compare(const char *dir, cpl_comparison *c, tdm_error *err);

tdm_status scn_stream(cpl_verify *v, tdm_error *err);
tdm_status scn_stream_compare(const char *dir, cpl_comparison *c, tdm_error *err);
tdm_status scn_pendulum(cpl_verify *v, tdm_error *err);
tdm_status scn_pendulum_compare(const char *dir, cpl_comparison *c, tdm_error *err);
tdm_status scn_torsional(cpl_verify *v, tdm_error *err);
tdm_status scn_torsional_compare(const char *dir, cpl_comparison *c, tdm_error *err);

/* the schemes, coupling/ */
tdm_status scn_coupling_collision(cpl_verify *v, tdm_error *err);
tdm_status scn_coupling_spring_damper(cpl_verify *v, tdm_error *err);
tdm_status scn_coupling_torsional(cpl_verify *v, tdm_error *err);
tdm_status scn_coupling_heavy_fill(cpl_verify *v, tdm_error *err);
tdm_status scn_coupling_stiff_support(cpl_verify *v, tdm_error *err);
tdm_status scn_coupling_stiff_hinge(cpl_verify *v, tdm_error *err);

/* stiff and extreme cases, stability/: the family is the scenario's name; and the map of all of them */
tdm_status scn_stability(cpl_verify *v, tdm_error *err);
tdm_status scn_stability_map(cpl_verify *v, tdm_error *err);

/* particles alone, dem_physics/ */
tdm_status scn_normal_laws(cpl_verify *v, tdm_error *err);
tdm_status scn_chung_ooi(cpl_verify *v, tdm_error *err);
tdm_status scn_rolling(cpl_verify *v, tdm_error *err);
tdm_status scn_lammps(cpl_verify *v, tdm_error *err);
tdm_status scn_conservation(cpl_verify *v, tdm_error *err);
tdm_status scn_convergence(cpl_verify *v, tdm_error *err);
tdm_status scn_discharge(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_impacts(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_statics(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_hydrogel(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_rubber(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_mixture(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_glass(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_plate(cpl_verify *v, tdm_error *err);
tdm_status scn_multi_liggghts(cpl_verify *v, tdm_error *err);

/* bodies alone, mbd/ */
tdm_status scn_andrews(cpl_verify *v, tdm_error *err);
tdm_status scn_pendulum_a01(cpl_verify *v, tdm_error *err);
tdm_status scn_double_pendulum(cpl_verify *v, tdm_error *err);
tdm_status scn_slider_crank(cpl_verify *v, tdm_error *err);
tdm_status scn_car_axis(cpl_verify *v, tdm_error *err);
tdm_status scn_heavy_top(cpl_verify *v, tdm_error *err);
tdm_status scn_regular_precession(cpl_verify *v, tdm_error *err);
tdm_status scn_fourbar_a02(cpl_verify *v, tdm_error *err);
tdm_status scn_torque_free(cpl_verify *v, tdm_error *err);

/* the tumbler screening machine, tumbler/ */
tdm_status scn_tumbler_screening(cpl_verify *v, tdm_error *err);

/* bodies alone: Adams' own results, adams/ */
tdm_status scn_adams(cpl_verify *v, tdm_error *err);

/* the tumbler screening machine, tumbler/ */
tdm_status scn_tumbler_kinematics(cpl_verify *v, tdm_error *err);
tdm_status scn_tumbler_drive(cpl_verify *v, tdm_error *err);
tdm_status scn_tumbler_mount(cpl_verify *v, tdm_error *err);

#endif

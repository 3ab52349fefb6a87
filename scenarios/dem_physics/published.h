/* Published values for the cases of this folder.
 *
 * Chung & Ooi (2011), Benchmark tests for verifying discrete element modelling codes at particle impact level, Granular
 * Matter 13, 643-656: curves of tests 1, 4 and 5, digitised from the figures. Digitising is good to about 1 % of an
 * axis: 0.15 kN, 0.005 in restitution, 7 rad/s, 0.5 degrees, 0.05 in the normalised numbers of test 5.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_PUBLISHED_H
#define SCN_PUBLISHED_H

typedef enum {
  SCN_FORCE_OVERLAP,
  SCN_FORCE_TIME,
  SCN_T4_OXIDE_E,
  SCN_T4_OXIDE_W,
  SCN_T4_ALLOY_W,
  SCN_T4_OXIDE_ANGLE,
  SCN_T4_EXPERIMENT_W,
  SCN_T4_EXPERIMENT_ANGLE,
  SCN_T5_STEEL_PSI,
  SCN_T5_PE_PSI,
  SCN_T5_STEEL_W,
  SCN_T5_PE_W,
  SCN_T5_FEM_PSI,
  SCN_T5_FEM_W,
  SCN_PUBLISHED
} scn_series_name;

typedef struct {
  const char *name; /* of its CSV in the results */
  const double (*xy)[2];
  int n;
} scn_series;

extern const scn_series scn_published[SCN_PUBLISHED];

/* Test 4 as two other forms of the tangential spring have it (Hertz-Mindlin without slip, integrated by another program
 * at high accuracy): [material: oxide, alloy][form: incremental, total] */
typedef struct {
  double angle; /* of incidence [deg] */
  struct {
    double restitution, spin; /* tangential; angular velocity afterwards [rad/s] */
  } outcome[2][2];
} scn_oblique_row;

enum { SCN_OBLIQUE_ROWS = 17 };
extern const scn_oblique_row scn_oblique_computed[SCN_OBLIQUE_ROWS];

#endif

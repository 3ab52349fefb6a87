/* A sphere that meets a rigid plane: by the engine, and by the same law integrated without it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_PLANE_IMPACT_H
#define SCN_PLANE_IMPACT_H

#include "scenarios/dem_physics/impact.h"
#include "scenarios/dem_physics/rig.h"

enum { SCN_IMPACT_STEPS = 4000 }; /* a contact */

typedef enum {
  SCN_GLASS,
  SCN_LIMESTONE,
  SCN_MG_ALLOY,
  SCN_AL_ALLOY_2,
  SCN_OXIDE,
  SCN_IRON,
  SCN_AL_ALLOY,
  SCN_STEEL,
  SCN_POLYETHYLENE,
  SCN_NYLON,
  SCN_COPPER
} scn_material;

typedef struct {
  const char *name;
  double young, poisson, density; /* [Pa], 1, [kg/m3] */
} scn_elastic;

extern const scn_elastic scn_materials[];

/* A sphere that meets a rigid plane. */
typedef struct {
  scn_material of;
  double radius, e, mu;
  bool clip;                   /* the attractive end of the force is cut */
  double normal, across, spin; /* approach speed, speed across [m/s], angular velocity (rolling: -across/R) [rad/s] */
} scn_plane_impact;

/* Afterwards; spin with the sign of the case's. */
typedef struct {
  double normal, across, spin;
  double slip; /* of the contact point, across + R spin [m/s] */
} scn_rebound;

double scn_sphere_mass(scn_material of, double radius); /* [kg] */
double scn_plate_modulus(scn_material of);              /* E/(1 - nu^2) [Pa] */

/* Duration of Hertz's impact [s], Johnson (1985) Eq. 11.24. Effective mass, radius, E*. */
double scn_hertz_time(double mass, double radius, double e_star, double speed);
double scn_plane_time(const scn_plane_impact *c);

/* By the engine; `watch` may be NULL. */
tdm_status scn_plane_run(cpl_verify *v, const scn_plane_impact *c, scn_impact *impact, scn_impact_watch *watch,
                         void *context, tdm_error *err);
tdm_status scn_plane_simulate(cpl_verify *v, const scn_plane_impact *c, scn_rebound *out, tdm_error *err);

/* The law of the case, and what the engine should do by it. */
scn_law scn_plane_law(const scn_plane_impact *c);
scn_rebound scn_plane_solve_with(const scn_plane_impact *c, const scn_law *law);
scn_rebound scn_plane_solve(const scn_plane_impact *c);

/* With another form of the spring, as the computed table of published.h has it: no damping across, arm R. */
scn_rebound scn_plane_solve_form(const scn_plane_impact *c, scn_spring spring);

#endif

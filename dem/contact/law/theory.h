/* Closed forms of impacts: what the scene's laws give for two bodies that collide centrally.
 *
 * With the coefficients of a pair; effective mass [kg] and radius [m], approach speed [m/s]. For hertz, duration and
 * overlap are those without damping; NaN where there is no closed form.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_THEORY_H
#define DEM_CONTACT_LAW_THEORY_H

#include "dem/contact/law/law.h"

/* Duration [s]; inf when the bodies stay together. */
double dem_normal_contact_time(const dem_model *model, const dem_pair *pair, dem_impact impact);

/* The same, but a finite time that a step must resolve where damping keeps the bodies together [s]. */
double dem_normal_step_time(const dem_model *model, const dem_pair *pair, dem_impact impact);

/* Largest overlap [m]. */
double dem_normal_overlap(const dem_model *model, const dem_pair *pair, dem_impact impact);

/* Coefficient of restitution; 0 when they stay together. */
double dem_normal_restitution(const dem_model *model, const dem_pair *pair, dem_impact impact);

/* Largest slope of the force at an overlap [N/m]; impact.speed does not matter. */
double dem_normal_stiffness(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);

/* The same of the tangential force where the law has a spring, else 0 [N/m]. */
double dem_tangential_stiffness(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);

/* Of the springs of the rolling and the twisting law, else 0 [N m]. */
double dem_rolling_stiffness(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);
double dem_twisting_stiffness(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);

/* The force there at rest, without cohesion, and the energy that is stored [N], [J]; impact.speed does not matter. */
double dem_normal_force(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);
double dem_normal_elastic(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);

/* Duration of an undamped Hertz impact [s]; inf for v = 0. */
double dem_contact_time(double mass, double radius, double young, double speed);

/* JKR, work of adhesion w [J/m2]: gap at which a contact that was closed opens [m], and largest pull [N]. */
double dem_jkr_reach(double radius, double young, double adhesion);
double dem_jkr_pull(double radius, double adhesion);

/* ---- of a contact among the others of its particles, by the scene's laws ---- */

/* Slope of the elastic force when all contacts of the particles grow alike [N/m]. */
double dem_stiffness_among(const struct dem_data *data, const dem_model *model, const dem_among *contact);

/* Stored in the normal direction [J]. */
double dem_elastic_among(const struct dem_data *data, const dem_model *model, const dem_among *contact);

/* The overlap that makes the contact's circle, and with it the tangential stiffness [m]. */
double dem_overlap_among(const struct dem_data *data, const dem_model *model, const dem_among *contact);

#endif

/* Particles that visit other ranks, and what is told of them in a step (homes.h). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEAM_VISITS_H
#define DEM_SEAM_VISITS_H

#include "dem/seam/homes.h"

/* Work out who visits whom, and which chunks wait for which, by the present crossings, unless that is known. Errors:
 * TDM_ERR_MEMORY. */
tdm_status dem_homes_plan(dem_data *data);

/* Of visitors array[i] becomes what it is at their homes; of home particles it is there. Errors: TDM_ERR_MEMORY. */
tdm_status dem_visitors_learn(dem_data *data, int *array);

/* Immigrants leave, unless all places are known everywhere; visitors have come. */
void dem_visitors_begin(dem_data *data);
void dem_visitors_end(dem_data *data);

/* The reactions on visitors go home, and their places are empty again; those on home particles have come. In between
 * ranks tell each other nothing else. */
void dem_reactions_begin(dem_data *data);
void dem_reactions_end(dem_data *data);

/* Which way something goes, and what entry k is about where it is written, and where it is read. */
typedef enum {
  DEM_TO_HOME,   /* of contacts with visitors: homes.returning.item[k], and at the visitor's home returned.item[k] */
  DEM_FROM_HOME, /* the other way */
  DEM_TO_VISITED /* of particles: immigrants.item[k], visitors.item[k] */
} dem_course;

/* Entry k, of n doubles, from where this rank has it, or to there. */
typedef void dem_letter(dem_data *data, int k, double *entry);

/* Tell other ranks n doubles of each contact or particle, no more than an introduction has. */
void dem_homes_tell(dem_data *data, dem_course course, int n, dem_letter *write, dem_letter *read);

#endif

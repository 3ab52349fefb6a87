/* What a contact loop is asked for and what it gives back. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_TASK_H
#define DEM_CONTACT_LAW_TASK_H

#include "dem/base/energy.h"
#include "protocol/math/pose.h"

#include <stdbool.h>
#include <stddef.h>

struct dem_model;
struct dem_data;

/* Which contacts a loop is about: all, or those whose effective mass is below or above model->multi_step.mass. */
typedef enum { DEM_ALL, DEM_FAST, DEM_SLOW } dem_share;

/* One chunk of particles. */
typedef struct {
  const struct dem_model *model;
  struct dem_data *data;
  int chunk;
  bool settling; /* chooses model->settle_pair */
  double dt;     /* [s], 0: only evaluate */
  dem_share share;
  size_t wall_first, wall_end; /* entries of data->lists.walls that are looked at, of this chunk */
  tdm_wrench *load;            /* (nbody) out: what the walls add to the bodies' loads */
  tdm_vec3
      *entry_force; /* (data->lists.walls.count) out: force of each entry on its particle, but of planes; or NULL */
  long touching;    /* out: contacts */
  dem_flux flux;    /* out: energies, when the scene asks for them */
} dem_loop_task;

/* Add the forces of the chunk's contacts to data->state.push (and, for walls, to the task's loads), advancing the
 * histories by dt. */
typedef void dem_loop(dem_loop_task *task);

typedef struct dem_loops {
  dem_loop *pairs, *walls;
} dem_loops;

/* What contacts tell the others of their particles, before the forces (seam/notes.h). */
typedef struct dem_noting {
  dem_loops write; /* the notes of a chunk's contacts */
  dem_loop *share; /* from these, what the contacts of each of a chunk's particles give each other */
  double (*again)(dem_loop_task *task, double *largest); /* the notes of a chunk anew, from what was given; returns
                                                            the largest change of a force; largest: of a force [N] */
  long (*iterations)(const struct dem_model *model);     /* how often they are shared, at most */
  double (*tolerance)(const struct dem_model *model); /* share of the largest force; no change above it: it is enough */
} dem_noting;

/* The loops of a normal law for one instruction set. */
typedef struct {
  const dem_loops *with;    /* with each tangential law, by its place in the table; NULLs: they do not go together */
  dem_loops all_terms;      /* with the scene's laws of all families, and with energies */
  dem_loops called;         /* likewise, with laws that a program adds, which are called; in plain C, else NULLs */
  int nsum;                 /* sums over the contacts of a particle, taken before the forces */
  dem_loops sums;           /* these, added to data->work.contact_sum; NULLs without them */
  const dem_noting *noting; /* NULL: it takes no notes */
} dem_loop_set;

#endif

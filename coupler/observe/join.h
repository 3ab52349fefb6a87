/* What there is to see of two solvers, put together: the bodies of the mechanism first, then those that only DEM has. A
 * coupled body is one, with mbd's name and pose; its surface is DEM's, and mbd's where DEM has none. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_OBSERVE_JOIN_H
#define CPL_OBSERVE_JOIN_H

#include "coupler/settings/settings.h"
#include "protocol/view/view.h"

/* Where the parts of both went. Zero-initialise; freed with cpl_join_free. */
typedef struct {
  int nbody, npolygon;  /* of both together */
  int *body[CPL_NROLE]; /* of each solver's bodies: their number in both */
  int npolygon_of_dem;  /* they are the first */
} cpl_join;

/* Make one scenery of two; that of a solver that is not seen is empty. */
tdm_status cpl_join_sceneries(cpl_join *join, const cpl_settings *settings, const tdm_scenery of[CPL_NROLE],
                              tdm_scenery *both, tdm_error *err);

/* Make one snapshot of two, which belong to those sceneries; that of a solver that is not seen is empty. */
tdm_status cpl_join_snapshots(const cpl_join *join, const tdm_snapshot of[CPL_NROLE], tdm_snapshot *both,
                              tdm_error *err);

void cpl_join_free(cpl_join *join);

#endif

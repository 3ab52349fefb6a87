/* The tables of contact laws, one a family. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TABLE_H
#define DEM_CONTACT_TABLE_H

#include "dem/contact/law/law.h"

/* "normal", "tangential", … as in dem.contact. */
extern const char *const dem_family_names[DEM_FAMILIES];

/* Row `place` of a family's table, NULL behind the last. It is the head of a dem_normal_law, dem_tangential_law, … */
const dem_law_head *dem_law_at(dem_family family, int place);

/* Place of a law in its family's table, -1: none has this name. */
int dem_law_place(dem_family family, const char *name);

/* Put a program's own law behind the table's, for the process; `law` is the head of its row, which stays the caller's
 * and must outlive it. Before any model is read. A normal law and one of many contacts bring their loops, made in a
 * file of their own; any other its kernel. TDM_ERR_ARGUMENT: the table is full, or has a law of this name. */
tdm_status dem_law_add(dem_family family, const dem_law_head *law, tdm_error *err);

/* The law of a family that a model has. */
const dem_law_head *dem_law_of(const dem_model *model, dem_family family);

/* model->place and model->loops, from its laws, model->simd and model->all_terms. False: the normal and the tangential
 * law do not go together. */
bool dem_loops_choose(dem_model *model);

/* model->columns, from its laws; sliding: contacts remember whether they slide. False: the laws have more columns than
 * a contact can keep, DEM_HISTORY_MAX. */
bool dem_columns_choose(dem_model *model, bool sliding);

#endif

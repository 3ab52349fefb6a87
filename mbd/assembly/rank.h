/* Dependent constraint rows: those that fix a motion which the rows before them fix already. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ASSEMBLY_RANK_H
#define MBD_ASSEMBLY_RANK_H

#include "mbd/mechanics/state.h"

/* Mark the dependent rows of G at data->kin in `dependent` (nrow), each row against those before it: so joints come
 * first in the scene's order, drivers last. *number is how many there are, *near the most nearly dependent one of the
 * others, -1: none is nearly so. false: out of memory. */
bool mbd_rank(const mbd_model *model, mbd_data *data, bool *dependent, int *number, int *near);

/* The same with the row `without` left out: it counts as dependent. */
bool mbd_rank_without(const mbd_model *model, mbd_data *data, int without, bool *dependent, int *number, int *near);

#endif

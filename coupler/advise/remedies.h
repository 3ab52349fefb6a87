/* What is tried after the first trial: remedies where it is bad, in the order of [L18]; what is cheaper where it is
 * good; and whether the DEM step is short enough. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ADVISE_REMEDIES_H
#define CPL_ADVISE_REMEDIES_H

#include "coupler/advise/advisor.h"

/* Shorter windows than those of `first`, then other formulations and tighter tolerances, then shorter steps, until one
 * is good (advisor->a.found). */
tdm_status cpl_remedies(cpl_advisor *advisor, const cpl_candidate *first, tdm_error *err);

/* Longer windows, as long as they save something and bear it. */
tdm_status cpl_longer_windows(cpl_advisor *advisor, tdm_error *err);

/* Another formulation, where the MBD solver takes much of the time. */
tdm_status cpl_cheaper_formulation(cpl_advisor *advisor, tdm_error *err);

/* A looser tolerance of the MBD solver, where that takes much of the time and bears it. */
tdm_status cpl_looser_tolerance(cpl_advisor *advisor, tdm_error *err);

/* Windows that choose their length, where that is cheaper than the n that was found. */
tdm_status cpl_own_windows(cpl_advisor *advisor, tdm_error *err);

/* Half the step at the same window, and half of that where it matters. */
tdm_status cpl_check_step(cpl_advisor *advisor, tdm_error *err);

#endif

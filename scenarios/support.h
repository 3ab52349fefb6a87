/* What the scenarios share: values of the scene as it ran, time histories by name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_SUPPORT_H
#define SCN_SUPPORT_H

#include "coupler/results/table.h"
#include "coupler/verify/verify.h"

/* One result directory. Zero-initialise; free with scn_result_free. */
typedef struct {
  json_t *scene;   /* scene.json: the scene with all overrides */
  json_t *summary; /* summary.json */
  cpl_table body;  /* body_<name>.csv of the first coupled body */
  cpl_table mbd, dem;
} scn_result;

tdm_status scn_result_read(scn_result *r, const char *dir, tdm_error *err);
void scn_result_free(scn_result *r);

/* The number at a path ("mbd.forces[0].stiffness", "solvers.dem.report.fill.mass") of a JSON value; an error when there
 * is none. */
double scn_number(const json_t *json, const char *path, tdm_error *err);

/* The same, with a value for when there is none. */
double scn_number_or(const json_t *json, const char *path, double fallback);

/* A case that has run, compared with its reference: nse (with the limit) and r2 of every state, r2 of every load;
 * writes the comparison and its plots. The caller frees *c also after an error; what is measured next belongs to the
 * case. */
tdm_status scn_verify_measure(cpl_verify *v, const cpl_verify_case *run, double least_nse, cpl_comparison *c,
                              tdm_error *err);

/* As scn_verify_comparison; the directory of case "" and its comparison (freed by the caller also after an error) are
 * handed out, and what is measured next belongs to it. */
tdm_status scn_verify_run_and_compare(cpl_verify *v, bool settles, double least_nse, char *dir, size_t size,
                                      cpl_comparison *c, tdm_error *err);

/* Run the scenario's scene with `lommen` (case "") and with `proxy`, and measure both. settles: the scene has a bed. */
tdm_status scn_verify_comparison(cpl_verify *v, bool settles, double least_nse, tdm_error *err);

#endif

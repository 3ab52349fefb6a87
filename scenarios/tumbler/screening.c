/* The screening of the tumbler screening machine: [A07]'s parametric studies, and the order in which they come out.
 *
 * [A07] gives statements, not curves, and leaves out half of its machine (README.md), so what has a limit is an order:
 * the better case less the worse one is positive. --full runs every study whole.
 *
 * [A07]: Alkhaldi (2007), dissertation, Universität Stuttgart, Section 4.4.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/table.h"

#include <stdio.h>

/* The mean of a measure is larger in one cell than in the other. */
typedef struct {
  const char *measure, *larger, *smaller; /* names in the study */
} order;

enum { ORDERS_MAX = 6, CELLS_MAX = 6 };

typedef struct {
  const char *file;                /* studies/FILE.json */
  const char *only[CELLS_MAX + 1]; /* cells without --full; none: a study of --full alone */
  const char *seeds[3];            /* of these without --full; none: all */
  const char *set[2];              /* and with these settings without --full */
  const char *measure;             /* its main measure */
  order orders[ORDERS_MAX + 1];    /* ended by a NULL measure */
  const char *least[2];            /* cell with the smallest `none`, which is at most `most` */
  double most;
} study_row;

static const study_row studies[] = {
    {.file = "speed",
     .only = {"rpm=10", "rpm=50", "rpm=150", "rpm=250"},
     .seeds = {"1"},
     .set = {"parameters.end=20"}, /* counted from 10 s on, when the machine is steady */
     .measure = "screening.efficiency",
     .orders = {{"screening.efficiency", "rpm=50", "rpm=150"},
                {"screening.efficiency", "rpm=150", "rpm=250"},
                {"screening.efficiency", "rpm=250", "rpm=10"}}},
    {.file = "friction",
     .only = {"friction_deck=0", "friction_deck=0.06", "friction_deck=0.3"},
     .seeds = {"1", "2"}, /* without a third, as at 0.3 runs are five times as long */
     .measure = "screening.efficiency_mass",
     .orders = {{"screening.efficiency_mass", "friction_deck=0.06", "friction_deck=0"},
                {"share", "friction_deck=0", "friction_deck=0.06"},
                {"rate_upper", "friction_deck=0", "friction_deck=0.06"}},
     .least = {"screening.out", "friction_deck=0.3"},
     .most = 39}, /* 5 % of 775: none or almost none; set after 28 to 31 were seen, which bounce out at the feed */
    {.file = "oscillation",
     .only = {"turning", "held", "K = 0.7"},
     .seeds = {"1"},
     .set = {"parameters.end=20"},
     .measure = "screening.efficiency",
     .orders = {{"screening.efficiency", "held", "turning"}, {"screening.efficiency", "K = 0.7", "held"}}},
    {.file = "feed", .measure = "screening.efficiency"},
    {.file = "tilt", .measure = "screening.efficiency"},
    {.file = "eccentricity",
     .measure = "lowest_sorted",
     .orders = {{"lowest_sorted", "eccentricity=0.04", "eccentricity=0.3"}}},
    {.file = "size", .measure = "screening.efficiency_mass"},
    {.file = "spring", .measure = "screening.efficiency"},
    {.file = "hole", .measure = "screening.efficiency"},
    {.file = "nozzle", .measure = "feed"},
    {.file = "number", .measure = "run_time"},
};

/* All that a study's cells gave for one measure. */
static void report(cpl_verify *v, const cpl_study *study, const study_row *row, const char *name, cpl_limit_kind kind) {
  const int measure = cpl_study_find_measure(study, name, &(tdm_error){0});
  for (int cell = 0; measure >= 0 && cell < study->ncell; cell++) {
    char cell_name[256], case_name[64], text[64];
    if (!cpl_study_status(study, cell))
      continue;
    snprintf(case_name, sizeof case_name, "%.20s %.40s", row->file,
             cpl_study_cell_name(study, cell, cell_name, sizeof cell_name));
    snprintf(text, sizeof text, "%s", name);
    cpl_verify_measure(v, text, case_name, cpl_study_value(study, cell, measure).mean, kind, 0);
  }
}

static void judge(cpl_verify *v, const cpl_study *study, const study_row *row) {
  report(v, study, row, row->measure, CPL_NO_LIMIT);
  report(v, study, row, "screening.lost", CPL_AT_MOST);
  for (const order *o = row->orders; o->measure; o++) {
    char name[64], case_name[64];
    snprintf(name, sizeof name, "%.40s, more", o->measure);
    snprintf(case_name, sizeof case_name, "%.24s than %.24s", o->larger, o->smaller);
    cpl_verify_measure(v, name, case_name,
                       cpl_study_mean(study, o->larger, o->measure) - cpl_study_mean(study, o->smaller, o->measure),
                       CPL_AT_LEAST, 0);
  }
  if (row->least[0])
    cpl_verify_measure(v, row->least[0], row->least[1], cpl_study_mean(study, row->least[1], row->least[0]),
                       CPL_AT_MOST, row->most);
}

static tdm_status run_study(cpl_verify *v, const study_row *row, tdm_error *err) {
  char file[64];
  cpl_study study = {0};
  const cpl_verify_part all = {0},
                        some = {.only = row->only, .set = row->set, .seeds = row->seeds[0] ? row->seeds : NULL};
  snprintf(file, sizeof file, "studies/%s.json", row->file);
  if (cpl_verify_study(v, file, cpl_verify_full(v) ? &all : &some, &study, err) == TDM_OK)
    judge(v, &study, row);
  cpl_study_free(&study);
  return err->status;
}

tdm_status scn_tumbler_screening(cpl_verify *v, tdm_error *err) {
  for (size_t k = 0; k < sizeof studies / sizeof *studies; k++)
    if ((studies[k].only[0] || cpl_verify_full(v)) && run_study(v, &studies[k], err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

/* What a family's runs came to: a table on the terminal, cells.json, and the map of all families. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_STABILITY_REPORT_H
#define SCN_STABILITY_REPORT_H

#include "scenarios/stability/judge.h"

/* rows: an array of scn_judge's, cases one after the other, all schemes of a case together. */
void scn_stability_print(const char *title, const json_t *rows);

/* Limits on the rows: nothing broken, nothing wrong without a word, `proxy` ok within its bounds, with windows of a
 * given length where its models hold, with windows that choose theirs everywhere. */
void scn_stability_measure(cpl_verify *v, const json_t *rows);

/* {"title", "cells": rows} as cells.json in the scenario's directory, and as the scenario's detail. */
tdm_status scn_stability_write(cpl_verify *v, const char *title, json_t *rows, tdm_error *err);

#endif

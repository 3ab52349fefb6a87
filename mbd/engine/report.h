/* What an engine says of its start: doubts, and figures of the mechanism. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ENGINE_REPORT_H
#define MBD_ENGINE_REPORT_H

#include "mbd/assembly/assemble.h"

enum { MBD_WARNINGS_MAX = 6 };

typedef struct {
  const mbd_model *model;       /* borrowed, as the next two */
  const mbd_data *data;         /* assembled, at the start */
  const mbd_assembly *assembly; /* what came of it */
  int nwarning;
  tdm_warning warning[MBD_WARNINGS_MAX]; /* (nwarning) */
} mbd_report;

/* Add the doubts. */
void mbd_report_warn(mbd_report *report);

/* The figures, a new reference; NULL: out of memory. */
json_t *mbd_report_json(const mbd_report *report);

#endif

/* Time histories of a result directory, as tests read them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_RESULT_TABLE_H
#define TEST_RESULT_TABLE_H

#include "coupler/results/table.h"

#include <check.h>
#include <stdio.h>

/* The table DIR/FILE; to be freed by cpl_table_free. */
static inline void read_table(cpl_table *table, const char *dir, const char *file) {
  char path[512];
  tdm_error err = {0};
  snprintf(path, sizeof path, "%s/%s", dir, file);
  ck_assert_msg(cpl_table_read(table, path, &err) == TDM_OK, "%s", err.message);
}

/* A column (nrow) of a table, which keeps it. */
static inline const double *column(const cpl_table *table, const char *name) {
  tdm_error err = {0};
  const double *c = cpl_table_column(table, name, &err);
  ck_assert_msg(c != NULL, "%s", err.message);
  return c;
}

#endif

/* Table, limits and files of a family: see report.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/stability/report.h"

#include "scenarios/support.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The bounds within which `proxy` has to hold, and what its exchange may make of the energy that goes through. */
static const double ratio_most = 10, window_most = 1e-2, residual_most = 1e-3;

static const char *text(const json_t *row, const char *key) {
  const char *value = json_string_value(json_object_get(row, key));
  return value ? value : "";
}

static double number(const json_t *row, const char *key) {
  return scn_number_or(row, key, NAN);
}

static bool is_true(const json_t *row, const char *key) {
  return json_is_true(json_object_get(row, key));
}

static bool is_proxy(const json_t *row) {
  return strcmp(text(row, "scheme"), "proxy") == 0;
}

static bool is_auto(const json_t *row) {
  return strcmp(text(row, "scheme"), scn_auto) == 0;
}

/* ---- the terminal ---- */

static void print_head(const char *title, const json_t *rows) {
  const char *first = text(json_array_get(rows, 0), "case");
  printf("\n%s: outcome and error\n%-34s", title, "");
  size_t i;
  json_t *row;
  json_array_foreach(rows, i, row) if (strcmp(text(row, "case"), first) == 0) printf(" %-16s", text(row, "scheme"));
  printf(" ceiling\n");
}

static void print_number(double x) {
  if (isnan(x))
    printf("%-7s", "-");
  else
    printf("%-7.1e", x);
}

static void print_cell(const json_t *row) {
  printf(" %-8s ", scn_outcome_name[scn_row_outcome(row)]);
  print_number(number(row, "error"));
}

/* What there is to say of a row that is not in order. */
static void print_reason(const json_t *row) {
  if (*text(row, "said"))
    printf("  %s %s, %s: %s\n", text(row, "case"), text(row, "scheme"), text(row, "outcome"), text(row, "said"));
}

void scn_stability_print(const char *title, const json_t *rows) {
  const char *now = "";
  double ceiling = NAN;
  size_t i;
  json_t *row;
  print_head(title, rows);
  json_array_foreach(rows, i, row) {
    if (strcmp(text(row, "case"), now) != 0) {
      now = text(row, "case");
      printf("%s%-34s", i ? "\n" : "", now);
    }
    print_cell(row);
    const json_t *next = json_array_get(rows, i + 1);
    if (!next || strcmp(text(next, "case"), now) != 0) {
      ceiling = number(row, "ceiling");
      printf(" ");
      print_number(ceiling);
      printf("%s", json_is_true(json_object_get(row, "chaotic")) ? " chaotic: mean and rms" : "");
      printf("%s", json_is_true(json_object_get(row, "beyond")) ? " beyond" : "");
      printf("%s", json_is_true(json_object_get(row, "coarse")) ? " coarse" : "");
    }
  }
  printf("\n");
  json_array_foreach(rows, i, row) if (is_auto(row) || is_proxy(row)) print_reason(row);
}

/* ---- limits ---- */

static bool is_broken(const json_t *row) {
  return scn_row_outcome(row) == SCN_BROKEN;
}

static bool is_silent(const json_t *row) {
  return scn_row_outcome(row) == SCN_SILENT;
}

/* within the bounds, and not accurate at its end */
static bool is_not_ok(const json_t *row) {
  return scn_row_outcome(row) > SCN_WARNED && number(row, "ratio") <= ratio_most &&
         number(row, "H") <= window_most * (1 + 1e-9);
}

static bool is_auto_not_ok(const json_t *row) {
  return is_auto(row) && is_not_ok(row);
}

static bool is_proxy_not_ok(const json_t *row) {
  return is_proxy(row) && !is_true(row, "beyond") && is_not_ok(row);
}

static void measure_count(cpl_verify *v, const json_t *rows, const char *name, bool is(const json_t *row),
                          cpl_limit_kind kind) {
  char example[64] = "";
  double n = 0;
  size_t i;
  json_t *row;
  json_array_foreach(rows, i, row) if (is(row) && n++ == 0)
      snprintf(example, sizeof example, "%.44s %.16s", text(row, "case"), text(row, "scheme"));
  cpl_verify_measure(v, name, example, n, kind, 0);
}

static bool is_proxy_within(const json_t *row) {
  return is_proxy(row) && !is_true(row, "beyond") && !is_true(row, "coarse");
}

static bool is_auto_within(const json_t *row) {
  return is_auto(row) && !is_true(row, "coarse");
}

/* The largest residual of runs that came to their end accurately. */
static void measure_residual(cpl_verify *v, const json_t *rows, const char *name, bool is(const json_t *row)) {
  char worst[64] = "";
  double most = 0;
  size_t i;
  json_t *row;
  json_array_foreach(rows, i,
                     row) if (is(row) && scn_row_outcome(row) <= SCN_WARNED && number(row, "residual_share") > most) {
    most = number(row, "residual_share");
    snprintf(worst, sizeof worst, "%.60s", text(row, "case"));
  }
  cpl_verify_measure(v, name, worst, most, CPL_AT_MOST, residual_most);
}

void scn_stability_measure(cpl_verify *v, const json_t *rows) {
  measure_count(v, rows, "broken", is_broken, CPL_AT_MOST);
  measure_count(v, rows, "silent", is_silent, CPL_AT_MOST);
  measure_count(v, rows, "proxy not ok", is_proxy_not_ok, CPL_AT_MOST);
  measure_count(v, rows, "auto not ok", is_auto_not_ok, CPL_AT_MOST);
  measure_residual(v, rows, "proxy, residual", is_proxy_within);
  measure_residual(v, rows, "auto, residual", is_auto_within);
}

tdm_status scn_stability_write(cpl_verify *v, const char *title, json_t *rows, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/cells.json", cpl_verify_dir(v));
  json_t *detail = json_pack("{s:s, s:O}", "title", title, "cells", rows);
  if (json_dump_file(detail, file, JSON_INDENT(1)) != 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  cpl_verify_detail(v, detail);
  return err->status;
}

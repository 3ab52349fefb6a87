/* Stiff and extreme cases: what each scheme makes of them, and whether it says so.
 *
 * A family (families/NAME.json) is a scene and values of its parameters. Each case runs with every scheme; its
 * reference is `proxy` with windows of one step; a twin of the reference, whose start is off by round-off, shows what
 * any run can reach.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/schemes.h"
#include "scenarios/stability/report.h"
#include "scenarios/table.h"

#include <stdio.h>
#include <string.h>

/* A parameter of a cell, as --set takes it. */
static void set_parameter(cpl_cell *cell, const char *key, const json_t *value, tdm_error *err) {
  char path[64], text[64];
  snprintf(path, sizeof path, "parameters.%.40s", key);
  if (json_is_string(value))
    snprintf(text, sizeof text, "%.60s", json_string_value(value));
  else
    snprintf(text, sizeof text, "%.17g", json_number_value(value));
  cpl_cell_set(cell, path, text, err);
}

static void set_case(cpl_cell *cell, const scn_family *f, const scn_stability_case *c, bool with_window,
                     tdm_error *err) {
  const char *key;
  json_t *value;
  cell->scene = f->scene;
  json_object_foreach(c->set, key, value) if (with_window || strcmp(key, "H") != 0)
      set_parameter(cell, key, value, err);
}

/* What a case is run with: tandem's defaults, `proxy` whose windows choose their length up to that of the case; each
 * scheme with windows of that length; and with --full [L18]'s exchange to the letter (docs/theory/coupling.md). */
static const char literal_name[] = "lommen-literal";
static const char literal[] = "{\"load\": \"end-held\", \"wall_velocity\": \"sent\"}";
static const char longest[] = "=max(1, rint(H/dt))";

static int columns(const cpl_verify *v) {
  int n = 0;
  while (cpl_schemes[n])
    n++;
  return 1 + n + cpl_verify_full(v);
}

static const char *column_name(int k) {
  if (k == 0)
    return scn_auto;
  for (int i = 0; i < k; i++)
    if (!cpl_schemes[i])
      return literal_name;
  return cpl_schemes[k - 1]->name;
}

static void set_column(cpl_cell *cell, int k, tdm_error *err) {
  const char *name = column_name(k);
  if (name == scn_auto) {
    cpl_cell_set(cell, "coupling.n", "auto", err);
    cpl_cell_set(cell, "coupling.auto.n_max", longest, err);
    return;
  }
  cpl_cell_set(cell, "coupling.scheme", name == literal_name ? "lommen" : name, err);
  if (name == literal_name)
    cpl_cell_set(cell, "coupling.lommen", literal, err);
}

/* Of a physics: the reference and those that start beside it. */
static void make_trio(const cpl_cells *cells, const scn_family *f, const scn_stability_case *c, tdm_error *err) {
  static const char *const names[SCN_TRIO] = {"reference", "twin", "neighbour"};
  for (int k = 0; k < SCN_TRIO; k++) {
    cpl_cell *cell = &cells->cell[SCN_TRIO * c->physics + k];
    char text[32];
    set_case(cell, f, c, false, err);
    cpl_cell_set(cell, "parameters.H", "=dt", err);
    snprintf(text, sizeof text, "%g", scn_nudge[k]);
    cpl_cell_set(cell, "parameters.nudge", text, err);
    snprintf(text, sizeof text, "%s %d", names[k], c->physics);
    cpl_cell_place(cells, cell, text, 2);
  }
}

/* Of each physics the trio, then of each case the schemes. */
static tdm_status make_cells(cpl_cells *cells, const scn_family *f, int nscheme, tdm_error *err) {
  if (cpl_cells_make(cells, SCN_TRIO * f->nphysics + nscheme * f->ncase, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < f->ncase; i++) {
    const scn_stability_case *c = &f->at[i];
    if (!cells->cell[SCN_TRIO * c->physics].scene)
      make_trio(cells, f, c, err);
    for (int k = 0; k < nscheme; k++) {
      cpl_cell *cell = &cells->cell[SCN_TRIO * f->nphysics + nscheme * i + k];
      char name[160];
      set_case(cell, f, c, true, err);
      set_column(cell, k, err);
      snprintf(name, sizeof name, "%s %s", c->name, column_name(k));
      cpl_cell_place(cells, cell, name, (int)json_object_size(c->set) + 1);
    }
  }
  return err->status;
}

static json_t *judge(const cpl_cells *cells, const scn_family *f, int nscheme) {
  json_t *rows = json_array();
  for (int i = 0; i < f->ncase; i++)
    for (int k = 0; k < nscheme; k++)
      json_array_append_new(rows, scn_judge(f, &f->at[i], column_name(k),
                                            &cells->cell[SCN_TRIO * f->nphysics + nscheme * i + k],
                                            &cells->cell[SCN_TRIO * f->at[i].physics]));
  return rows;
}

tdm_status scn_stability(cpl_verify *v, tdm_error *err) {
  scn_family f = {0};
  cpl_cells cells = {.out = cpl_verify_dir(v)};
  const char *name = cpl_verify_name(v) + strlen("stability_");
  if (scn_family_read(&f, v, name, cpl_verify_full(v), err) == TDM_OK &&
      make_cells(&cells, &f, columns(v), err) == TDM_OK && cpl_verify_cells(v, &cells, err) == TDM_OK) {
    json_t *rows = judge(&cells, &f, columns(v));
    scn_stability_print(f.title, rows);
    scn_stability_measure(v, rows);
    scn_stability_write(v, f.title, rows, err);
    json_decref(rows);
  }
  cpl_cells_free(&cells);
  scn_family_free(&f);
  return err->status;
}

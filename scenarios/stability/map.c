/* The map of all families: cases down, schemes across, the outcome as colour, the error as a number.
 *
 * It reads cells.json of the families that have run, in this verification or an earlier one into the same directory.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/stability/report.h"
#include "scenarios/support.h"
#include "scenarios/table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char group[] = "stability", own_name[] = "stability_map";

enum { SCHEMES_MAX = 12, ROW_HEIGHT = 13, COLUMN_WIDTH = 66, LEFT = 256, TOP = 56, BOTTOM = 20 }; /* pixels */

/* colours of the outcomes, 0xRRGGBB */
static const unsigned colour[SCN_OUTCOMES] = {0x9fd89f, 0xdff0a0, 0xffd27f, 0xa9c4e8, 0xd8d8d8, 0xf04040, 0xc040c0};

typedef struct {
  FILE *data, *labels; /* cells; names beside the rows, as gnuplot commands */
  int nrow, nscheme;
  const char *scheme[SCHEMES_MAX]; /* in order of appearance */
  int n[SCN_OUTCOMES];
} map;

static const char *text(const json_t *row, const char *key) {
  const char *value = json_string_value(json_object_get(row, key));
  return value ? value : "";
}

static int column_of(map *m, const char *scheme) {
  int i = 0;
  while (i < m->nscheme && strcmp(m->scheme[i], scheme) != 0)
    i++;
  if (i == m->nscheme && i < SCHEMES_MAX)
    m->scheme[m->nscheme++] = scheme;
  return i;
}

/* A name beside the row; quotes and backslashes have no place in it. */
static void label(map *m, const char *name, const char *font, double x) {
  fprintf(m->labels, "set label '");
  for (; *name; name++)
    fputc(*name == '\'' || *name == '\\' ? ' ' : *name, m->labels);
  fprintf(m->labels, "' at screen 0, first %d offset character %g,0 left font '%s'\n", -m->nrow, x, font);
}

static void add_cell(map *m, const json_t *row) {
  const scn_outcome outcome = scn_row_outcome(row);
  const double error = scn_number_or(row, "error", NAN);
  m->n[outcome]++;
  fprintf(m->data, "%d %d %u ", column_of(m, text(row, "scheme")), -m->nrow, colour[outcome]);
  if (isnan(error) || outcome == SCN_STOPPED || outcome == SCN_REFUSED)
    fprintf(m->data, "%s\n", scn_outcome_name[outcome]);
  else
    fprintf(m->data, "%.0e\n", error);
}

static void add_family(map *m, const json_t *family) {
  const json_t *rows = json_object_get(family, "cells");
  const char *now = "";
  size_t i;
  json_t *row;
  m->nrow++;
  label(m, text(family, "title"), ",9", 1);
  json_array_foreach(rows, i, row) {
    if (strcmp(text(row, "case"), now) != 0) {
      char name[128];
      now = text(row, "case");
      snprintf(name, sizeof name, "%s%s%s%s", now, json_is_true(json_object_get(row, "chaotic")) ? " *" : "",
               json_is_true(json_object_get(row, "beyond")) ? " +" : "",
               json_is_true(json_object_get(row, "coarse")) ? " o" : "");
      m->nrow++;
      label(m, name, ",8", 3);
    }
    add_cell(m, row);
  }
}

static void write_script(const map *m, FILE *f) {
  const int height = TOP + BOTTOM + ROW_HEIGHT * (m->nrow + 1), width = LEFT + COLUMN_WIDTH * m->nscheme + 20;
  fprintf(f, "set terminal png notruecolor noenhanced size %d,%d font ',8'\nset output 'map.png'\nload 'map.labels'\n",
          width, height);
  fprintf(f, "set lmargin at screen %g\nset rmargin at screen %g\nset tmargin at screen %g\nset bmargin at screen %g\n",
          (double)LEFT / width, 1 - 20.0 / width, 1 - (double)TOP / height, (double)BOTTOM / height);
  fprintf(f,
          "unset key\nunset border\nunset ytics\nset xrange [-0.5:%g]\nset yrange [%g:-0.5]\nset x2range [-0.5:%g]\n",
          m->nscheme - 0.5, -m->nrow - 0.5, m->nscheme - 0.5);
  fputs("unset xtics\nset x2tics scale 0 (", f);
  for (int i = 0; i < m->nscheme; i++)
    fprintf(f, "%s'%.20s' %d", i ? ", " : "", m->scheme[i], i);
  fputs(")\n", f);
  for (int i = 0, x = 10; i < SCN_OUTCOMES; i++, x += 82) {
    fprintf(f, "set object rectangle from screen %g,%g to screen %g,%g fillstyle solid fillcolor rgb 0x%06x\n",
            (double)x / width, 1 - 10.0 / height, (x + 14.0) / width, 1 - 22.0 / height, colour[i]);
    fprintf(f, "set label '%s %d' at screen %g,%g\n", scn_outcome_name[i], m->n[i], (x + 18.0) / width,
            1 - 16.0 / height);
  }
  fputs("set label '* chaotic: mean and rms; + beyond; o coarse' at screen 0.01,", f);
  fprintf(f, "%g\n", (double)BOTTOM / 2 / height);
  fputs(
      "plot 'map.data' using 1:2:(0.47):(0.44):3 with boxxyerror fillstyle solid noborder linecolor rgb variable, \\\n"
      "     '' using 1:2:4 with labels\n",
      f);
}

/* a file of the map's directory */
static FILE *open_file(const cpl_verify *v, const char *name, tdm_error *err) {
  char file[4352];
  snprintf(file, sizeof file, "%s/%s", cpl_verify_dir(v), name);
  FILE *f = fopen(file, "w");
  if (!f)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  return f;
}

/* cells.json of all families beside this directory, in the table's order (new reference). */
static json_t *read_families(const cpl_verify *v) {
  json_t *families = json_array();
  for (const cpl_scenario *s = scn_table; s->name; s++) {
    char file[4352];
    if (strcmp(s->group, group) != 0 || strcmp(s->name, own_name) == 0)
      continue;
    snprintf(file, sizeof file, "%s/../%s/cells.json", cpl_verify_dir(v), s->name);
    json_t *family = json_load_file(file, 0, NULL);
    if (family)
      json_array_append_new(families, family);
  }
  return families;
}

static tdm_status draw(const cpl_verify *v, const json_t *families, map *m, tdm_error *err) {
  size_t i;
  json_t *family;
  m->data = open_file(v, "map.data", err);
  m->labels = m->data ? open_file(v, "map.labels", err) : NULL;
  FILE *script = m->labels ? open_file(v, "map.gp", err) : NULL;
  if (script) {
    json_array_foreach(families, i, family) add_family(m, family);
    write_script(m, script);
  }
  FILE *const all[] = {m->data, m->labels, script};
  for (int k = 0; k < 3; k++)
    if (all[k])
      fclose(all[k]);
  return err->status;
}

tdm_status scn_stability_map(cpl_verify *v, tdm_error *err) {
  map m = {0};
  if (tdm_make_directory(cpl_verify_dir(v), err) != TDM_OK)
    return err->status;
  json_t *families = read_families(v);
  if (draw(v, families, &m, err) == TDM_OK && m.nrow > 0) {
    tdm_error plot = {0};
    if (tdm_plot_run(cpl_verify_dir(v), "map", &plot) != TDM_OK)
      fprintf(stderr, "tandem: notice: %s\n", plot.message);
    for (int i = 0; i < SCN_OUTCOMES; i++)
      cpl_verify_measure(v, scn_outcome_name[i], "all families", m.n[i], CPL_NO_LIMIT, 0);
  }
  json_decref(families);
  return err->status;
}

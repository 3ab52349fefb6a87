/* What a calibration says: lines, tables, files. See calibration.h; docs/calibrate.md has the keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/calibration.h"

#include "protocol/scene/json.h"
#include "protocol/version.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static const char *const endings[] = {
    [CPL_CONVERGED] = "converged", [CPL_AT_LIMIT] = "at_end",         [CPL_FLAT] = "flat",      [CPL_SPENT] = "spent",
    [CPL_FAILED] = "failed",       [CPL_INTERRUPTED] = "interrupted", [CPL_RUNNING] = "running"};

const char *cpl_ending_name(cpl_ending ending) {
  return endings[ending];
}

/* The reason of the last try that has no misfit. */
static const char *last_reason(const cpl_calibration *c) {
  for (int i = c->ntry - 1; i >= 0; i--)
    if (c->tried[i].reason[0])
      return c->tried[i].reason;
  return "there was none";
}

const char *cpl_ending_words(const cpl_calibration *c, char *out, size_t size) {
  const char *ends = "";
  for (int k = c->nparameter - 1; k >= 0; k--)
    ends = c->parameter[k].at_end ? c->parameter[k].path : ends;
  switch (c->ending) {
  case CPL_CONVERGED:
    snprintf(out, size, "the search came to rest, its steps below %g of the ranges", c->o->tolerance);
    break;
  case CPL_AT_LIMIT:
    snprintf(out, size, "the best value of %.200s lies at an end of its range; widen it if values beyond make sense",
             ends);
    break;
  case CPL_FLAT:
    snprintf(out, size, "all tries have the same misfit: nothing that is compared depends on the parameters");
    break;
  case CPL_SPENT:
    snprintf(out, size, "all %d tries were made; --resume with more --tries goes on", c->o->tries);
    break;
  case CPL_FAILED:
    snprintf(out, size, "no run could be compared with the targets; the last: %.300s", last_reason(c));
    break;
  case CPL_INTERRUPTED:
    snprintf(out, size, "interrupted; --resume goes on");
    break;
  case CPL_RUNNING:
    snprintf(out, size, "the search has not come to its end");
    break;
  }
  return out;
}

/* How well a value is determined, by its standard error beside its range; NULL: not known. */
static const char *determined(const cpl_parameter *p, double value) {
  const double range = p->log ? value * log(p->to / p->from) : p->to - p->from;
  return isnan(p->error) ? NULL : p->error <= 0.05 * range ? "well" : p->error <= 0.2 * range ? "roughly" : "poorly";
}

static int count_failed(const cpl_calibration *c) {
  int n = 0;
  for (int i = 0; i < c->ntry; i++)
    n += isnan(c->tried[i].misfit);
  return n;
}

static double wall_of(const cpl_calibration *c) {
  double sum = 0;
  for (int i = 0; i < c->ntry; i++)
    sum += c->tried[i].wall;
  return sum;
}

/* The misfit of one target in a try; NaN: none. */
static double target_misfit(const cpl_calibration *c, int k, const cpl_try *t) {
  double sum = 0;
  int first = 0;
  for (int j = 0; j < k; j++)
    first += c->target[j].n;
  for (int i = 0; t->row && i < c->target[k].n; i++)
    sum += pow((t->row[first + i] - c->target[k].y[i]) / c->target[k].scale, 2) / c->target[k].n;
  return t->row ? sqrt(sum) : NAN;
}

/* ---- lines ---- */

void cpl_tell_try(const cpl_calibration *c, int which) {
  const cpl_try *t = &c->tried[which];
  const char *start = isatty(2) ? "\r\033[K" : ""; /* where the cell's name stands */
  if (isnan(t->misfit))
    fprintf(stderr, "%standem: try %d: %s: no misfit: %s\n", start, which + 1, t->label, t->reason);
  else
    fprintf(stderr, "%standem: try %d: %s: misfit %.4g%s, %.1f s\n", start, which + 1, t->label, t->misfit,
            t->aside           ? " (beside the best)"
            : c->best == which ? ", the best so far"
                               : "",
            t->wall);
}

/* ---- the terminal ---- */

static const char *number(double x, char *out, size_t size) {
  snprintf(out, size, "%.4g", x);
  return isfinite(x) ? out : "-";
}

static void print_parameters(const cpl_calibration *c, const cpl_try *best) {
  char a[32], b[32];
  printf("\n%-32s %12s %14s %14s %12s %12s\n", "parameter", "value", "std error", "for 1 %", "from", "to");
  for (int k = 0; k < c->nparameter; k++) {
    const cpl_parameter *p = &c->parameter[k];
    const char *how = determined(p, best->value[k]);
    printf("%-32s %12.6g %14s %14s %12.6g %12.6g%s%s%s%s\n", p->path, best->value[k], number(p->error, a, sizeof a),
           number(p->percent, b, sizeof b), p->from, p->to, p->log ? "  log" : "", p->at_end ? "  at an end" : "",
           how ? "  " : "", how ? how : "");
  }
  for (int a_ = 0; a_ < c->nparameter; a_++)
    for (int b_ = a_ + 1; b_ < c->nparameter; b_++)
      if (!isnan(c->correlation[a_][b_]))
        printf("correlation of %s and %s: %.3f\n", c->parameter[a_].path, c->parameter[b_].path,
               c->correlation[a_][b_]);
}

static void print_targets(const cpl_calibration *c, const cpl_try *best) {
  printf("\n%-32s %6s %12s %12s %12s %9s\n", "target", "rows", "misfit", "measured", "best run", "reached");
  for (int k = 0, first = 0; k < c->ntarget; first += c->target[k++].n) {
    const cpl_target *t = &c->target[k];
    char measured[32] = "", run[32] = "";
    if (!t->file) {
      snprintf(measured, sizeof measured, "%.6g", t->y[0]);
      snprintf(run, sizeof run, "%.6g", best->row[first]);
    }
    printf("%-32s %6d %12.4g %12s %12s %8.3g%%\n", t->name, t->n, target_misfit(c, k, best), measured, run,
           100 * best->covered);
  }
}

void cpl_calibration_print(const cpl_calibration *c) {
  char words[768], start[32];
  const cpl_try *best = c->best < 0 ? NULL : &c->tried[c->best];
  printf("%s: %s\n", cpl_ending_name(c->ending), cpl_ending_words(c, words, sizeof words));
  printf("%d tries, %d without a misfit; %d run%s each, %.3g s of run time\n", c->ntry, count_failed(c), c->nseed,
         c->nseed == 1 ? "" : "s", wall_of(c));
  if (!best)
    return;
  printf("misfit %.4g, with the values at the start %s\n", best->misfit,
         number(c->tried[0].misfit, start, sizeof start));
  if (isfinite(c->noise))
    printf("of the seeds' scatter %.4g\n", c->noise);
  print_parameters(c, best);
  print_targets(c, best);
  if (best->covered < 1)
    puts("the best run does not reach all rows of a target: beyond its end its last value counts");
  if (c->valleys > 1)
    printf(
        "the misfit has %d valleys over the parameter: runs scatter more than it moves them (--repeat), or there are "
        "several solutions (sensitivity.png)\n",
        c->valleys);
  if (c->better_nearby)
    puts(
        "a try beside the best one is better: the misfit scatters (--repeat), or the search ended early (--tolerance)");
  printf("\n");
  for (int k = 0; k < c->nparameter; k++)
    printf("%s--set '%s=%.9g'", k ? " " : "", c->parameter[k].path, best->value[k]);
  puts("");
}

/* ---- JSON ---- */

static json_t *parameter_json(const cpl_calibration *c, int k) {
  const cpl_parameter *p = &c->parameter[k];
  const double value = c->best < 0 ? NAN : c->tried[c->best].value[k];
  const char *how = c->best < 0 ? NULL : determined(p, value);
  json_t *correlation = json_array();
  for (int i = 0; i < c->nparameter; i++)
    json_array_append_new(correlation, tdm_number_to_json(c->correlation[k][i]));
  return json_pack("{s:s, s:f, s:f, s:b, s:f, s:o, s:o, s:o, s:o, s:o, s:s?, s:o, s:b}", "path", p->path, "from",
                   p->from, "to", p->to, "log", (int)p->log, "start", p->start, "value", tdm_number_to_json(value),
                   "sensitivity", tdm_number_to_json(p->sensitivity), "for_1_percent", tdm_number_to_json(p->percent),
                   "scatter", tdm_number_to_json(p->scatter), "standard_error", tdm_number_to_json(p->error),
                   "determined", how, "correlation", correlation, "at_end", (int)p->at_end);
}

static json_t *target_json(const cpl_calibration *c, int k, int first) {
  const cpl_target *t = &c->target[k];
  const cpl_try *best = c->best < 0 ? NULL : &c->tried[c->best];
  json_t *values = json_array();
  char file[4096];
  snprintf(file, sizeof file, "%s", t->file ? t->file : "");
  tdm_utf8_clean(file);
  for (int i = 0; best && i < t->n; i++)
    json_array_append_new(values, json_pack("[f, f, o]", t->x[i], t->y[i], tdm_number_to_json(best->row[first + i])));
  return json_pack("{s:s, s:s, s:i, s:f, s:o, s:o}", t->file ? "file" : "measure", t->file ? file : t->name, "channel",
                   t->column[1], "rows", t->n, "scale", t->scale, "misfit",
                   tdm_number_to_json(best ? target_misfit(c, k, best) : NAN), "values", values);
}

static json_t *try_json(const cpl_calibration *c, const cpl_try *t) {
  json_t *values = json_array();
  for (int k = 0; k < c->nparameter; k++)
    json_array_append_new(values, json_real(t->value[k]));
  return json_pack("{s:s, s:o, s:o, s:s, s:s, s:f, s:f, s:b}", "name", t->label, "values", values, "misfit",
                   tdm_number_to_json(t->misfit), "status", t->status, "reason", t->reason, "reached", t->covered,
                   "wall_s", t->wall, "aside", (int)t->aside);
}

static json_t *calibration_json(const cpl_calibration *c) {
  json_t *parameters = json_array(), *targets = json_array(), *tries = json_array();
  char words[768], scene[4096];
  const double misfit = c->best < 0 ? NAN : c->tried[c->best].misfit;
  for (int k = 0; k < c->nparameter; k++)
    json_array_append_new(parameters, parameter_json(c, k));
  for (int k = 0, first = 0; k < c->ntarget; first += c->target[k++].n)
    json_array_append_new(targets, target_json(c, k, first));
  for (int i = 0; i < c->ntry; i++)
    json_array_append_new(tries, try_json(c, &c->tried[i]));
  cpl_ending_words(c, words, sizeof words);
  tdm_utf8_clean(words);
  snprintf(scene, sizeof scene, "%s", c->o->scene);
  tdm_utf8_clean(scene);
  return json_pack("{s:s, s:s, s:s, s:s, s:s, s:f, s:o, s:o, s:o, s:i, s:b, s:i, s:i, s:i, s:f, s:i, s:o, s:o, s:o}",
                   "tandem", TDM_VERSION, "scene", scene, "status", cpl_ending_name(c->ending), "reason", words,
                   "method", c->nparameter == 1 ? "brent" : "simplex", "tolerance", c->o->tolerance, "misfit",
                   tdm_number_to_json(misfit), "misfit_at_start",
                   tdm_number_to_json(c->ntry > 0 ? c->tried[0].misfit : NAN), "noise", tdm_number_to_json(c->noise),
                   "valleys", c->valleys, "better_nearby", (int)c->better_nearby, "ntries", c->ntry, "failed",
                   count_failed(c), "runs", c->ntry * c->nseed, "wall_s", wall_of(c), "best", c->best, "parameters",
                   parameters, "targets", targets, "tries", tries);
}

/* ---- files ---- */

/* A text as a cell of CSV: what would end the cell is left out. */
static void write_text(FILE *f, const char *text) {
  for (; *text; text++)
    fputc(strchr(",\"\r\n", *text) ? ' ' : *text, f);
}

static tdm_status write_csv(const cpl_calibration *c, tdm_error *err) {
  FILE *f = tdm_results_file(c->results, "calibration.csv", err);
  if (!f)
    return err->status;
  fputs("try [1]", f);
  for (int k = 0; k < c->nparameter; k++) {
    fputc(',', f);
    write_text(f, c->parameter[k].path);
  }
  fputs(",misfit [1],status,aside\n", f);
  for (int i = 0; i < c->ntry; i++) {
    fprintf(f, "%d", i + 1);
    for (int k = 0; k < c->nparameter; k++)
      fprintf(f, ",%.9g", c->tried[i].value[k]);
    fprintf(f, ",%.9g,%s,%d\n", c->tried[i].misfit, c->tried[i].status, c->tried[i].aside);
  }
  return fclose(f) == 0 ? TDM_OK
                        : tdm_fail(err, TDM_ERR_FILE, NULL, "%s/calibration.csv: cannot be written: %s", c->o->out,
                                   strerror(errno));
}

tdm_status cpl_calibration_write(const cpl_calibration *c, const char *copy, tdm_error *err) {
  json_t *json = calibration_json(c);
  tdm_results_json(c->results, "calibration.json", json, err);
  if (copy && json_dump_file(json, copy, JSON_INDENT(2)) != 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written", copy);
  json_decref(json);
  return write_csv(c, err);
}

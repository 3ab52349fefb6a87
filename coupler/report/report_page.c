/* The page of a report: see report_page.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/report/report_page.h"

#include "coupler/contents/words.h"
#include "coupler/results/html.h"
#include "protocol/results/print.h"

#include <math.h>
#include <string.h>

static const char *text_of(const json_t *object, const char *key) {
  return json_string_value(json_object_get(object, key));
}

bool cpl_report_good(const cpl_report_data *r) {
  const char *status = text_of(r->summary, "status");
  return status && strcmp(status, "TDM_OK") == 0;
}

/* ---- head, warnings ---- */

/* How the run ended, in a word. */
static const char *ending(const cpl_report_data *r, const char *status) {
  if (cpl_report_good(r))
    return "finished";
  if (!status)
    return "unknown";
  if (strcmp(status, "TDM_ERR_INTERRUPTED") == 0)
    return "interrupted";
  return strncmp(status, "TDM_ERR_", 8) == 0 ? "failed" : status;
}

static void write_head(FILE *page, const cpl_report_data *r) {
  const char *title = text_of(r->scene, "title"), *scene = text_of(r->summary, "scene");
  const char *status = text_of(r->summary, "status");
  cpl_html_head(page, title && *title ? title : scene ? scene : "A run of tandem");
  fputs("<p class=\"quiet\">", page);
  if (scene) {
    fputs("scene: ", page);
    cpl_html_text(page, scene);
    fputs(" &middot; ", page);
  }
  fputs("status: ", page);
  cpl_html_text(page, ending(r, status));
  fputs("</p>\n", page);
  if (cpl_report_good(r))
    return;
  fputs("<div class=\"box error\">\n<p><b>The run did not come to its end.</b> ", page);
  const char *error = text_of(r->summary, "error");
  cpl_html_text(page, error                                         ? error
                      : status && strcmp(status, "unfinished") == 0 ? "It is still under way, or was ended by force."
                                                                    : "Why is not known: summary.json does not say.");
  fputs("</p>\n", page);
  cpl_report_logs(page, r->dir);
  fputs("</div>\n", page);
}

const char *cpl_report_remark(const json_t *entry, char *out, size_t size) {
  const char *from = text_of(entry, "from"), *path = text_of(entry, "path"), *message = text_of(entry, "message");
  const long long count = json_integer_value(json_object_get(entry, "count"));
  const int n = snprintf(out, size, "%s%s%s%s%s", from ? from : "", from ? ": " : "", path ? path : "",
                         path && *path ? ": " : "", message ? message : "");
  if (count > 1 && n > 0 && (size_t)n < size)
    snprintf(out + n, size - (size_t)n, " (%lld times, from t = %.6g s to %.6g s)", count,
             json_number_value(json_object_get(entry, "first_s")), json_number_value(json_object_get(entry, "last_s")));
  return out;
}

/* What DEM notes of its start: no reason for doubt, but worth a look. */
static const json_t *notes_of(const json_t *summary) {
  const json_t *report = json_object_get(json_object_get(json_object_get(summary, "solvers"), "dem"), "report");
  return json_object_get(report ? report : json_object_get(summary, "report"), "notes");
}

static void write_remarks(FILE *page, const cpl_report_data *r, const char *list, const char *kind, bool lacks) {
  const json_t *entries = json_object_get(r->summary, list), *notes = lacks ? NULL : notes_of(r->summary);
  const size_t n = json_array_size(entries);
  char text[2048];
  size_t k;
  json_t *note;
  if (n + json_array_size(notes) == 0 && (!lacks || r->nlack == 0))
    return;
  fprintf(page, "<div class=\"box %s\">\n<b>%s</b>\n<ul>\n", kind, list);
  for (size_t i = 0; i < n; i++) {
    fputs("<li>", page);
    cpl_html_text(page, cpl_report_remark(json_array_get(entries, i), text, sizeof text));
    fputs("</li>\n", page);
  }
  json_array_foreach((json_t *)notes, k, note) {
    fputs("<li>", page);
    cpl_html_text(page, tdm_json_text(note, text, sizeof text));
    fputs("</li>\n", page);
  }
  for (int i = 0; lacks && i < r->nlack; i++) {
    fputs("<li>report: ", page);
    cpl_html_text(page, r->lack[i]);
    fputs("</li>\n", page);
  }
  fputs("</ul>\n</div>\n", page);
}

/* ---- what ran ---- */

static void write_row(FILE *page, const char *name, const char *value) {
  fputs("<tr>", page);
  cpl_html_cell(page, name);
  cpl_html_cell(page, value);
  fputs("</tr>\n", page);
}

static void write_settings(FILE *page, const cpl_report_data *r) {
  static const char *const times[] = {"time.end", "time.dt", "output.interval", "window"};
  const char *key;
  json_t *value;
  char text[512];
  json_object_foreach(json_object_get(r->summary, "settings"), key, value) {
    tdm_json_text(value, text, sizeof text);
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++)
      if (strcmp(key, times[k]) == 0 && strlen(text) + 3 < sizeof text)
        strcat(text, " s");
    write_row(page, key, text);
  }
}

static void write_software(FILE *page, const cpl_report_data *r) {
  char text[512];
  const char *key, *software = text_of(r->summary, "software"), *tandem = text_of(r->summary, "tandem");
  const json_t *machine = json_object_get(r->summary, "machine");
  json_t *solver;
  if (tandem)
    write_row(page, "tandem", tandem);
  if (software)
    write_row(page, "solver", software);
  json_object_foreach(json_object_get(r->summary, "solvers"), key, solver) {
    software = text_of(solver, "software");
    write_row(page, key, software ? software : "-");
  }
  if (machine) {
    const char *system = text_of(machine, "system"), *processor = text_of(machine, "processor");
    snprintf(text, sizeof text, "%.200s %.200s, %lld cores", system ? system : "-", processor ? processor : "-",
             (long long)json_integer_value(json_object_get(machine, "cores")));
    write_row(page, "machine", text);
  }
}

/* Wall times of the parts, with bars. The server's own is what is left of the loop. */
static void write_times(FILE *page, const json_t *wall) {
  static const char *const names[][2] = {{"setup", "start"}, {"dem", "DEM"}, {"mbd", "MBD"}, {"output", "outputs"}};
  const double all = json_number_value(json_object_get(wall, "all"));
  const bool coupled = json_object_get(wall, "coupling") != NULL;
  const double exchange = json_number_value(json_object_get(wall, "dem_exchange")) +
                          json_number_value(json_object_get(wall, "mbd_exchange"));
  struct {
    const char *name;
    double time;
  } parts[7];
  int n = 0;
  double rest = all;
  for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
    if (json_object_get(wall, names[k][0])) {
      parts[n].name = names[k][1];
      parts[n++].time = json_number_value(json_object_get(wall, names[k][0]));
    }
  if (coupled) {
    parts[n].name = "exchange";
    parts[n++].time = exchange;
    parts[n].name = "server";
    parts[n++].time = fmax(0, json_number_value(json_object_get(wall, "coupling")) - exchange);
  }
  for (int k = 0; k < n; k++)
    rest -= parts[k].time;
  parts[n].name = "end, plots";
  parts[n++].time = fmax(0, rest);
  fprintf(page, "<h3>Where the time went</h3>\n<table>\n<tr><th class=\"text\">part</th><th>wall time [s]</th></tr>\n");
  for (int k = 0; k < n; k++)
    fprintf(page,
            "<tr><td class=\"text\">%s</td><td>%.3f</td><td class=\"text\" style=\"width:20em\"><div class=\"bar\" "
            "style=\"width:%.1f%%\"></div></td></tr>\n",
            parts[k].name, parts[k].time, all > 0 ? fmin(100, 100 * parts[k].time / all) : 0);
  fprintf(page, "<tr><td class=\"text\">all</td><td>%.3f</td></tr>\n</table>\n", all);
}

/* ---- how far the result can be trusted ---- */

/* A number of the estimate, or that it is not known. */
static void write_estimated(FILE *page, const json_t *of, const char *key, double factor, const char *unit) {
  const json_t *x = json_object_get(of, key);
  if (json_is_number(x))
    fprintf(page, "<td>%.2g%s</td>", factor * json_number_value(x), unit);
  else
    fputs("<td class=\"quiet\">unknown</td>", page);
}

/* A row a body and quantity of an object of bodies, with these of its numbers; those that do not move are left out. */
static void write_errors(FILE *page, const json_t *bodies, const char *const *keys, int nkey) {
  static const char *const units[][2] = {
      {"position", "m"}, {"velocity", "m/s"}, {"angle", "rad"}, {"angular_velocity", "rad/s"}};
  const char *name;
  json_t *body;
  json_object_foreach((json_t *)bodies, name, body) for (size_t q = 0; q < sizeof units / sizeof units[0]; q++) {
    const json_t *of = json_object_get(body, units[q][0]);
    if (!(json_number_value(json_object_get(of, "spread")) > 0))
      continue;
    fputs("<tr>", page);
    cpl_html_cell(page, name);
    fprintf(page, "<td class=\"text\">%s [%s]</td>", units[q][0], units[q][1]);
    for (int k = 0; k < nkey; k++)
      write_estimated(page, of, keys[k], strcmp(keys[k], "share") == 0 ? 100 : 1,
                      strcmp(keys[k], "share") == 0 ? " %" : "");
    fputs("</tr>\n", page);
  }
}

static void write_repetition(FILE *page, const json_t *repetition) {
  static const char *const keys[] = {"coupling", "dem_step", "round_off", "spread"};
  const char *key;
  json_t *why;
  if (!repetition)
    return;
  fprintf(page,
          "<p>Repeated until %.4g s (%.3g %% of the run) with half the window, half the DEM step, and a change of the "
          "size of round-off:</p>\n<table>\n<tr><th class=\"text\">body</th><th class=\"text\">quantity</th>"
          "<th>error of the exchange</th><th>of the DEM step</th><th>two runs that round-off sets apart</th>"
          "<th>spread</th></tr>\n",
          json_number_value(json_object_get(repetition, "until_s")),
          100 * json_number_value(json_object_get(repetition, "share")));
  write_errors(page, json_object_get(repetition, "bodies"), keys, 4);
  fputs("</table>\n", page);
  json_object_foreach(json_object_get(repetition, "unknown"), key, why) {
    fputs("<p class=\"quiet\">", page);
    cpl_html_text(page, key);
    fputs(": unknown: ", page);
    cpl_html_text(page, json_string_value(why) ? json_string_value(why) : "");
    fputs("</p>\n", page);
  }
}

static void write_error(FILE *page, const cpl_report_data *r) {
  static const char *const keys[] = {"rms", "share", "coupling", "rattle", "spread"};
  const json_t *estimate = json_object_get(r->summary, "error_estimate");
  const char *unknown = text_of(estimate, "unknown");
  if (!estimate)
    return;
  fputs("<h3 id=\"error\">The error, estimated</h3>\n", page);
  if (unknown) {
    fputs("<p>unknown: ", page);
    cpl_html_text(page, unknown);
    fputs("</p>\n", page);
  } else {
    fputs("<table>\n<tr><th class=\"text\">body</th><th class=\"text\">quantity</th><th>error, rms</th>"
          "<th>beside the spread</th><th>of the exchange</th><th>rattle of the particles</th><th>spread</th></tr>\n",
          page);
    write_errors(page, json_object_get(estimate, "bodies"), keys, 5);
    fputs("</table>\n", page);
    if (json_is_true(json_object_get(estimate, "large")))
      fputs("<p><b>This is large</b>: the motion may be far from the right one.</p>\n", page);
  }
  write_repetition(page, json_object_get(estimate, "repetition"));
}

/* The scene's parameters: name, value, expression. */
static void write_parameters(FILE *page, const cpl_report_data *r) {
  const json_t *values = json_object_get(r->summary, "parameters");
  const json_t *written = json_object_get(r->written, "parameters");
  const char *name;
  json_t *value;
  char text[64];
  if (json_object_size(values) == 0)
    return;
  fputs("<h3>Parameters</h3>\n<table>\n", page);
  json_object_foreach((json_t *)values, name, value) {
    const char *expression = json_string_value(json_object_get(written, name));
    fputs("<tr>", page);
    cpl_html_cell(page, name);
    cpl_html_cell(page, tdm_json_text(value, text, sizeof text));
    cpl_html_cell(page, expression ? expression : "");
    fputs("</tr>\n", page);
  }
  fputs("</table>\n", page);
}

static void write_run(FILE *page, const cpl_report_data *r) {
  static const char *const counts[] = {"windows", "steps", "particles"};
  char text[64];
  if (!r->summary)
    return;
  fputs("<h2 id=\"run\">What ran</h2>\n<table>\n", page);
  const json_t *simulated = json_object_get(r->summary, "simulated_s");
  if (simulated) {
    snprintf(text, sizeof text, "%.6g s", json_number_value(simulated));
    write_row(page, "simulated", text);
  }
  for (size_t k = 0; k < sizeof counts / sizeof counts[0]; k++)
    if (json_object_get(r->summary, counts[k]))
      write_row(page, counts[k], tdm_json_text(json_object_get(r->summary, counts[k]), text, sizeof text));
  write_settings(page, r);
  write_software(page, r);
  fputs("</table>\n", page);
  write_parameters(page, r);
  if (json_object_get(r->summary, "wall_s"))
    write_times(page, json_object_get(r->summary, "wall_s"));
  write_error(page, r);
}

/* ---- agreement with the reference ---- */

static void write_agreement(FILE *page, const cpl_report_data *r) {
  const cpl_comparison *c = &r->comparison;
  const char *key;
  json_t *value;
  if (!r->compared)
    return;
  fputs("<h2 id=\"reference\">Simulation and reference</h2>\n<table>\n<tr><th class=\"text\">curve</th><th>nse</th>"
        "<th>r2</th><th>r2 of 20 ms means</th></tr>\n",
        page);
  for (int i = 0; i < c->ncurve; i++) {
    const cpl_compared *curve = &c->curve[i];
    fputs("<tr>", page);
    cpl_html_cell(page, curve->name);
    fprintf(page, "<td>%.6f</td><td>%.6f</td><td>%.6f</td></tr>\n", cpl_comparison_nse(c, curve),
            cpl_comparison_r2(c, curve), cpl_comparison_r2_mean(c, curve, 0.02));
  }
  fputs("</table>\n", page);
  json_object_foreach(c->notes, key, value) {
    fputs("<p>", page);
    cpl_html_text(page, key);
    fprintf(page, ": %.6g</p>\n", json_number_value(value));
  }
  if (r->comparison_drawn)
    fputs("<img src=\"comparison.png\" alt=\"simulation and reference\">\n", page);
}

/* ---- index ---- */

static void write_index(FILE *page, const cpl_report_data *r) {
  const cpl_contents *c = &r->contents;
  if (c->nsection == 0)
    return;
  fputs("<h2 id=\"index\">Time histories</h2>\n<table>\n", page);
  for (int group = 0; group < CPL_NGROUP; group++) {
    bool any = false;
    for (int i = 0; i < c->nsection; i++) {
      if ((int)c->section[i].group != group)
        continue;
      fprintf(page, any ? " &middot; " : "<tr><td class=\"text\">%s</td><td class=\"text\">",
              cpl_group_title((cpl_group)group));
      fprintf(page, "<a href=\"#s%d\">", i);
      cpl_html_text(page, c->section[i].name);
      fputs("</a>", page);
      any = true;
    }
    fputs(any ? "</td></tr>\n" : "", page);
  }
  fputs("</table>\n", page);
}

/* ---- sections ---- */

static void write_name(FILE *page, const cpl_panel *p, const cpl_channel *channel) {
  char unit[48];
  fputs("<td class=\"text\">", page);
  cpl_html_text(page, p->quantity);
  if (p->vector || strcmp(p->unit, "J") == 0) {
    fputs(": ", page);
    cpl_html_text(page, channel->component);
  }
  fputs("</td><td class=\"text quiet\">", page);
  cpl_html_text(page, channel->name);
  fputs("</td>", page);
  cpl_html_cell(page, cpl_words_unit(channel->unit, unit, sizeof unit));
}

/* start, end and extremes of what varies; open where there is no picture */
static void write_numbers(FILE *page, const cpl_report_data *r, int section, bool open) {
  const cpl_contents *c = &r->contents;
  fprintf(page,
          "<details%s><summary>numbers</summary>\n<table>\n<tr><th class=\"text\">quantity</th><th "
          "class=\"text\">column</th><th class=\"text\">unit</th><th>start</th><th>end</th><th>least</th>"
          "<th>greatest</th></tr>\n",
          open ? " open" : "");
  for (int i = 0; i < c->npanel; i++)
    for (int k = 0; c->panel[i].section == section && k < c->panel[i].nchannel; k++) {
      const cpl_channel *channel = &c->channel[c->panel[i].channel[k]];
      if (channel->course != CPL_VARIES)
        continue;
      fputs("<tr>", page);
      write_name(page, &c->panel[i], channel);
      fprintf(page, "<td>%.6g</td><td>%.6g</td><td>%.6g</td><td>%.6g</td></tr>\n", channel->start + 0.0,
              channel->end + 0.0, channel->least + 0.0, channel->greatest + 0.0); /* no -0 */
    }
  fputs("</table>\n</details>\n", page);
}

static void write_constants_of(FILE *page, const cpl_report_data *r, int section) {
  const cpl_contents *c = &r->contents;
  bool any = false;
  for (int i = 0; i < c->npanel; i++)
    for (int k = 0; c->panel[i].section == section && k < c->panel[i].nchannel; k++) {
      const cpl_channel *channel = &c->channel[c->panel[i].channel[k]];
      if (channel->course == CPL_VARIES)
        continue;
      fputs(any ? ", " : "<p class=\"quiet\">not plotted, as <a href=\"#constants\">it does not change</a>: ", page);
      cpl_html_text(page, c->panel[i].quantity);
      if (c->panel[i].vector || strcmp(c->panel[i].unit, "J") == 0) {
        fputs(" ", page);
        cpl_html_text(page, channel->component);
      }
      any = true;
    }
  fputs(any ? "</p>\n" : "", page);
}

static void write_section(FILE *page, const cpl_report_data *r, int section) {
  char title[192];
  bool varies = false, all = true;
  fprintf(page, "<h3 id=\"s%d\">", section);
  cpl_html_text(page, cpl_section_title(&r->contents.section[section], title, sizeof title));
  fputs("</h3>\n", page);
  for (int i = 0; i < r->pictures.n; i++) {
    const cpl_picture *p = &r->pictures.picture[i];
    if (p->section != section)
      continue;
    varies = true;
    all = all && p->there;
    if (!p->there)
      continue;
    fputs("<a href=\"", page);
    cpl_html_link(page, p->name);
    fputs(".png\"><img loading=\"lazy\" src=\"", page);
    cpl_html_link(page, p->name);
    fputs(".png\" alt=\"", page);
    cpl_html_text(page, title);
    fputs("\"></a>\n", page);
  }
  if (varies)
    write_numbers(page, r, section, !all);
  write_constants_of(page, r, section);
}

/* ---- what does not change ---- */

static void write_constants(FILE *page, const cpl_report_data *r) {
  const cpl_contents *c = &r->contents;
  char title[192];
  bool any = false;
  for (int s = 0; s < c->nsection; s++)
    for (int i = 0; i < c->npanel; i++)
      for (int k = 0; c->panel[i].section == s && k < c->panel[i].nchannel; k++) {
        const cpl_channel *channel = &c->channel[c->panel[i].channel[k]];
        if (channel->course == CPL_VARIES)
          continue;
        if (!any)
          fputs("<h2 id=\"constants\">What does not change</h2>\n<table>\n<tr><th class=\"text\">of</th><th "
                "class=\"text\">quantity</th><th class=\"text\">column</th><th class=\"text\">unit</th>"
                "<th>value</th></tr>\n",
                page);
        any = true;
        fputs("<tr>", page);
        cpl_html_cell(page, cpl_section_title(&c->section[s], title, sizeof title));
        write_name(page, &c->panel[i], channel);
        if (channel->course == CPL_CONSTANT)
          fprintf(page, "<td>%.6g</td></tr>\n", channel->start + 0.0);
        else if (channel->course == CPL_ROUND_OFF)
          fprintf(page, "<td>%.3g &hellip; %.3g (round-off)</td></tr>\n", channel->least, channel->greatest);
        else
          fputs("<td>no number</td></tr>\n", page);
      }
  fputs(any ? "</table>\n" : "", page);
}

/* ---- the other figures of the summary ---- */

static void write_figure(void *arg, const char *path, const json_t *value) {
  FILE *page = arg;
  char text[512];
  size_t i;
  json_t *number;
  if (!json_is_array(value)) {
    write_row(page, path, tdm_json_text(value, text, sizeof text));
    return;
  }
  fputs("<tr>", page);
  cpl_html_cell(page, path);
  fputs("<td class=\"text\">", page);
  json_array_foreach((json_t *)value, i, number) {
    fputs(i ? ", " : "", page);
    cpl_html_text(page, tdm_json_text(number, text, sizeof text));
  }
  fputs("</td></tr>\n", page);
}

static void write_details(FILE *page, const char *name, const json_t *value) {
  if (json_object_size(value) == 0)
    return;
  fputs("<details><summary>", page);
  cpl_html_text(page, name);
  fputs("</summary>\n<table>\n", page);
  tdm_json_rows(value, write_figure, page);
  fputs("</table>\n</details>\n", page);
}

static void write_figures(FILE *page, const cpl_report_data *r) {
  static const char *const shown[] = {"settings", "machine", "wall_s", "solvers", "parameters", NULL};
  const char *key;
  json_t *value;
  if (!r->summary)
    return;
  fputs("<h2 id=\"figures\">Figures</h2>\n", page);
  json_object_foreach(json_object_get(r->summary, "solvers"), key, value) {
    char name[128];
    snprintf(name, sizeof name, "what %.100s says of its start", key);
    write_details(page, name, json_object_get(value, "report"));
  }
  json_object_foreach(r->summary, key, value) {
    int k = 0;
    while (shown[k] && strcmp(shown[k], key) != 0)
      k++;
    if (!shown[k])
      write_details(page, strcmp(key, "report") == 0 ? "what the solver says of its start" : key, value);
  }
}

/* ---- the whole ---- */

void cpl_report_page(FILE *page, const cpl_report_data *r) {
  write_head(page, r);
  write_remarks(page, r, "warnings", "warning", true);
  write_remarks(page, r, "notices", "notice", false);
  cpl_report_shots(page, r->dir);
  write_run(page, r);
  write_agreement(page, r);
  write_index(page, r);
  for (int i = 0; i < r->contents.nsection; i++)
    write_section(page, r, i);
  write_constants(page, r);
  write_figures(page, r);
  cpl_report_files(page, r->dir);
}

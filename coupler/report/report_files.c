/* The files of a result directory, on a report's page: see report_page.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/report/report_page.h"
#include "coupler/results/html.h"
#include "protocol/scene/input.h"

#include <ctype.h>
#include <dirent.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SHOTS_MAX = 12, LINES = 3, LINE_MAX = 1024 };

bool cpl_report_has(const char *dir, const char *name) {
  char path[4352];
  snprintf(path, sizeof path, "%s/%s", dir, name);
  return access(path, F_OK) == 0;
}

/* ---- pictures of the run ---- */

/* picture_NNN.png, or picture_VIEW_NNN.png where a run has several views: how much of the name all of a view share; 0:
 * it is no picture of a run. */
static size_t shot_stem(const char *name) {
  const size_t n = strlen(name);
  size_t k = n < 4 ? 0 : n - 4;
  if (strncmp(name, "picture_", 8) != 0 || strcmp(name + k, ".png") != 0)
    return 0;
  while (k > 0 && isdigit((unsigned char)name[k - 1]))
    k--;
  return k < n - 4 && name[k - 1] == '_' ? k : 0;
}

static int is_shot(const struct dirent *entry) {
  return shot_stem(entry->d_name) > 0;
}

/* The pictures of one view: the first, the last and some between. */
static void write_view(FILE *page, int n, struct dirent *const *shot) {
  const int shown = n < SHOTS_MAX ? n : SHOTS_MAX;
  fputs("<div class=\"shots\">\n", page);
  for (int k = 0; k < shown; k++) {
    const char *name = shot[shown > 1 ? k * (n - 1) / (shown - 1) : 0]->d_name;
    fputs("<a href=\"", page);
    cpl_html_link(page, name);
    fputs("\"><img src=\"", page);
    cpl_html_link(page, name);
    fputs("\" alt=\"", page);
    cpl_html_text(page, name);
    fputs("\"></a>\n", page);
  }
  fputs("</div>\n", page);
  if (shown < n)
    fprintf(page, "<p class=\"quiet\">%d of %d pictures</p>\n", shown, n);
}

void cpl_report_shots(FILE *page, const char *dir) {
  struct dirent **shot = NULL;
  const int n = scandir(dir, &shot, is_shot, alphasort);
  if (cpl_report_has(dir, "view.html"))
    fputs("<p><a href=\"view.html\">Play the run in the viewer</a></p>\n", page);
  if (cpl_report_has(dir, "movie.mp4"))
    fputs("<video controls src=\"movie.mp4\" style=\"max-width:100%\"></video>\n", page);
  for (int i = 0, next; i < n; i = next) {
    const size_t stem = shot_stem(shot[i]->d_name);
    for (next = i;
         next < n && shot_stem(shot[next]->d_name) == stem && strncmp(shot[next]->d_name, shot[i]->d_name, stem) == 0;
         next++)
      ;
    write_view(page, next - i, shot + i);
  }
  for (int k = 0; k < n; k++)
    free(shot[k]);
  free(shot);
}

/* ---- logs ---- */

static void write_log(FILE *page, const char *dir, const char *name) {
  char path[4352], last[LINES][LINE_MAX] = {{0}}, line[LINE_MAX];
  const char *why;
  int n = 0;
  snprintf(path, sizeof path, "%s/%s", dir, name);
  FILE *f = tdm_open_input(path, false, &why);
  while (f && fgets(line, sizeof line, f))
    memcpy(last[n++ % LINES], line, sizeof line);
  if (f)
    fclose(f);
  if (n == 0)
    return;
  fprintf(page, "<p>The end of <a href=\"%s\">%s</a>:</p>\n<pre>", name, name);
  for (int k = n < LINES ? 0 : n - LINES; k < n; k++)
    cpl_html_text(page, last[k % LINES]);
  fputs("</pre>\n", page);
}

void cpl_report_logs(FILE *page, const char *dir) {
  static const char *const logs[] = {"server.log", "dem.log", "mbd.log"};
  for (size_t k = 0; k < sizeof logs / sizeof logs[0]; k++)
    write_log(page, dir, logs[k]);
}

/* ---- all files ---- */

static const struct {
  const char *name, *what;
} known[] = {
    {"scene.json", "the scene with all overrides"},
    {"summary.json", "figures of the run, warnings, notices"},
    {"ledger.csv", "impulse, work, drift and energy of the exchange"},
    {"mbd.csv", "channels of the multibody solver"},
    {"dem.csv", "channels of the particles"},
    {"channels.csv", "channels of the solver"},
    {"comparison.csv", "simulation and reference"},
    {"body_*.csv", "pose, twist and load of a coupled body"},
    {"report.gp", "what gnuplot draws the time histories from"},
    {"report_*.png", "time histories"},
    {"server.log", "log of the server"},
    {"dem.log", "log of the particles' solver"},
    {"mbd.log", "log of the multibody solver"},
    {"view.html", "viewer: plays the run in a browser"},
    {"movie.mp4", "the pictures as an animation"},
    {"scene.pvd", "open this in ParaView"},
    {"frames.tdv", "what the viewer, pictures and the animation are made from"},
    {"*.vtp", "what scene.pvd shows"},
    {"picture_*.png", "pictures of the run"},
    {"picture_*.frame", "pictures that were not drawn when the run ended: tandem draw FILE.frame"},
};

static const char *what_is(const char *name) {
  for (size_t k = 0; k < sizeof known / sizeof known[0]; k++) {
    const char *star = strchr(known[k].name, '*');
    const size_t before = star ? (size_t)(star - known[k].name) : 0, n = strlen(name);
    const size_t behind = star ? strlen(star + 1) : 0;
    if (star ? n > before + behind && strncmp(name, known[k].name, before) == 0 &&
                   strcmp(name + n - behind, star + 1) == 0
             : strcmp(name, known[k].name) == 0)
      return known[k].what;
  }
  return "";
}

static int is_listed(const struct dirent *entry) {
  return entry->d_name[0] != '.' && strcmp(entry->d_name, "index.html") != 0;
}

/* The name with its first number as "*": that of one of many. The pictures of a report are one kind. */
static void kind_of(const char *name, char *kind, size_t size) {
  size_t n = 0;
  if (strncmp(name, "report_", 7) == 0) {
    snprintf(kind, size, "report_*.png");
    return;
  }
  for (bool star = false; *name && n + 1 < size; name++)
    if (star || !isdigit((unsigned char)*name)) {
      kind[n++] = *name;
    } else {
      while (isdigit((unsigned char)name[1]))
        name++;
      kind[n++] = '*';
      star = true;
    }
  kind[n] = 0;
}

static double file_size(const char *dir, const char *name) {
  char path[4352];
  struct stat st;
  snprintf(path, sizeof path, "%s/%s", dir, name);
  return stat(path, &st) == 0 ? (double)st.st_size : 0;
}

static void write_size(FILE *page, double bytes) {
  static const char *const units[] = {"B", "kB", "MB", "GB"};
  int k = 0;
  for (; bytes >= 1000 && k < 3; k++)
    bytes /= 1000;
  fprintf(page, "<td>%.3g %s</td>", bytes, units[k]);
}

void cpl_report_files(FILE *page, const char *dir) {
  struct dirent **file = NULL;
  const int n = scandir(dir, &file, is_listed, alphasort);
  fputs("<h2 id=\"files\">Files</h2>\n<table>\n", page);
  for (int i = 0, next; i < n; i = next) {
    char kind[256], other[256];
    const char *name = file[i]->d_name;
    double bytes = 0;
    kind_of(name, kind, sizeof kind);
    for (next = i; next < n; next++) {
      kind_of(file[next]->d_name, other, sizeof other);
      if (strcmp(kind, other) != 0)
        break;
      bytes += file_size(dir, file[next]->d_name);
    }
    const bool many = next - i > 2;
    next = many ? next : i + 1;
    fputs("<tr><td class=\"text\">", page);
    if (!many)
      fputs("<a href=\"", page), cpl_html_link(page, name), fputs("\">", page);
    cpl_html_text(page, many ? kind : name);
    fputs(many ? "" : "</a>", page);
    if (many)
      fprintf(page, " (%d files)", next - i);
    fputs("</td>", page);
    write_size(page, many ? bytes : file_size(dir, name));
    cpl_html_cell(page, what_is(name));
    fputs("</tr>\n", page);
  }
  fputs("</table>\n", page);
  for (int i = 0; i < n; i++)
    free(file[i]);
  free(file);
}

/* Plots by gnuplot: see plot.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/plot.h"

#include "protocol/app/command_line.h"
#include "protocol/base/log.h"
#include "protocol/results/mark.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A name or title, whose bytes may be anybody's. What could mean something to gnuplot (quotes, backticks, backslashes,
 * macros, line breaks) is written in octal: backticks and macros it looks for before it reads, escapes after. Single
 * quotes would not do: gnuplot 5.4 fails on a doubled one at their start. The terminals are noenhanced. */
static void write_quoted(FILE *f, const char *text) {
  fputc('"', f);
  for (; *text; text++) {
    unsigned char c = (unsigned char)*text;
    if (c < ' ' || c == 127)
      fputc(' ', f);
    else if (isalnum(c) || c >= 0x80 || strchr(" .,:;_-+=/*()[]<>|", c))
      fputc(c, f);
    else
      fprintf(f, "\\%03o", c);
  }
  fputc('"', f);
}

/* A file: a relative name gets ./ in front, as '<' there would be a shell command, and '-' or '+' no file. */
static void write_file_name(FILE *f, const char *file) {
  char path[4352];
  snprintf(path, sizeof path, "%s%s", *file == '/' ? "" : "./", file);
  write_quoted(f, path);
}

static void write_word(FILE *f, const char *command, const char *text) {
  fputs(command, f);
  write_quoted(f, text);
  fputc('\n', f);
}

/* "nan" interrupts a line, whatever the sign of the NaN */
static void write_number(FILE *f, double x, char end) {
  if (isnan(x))
    fprintf(f, "nan%c", end);
  else
    fprintf(f, "%.9g%c", x, end);
}

/* A plot's data as gnuplot's data block $panelN. */
static void write_data(FILE *f, const tdm_plot_data *data, int number) {
  fprintf(f, "$panel%d << EOD\n", number);
  for (int i = 0; i < data->nrow; i++)
    for (int k = 0; k < data->ncolumn; k++)
      write_number(f, data->value[i * data->ncolumn + k], k + 1 < data->ncolumn ? ',' : '\n');
  fputs("EOD\n", f);
}

/* Names in place of numbers on the x axis, with room at both ends. */
static void write_ticks(FILE *f, const tdm_plot *plot) {
  fputs("set xtics (", f);
  for (int i = 0; i < plot->ntick; i++) {
    fputs(i ? ", " : "", f);
    write_quoted(f, plot->tick[i]);
    fprintf(f, " %d", i);
  }
  fprintf(f, ")\nset xrange [-0.5:%g]\n", plot->ntick - 0.5);
}

static void write_panel(FILE *f, const tdm_plot *plot, int number) {
  write_word(f, "set title ", plot->title);
  write_word(f, "set xlabel ", plot->xlabel);
  write_word(f, "set ylabel ", plot->ylabel);
  if (plot->setup)
    fputs(plot->setup, f);
  if (plot->ntick > 0)
    write_ticks(f, plot);
  fputs("plot ", f);
  for (int i = 0; i < plot->ncurve; i++) {
    const tdm_curve *c = &plot->curve[i];
    fputs(i ? ", \\\n     " : "", f);
    if (c->file)
      write_file_name(f, c->file);
    else
      fprintf(f, "$panel%d", number);
    fprintf(f, "%s using %s with %s title ", c->file ? " skip 1" : "", c->using, c->style);
    write_quoted(f, c->title);
  }
  fputs("\n", f);
}

enum { PANEL_WIDTH = 900, COLUMN_WIDTH = 600, PANEL_HEIGHT = 360, ROW_HEIGHT = 280, TITLE_HEIGHT = 40 }; /* pixels */

static void write_picture(FILE *f, const tdm_plot_picture *p) {
  char output[256];
  const int across = p->across > 1 ? p->across : 1, rows = (p->nplot + across - 1) / across;
  const int width = across > 1 ? across * COLUMN_WIDTH : PANEL_WIDTH;
  const int height = rows * (across > 1 ? ROW_HEIGHT : PANEL_HEIGHT) + (p->title ? TITLE_HEIGHT : 0);
  for (int i = 0; i < p->nplot && p->data; i++)
    write_data(f, &p->data[i], i);
  fprintf(f, "set terminal pngcairo noenhanced size %d,%d font ',%d'\nset output ", width, height,
          across > 1 ? 10 : 11);
  snprintf(output, sizeof output, "%s.png", p->name);
  write_file_name(f, output);
  fputc('\n', f);
  if (p->nplot > 1 || p->title)
    fprintf(f, "set multiplot layout %d,%d", rows, across);
  if (p->title) { /* a second line keeps what stands above the first panels out of it */
    fputs(" title ", f);
    write_quoted(f, p->title);
    fputs(".\"\\n\"\n", f);
  } else if (p->nplot > 1) {
    fputc('\n', f);
  }
  for (int i = 0; i < p->nplot; i++)
    write_panel(f, &p->plot[i], i);
  fputs(p->nplot > 1 || p->title ? "unset multiplot\nunset output\n" : "unset output\n", f);
}

static void write_script(FILE *f, int npicture, const tdm_plot_picture *picture) {
  fputs("set datafile separator ','\nset grid lt 1 lw 0.5 lc rgb '#cccccc'\nset key top right\nset encoding utf8\n", f);
  for (int i = 0; i < npicture; i++)
    write_picture(f, &picture[i]);
}

/* ---- gnuplot ---- */

enum { PLOT_CANNOT = -1, PLOT_INTERRUPTED = -2, PLOT_HANGS = -3 }; /* beside exit statuses */

static int given_up; /* one of the last two: no further plot is tried */

bool tdm_plot_interrupted(void) {
  return given_up == PLOT_INTERRUPTED;
}

double tdm_plot_patience(void) {
  const char *text = getenv("TANDEM_PLOT_TIMEOUT");
  double seconds = text ? strtod(text, NULL) : 0;
  return seconds > 0 ? seconds : 120;
}

/* In the child, between fork and exec. gnuplot has a process group of its own, so that it ends with its helpers; it
 * does not outlive tandem. -d: no start-up files, of the user or beside the data. */
static void become_gnuplot(const char *dir, const char *script, const char *log, pid_t parent) {
  int out;
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent || chdir(dir) != 0 || (out = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666)) < 0)
    _exit(126);
  dup2(open("/dev/null", O_RDONLY), 0);
  dup2(out, 1);
  dup2(out, 2);
  execlp("gnuplot", "gnuplot", "-d", script, (char *)NULL);
  _exit(127);
}

/* Its exit status; it is ended at the next signal to this process, or when it takes too long. */
static int wait_for_gnuplot(pid_t pid, int signals) {
  double deadline = tdm_clock() + tdm_plot_patience();
  int status;
  while (true) {
    pid_t got = waitpid(pid, &status, WNOHANG);
    if (got == pid)
      return WIFEXITED(status) ? WEXITSTATUS(status) : PLOT_CANNOT;
    if (got < 0 && errno != EINTR)
      return PLOT_CANNOT;
    if (tdm_signal_count != signals || tdm_clock() > deadline) {
      given_up = tdm_signal_count != signals ? PLOT_INTERRUPTED : PLOT_HANGS;
      kill(-pid, SIGKILL);
      kill(pid, SIGKILL); /* it may not have its group yet */
      while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
      return given_up;
    }
    nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
  }
}

/* gnuplot on the script, in its directory, its words into `log` there. */
static int run_gnuplot(const char *dir, const char *script, const char *log) {
  int signals = tdm_signal_count;
  pid_t parent = getpid(), pid = given_up ? 0 : fork();
  if (given_up)
    return given_up;
  if (pid == 0)
    become_gnuplot(dir, script, log, parent);
  return pid < 0 ? PLOT_CANNOT : wait_for_gnuplot(pid, signals);
}

/* Files of a plot are the directory's own: a new run may remove them. */
static void mark_file(const char *dir, const char *name, const char *ending) {
  char file[256];
  snprintf(file, sizeof file, "%s.%s", name, ending);
  tdm_mark_add_in(dir, file);
}

tdm_status tdm_plot_run(const char *dir, const char *name, tdm_error *err) {
  char path[4096], script[256], log[256];
  snprintf(script, sizeof script, "%s.gp", name);
  snprintf(log, sizeof log, "%s.gnuplot", name); /* not .log: dem.log is the solver's */
  mark_file(dir, name, "gp");
  mark_file(dir, name, "png");
  mark_file(dir, name, "gnuplot");
  int status = run_gnuplot(dir, script, log);
  if (status == PLOT_INTERRUPTED)
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted while plotting; the data is there, not all plots are");
  if (status == PLOT_HANGS)
    return tdm_fail(err, TDM_ERR_TIMEOUT, NULL,
                    "no plot %s: gnuplot took longer than %g s and was ended, see %s/%s; the environment variable "
                    "TANDEM_PLOT_TIMEOUT sets another limit [s]",
                    name, tdm_plot_patience(), dir, log);
  snprintf(path, sizeof path, "%s/%s", dir, log);
  if (status == 0 || status == 127) /* nothing to say */
    unlink(path);
  if (status == 127)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "no plots: gnuplot is not installed (Debian package gnuplot-nox)");
  if (status != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "no plot %s: gnuplot failed, see %s/%s", name, dir, log);
  return TDM_OK;
}

tdm_status tdm_plot_pictures(const char *dir, const char *name, int npicture, const tdm_plot_picture *picture,
                             tdm_error *err) {
  char path[4096], script[256];
  snprintf(script, sizeof script, "%s.gp", name);
  snprintf(path, sizeof path, "%s/%s", dir, script);
  for (int i = 0; i < npicture; i++)
    mark_file(dir, picture[i].name, "png");
  FILE *f = fopen(path, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  write_script(f, npicture, picture);
  if (fclose(f) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  return tdm_plot_run(dir, name, err);
}

tdm_status tdm_plot_write(const char *dir, const char *name, int nplot, const tdm_plot *plot, tdm_error *err) {
  return tdm_plot_write_data(dir, name, nplot, plot, NULL, err);
}

tdm_status tdm_plot_write_data(const char *dir, const char *name, int nplot, const tdm_plot *plot,
                               const tdm_plot_data *data, tdm_error *err) {
  const tdm_plot_picture picture = {.name = name, .nplot = nplot, .plot = plot, .data = data};
  return tdm_plot_pictures(dir, name, 1, &picture, err);
}

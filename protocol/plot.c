#include "protocol/plot.h"

#include "protocol/mark.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static void write_panel(FILE *f, const tdm_plot *plot) {
  fprintf(f, "set title \"%s\"\nset xlabel \"%s\"\nset ylabel \"%s\"\n", plot->title, plot->xlabel, plot->ylabel);
  if (plot->setup)
    fputs(plot->setup, f);
  fputs("plot ", f);
  for (int i = 0; i < plot->ncurve; i++) {
    const tdm_curve *c = &plot->curve[i];
    fprintf(f, "%s'%s' skip 1 using %s with %s title \"%s\"", i ? ", \\\n     " : "", c->file, c->using, c->style,
            c->title);
  }
  fputs("\n", f);
}

static void write_script(FILE *f, const char *name, int nplot, const tdm_plot *plot) {
  static const char *const terminals[][2] = {{"pngcairo", "png"}, {"svg", "svg"}};
  fputs("set datafile separator ','\nset grid lc rgb '#dddddd'\nset key top right\nset encoding utf8\n", f);
  for (int t = 0; t < 2; t++) {
    fprintf(f, "set terminal %s noenhanced size 900,%d font ',11'\nset output '%s.%s'\n", terminals[t][0], 360 * nplot,
            name, terminals[t][1]);
    if (nplot > 1)
      fprintf(f, "set multiplot layout %d,1\n", nplot);
    for (int i = 0; i < nplot; i++)
      write_panel(f, &plot[i]);
    fputs(nplot > 1 ? "unset multiplot\nunset output\n" : "unset output\n", f);
  }
}

/* gnuplot on the script, in its directory, its words into name.gnuplot. Returns the exit status, -1 when it cannot run.
 */
static int run_gnuplot(const char *dir, const char *script, const char *log) {
  pid_t pid = fork();
  if (pid < 0)
    return -1;
  if (pid == 0) {
    int out;
    if (chdir(dir) != 0 || (out = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666)) < 0)
      _exit(126);
    dup2(out, 1);
    dup2(out, 2);
    execlp("gnuplot", "gnuplot", script, (char *)NULL);
    _exit(127);
  }
  int status;
  while (waitpid(pid, &status, 0) < 0)
    if (errno != EINTR)
      return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The files of a plot are the directory's own: a new run may remove them. */
static void mark_files(const char *dir, const char *name) {
  static const char *const endings[] = {"gp", "png", "svg", "gnuplot"};
  char file[256];
  for (int i = 0; i < 4; i++) {
    snprintf(file, sizeof file, "%s.%s", name, endings[i]);
    tdm_mark_add_in(dir, file);
  }
}

tdm_status tdm_plot_run(const char *dir, const char *name, tdm_error *err) {
  char path[4096], script[256], log[256];
  snprintf(script, sizeof script, "%s.gp", name);
  snprintf(log, sizeof log, "%s.gnuplot", name); /* not .log: dem.log is the solver's */
  mark_files(dir, name);
  int status = run_gnuplot(dir, script, log);
  if (status == 127)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "no plots: gnuplot is not installed (Debian package gnuplot-nox)");
  if (status != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "no plot %s: gnuplot failed, see %s/%s", name, dir, log);
  snprintf(path, sizeof path, "%s/%s", dir, log);
  unlink(path);
  return TDM_OK;
}

tdm_status tdm_plot_write(const char *dir, const char *name, int nplot, const tdm_plot *plot, tdm_error *err) {
  char path[4096], script[256];
  snprintf(script, sizeof script, "%s.gp", name);
  snprintf(path, sizeof path, "%s/%s", dir, script);
  FILE *f = fopen(path, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  write_script(f, name, nplot, plot);
  if (fclose(f) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  return tdm_plot_run(dir, name, err);
}

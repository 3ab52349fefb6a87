/* Plots: whatever names, titles and files are called, gnuplot gets data and no commands; a plot can be ended. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"
#include "protocol/app/plot.h"
#include "tests/command.h"
#include "tests/test_main.h"

static const char csv[] = "time [s],x [m]\n0,1\n1,2\n2,3\n";

static const char *const hostile[] = {
    "`touch pwned`",
    "$(touch pwned)",
    "'; system(\"touch pwned\"); '",
    "''; !touch pwned",
    "\"; system 'touch pwned'; \"",
    "a\nsystem('touch pwned')\nb",
    "a\\\nb",
    "@pwned {/=40 x}_{y}^{z} %g \\",
    "\303\244 \342\202\254 \033[31m",
};
enum { NHOSTILE = sizeof hostile / sizeof hostile[0] };

/* All of dir/name; the caller frees. */
static char *read_all(const char *dir, const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", dir, name);
  FILE *f = fopen(path, "r");
  ck_assert_msg(f != NULL, "no %s", path);
  char *text = calloc(1 << 20, 1);
  text[fread(text, 1, (1 << 20) - 1, f)] = 0;
  fclose(f);
  return text;
}

START_TEST(titles_are_data) {
  const char *dir = directory_make();
  write_file(dir, "x.csv", csv);
  for (int i = 0; i < NHOSTILE; i++) {
    tdm_error err = {0};
    const tdm_curve curve = {"x.csv", "1:2", hostile[i], "lines"};
    const tdm_plot plot = {
        .title = hostile[i],
        .xlabel = hostile[i],
        .ylabel = hostile[i],
        .ncurve = 1,
        .curve = &curve,
    };
    ck_assert_msg(tdm_plot_write(dir, "plot", 1, &plot, &err) == TDM_OK, "%s: %s", hostile[i], err.message);
    ck_assert_msg(command("ls %s/pwned", dir) != 0, "%s was executed", hostile[i]);
    ck_assert_int_eq(command("test -s %s/plot.png", dir), 0);
  }
  /* what stands in the picture is what was given: no enhanced mode, nothing replaced */
  tdm_error err = {0};
  const tdm_curve curve = {"x.csv", "1:2", "`date` it's {/=40 x}_{y} %g @z", "lines"};
  const tdm_plot plot = {
      .title = "",
      .xlabel = "",
      .ylabel = "",
      .ncurve = 1,
      .curve = &curve,
  };
  ck_assert_msg(tdm_plot_write(dir, "plot", 1, &plot, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(command("sh -c 'cd %s && sed \"s/pngcairo/svg/; s/plot.png/plot.svg/\" plot.gp > svg.gp && gnuplot "
                           "-d svg.gp'",
                           dir),
                   0);
  char *svg = read_all(dir, "plot.svg");
  ck_assert_msg(strstr(svg, "`date` it's {/=40 x}_{y} %g @z") || strstr(svg, "`date` it&apos;s {/=40 x}_{y} %g @z") ||
                    strstr(svg, "`date` it&#39;s {/=40 x}_{y} %g @z"),
                "%s", svg);
  free(svg);
  directory_remove(dir);
}
END_TEST

START_TEST(files_are_data) {
  static const char *const names[] = {"it's.csv", "`touch pwned`.csv",  "< touch pwned", "-",
                                      "+",        "a\"b $(touch pwned)"};
  const char *dir = directory_make();
  for (int i = 0; i < 6; i++) {
    tdm_error err = {0};
    const tdm_curve curve = {names[i], "1:2", "x", "lines"};
    const tdm_plot plot = {
        .title = "",
        .xlabel = "",
        .ylabel = "",
        .ncurve = 1,
        .curve = &curve,
    };
    write_file(dir, names[i], csv);
    ck_assert_msg(tdm_plot_write(dir, "plot", 1, &plot, &err) == TDM_OK, "%s: %s", names[i], err.message);
    ck_assert_msg(command("ls %s/pwned", dir) != 0, "%s was executed", names[i]);
  }
  /* start-up files beside the data are not read */
  tdm_error err = {0};
  const tdm_curve curve = {"-", "1:2", "x", "lines"};
  const tdm_plot plot = {
      .title = "",
      .xlabel = "",
      .ylabel = "",
      .ncurve = 1,
      .curve = &curve,
  };
  write_file(dir, ".gnuplot", "system('touch pwned')\n");
  setenv("HOME", dir, 1);
  ck_assert_msg(tdm_plot_write(dir, "plot", 1, &plot, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_ne(command("ls %s/pwned", dir), 0);
  directory_remove(dir);
}
END_TEST

/* A gnuplot that ignores what it is told, in front of the others. */
static void deaf_gnuplot(const char *dir) {
  char path[4096];
  write_file(dir, "gnuplot", "#!/bin/sh\ntrap '' INT TERM HUP\nsleep 1000 & sleep 1000\nsleep 1000\n");
  ck_assert_int_eq(command("chmod +x %s/gnuplot", dir), 0);
  snprintf(path, sizeof path, "%s:%s", dir, getenv("PATH"));
  setenv("PATH", path, 1);
}

static tdm_status plot_something(const char *dir, tdm_error *err) {
  const tdm_curve curve = {"x.csv", "1:2", "x", "lines"};
  const tdm_plot plot = {
      .title = "",
      .xlabel = "",
      .ylabel = "",
      .ncurve = 1,
      .curve = &curve,
  };
  write_file(dir, "x.csv", csv);
  return tdm_plot_write(dir, "plot", 1, &plot, err);
}

/* What was killed has gone, though perhaps a moment later. */
static void nothing_runs_in(const char *dir) {
  char text[128];
  snprintf(text, sizeof text, "%s/gnuplot", dir);
  WAIT_FOR(find_processes(text, NULL) == 0);
}

START_TEST(a_signal_ends_a_plot) {
  static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  const char *dir = directory_make();
  tdm_error err = {0}, next = {0};
  deaf_gnuplot(dir);
  tdm_catch_signals();
  pid_t self = getpid();
  if (fork() == 0) {
    char text[128];
    snprintf(text, sizeof text, "%s/gnuplot", dir);
    WAIT_FOR(find_processes(text, NULL) > 0);
    _exit(kill(self, signals[_i]) != 0);
  }
  ck_assert_int_eq(plot_something(dir, &err), TDM_ERR_INTERRUPTED);
  ck_assert_int_eq(plot_something(dir, &next), TDM_ERR_INTERRUPTED); /* and no further one is tried */
  ck_assert(tdm_plot_interrupted());
  nothing_runs_in(dir);
  directory_remove(dir);
}
END_TEST

START_TEST(a_plot_that_hangs_is_ended) {
  const char *dir = directory_make();
  tdm_error err = {0};
  deaf_gnuplot(dir);
  setenv("TANDEM_PLOT_TIMEOUT", "0.3", 1);
  ck_assert_int_eq(plot_something(dir, &err), TDM_ERR_TIMEOUT);
  ck_assert_ptr_nonnull(strstr(err.message, "gnuplot took longer than 0.3 s"));
  ck_assert_ptr_nonnull(strstr(err.message, "TANDEM_PLOT_TIMEOUT"));
  ck_assert(!tdm_plot_interrupted());
  nothing_runs_in(dir);
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("plot", {titles_are_data, 1}, {files_are_data, 1}, {a_signal_ends_a_plot, 3},
               {a_plot_that_hangs_is_ended, 1})

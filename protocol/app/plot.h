/* Plots by gnuplot: a script and PNG pictures in the directory of the data. Who wants another format changes the
 * script's terminal. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_APP_PLOT_H
#define TDM_APP_PLOT_H

#include "protocol/base/status.h"

#include <stdbool.h>

/* Files, titles and labels may hold any bytes; `using`, `style` and `setup` are gnuplot's own words and never come from
 * a file or a scene. */
typedef struct {
  const char *file;  /* CSV with one header line, relative to the directory; NULL: the plot's data */
  const char *using; /* gnuplot's column expression: "1:4", "1:(-$4)" */
  const char *title;
  const char *style; /* gnuplot's: "lines lw 2", "points pt 7" */
} tdm_curve;

typedef struct {
  const char *title, *xlabel, *ylabel;
  const char *setup;       /* further gnuplot commands, each line ended: "set logscale x\n"; may be NULL */
  int ntick;               /* x = 0, 1, 2 ... have names instead of numbers; 0: numbers */
  const char *const *tick; /* (ntick) */
  int ncurve;
  const tdm_curve *curve;
} tdm_plot;

/* data of a plot's curves without a file */
typedef struct {
  double *value; /* (nrow x ncolumn) row-major */
  int nrow, ncolumn;
} tdm_plot_data;

/* One picture: panels one under the other, or in rows of `across`. */
typedef struct {
  const char *name;  /* of its file, without .png */
  const char *title; /* above the panels; NULL: none */
  int across;        /* panels side by side; 0 is 1 */
  int nplot;
  const tdm_plot *plot;      /* (nplot) */
  const tdm_plot_data *data; /* (nplot) of curves without a file; may be NULL */
} tdm_plot_picture;

/* Write dir/name.gp and have gnuplot make the pictures beside it, all in one process. A missing gnuplot is an error of
 * status TDM_ERR_FILE that the caller may take as a notice; gnuplot ends at the first picture that it cannot make. */
tdm_status tdm_plot_pictures(const char *dir, const char *name, int npicture, const tdm_plot_picture *picture,
                             tdm_error *err);

/* One picture name.png of plots one under the other. */
tdm_status tdm_plot_write(const char *dir, const char *name, int nplot, const tdm_plot *plot, tdm_error *err);

/* The same with `data` (nplot) of their own, written into the script: gnuplot reads a file anew for each curve. */
tdm_status tdm_plot_write_data(const char *dir, const char *name, int nplot, const tdm_plot *plot,
                               const tdm_plot_data *data, tdm_error *err);

/* Have gnuplot run dir/name.gp, which is there; the same errors. A signal to this process ends it
 * (TDM_ERR_INTERRUPTED), and so does too long a time (TDM_ERR_TIMEOUT; TANDEM_PLOT_TIMEOUT in the environment, 120 s);
 * then no further plot is tried. */
tdm_status tdm_plot_run(const char *dir, const char *name, tdm_error *err);

/* How long one plot or picture may take [s]: TANDEM_PLOT_TIMEOUT, or 120. */
double tdm_plot_patience(void);

/* A signal has ended a plot: the program should end. */
bool tdm_plot_interrupted(void);

#endif

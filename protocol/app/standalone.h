/* A scene for one solver alone: `tandem-dem run`, `tandem-mbd run` and their `check`.
 *
 *   tdm_standalone_main          the command line: commands, options, the scene's file; then the program's operations
 *   tdm_standalone_loaded        what the engine says of its start, and its warnings
 *   tdm_standalone_begin/_row    channels.csv, the time histories of all of the solver's channels
 *   tdm_standalone_close/_plot   and its plots
 *   tdm_standalone_summary       what every summary.json holds
 *
 * What runs when, and every other output, is the solver's own (dem/app/run.c, mbd/app/run.c).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_APP_STANDALONE_H
#define TDM_APP_STANDALONE_H

#include "protocol/results/results.h"
#include "protocol/results/thin.h"
#include "protocol/scene/remark.h"
#include "protocol/scene/scene.h"
#include "protocol/wire/participant.h"

/* ---- the command line ---- */

typedef struct {
  const char *scene;      /* file */
  const char *const *set; /* NULL-terminated "path=value" overrides, may be NULL */
  const char *out;        /* result directory; not for a check */
  bool force;             /* replace the results of an earlier run */
  bool strict;            /* refuse a scene that the solver has doubts about */
  bool no_plots;          /* leave out the plots of time histories */
} tdm_standalone_options;

typedef struct tdm_standalone tdm_standalone;

/* A solver that also runs scenes alone. The operations come in this order; after an error conclude, if there is a
 * result directory, and let_go. */
typedef struct {
  const char *name; /* of the program: "tandem-dem" */
  const char *help; /* all of --help */
  const tdm_solver_ops *ops;
  size_t size; /* of the solver's own run, whose first member is a tdm_standalone: the operations get that one */
  /* Read the scene's other sections (run->scene is there), and doubt them. */
  tdm_status (*load)(tdm_standalone *run, tdm_error *err);
  /* Make the engine; ends with tdm_standalone_loaded. */
  tdm_status (*start)(tdm_standalone *run, tdm_error *err);
  /* Of a run: begins with tdm_standalone_begin. */
  tdm_status (*solve)(tdm_standalone *run, tdm_error *err);
  /* Of a run: the files of the end. The result directory holds what was computed, also after an error. */
  void (*conclude)(tdm_standalone *run, tdm_error *err);
  /* Of a check: print what would run; the engine's report follows. */
  void (*print)(const tdm_standalone *run);
  /* Free what is the solver's own. */
  void (*let_go)(tdm_standalone *run);
} tdm_standalone_program;

/* main() of a solver that also runs scenes alone: run SCENE, check SCENE, or the options of tdm_solver_main. A SCENE
 * without a file of its name is looked for in scenarios/ROLE. Returns the exit status. */
int tdm_standalone_main(const tdm_standalone_program *program, int argc, char **argv);

/* One scene, from its file to the result directory or, for a check, to what would run. */
tdm_status tdm_standalone_perform(const tdm_standalone_program *program, const tdm_standalone_options *options,
                                  bool check, tdm_error *err);

/* ---- a run ---- */

enum { TDM_STANDALONE_DOUBTS = 24 };

/* What a solver says of its start; borrowed while the run lasts. */
typedef struct {
  int nchannel;
  const tdm_channel *channel; /* (nchannel) */
  const double *initial;      /* (nchannel) values at the start */
  int nwarning;
  const tdm_warning *warning; /* (nwarning) doubtful settings, with the cure */
  json_t *report;             /* the solver's own figures, may be NULL */
} tdm_standalone_figures;

/* A run or a check. */
struct tdm_standalone {
  const tdm_standalone_program *program;
  const tdm_standalone_options *options;
  double begin; /* wall clock [s] */
  double setup; /* wall time until the start [s] */
  tdm_scene scene;
  tdm_results results;
  tdm_standalone_figures figures;
  int ndoubt;
  tdm_warning doubt[TDM_STANDALONE_DOUBTS]; /* about the sections time and output */
  json_t *section;                          /* of the scene, as the solver gets it */
  json_t *warnings;
  tdm_remarks remarks; /* of this thread, while the run lasts */
  tdm_teller teller;
  uint64_t told; /* changes of the remarks that the terminal knows */
  FILE *channels;
  double last_flush; /* wall clock [s] */
  uint64_t nrow;     /* rows of the time histories */
  bool *moved;       /* (nchannel) not zero in every row so far; NULL: out of memory */
  tdm_thin thin;     /* the rows, as plots show them */
  bool plots;        /* they are gathered there */
  double *values;    /* (nchannel) */
};

/* Refuse the sections of a co-simulation: `other` solver's, and coupling. `what`: "particles" of this one. */
void tdm_standalone_refuse_coupling(tdm_object *root, const char *other, const char *what);

/* Doubt a setting of the run, with printf's arguments; TDM_STANDALONE_DOUBTS at most, before tdm_standalone_loaded. */
void tdm_standalone_doubt(tdm_standalone *run, const char *path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Doubt an interval of the time histories that is longer than the run [s]. */
void tdm_standalone_doubt_interval(tdm_standalone *run, double interval, double end);

/* The solver's section of the scene, as the solver gets it (borrowed). */
json_t *tdm_standalone_section(tdm_standalone *run);

/* The solver has loaded its section, and says this: doubts about the settings and its warnings are printed, or refused
 * when strict. */
tdm_status tdm_standalone_loaded(tdm_standalone *run, const tdm_standalone_figures *figures, tdm_error *err);

/* Print remarks that are new; `bar`: there is a progress bar. To be called often. */
void tdm_standalone_tell(tdm_standalone *run, bool bar);

/* The run begins: channels.csv is opened, with its head; run->values are the values at the start. */
tdm_status tdm_standalone_begin(tdm_standalone *run, tdm_error *err);
/* Write `values` (nchannel) as the next row, at time t [s]. */
tdm_status tdm_standalone_row(tdm_standalone *run, double t, const double *values, tdm_error *err);
void tdm_standalone_close(tdm_standalone *run, tdm_error *err);

/* Plot the channels whose names begin with one of `of` (NULL-terminated; NULL: all channels) as NAME.png, a panel
 * a unit; what is zero throughout is left out, and all with no_plots. Nothing to plot is no error. */
tdm_status tdm_standalone_plot(const tdm_standalone *run, const char *name, const char *const *of, tdm_error *err);

/* A new object with tandem, software, scene, machine, report, warnings, notices, status and error. Prints the last
 * remarks, and how often each came. */
json_t *tdm_standalone_summary(tdm_standalone *run, const tdm_error *err);

/* The last line of the log: `pairs` after a good end, else the error. */
void tdm_standalone_log_end(const char *pairs, const tdm_error *err);

#endif

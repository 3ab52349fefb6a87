/* tandem: the command line. */
#include "coupler/find.h"
#include "coupler/report.h"
#include "coupler/run.h"
#include "coupler/session.h"
#include "coupler/verify.h"
#include "dem/solver.h"
#include "mbd/solver.h"
#include "scenarios/table.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const cpl_solver solvers[CPL_NROLE] = {
    [CPL_MBD] = {"tandem-mbd", &mbd_solver_ops},
    [CPL_DEM] = {"tandem-dem", &dem_solver_ops},
};

static void usage(FILE *out) {
  fputs("tandem: co-simulation of discrete elements and multibody dynamics\n\n"
        "  tandem run SCENE [--out DIR] [--set PATH=VALUE ...] [--strict]\n"
        "      Run a scene: a JSON file, or the name of a scenario. Results go to DIR (default: run-out).\n"
        "      --set PATH=VALUE   override a value of the scene: --set coupling.n=25 --set dem.pairs[0].friction=0.3\n"
        "      --strict           refuse a run that a solver has doubts about\n\n"
        "  tandem check SCENE [--out DIR] [--set PATH=VALUE ...] [--strict]\n"
        "      Start both solvers, print what would run, step limits, masses and doubts, and end.\n\n"
        "  tandem report DIR\n"
        "      Plot a result directory: every time history, simulation against reference, where the time went.\n\n"
        "  tandem verify [NAME|GROUP ...] [--out DIR] [--json FILE]\n"
        "      Run verification scenarios (default: the group \"scenarios\") and compare them with theory.\n"
        "      Curves and plots go to DIR (default: verify-out). Exit status 1 when a limit is missed.\n\n"
        "  --scenarios DIR   where scenarios are (default: ./scenarios, the installed ones, those of the source)\n"
        "  --help, --version\n\n"
        "Scenarios:\n",
        out);
  for (const cpl_scenario *s = scn_table; s->name; s++)
    fprintf(out, "  %-16s %-12s %s\n", s->name, s->group, s->summary);
}

static void on_signal(int number) {
  (void)number;
  cpl_interrupted = 1;
}

/* Ctrl-C and SIGTERM end a run in order. Calls that wait are woken. */
static void catch_signals(void) {
  struct sigaction action = {.sa_handler = on_signal};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  signal(SIGPIPE, SIG_IGN);
}

static int finish(const tdm_error *err) {
  if (err->status == TDM_OK)
    return 0;
  fprintf(stderr, "tandem: error: %s\n", err->message);
  return err->status == TDM_ERR_ARGUMENT ? 2 : err->status == TDM_ERR_INTERRUPTED ? 130 : 1;
}

/* ---- arguments ---- */

typedef struct {
  const char **word; /* what is no option, NULL-terminated */
  int nword;
  const char **set; /* --set values, NULL-terminated */
  int nset;
  const char *out, *json, *scenarios;
  bool strict;
} arguments;

static tdm_status parse(arguments *a, int argc, char **argv, tdm_error *err) {
  a->word = calloc((size_t)argc + 1, sizeof *a->word);
  a->set = calloc((size_t)argc + 1, sizeof *a->set);
  if (!a->word || !a->set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  struct {
    const char *name, **value;
  } options[] = {{"--out", &a->out}, {"--json", &a->json}, {"--scenarios", &a->scenarios}, {"--set", NULL}};
  const char *const names[] = {"--out", "--json", "--scenarios", "--set", "--strict", "--help", "--version"};
  for (int i = 0; i < argc; i++) {
    if (strncmp(argv[i], "--", 2) != 0) {
      a->word[a->nword++] = argv[i];
      continue;
    }
    if (strcmp(argv[i], "--strict") == 0) {
      a->strict = true;
      continue;
    }
    size_t k = 0;
    while (k < 4 && strcmp(argv[i], options[k].name) != 0)
      k++;
    if (k == 4) {
      const char *near = tdm_nearest(argv[i], names, 7);
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "unknown option %s%s%s; see tandem --help", argv[i],
                      near ? "; did you mean " : "", near ? near : "");
    }
    if (i + 1 == argc)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s needs a value", argv[i]);
    if (options[k].value)
      *options[k].value = argv[++i];
    else
      a->set[a->nset++] = argv[++i];
  }
  return TDM_OK;
}

/* ---- commands ---- */

/* run and check: one scene, up to its end or until both solvers are ready */
static tdm_status one_scene(const arguments *a, bool check, tdm_error *err) {
  char scene[4096];
  cpl_run_result result;
  if (a->nword != 1 || a->json)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    a->json ? "--json goes with verify" : "name one scene; see tandem --help");
  if (cpl_find_scene(scene, sizeof scene, a->word[0], a->scenarios, err) != TDM_OK)
    return err->status;
  cpl_run_options options = {.scene = scene, .set = a->set, .strict = a->strict, .check = check};
  options.out = a->out ? a->out : check ? "check-out" : "run-out";
  memcpy(options.solver, solvers, sizeof solvers);
  cpl_run(&options, &result, err);
  if (result.windows > 0)
    cpl_run_print(&result, options.out);
  return err->status;
}

static tdm_status command_run(const arguments *a, tdm_error *err) {
  return one_scene(a, false, err);
}

static tdm_status command_check(const arguments *a, tdm_error *err) {
  return one_scene(a, true, err);
}

static tdm_status command_report(const arguments *a, tdm_error *err) {
  if (a->nword != 1 || a->nset || a->json || a->strict || a->out)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "report: name one result directory, and nothing else");
  return cpl_report(a->word[0], scn_table, err);
}

static tdm_status command_verify(const arguments *a, tdm_error *err) {
  if (a->nset || a->strict)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "verify: %s goes with run", a->nset ? "--set" : "--strict");
  cpl_verify_options options = {.scenario = scn_table,
                                .name = a->word,
                                .out = a->out ? a->out : "verify-out",
                                .json = a->json,
                                .scenarios = a->scenarios};
  memcpy(options.solver, solvers, sizeof solvers);
  return cpl_verify_all(&options, err);
}

int main(int argc, char **argv) {
  const struct {
    const char *name;
    tdm_status (*run)(const arguments *, tdm_error *);
  } commands[] = {
      {"run", command_run}, {"check", command_check}, {"report", command_report}, {"verify", command_verify}};
  enum { NCOMMAND = sizeof commands / sizeof commands[0] };
  const char *names[NCOMMAND];
  for (int i = 0; i < NCOMMAND; i++)
    names[i] = commands[i].name;
  tdm_error err = {0};
  arguments a = {0};
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--help") == 0) {
      usage(stdout);
      return 0;
    }
    if (strcmp(argv[i], "--version") == 0) {
      printf("tandem %s\n", TANDEM_VERSION);
      return 0;
    }
  }
  if (argc < 2) {
    usage(stderr);
    return 2;
  }
  catch_signals();
  size_t k = 0;
  while (k < NCOMMAND && strcmp(argv[1], commands[k].name) != 0)
    k++;
  if (k == NCOMMAND) {
    const char *near = tdm_nearest(argv[1], names, NCOMMAND);
    tdm_fail(&err, TDM_ERR_ARGUMENT, NULL, "unknown command \"%s\"%s%s; see tandem --help", argv[1],
             near ? "; did you mean " : "", near ? near : "");
  } else if (parse(&a, argc - 2, argv + 2, &err) == TDM_OK) {
    commands[k].run(&a, &err);
  }
  free(a.word);
  free(a.set);
  return finish(&err);
}

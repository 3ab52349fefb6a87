/* tandem-dem: the solver process of a co-simulation, and the command line of scenes of particles alone. */
#include "dem/bench.h"
#include "dem/run.h"
#include "dem/solver.h"
#include "protocol/command_line.h"
#include "protocol/find.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>

static void usage(FILE *out) {
  fputs("tandem-dem: the discrete element engine of tandem\n\n"
        "  tandem-dem run SCENE [--out DIR] [--force] [--set PATH=VALUE ...] [--strict]\n"
        "      Run a scene that has only particles: a JSON file, or the name of a scene in scenarios/dem.\n"
        "      Results go to DIR (default: run-out): time histories, particles for ParaView, pictures.\n"
        "      --force            replace the results of an earlier run in DIR\n"
        "      --set PATH=VALUE   override a value of the scene: --set time.end=2 --set dem.pairs[0].friction=0.3\n"
        "      --strict           refuse a run that the solver has doubts about\n\n"
        "  tandem-dem check SCENE [--set PATH=VALUE ...] [--strict]\n"
        "      Load and settle the scene, print what would run, step limits and doubts, and end.\n\n"
        "  tandem-dem bench [OPTIONS]\n"
        "      Measure the engine's speed; see tandem-dem bench --help.\n\n"
        "  tandem-dem --connect ENDPOINT [--name NAME] [--timeout SECONDS]\n"
        "      Take part in a co-simulation; \"tandem run SCENE\" starts it so by itself.\n"
        "      --connect ENDPOINT  where the server listens, for example ipc:///tmp/dir/tandem\n"
        "      --name NAME         the name in messages and logs (default: dem)\n"
        "      --timeout SECONDS   give up when the server is silent for so long (default: 30)\n\n"
        "  --scenarios DIR   where scenarios are (default: ./scenarios, the installed ones, those of the source)\n"
        "  --help, --version\n",
        out);
}

typedef struct {
  tdm_arguments given;
  const char *out, *scenarios;
  bool force, strict;
} arguments;

static tdm_status parse(arguments *a, int argc, char **argv, tdm_error *err) {
  const tdm_option options[] = {{"--out", &a->out, NULL},
                                {"--scenarios", &a->scenarios, NULL},
                                {"--set", NULL, NULL},
                                {"--force", NULL, &a->force},
                                {"--strict", NULL, &a->strict}};
  return tdm_arguments_read(&a->given, options, sizeof options / sizeof options[0], "tandem-dem", argc, argv, err);
}

/* the options of a run; `scene` (4096) gets the file's name */
static tdm_status find_scene(const arguments *a, const char *command, char *scene, dem_run_options *o, tdm_error *err) {
  *o = (dem_run_options){.scene = scene, .set = a->given.set, .force = a->force, .strict = a->strict};
  o->out = a->out ? a->out : "run-out";
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: name one scene; see tandem-dem --help", command);
  return tdm_find_scene(scene, 4096, "dem", a->given.word[0], a->scenarios, err);
}

static tdm_status command_run(const arguments *a, tdm_error *err) {
  char scene[4096];
  dem_run_options options;
  return find_scene(a, "run", scene, &options, err) != TDM_OK ? err->status : dem_run(&options, err);
}

static tdm_status command_check(const arguments *a, tdm_error *err) {
  char scene[4096];
  dem_run_options options;
  if (a->out || a->force)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "check: %s does not go with this command; see tandem-dem --help",
                    a->out ? "--out" : "--force");
  return find_scene(a, "check", scene, &options, err) != TDM_OK ? err->status : dem_run_check(&options, err);
}

int main(int argc, char **argv) {
  /* Large arrays in pages of their own, also after some were freed: they grow without a copy, and what is freed goes.
   */
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  const struct {
    const char *name;
    tdm_status (*run)(const arguments *, tdm_error *);
  } commands[] = {{"run", command_run}, {"check", command_check}};
  enum { NCOMMAND = sizeof commands / sizeof commands[0] };
  const char *names[NCOMMAND];
  for (int i = 0; i < NCOMMAND; i++)
    names[i] = commands[i].name;
  tdm_error err = {0};
  arguments a = {0};
  if (argc > 1 && strcmp(argv[1], "bench") == 0)
    return dem_bench_main(argc - 2, argv + 2);
  for (int i = 1; i < argc; i++)
    if (strcmp(argv[i], "--help") == 0) {
      usage(stdout);
      return 0;
    }
  if (argc < 2) {
    usage(stderr);
    return 2;
  }
  if (strncmp(argv[1], "--", 2) == 0)
    return tdm_solver_main(&dem_solver_ops, argc, argv);
  tdm_catch_signals();
  int k = 0;
  while (k < NCOMMAND && strcmp(argv[1], commands[k].name) != 0)
    k++;
  if (k == NCOMMAND)
    tdm_unknown_command("tandem-dem", argv[1], names, NCOMMAND, &err);
  else if (parse(&a, argc - 2, argv + 2, &err) == TDM_OK)
    commands[k].run(&a, &err);
  tdm_arguments_free(&a.given);
  return tdm_finish("tandem-dem", &err);
}

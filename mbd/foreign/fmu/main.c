/* tandem-fmu FILE.fmu: an FMU as the multibody solver of a co-simulation; alone, it tells what the FMU has. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/foreign/fmu/solver.h"
#include "protocol/base/log.h"
#include "protocol/math/gsl_errors.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

/* ---- an FMU that crashes or hangs ---- */

static const char *file; /* for the handlers */
static double patience;  /* silence after which a call is told of [s] */

static void write_words(const char *const *words) {
  for (; *words; words++)
    if (write(2, *words, strlen(*words)) < 0)
      return;
}

/* The last line of the log, which the server puts into its error. */
static void on_crash(int sig) {
  const char *call = tdm_fmu_calling;
  const char *const words[] = {"level=error event=crash message=\"",
                               file,
                               call ? ": crashed in " : ": crashed",
                               call ? call : " outside of the FMU's functions",
                               "\"\n",
                               NULL};
  write_words(words);
  signal(sig, SIG_DFL);
  raise(sig);
}

static void on_tick(int sig) {
  const char *call = tdm_fmu_calling;
  const char *const words[] = {"level=error event=slow message=\"",
                               file,
                               ": ",
                               call ? call : "?",
                               " has not returned for half the time that the server waits (coupling.timeout)\"\n",
                               NULL};
  (void)sig;
  if (!call || tdm_clock() - tdm_fmu_called_at < patience)
    return;
  tdm_fmu_called_at = tdm_clock() + 1e9; /* once a call */
  write_words(words);
}

/* An FMU must not end the process that it is a guest of. */
static void on_exit_in_call(void) {
  const char *const words[] = {
      "level=error event=exit message=\"", file, ": ended the process in ", tdm_fmu_calling, "\"\n", NULL};
  if (!tdm_fmu_calling)
    return;
  write_words(words);
  _exit(1);
}

static void watch(double timeout) {
  static const int signals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  static char stack[65536]; /* of on_crash: an FMU may have used up its own */
  sigaltstack(&(stack_t){.ss_sp = stack, .ss_size = sizeof stack}, NULL);
  for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
    sigaction(signals[i], &(struct sigaction){.sa_handler = on_crash, .sa_flags = SA_ONSTACK}, NULL);
  atexit(on_exit_in_call);
  patience = timeout / 2;
  const double tick = patience / 4;
  const struct timeval interval = {.tv_sec = (time_t)tick, .tv_usec = (suseconds_t)(1e6 * (tick - (time_t)tick)) + 1};
  sigaction(SIGALRM, &(struct sigaction){.sa_handler = on_tick, .sa_flags = SA_RESTART}, NULL);
  setitimer(ITIMER_REAL, &(struct itimerval){interval, interval}, NULL);
}

/* ---- what the FMU has ---- */

static void print_fmu(const tdm_fmu *f) {
  const tdm_fmi_description *d = &f->description;
  printf("%s: \"%s\", FMI %d.0 co-simulation%s%s\n", f->file, d->model_name ? d->model_name : d->identifier, d->version,
         d->tool ? ", made by " : "", d->tool ? d->tool : "");
  printf("  %-28s %s\n", "saves and restores states", d->keeps_states ? "yes: restore, mobility by trials" : "no");
  printf("  %-28s %s\n", "directional derivatives",
         d->gives_derivatives ? "yes: mobility where accelerations are outputs" : "no");
  printf("  %-28s %s\n", "steps of any length", d->varies_step ? "yes" : "no: mbd.step must divide all windows");
  printf("  %-28s %s\n", "instances in a process", d->once_per_process ? "one" : "any number");
  printf("  %-28s %s\n", "needs the tool it is from", d->needs_tool ? "yes, installed here" : "no");
  printf("  %-28s %s\n", "schemes",
         d->keeps_states        ? "all"
         : d->gives_derivatives ? "all but iterative; proxy where accelerations are outputs"
                                : "dem-first, lommen, hold");
  for (int i = 0; i < d->nvariable; i++) {
    const tdm_fmi_variable *v = &d->variable[i];
    printf("  %-20s %-12s %s", tdm_fmi_causality_names[v->causality], v->type_name ? v->type_name : "?", v->name);
    if (v->size != 1)
      printf("[%ld]", v->size);
    printf("%s%s%s\n", v->unit ? " [" : "", v->unit ? v->unit : "", v->unit ? "]" : "");
  }
}

static int usage(FILE *out, int status) {
  fputs("usage: tandem-fmu FILE.fmu                 what the FMU has: capabilities and variables\n"
        "       tandem-fmu FILE.fmu --connect ENDPOINT [--name NAME] [--timeout SECONDS]\n\n"
        "The FMU as the multibody side of a tandem co-simulation. In a scene:\n\n"
        "  \"mbd\": {\"solver\": \"tandem-fmu model.fmu\", ...}\n\n"
        "The rest of the section says what the FMU's variables are: mbd/foreign/fmu/README.md.\n",
        out);
  return status;
}

int main(int argc, char **argv) {
  tdm_error err = {0};
  tdm_fmu *fmu = NULL;
  const char *capability[FMU_CAPABILITIES_MAX];
  double timeout = tdm_participant_default_def().timeout;
  if (argc < 2 || strcmp(argv[1], "--help") == 0)
    return usage(argc < 2 ? stderr : stdout, argc < 2 ? 2 : 0);
  if (argv[1][0] == '-' && strcmp(argv[1], "--version") != 0)
    return usage(stderr, 2);
  for (int i = 2; i + 1 < argc; i++)
    if (strcmp(argv[i], "--timeout") == 0 && atof(argv[i + 1]) > 0)
      timeout = atof(argv[i + 1]);
  file = argv[1];
  tdm_log_open(stderr, "mbd");
  tdm_gsl_return_errors();
  int status = 1;
  if (argv[1][0] != '-' && tdm_fmu_open(&fmu, file, &err) != TDM_OK) {
    fprintf(stderr, "tandem-fmu: %s\n", err.message);
  } else if (fmu && argc == 2) {
    print_fmu(fmu);
    status = 0;
  } else if (fmu) {
    const tdm_solver_ops ops = fmu_solver_ops(fmu, capability);
    watch(timeout);
    argv[1] = argv[0];
    status = tdm_solver_main(&ops, argc - 1, argv + 1);
  } else {
    status = tdm_solver_main(&(tdm_solver_ops){.role = "mbd", .software = "tandem-fmu " TDM_VERSION}, argc, argv);
  }
  tdm_fmu_close(&fmu);
  return status;
}

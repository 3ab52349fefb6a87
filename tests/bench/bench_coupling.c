/* What the coupling costs: wall time per window beyond the solvers' own work, beside two bare ZeroMQ round trips with
 * messages of the same size, in turn within one run; medians. Prints numbers, judges nothing.
 *
 *   bench_coupling [windows] [repeats]
 *
 * The scene is a free body and a DEM without particles, so that nearly nothing but the exchange is left.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/run/run.h"
#include "dem/adapter/solver.h"
#include "mbd/adapter/solver.h"
#include "protocol/base/log.h"

#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zmq.h>

enum { REPEATS_MAX = 51 };

/* sizes on the wire for one coupled body: STEP and RESULT of mbd, of dem */
static const size_t mbd_step = 24 + 48 + 3 * 48, mbd_result = 24 + 40 + 104;
static const size_t dem_step = 24 + 48 + 2 * 104, dem_result = 24 + 40 + 48;

static const char scene[] =
    "{\"time\": {\"end\": %g, \"dt\": 1e-4}, \"coupling\": {\"n\": 1, \"bodies\": [{\"mbd\": \"body\", \"dem\": "
    "\"body\"}]},"
    "\"output\": {\"interval\": 1}, \"mbd\": {\"bodies\": [{\"name\": \"body\", \"mass\": 1, \"inertia\": [1, 1, 1],"
    "\"position\": [0, 0, 0]}]}, \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1, \"young_modulus\": 1e6,"
    "\"poisson_ratio\": 0.2}], \"bodies\": [{\"name\": \"body\", \"material\": \"m\", \"shapes\": [{\"type\": "
    "\"plane\","
    "\"normal\": [0, 0, 1]}]}]}}";

static int compare(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values, int n) {
  qsort(values, (size_t)n, sizeof *values, compare);
  return values[n / 2];
}

/* ---- bare round trips ---- */

typedef struct {
  void *context;
  const char *endpoint;
  long windows;
} echo;

/* answer each message with one of the partner's size */
static void *echo_main(void *argument) {
  const echo *e = argument;
  void *socket = zmq_socket(e->context, ZMQ_DEALER);
  char buffer[1024] = "";
  zmq_connect(socket, e->endpoint);
  zmq_send(socket, buffer, 1, 0);
  for (long i = 0; i < 2 * e->windows; i++) {
    zmq_recv(socket, buffer, sizeof buffer, 0);
    zmq_send(socket, buffer, i % 2 ? dem_result : mbd_result, 0);
  }
  zmq_close(socket);
  return NULL;
}

/* Two round trips a window over one ROUTER-DEALER pair; seconds a window. */
static double bare(const char *endpoint, int is_ipc, long windows) {
  char id[64], buffer[1024] = "";
  void *context = zmq_ctx_new(), *socket = zmq_socket(context, ZMQ_ROUTER);
  pthread_t thread;
  pid_t pid = 0;
  echo e = {context, endpoint, windows};
  if (zmq_bind(socket, endpoint) != 0) {
    fprintf(stderr, "cannot listen on %s: %s\n", endpoint, zmq_strerror(errno));
    exit(1);
  }
  if (is_ipc && (pid = fork()) == 0) {
    e.context = zmq_ctx_new();
    echo_main(&e);
    zmq_ctx_term(e.context);
    _exit(0);
  }
  if (!is_ipc)
    pthread_create(&thread, NULL, echo_main, &e);
  int n = zmq_recv(socket, id, sizeof id, 0);
  zmq_recv(socket, buffer, sizeof buffer, 0);
  double begin = tdm_clock();
  for (long i = 0; i < 2 * windows; i++) {
    zmq_send(socket, id, (size_t)n, ZMQ_SNDMORE);
    zmq_send(socket, buffer, i % 2 ? dem_step : mbd_step, 0);
    zmq_recv(socket, id, sizeof id, 0);
    zmq_recv(socket, buffer, sizeof buffer, 0);
  }
  double seconds = tdm_clock() - begin;
  if (is_ipc)
    waitpid(pid, NULL, 0);
  else
    pthread_join(thread, NULL);
  zmq_close(socket);
  zmq_ctx_term(context);
  return seconds / (double)windows;
}

/* ---- the coupling ---- */

static double coupled(const char *file, const char *out, const char *transport, long *windows) {
  const char *set[] = {transport, NULL};
  cpl_run_options options = {.scene = file, .set = set, .out = out, .quiet = true};
  options.solver[CPL_MBD] = (cpl_solver){TANDEM_BIN_DIR "/tandem-mbd", &mbd_solver_ops};
  options.solver[CPL_DEM] = (cpl_solver){TANDEM_BIN_DIR "/tandem-dem", &dem_solver_ops};
  cpl_run_result result;
  tdm_error err = {0};
  if (cpl_run(&options, &result, &err) != TDM_OK) {
    fprintf(stderr, "%s\n", err.message);
    exit(1);
  }
  *windows = (long)result.windows;
  return cpl_run_coupling(&result) / (double)result.windows;
}

int main(int argc, char **argv) {
  long windows = argc > 1 ? atol(argv[1]) : 20000;
  int repeats = argc > 2 ? atoi(argv[2]) : 5;
  char dir[] = "/tmp/tandem-bench-XXXXXX", file[128], out[128], endpoint[128], line[256];
  if (windows < 1 || repeats < 1 || repeats > REPEATS_MAX || !mkdtemp(dir))
    return 1;
  snprintf(file, sizeof file, "%s/scene.json", dir);
  snprintf(out, sizeof out, "%s/out", dir);
  snprintf(endpoint, sizeof endpoint, "ipc://%s/bare", dir);
  FILE *f = fopen(file, "w");
  fprintf(f, scene, (double)windows * 1e-4);
  fclose(f);
  double bare_ipc[REPEATS_MAX], bare_inproc[REPEATS_MAX], ipc[REPEATS_MAX], inproc[REPEATS_MAX];
  for (int i = 0; i < repeats; i++) {
    bare_ipc[i] = bare(endpoint, 1, windows);
    ipc[i] = coupled(file, out, "coupling.transport=ipc", &windows);
    bare_inproc[i] = bare("inproc://bare", 0, windows);
    inproc[i] = coupled(file, out, "coupling.transport=inproc", &windows);
  }
  double a = median(bare_ipc, repeats), b = median(ipc, repeats), c = median(bare_inproc, repeats),
         d = median(inproc, repeats);
  printf("%ld windows, medians of %d, microseconds a window\n", windows, repeats);
  printf("ipc     two bare round trips %7.1f   coupling %7.1f   ratio %.2f\n", 1e6 * a, 1e6 * b, b / a);
  printf("inproc  two bare round trips %7.1f   coupling %7.1f   ratio %.2f\n", 1e6 * c, 1e6 * d, d / c);
  printf("ipc / inproc %.2f\n", b / d);
  snprintf(line, sizeof line, "rm -rf %s", dir);
  return system(line);
}

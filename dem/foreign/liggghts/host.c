/* LIGGGHTS, hosted: see host.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* fopencookie: LIGGGHTS speaks to a stream of ours */
#include "dem/foreign/liggghts/host.h"

#include "protocol/base/log.h"

#include <assert.h>
#include <liggghts/library.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { LINE = 2048 }; /* LIGGGHTS' longest command */

typedef enum { OPEN, COMMAND, SCRIPT, VARIABLE, PARTICLES, END } order_kind;

/* What rank 0 has all ranks do. */
typedef struct {
  order_kind kind;
  char text[LINE];
} order;

static struct {
  void *lammps; /* NULL: not started */
  int rank, ranks;
  MPI_Comm errors;              /* of lines that other ranks send to rank 0 */
  bool hears;                   /* rank 0's thread may take them */
  tdm_participant *participant; /* rank 0's */
  pthread_t pulse;
  bool pulses, ends;
  pthread_mutex_t lock; /* of the participant and of what follows */
  const char *doing;    /* the order that LIGGGHTS works on; NULL: none */
  const char *path;     /* in the scene */
  bool aloud;
  char last[LINE]; /* line that it has printed, or begun */
  size_t length;   /* of what it has begun */
  char before[LINE];
  char failure[LINE];            /* an error of another rank, "" if there is none */
  unsigned long printed, orders; /* bytes; orders so far */
  void (*listener)(void *arg, const char *line);
  void *listener_arg;
  double running; /* [s] */
} host = {.lock = PTHREAD_MUTEX_INITIALIZER, .path = ""};

/* ---- the end that LIGGGHTS makes ---- */

/* The kind of an error: of the scene, where it lies somewhere in it. */
static tdm_status blame(void) {
  return host.path[0] ? TDM_ERR_SCENE : TDM_ERR_NUMERIC;
}

/* Send an error to the server, and leave: LIGGGHTS cannot go on. The lock is held. */
static void give_up(tdm_error *err) __attribute__((noreturn));

static void give_up(tdm_error *err) {
  char quoted[TDM_MESSAGE_MAX];
  tdm_log(TDM_LOG_ERROR, "liggghts", "message=%s", tdm_log_quote(quoted, sizeof quoted, err->message));
  tdm_participant_finalize(&host.participant, err);
  fflush(stderr);
  _exit(1); /* under mpirun this ends the other ranks too */
}

/* By an error that LIGGGHTS has printed, on whatever rank. */
static void give_up_by(const char *line) __attribute__((noreturn));

static void give_up_by(const char *line) {
  tdm_error err = {0};
  tdm_fail(&err, blame(), host.path, "LIGGGHTS: %.500s%s%.300s", line, host.before[0] ? "; the line before: " : "",
           host.before);
  give_up(&err);
}

/* Another rank than 0: rank 0 tells the server, which ends this process; else LIGGGHTS does, after a while. */
static void send_failure(const char *line) {
  const double end = tdm_clock() + 5;
  MPI_Request request;
  int there = 0;
  MPI_Isend((void *)line, (int)strlen(line) + 1, MPI_CHAR, 0, 0, host.errors, &request);
  while (tdm_clock() < end) {
    MPI_Test(&request, &there, MPI_STATUS_IGNORE); /* also where it has gone: rank 0 may not have taken it yet */
    nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
  }
}

/* Rank 0: an error that another rank has sent. The lock is held. */
static void hear_failure(void) {
  int there = 0;
  MPI_Status status;
  if (!host.hears || host.failure[0] || MPI_Iprobe(MPI_ANY_SOURCE, 0, host.errors, &there, &status) != MPI_SUCCESS ||
      !there)
    return;
  MPI_Recv(host.failure, LINE, MPI_CHAR, status.MPI_SOURCE, 0, host.errors, MPI_STATUS_IGNORE);
  host.failure[LINE - 1] = 0;
}

/* LIGGGHTS' own errors: "ERROR: what (../file.cpp:12)", "ERROR on proc 1: …". */
static bool is_error(const char *line) {
  return strncmp(line, "ERROR", 5) == 0 && (strstr(line, ".cpp:") || strstr(line, ".h:"));
}

/* But for that about what NAME_mesh does on purpose: it gives a mesh that it moves a reference point. */
static bool is_warning(const char *line) {
  return strncmp(line, "WARNING", 7) == 0 && !strstr(line, "has been scaled, moved, or rotated");
}

/* A whole line that LIGGGHTS has printed. */
static void heard(char *line) {
  if (host.aloud || is_error(line) || is_warning(line))
    dprintf(1, "%s\n", line);
  if (is_error(line) && host.rank > 0)
    send_failure(line);
  else if (is_error(line))
    give_up_by(line);
  if (is_warning(line))
    tdm_remark(TDM_WARNING, "liggghts", host.path, NAN, "LIGGGHTS: %.700s", line);
  if (!host.aloud)
    return;
  if (line[strspn(line, " ")])
    memcpy(host.before, line, LINE);
  if (host.listener)
    host.listener(host.listener_arg, line);
}

/* The stream that LIGGGHTS prints to. */
static ssize_t hear(void *cookie, const char *text, size_t size) {
  (void)cookie;
  pthread_mutex_lock(&host.lock);
  host.printed += size;
  for (size_t k = 0; k < size; k++) {
    const bool ends = text[k] == '\n';
    if (!ends && host.length < LINE - 1)
      host.last[host.length++] = text[k];
    if (!ends)
      continue;
    host.last[host.length] = 0;
    host.length = 0;
    heard(host.last);
  }
  pthread_mutex_unlock(&host.lock);
  return (ssize_t)size;
}

static void on_exit_in_order(void) {
  pthread_mutex_lock(&host.lock);
  if (host.rank == 0 && host.doing) {
    tdm_error err = {0};
    tdm_fail(&err, blame(), host.path, "LIGGGHTS ended the process in: %.500s", host.doing);
    give_up(&err);
  }
  pthread_mutex_unlock(&host.lock);
}

/* ---- signs of life ---- */

/* Something that changes as LIGGGHTS gets on: bytes that it prints, orders, steps since it built its neighbour lists.
 */
static unsigned long progress(void) {
  const int *steps = host.lammps ? lammps_extract_global(host.lammps, "ago") : NULL;
  return host.printed + 4099UL * host.orders +
         16777259UL * (unsigned long)(steps ? *(const volatile int *)steps + 1 : 0);
}

static void *pulse(void *argument) {
  (void)argument;
  unsigned long before = 0;
  tdm_log_open(stderr, "dem");
  for (bool ends = false; !ends;) {
    nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
    pthread_mutex_lock(&host.lock);
    ends = host.ends;
    hear_failure();
    if (host.failure[0] && host.doing)
      give_up_by(host.failure);
    const unsigned long now = ends || !host.doing ? before : progress();
    const bool lives = now != before;
    before = now;
    if (lives && tdm_participant_alive(host.participant) != TDM_OK) {
      tdm_log(TDM_LOG_INFO, "finished", "cause=\"the server wants no more, or is gone\"");
      _exit(1);
    }
    pthread_mutex_unlock(&host.lock);
  }
  return NULL;
}

static void work_begins(const char *what) {
  if (host.rank > 0)
    return;
  pthread_mutex_lock(&host.lock);
  if (host.failure[0])
    give_up_by(host.failure);
  host.doing = what;
  host.orders++;
  host.before[0] = 0;
  pthread_mutex_unlock(&host.lock);
}

static void work_ends(void) {
  if (host.rank > 0)
    return;
  pthread_mutex_lock(&host.lock);
  host.doing = NULL;
  pthread_mutex_unlock(&host.lock);
}

/* ---- orders ---- */

static void start_lammps(void) {
  static char *argv[] = {(char *)"liggghts", (char *)"-log", (char *)"none", NULL};
  lammps_open(3, argv, MPI_COMM_WORLD, &host.lammps);
}

/* Do an order on this rank. */
static double obey(const order *o) {
  double value = NAN;
  double *got;
  switch (o->kind) {
  case OPEN:
    start_lammps();
    break;
  case COMMAND:
    lammps_command(host.lammps, o->text);
    break;
  case SCRIPT:
    lammps_file(host.lammps, o->text);
    break;
  case VARIABLE:
    got = lammps_extract_variable(host.lammps, (char *)o->text, (char *)"all");
    if (got)
      value = *got;
    free(got);
    break;
  case PARTICLES:
    value = lammps_get_natoms(host.lammps);
    break;
  case END:
    if (host.lammps)
      lammps_close(host.lammps);
    host.lammps = NULL;
    break;
  }
  return value;
}

/* Rank 0: have all ranks do it. */
static double give(const order *o) {
  MPI_Request request;
  if (host.ranks > 1) { /* as the others wait for it */
    MPI_Ibcast((void *)o, sizeof *o, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
    MPI_Wait(&request, MPI_STATUS_IGNORE);
  }
  work_begins(o->text);
  const double value = obey(o);
  work_ends();
  return value;
}

/* The next order, without taking a processor from those that have something to do. */
static void wait_for_order(order *o) {
  const double begin = tdm_clock();
  MPI_Request request;
  int there = 0;
  MPI_Ibcast(o, sizeof *o, MPI_BYTE, 0, MPI_COMM_WORLD, &request);
  while (MPI_Test(&request, &there, MPI_STATUS_IGNORE) == MPI_SUCCESS && !there)
    if (tdm_clock() - begin > 2e-4)
      nanosleep(&(struct timespec){.tv_nsec = 20000}, NULL);
}

/* LIGGGHTS takes a stream of ours as its screen; without a screen it crashes when it reads a mesh. */
static tdm_status listen_to_lammps(tdm_error *err) {
  FILE *stream = fopencookie(NULL, "w", (cookie_io_functions_t){.write = hear});
  if (!stream)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  setvbuf(stream, NULL, _IOLBF, LINE);
  fflush(stdout);
  stdout = stream;
  return TDM_OK;
}

void lig_host_follow(void) {
  static order o;
  listen_to_lammps(NULL);
  do {
    wait_for_order(&o);
    obey(&o);
  } while (o.kind != END);
  MPI_Finalize();
}

/* ---- begin and end ---- */

int lig_host_begin(int *argc, char ***argv, int *ranks) {
  int threads;
  MPI_Init_thread(argc, argv, MPI_THREAD_MULTIPLE, &threads);
  MPI_Comm_rank(MPI_COMM_WORLD, &host.rank);
  MPI_Comm_size(MPI_COMM_WORLD, &host.ranks);
  MPI_Comm_dup(MPI_COMM_WORLD, &host.errors);
  host.hears = threads == MPI_THREAD_MULTIPLE && host.ranks > 1;
  *ranks = host.ranks;
  return host.rank;
}

tdm_status lig_host_open(tdm_participant *participant, tdm_error *err) {
  host.participant = participant;
  if (listen_to_lammps(err) != TDM_OK)
    return err->status;
  if (pthread_create(&host.pulse, NULL, pulse, NULL) != 0)
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "cannot start a thread");
  host.pulses = true;
  atexit(on_exit_in_order);
  give(&(order){.kind = OPEN, .text = "start"});
  return TDM_OK;
}

void lig_host_end(void) {
  if (host.pulses) {
    pthread_mutex_lock(&host.lock);
    host.ends = true;
    pthread_mutex_unlock(&host.lock);
    pthread_join(host.pulse, NULL);
    host.pulses = false;
  }
  host.aloud = false;
  host.participant = NULL;
  give(&(order){.kind = END, .text = "end"});
  MPI_Finalize();
}

void lig_host_at(const char *path, bool aloud) {
  fflush(stdout);
  host.path = path;
  host.aloud = aloud;
}

void lig_host_listen(void (*listener)(void *arg, const char *line), void *arg) {
  fflush(stdout);
  host.listener = listener;
  host.listener_arg = arg;
}

double lig_host_running(void) {
  return host.running;
}

/* ---- for the solver ---- */

void lig_host_command(const char *format, ...) {
  order o = {.kind = COMMAND};
  va_list args;
  va_start(args, format);
  const int n = vsnprintf(o.text, sizeof o.text, format, args);
  va_end(args);
  assert(n < (int)sizeof o.text);
  (void)n;
  const double begin = tdm_clock();
  give(&o);
  if (strncmp(o.text, "run ", 4) == 0)
    host.running += tdm_clock() - begin;
}

void lig_host_script(const char *file) {
  order o = {.kind = SCRIPT};
  snprintf(o.text, sizeof o.text, "%s", file);
  give(&o);
}

bool lig_host_fix_value(const char *fix, int i, double *value) {
  double *got = lammps_extract_fix(host.lammps, fix, 0, 1, i, 0);
  if (got)
    *value = *got;
  free(got);
  return got != NULL;
}

bool lig_host_variable(const char *variable, double *value) {
  order o = {.kind = VARIABLE};
  snprintf(o.text, sizeof o.text, "%s", variable);
  *value = give(&o);
  return *value == *value;
}

double lig_host_particles(void) {
  return give(&(order){.kind = PARTICLES, .text = "count"});
}

/* Solvers that the server starts itself: see launch.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* pthread_timedjoin_np, environ */
#include "coupler/session/launch.h"

#include "protocol/app/find.h"
#include "protocol/base/log.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

struct cpl_child {
  int log;   /* open for reading: the file may be moved */
  pid_t pid; /* 0 for a thread */
  bool ended;
  int wait_status;
  /* a thread */
  pthread_t thread;
  const tdm_solver_ops *ops;
  tdm_participant_def def;
  char *endpoint;
  FILE *sink;
  tdm_error err;
};

static void child_free(cpl_child *child) {
  if (child->sink)
    fclose(child->sink);
  free(child->endpoint);
  if (child->log >= 0)
    close(child->log);
  free(child);
}

/* ---- processes ---- */

/* The environment with this program's folder first on PATH: "mpirun -n 2 tandem-liggghts" finds its last word there
 * too. The caller frees it, one block; NULL: no memory. */
static char **environment_with_folder(void) {
  char self[4096];
  const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
  self[length > 0 ? length : 0] = 0;
  const char *slash = strrchr(self, '/'), *path = getenv("PATH");
  const int folder = slash ? (int)(slash - self) : 0;
  path = path ? path : "/usr/bin:/bin";
  size_t n = 0, k = 0;
  while (environ[n])
    n++;
  const size_t size = strlen("PATH=") + (size_t)folder + 1 + strlen(path) + 1;
  char **all = malloc((n + 2) * sizeof *all + size);
  if (!all)
    return NULL;
  char *own = (char *)(all + n + 2);
  snprintf(own, size, "PATH=%.*s%s%s", folder, self, folder ? ":" : "", path);
  all[k++] = own;
  for (size_t i = 0; i < n; i++)
    if (strncmp(environ[i], "PATH=", 5) != 0)
      all[k++] = environ[i];
  all[k] = NULL;
  return all;
}

/* In the child, between fork and exec: only calls that are safe there. */
static void become_solver(const char *path, char *const *argv, char *const *environment, int log, pid_t server) {
  struct sigaction ignore = {.sa_handler = SIG_IGN};
  sigaction(SIGINT, &ignore, NULL);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != server) /* the server died before the line above */
    _exit(126);
  int null = open("/dev/null", O_RDONLY);
  dup2(null, 0);
  dup2(log, 1);
  dup2(log, 2);
  execve(path, argv, environment);
  static const char message[] = "cannot be executed\n";
  ssize_t ignored = write(2, message, sizeof message - 1);
  (void)ignored;
  _exit(127);
}

enum { WORDS_MAX = 64 };

/* The words of a command, in `text` (size bytes): blanks part them, unless all of it is a program. Returns their
 * number, the first being the program's path in `path`; 0: there is no such program. */
static int read_command(const char *command, char *text, size_t size, char **word, char *path, size_t path_size) {
  int n = 1;
  if (tdm_find_program(path, path_size, command))
    return n;
  if (strlen(command) >= size)
    return 0;
  strcpy(text, command);
  char *rest = NULL, *first = strtok_r(text, " ", &rest);
  if (!first || !tdm_find_program(path, path_size, first))
    return 0;
  for (char *next; n < WORDS_MAX && (next = strtok_r(NULL, " ", &rest)) != NULL;)
    word[n++] = next;
  return n;
}

const char *cpl_launch_command(const cpl_settings *s, cpl_role role, const char *program, char *text, size_t size) {
  if (s->command[role] || role != CPL_DEM || s->ranks <= 1)
    return s->command[role] ? s->command[role] : program;
  snprintf(text, size, "%s --ranks %d", program, s->ranks);
  return text;
}

tdm_status cpl_launch_process(cpl_child **child, const char *command, const char *endpoint, const char *name,
                              const char *log, double timeout, tdm_error *err) {
  char path[4096], text[4096], seconds[32], *argv[WORDS_MAX + 7];
  const int n = read_command(command, text, sizeof text, argv, path, sizeof path);
  if (n == 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL,
                    "the solver \"%s\" is neither beside this program nor on PATH, or may not be executed", command);
  snprintf(seconds, sizeof seconds, "%g", timeout);
  int file = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", log, strerror(errno));
  char *const options[] = {"--connect", (char *)endpoint, "--name", (char *)name, "--timeout", seconds, NULL};
  argv[0] = path;
  memcpy(argv + n, options, sizeof options);
  cpl_child *c = calloc(1, sizeof *c);
  char **environment = environment_with_folder();
  if (!c || !environment) {
    close(file);
    free(c);
    free(environment);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  pid_t server = getpid(), pid = fork();
  if (pid == 0)
    become_solver(path, argv, environment, file, server);
  free(environment);
  close(file);
  if (pid < 0) {
    free(c);
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "cannot start %s: %s", path, strerror(errno));
  }
  c->pid = pid;
  c->log = open(log, O_RDONLY | O_CLOEXEC);
  *child = c;
  return TDM_OK;
}

/* ---- threads ---- */

static void *thread_main(void *argument) {
  cpl_child *c = argument;
  tdm_log_open(c->sink, c->def.name);
  tdm_participant_run(c->ops, &c->def, &c->err);
  return NULL;
}

tdm_status cpl_launch_thread(cpl_child **child, const tdm_solver_ops *ops, const char *endpoint, void *context,
                             const char *log, double timeout, tdm_error *err) {
  cpl_child *c = calloc(1, sizeof *c);
  if (!c)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  c->endpoint = strdup(endpoint);
  c->sink = fopen(log, "we");
  c->log = open(log, O_RDONLY | O_CLOEXEC);
  c->ops = ops;
  c->def = tdm_participant_default_def();
  c->def.name = c->def.role = ops->role;
  c->def.software = ops->software;
  c->def.capabilities = ops->capabilities;
  c->def.ncapability = ops->ncapability;
  c->def.endpoint = c->endpoint;
  c->def.context = context;
  c->def.timeout = timeout;
  int failure = 0;
  if (!c->endpoint)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  else if (!c->sink)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", log, strerror(errno));
  else if ((failure = pthread_create(&c->thread, NULL, thread_main, c)) != 0)
    tdm_fail(err, TDM_ERR_SYSTEM, NULL, "cannot start a thread for %s: %s", ops->role, strerror(failure));
  if (err->status != TDM_OK) {
    child_free(c);
    return err->status;
  }
  *child = c;
  return TDM_OK;
}

/* ---- both ---- */

/* Wait up to `seconds` for the end. */
static bool wait_for_end(cpl_child *c, double seconds) {
  if (c->ended)
    return true;
  if (!c->pid) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    double whole = floor(seconds);
    until.tv_sec += (time_t)whole;
    until.tv_nsec += (long)(1e9 * (seconds - whole));
    if (until.tv_nsec >= 1000000000) {
      until.tv_nsec -= 1000000000;
      until.tv_sec++;
    }
    c->ended = pthread_timedjoin_np(c->thread, NULL, &until) == 0;
    return c->ended;
  }
  double deadline = tdm_clock() + seconds;
  while (true) {
    pid_t got = waitpid(c->pid, &c->wait_status, WNOHANG);
    if (got == c->pid || (got < 0 && errno != EINTR)) {
      c->ended = true;
      return true;
    }
    if (tdm_clock() >= deadline)
      return false;
    nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
  }
}

bool cpl_child_running(cpl_child *c, char *how, size_t size) {
  if (!wait_for_end(c, 0))
    return true;
  if (!how)
    return false;
  if (!c->pid)
    snprintf(how, size, "its thread ended: %s", tdm_status_text(c->err.status));
  else if (WIFSIGNALED(c->wait_status))
    snprintf(how, size, "killed by signal %d (%s)", WTERMSIG(c->wait_status), strsignal(WTERMSIG(c->wait_status)));
  else
    snprintf(how, size, "exit status %d", WEXITSTATUS(c->wait_status));
  return false;
}

void cpl_child_interrupt(const cpl_child *c) {
  if (c->pid && !c->ended)
    kill(c->pid, SIGINT);
}

void cpl_child_last_lines(const cpl_child *c, int nline, char *out, size_t size) {
  char text[4096];
  out[0] = 0;
  off_t length = c->log < 0 ? -1 : lseek(c->log, 0, SEEK_END), most = (off_t)sizeof text - 1;
  ssize_t got = length < 0 ? -1 : pread(c->log, text, sizeof text - 1, length > most ? length - most : 0);
  if (got < 0)
    return;
  size_t n = (size_t)got;
  while (n > 0 && text[n - 1] == '\n')
    n--;
  text[n] = 0;
  char *start = text + n;
  for (; start > text && nline > 0; start--)
    if (start[-1] == '\n' && --nline == 0)
      break;
  size_t used = 0;
  for (const char *p = start; *p && used + 4 < size; p++) {
    if (*p == '\n') {
      memcpy(out + used, " | ", 3);
      used += 3;
    } else {
      out[used++] = *p;
    }
  }
  out[used] = 0;
}

bool cpl_child_stop(cpl_child **child, double grace) {
  cpl_child *c = *child;
  if (!c)
    return true;
  bool ended = wait_for_end(c, grace);
  if (!ended && c->pid) {
    kill(c->pid, SIGTERM);
    if (!wait_for_end(c, 0.5)) {
      kill(c->pid, SIGKILL);
      wait_for_end(c, 5);
    }
    ended = c->ended;
  }
  *child = NULL;
  if (ended)
    child_free(c); /* a thread that hangs still uses its own */
  return ended;
}

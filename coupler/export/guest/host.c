/* The process behind an FMU's instance: see host.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* memfd_create, POSIX_SPAWN_SETSID */
#include "coupler/export/guest/host.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum { LINE = 3 }; /* the file descriptor of the line in tandem-serve */

/* Archives need not keep that a file may be executed. */
static int make_executable(const char *path) {
  struct stat is;
  return access(path, X_OK) == 0 || (stat(path, &is) == 0 && chmod(path, is.st_mode | S_IXUSR) == 0);
}

/* The environment without what tools put there to have their own libraries loaded before those of the system; the
 * caller frees the list. */
static char **own_environment(void) {
  static const char *const dropped[] = {"LD_LIBRARY_PATH=", "LD_PRELOAD="};
  size_t n = 0, kept = 0;
  while (environ && environ[n])
    n++;
  char **list = calloc(n + 1, sizeof *list);
  for (size_t i = 0; list && i < n; i++)
    if (strncmp(environ[i], dropped[0], strlen(dropped[0])) != 0 &&
        strncmp(environ[i], dropped[1], strlen(dropped[1])) != 0)
      list[kept++] = environ[i];
  return list;
}

/* Signals as they are by default, none blocked; a session of its own, so that the terminal's Ctrl-C is the tool's
 * affair. */
static int spawn(guest_host *host, const char *program, char *const *argv, int line) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  sigset_t all, none;
  char **environment = own_environment();
  if (!environment)
    return ENOMEM;
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", 0, 0);
  posix_spawn_file_actions_adddup2(&files, host->errors, 1);
  posix_spawn_file_actions_adddup2(&files, host->errors, 2);
  posix_spawn_file_actions_adddup2(&files, line, LINE);
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID);
  const int failure = posix_spawn(&host->pid, program, &files, &attributes, argv, environment);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  free(environment);
  return failure;
}

/* A file of a tool that has its standard files closed may have got their numbers, or LINE: give it a higher one. */
static int above_line(int fd) {
  if (fd < 0 || fd > LINE)
    return fd;
  const int above = fcntl(fd, F_DUPFD_CLOEXEC, LINE + 1);
  close(fd);
  return above;
}

int guest_host_start(guest_host *host, const char *resources, char *why, size_t size) {
  char program[4096];
  int line[2] = {-1, -1};
  const char *folder = getenv("TANDEM_PROGRAMS");
  *host = (guest_host){.fd = -1, .errors = -1};
  if (folder && *folder)
    snprintf(program, sizeof program, "%s/tandem-serve", folder);
  else
    snprintf(program, sizeof program, "%s/bin/tandem-serve", resources);
  if (!make_executable(program)) {
    snprintf(why, size,
             "%s cannot be executed: %s; the FMU must be unpacked where programs may run, or "
             "TANDEM_PROGRAMS name a folder with tandem-serve and tandem's solvers",
             program, strerror(errno));
    return 0;
  }
  host->errors = above_line(memfd_create("tandem-serve", MFD_CLOEXEC));
  const int made = host->errors >= 0 && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, line) == 0;
  for (int i = 0; i < 2 && made; i++)
    line[i] = above_line(line[i]);
  host->fd = line[0];
  if (line[0] < 0 || line[1] < 0) {
    snprintf(why, size, "no line to %s can be made: %s", program, strerror(errno));
    if (line[1] >= 0)
      close(line[1]);
    guest_host_end(host);
    return 0;
  }
  char *const argv[] = {program, (char *)resources, NULL};
  const int failure = spawn(host, program, argv, line[1]);
  close(line[1]);
  if (failure == 0)
    return 1;
  host->pid = 0;
  snprintf(why, size, "%s cannot be started: %s", program, strerror(failure));
  guest_host_end(host);
  return 0;
}

/* Wait up to so many seconds for its end. */
static int ended(guest_host *host, double seconds, int *status) {
  const struct timespec nap = {.tv_nsec = 2000000};
  for (double waited = 0; host->pid > 0; waited += 2e-3) {
    const pid_t got = waitpid(host->pid, status, WNOHANG);
    if (got == host->pid || (got < 0 && errno != EINTR)) { /* the tool may have waited for it itself */
      host->pid = 0;
      return 1;
    }
    if (waited >= seconds)
      return 0;
    nanosleep(&nap, NULL);
  }
  return 1;
}

void guest_host_last_words(guest_host *host, char *out, size_t size) {
  char text[512] = "";
  int status = 0;
  const pid_t pid = host->pid;
  const int over = ended(host, 1, &status) && pid > 0;
  const off_t length = lseek(host->errors, 0, SEEK_END);
  const ssize_t n = length > 0 ? pread(host->errors, text, sizeof text - 1,
                                       length > (off_t)sizeof text - 1 ? length - (off_t)sizeof text + 1 : 0)
                               : 0;
  text[n > 0 ? n : 0] = 0;
  for (char *c = text; *c; c++)
    *c = *c == '\n' ? ' ' : *c;
  snprintf(out, size, "tandem-serve has ended%s%s%s", text[0] ? ": " : "", text,
           over && WIFSIGNALED(status) ? " (killed by a signal)" : "");
}

void guest_host_end(guest_host *host) {
  int status = 0;
  if (host->fd >= 0) {
    shutdown(host->fd, SHUT_RDWR); /* a process that the tool has forked may hold it, too */
    close(host->fd);
  }
  if (!ended(host, 10, &status)) {
    kill(host->pid, SIGKILL); /* its solvers are killed with it */
    ended(host, 5, &status);
  }
  if (host->errors >= 0)
    close(host->errors);
  *host = (guest_host){.fd = -1, .errors = -1};
}

/* The process behind an FMU's instance: tandem-serve, from the FMU's resources or TANDEM_PROGRAMS. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_GUEST_HOST_H
#define CPL_EXPORT_GUEST_HOST_H

#include <stddef.h>
#include <sys/types.h>

typedef struct {
  int fd;     /* the line to it, -1: none */
  int errors; /* its standard error, a file in memory, -1: none */
  pid_t pid;  /* 0: none */
} guest_host;

/* Start it for an FMU whose resources lie in a folder. False: `why` (size bytes) says what is wrong and what to do. */
int guest_host_start(guest_host *host, const char *resources, char *why, size_t size);

/* How it ended and the last lines that it wrote to standard error; to be asked when the line is dead. */
void guest_host_last_words(guest_host *host, char *out, size_t size);

/* Hang up, and wait until it has ended with its solvers; after some seconds it is killed. */
void guest_host_end(guest_host *host);

#endif

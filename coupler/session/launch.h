/* Solvers that the server starts itself: as processes, or as threads of this process (inproc). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SESSION_LAUNCH_H
#define CPL_SESSION_LAUNCH_H

#include "coupler/settings/settings.h"

#include <stdbool.h>
#include <stddef.h>

/* A solver that this program can start. */
typedef struct {
  const char *executable;    /* "tandem-dem", beside this program or on PATH */
  const tdm_solver_ops *ops; /* the same as a thread; NULL: not linked in */
} cpl_solver;

typedef struct cpl_child cpl_child;

/* The command that starts a role's solver: the scene's, else tandem's own program, on as many ranks as the scene wants.
 * `text` (size bytes) may hold it. */
const char *cpl_launch_command(const cpl_settings *settings, cpl_role role, const char *program, char *text,
                               size_t size);

/* Start a process `command --connect endpoint --name name`, its output written to the file `log`. The child ignores
 * Ctrl-C (the server ends it in order) and is killed by the kernel when the server dies. `command` is a program, or one
 * with words behind it that blanks part ("mpirun -n 2 mysolver"); the folder of this program is first on its PATH. */
tdm_status cpl_launch_process(cpl_child **child, const char *command, const char *endpoint, const char *name,
                              const char *log, double timeout, tdm_error *err);

/* Start a thread that runs the solver's operations, its log written to the file `log`. */
tdm_status cpl_launch_thread(cpl_child **child, const tdm_solver_ops *ops, const char *endpoint, void *context,
                             const char *log, double timeout, tdm_error *err);

/* false once it has ended; then `how` (may be NULL) says how: "exit status 1", "killed by signal 9 (Killed)". */
bool cpl_child_running(cpl_child *child, char *how, size_t size);

/* Send a process SIGINT, as a terminal does. */
void cpl_child_interrupt(const cpl_child *child);

/* The last lines of its log, joined by " | ", at most `size` bytes. */
void cpl_child_last_lines(const cpl_child *child, int nline, char *out, size_t size);

/* Wait up to `grace` seconds for it to end, then end it (SIGTERM, SIGKILL). Frees; *child becomes NULL. Returns false
 * when a thread did not end: the process must then leave by _exit. */
bool cpl_child_stop(cpl_child **child, double grace);

#endif

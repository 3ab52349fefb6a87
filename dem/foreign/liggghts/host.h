/* LIGGGHTS, which this process hosts by its C library; one, on all ranks of an MPI program.
 *
 * Rank 0 is the participant, and what it orders here all ranks do: the others are in lig_host_follow until the end.
 * LIGGGHTS ends the process when something is wrong; what it says then, on any rank, goes to the server as ERROR before
 * that. While it gets on (it prints, or its steps go by), a thread gives the server signs of life, and ends the process
 * when the server is gone or wants no more. When LIGGGHTS hangs the server hears nothing, and ends it after
 * coupling.timeout.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FOREIGN_LIGGGHTS_HOST_H
#define DEM_FOREIGN_LIGGGHTS_HOST_H

#include "protocol/wire/participant.h"

/* Begin MPI. Returns this process' rank; *ranks is their number. */
int lig_host_begin(int *argc, char ***argv, int *ranks);

/* All but rank 0: do what rank 0 orders until it ends. */
void lig_host_follow(void);

/* Rank 0: start LIGGGHTS. From now on its errors go to the server by `participant` (borrowed). */
tdm_status lig_host_open(tdm_participant *participant, tdm_error *err);

/* Rank 0: end LIGGGHTS, if it was started, on all ranks, and MPI. */
void lig_host_end(void);

/* What goes wrong from now on lies in this place of the scene (a literal), or nowhere (""). What LIGGGHTS prints goes
 * to standard output if `aloud`; warnings always do. */
void lig_host_at(const char *path, bool aloud);

/* Hear every line that LIGGGHTS prints while it is aloud; NULL: no longer. */
void lig_host_listen(void (*listener)(void *arg, const char *line), void *arg);

/* A command, by printf's format. */
void lig_host_command(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* A script. */
void lig_host_script(const char *file);

/* Value i (from 0) of the global vector of a fix; false: there is no such fix, or it has none. */
bool lig_host_fix_value(const char *fix, int i, double *value);

/* The value of an equal-style variable; false: there is no such variable. */
bool lig_host_variable(const char *variable, double *value);

/* Time that commands "run" have taken so far [s]. */
double lig_host_running(void);

/* Particles there are. */
double lig_host_particles(void);

#endif

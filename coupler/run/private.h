/* A directory of the server's own for as long as it lives: the ipc socket, the logs of a check.
 *
 * It lies in TMPDIR (/tmp), only this user can enter it, and a lock in it lives as long as the server. What a server
 * that was killed has left is removed by the next one.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RUN_PRIVATE_H
#define CPL_RUN_PRIVATE_H

#include "protocol/base/status.h"

typedef struct {
  char dir[128]; /* "": none */
  int lock;      /* file descriptor */
} cpl_private;

/* Make one, and remove those of dead servers. */
tdm_status cpl_private_make(cpl_private *p, tdm_error *err);

/* Remove it with all that is in it; nothing to do when there is none. */
void cpl_private_remove(cpl_private *p);

#endif

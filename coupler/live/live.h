/* The live view of a run: an observer that shows a viewer in the browser (server.h) what the run does.
 *
 * Solvers are asked for their states (observe/eyes.h) only while somebody looks, and so seldom that this takes a
 * fiftieth of the time at most. Nothing of the run depends on it but a stop that a viewer asks for, which is an
 * interrupt.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LIVE_LIVE_H
#define CPL_LIVE_LIVE_H

#include "coupler/loop/observer.h"

typedef struct cpl_live cpl_live;

/* Serve at `port` of this machine, 0: a free one, before the run begins. A viewer's stop interrupts the calling thread
 * by SIGINT. TDM_ERR_SYSTEM: the port is taken. Close it whatever happened. */
tdm_status cpl_live_open(cpl_live **live, int port, tdm_error *err);

/* Print the address of a cpl_live: a run calls it when its scene has been read (cpl_run_options.loaded). */
void cpl_live_tell(void *live);

/* Its row among the observers of a run; lives as long as *live. */
const cpl_observer *cpl_live_observer(const cpl_live *live);

void cpl_live_close(cpl_live **live);

#endif

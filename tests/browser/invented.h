/* A result directory of a run that never was: a bucket that swings and lifts over a heap of particles, on a spring and
 * a cable. For tests of the viewer, which see what is in it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TESTS_BROWSER_INVENTED_H
#define TESTS_BROWSER_INVENTED_H

#include "protocol/view/frames.h"

/* Its scenery, and the state at t [s] with n particles; particle 0 lies at (0, -0.9, 0.1 + 0.5 t). Status TDM_OK, or
 * out of memory. */
tdm_status invented_scenery(tdm_scenery *scenery, tdm_error *err);
tdm_status invented_snapshot(tdm_snapshot *snapshot, double t, int n, tdm_error *err);

/* frames.tdv with so many frames 0.01 s apart, body_bucket.csv, mbd.csv, summary.json, in `dir`, which is made. */
tdm_status invented_run(const char *dir, int nparticle, int nframe, tdm_error *err);

#endif

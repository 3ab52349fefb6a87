/* The observers of every run (loop/observer.h says how to add one), and the files that they write into the result
 * directory:
 *
 *   record     body_<name>.csv  per coupled body (mbd's name): pose, twist, and the mean load since the row before
 *              mbd.csv, dem.csv further outputs that the solvers announce (joint reactions, energies, particle sums)
 *   ledger     ledger.csv       impulse, work, drift and energy (ledger.h)
 *   view       frames.tdv, particles_N.vtp, walls_N.vtp, mechanism_N.vtp, scene.pvd: what there is to see, if the scene
 *              asks for it (protocol/output/outputs.h)
 *   screening  on the terminal at the end, and in summary.json: what DEM's channels of screening and of containers come
 *              to
 *   estimate   what the motion of the bodies is off: in summary.json (coupler/estimate/error.h)
 *   progress   on the terminal: how far the run is
 *
 * run.c writes scene.json (the scene with all overrides), summary.json and the logs.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_OBSERVE_OBSERVERS_H
#define CPL_OBSERVE_OBSERVERS_H

#include "coupler/loop/observer.h"

#define CPL_OBSERVER_LIST(X) \
  X(record)                  \
  X(ledger)                  \
  X(view)                    \
  X(screening)               \
  X(estimate)                \
  X(progress)

#define X(name) extern const cpl_observer cpl_observer_##name;
CPL_OBSERVER_LIST(X)
#undef X

extern const cpl_observer *const cpl_observer_table[]; /* NULL-terminated, in the order of their calls */

/* The name of the file of a coupled body, by mbd's name for it. Returns out. */
const char *cpl_record_body_file(const char *body, char *out, size_t size);

#endif

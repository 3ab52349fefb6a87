/* `tandem-dem bench`: particle-steps a second on a settled bed. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_APP_BENCH_H
#define DEM_APP_BENCH_H

/* argv as after the word bench; returns the exit status. */
int dem_bench_main(int argc, char **argv);

#endif

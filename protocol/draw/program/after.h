/* Pictures and animations of a run that has ended, or of what there is of one that failed or goes on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_DRAW_PROGRAM_AFTER_H
#define TDM_DRAW_PROGRAM_AFTER_H

#include "protocol/base/status.h"

/* tandem draw DIR|FILE [--times LIST] [--all] [--view VIEW] [--set KEY=VALUE ...] [--out PREFIX]: the words behind
 * "draw". */
tdm_status draw_again(int argc, char **argv, tdm_error *err);

/* tandem movie DIR [--view VIEW] [--set KEY=VALUE ...] [--fps N] [--size WxH] [--out FILE] */
tdm_status draw_movie(int argc, char **argv, tdm_error *err);

#endif

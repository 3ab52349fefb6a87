/* What a run came to, by the last values of its channels: parts of summary.json, the same of one solver and of two. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_OUTPUT_FIGURES_H
#define TDM_OUTPUT_FIGURES_H

#include "protocol/wire/participant.h"

/* Enter the last value of a channel into a summary, if it is one of a container: "container.NAME.x" as {"containers":
 * {"NAME": {"x": value}}}; numbers of particles and jams (unit "1") as integers, and null where the value is not
 * defined. Other channels are left out. */
void tdm_figure_enter(json_t *summary, const tdm_channel *channel, double value);

#endif

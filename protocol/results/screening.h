/* What a run that measures screening comes to: its channels "screening.DECK.x" and "screening.x" at the end as the part
 * "screening" of summary.json, and as a table for a terminal. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RESULTS_SCREENING_H
#define TDM_RESULTS_SCREENING_H

#include <jansson.h>

#include <stdio.h>

/* Enter the last value of a channel into a summary, if the channel is one of screening: "screening.x" as
 * {"screening": {"x"}}, "screening.DECK.x" as {"screening": {"decks": {"DECK": {"x"}}}}; null where it is not defined.
 * Numbers of particles or holes (unit "1") are integers. */
void tdm_screening_enter(json_t *summary, const char *channel, const char *unit, double value);

/* Print what a summary has of it: a line of the whole, and a line a deck; nothing without. */
void tdm_screening_print(FILE *file, const json_t *summary);

#endif

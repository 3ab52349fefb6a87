/* Signals that ask a program to end. Programs catch them (tdm_catch_signals in app/command_line.h); what takes long
 * looks here whether to stop. */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_BASE_INTERRUPT_H
#define TDM_BASE_INTERRUPT_H

#include <signal.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Set by Ctrl-C, SIGTERM and a closed terminal once tdm_catch_signals was called: runs end in order then. */
extern volatile sig_atomic_t tdm_interrupted;

/* How many of them came: what goes on after the first (the plots of a run that was interrupted) ends at the next. */
extern volatile sig_atomic_t tdm_signal_count;

#ifdef __cplusplus
}
#endif

#endif

/* `tandem report DIR`: a page of a run's results, of tandem run, tandem-dem run or tandem-mbd run.
 *
 *   index.html       what ran, its warnings, every time history by body, joint and scheme, its files
 *   report_NN_*.png  the time histories of a section, at most eight panels a picture; report.gp draws them
 *   comparison.png   simulation against reference, when the scene names its scenario
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_REPORT_REPORT_H
#define CPL_REPORT_REPORT_H

#include "coupler/verify/verify.h"

/* The page goes into `dir` itself, and links by relative names. What cannot be read or drawn is left out, and the page
 * says so. Prints warnings and notices of the run, and what was made. */
tdm_status cpl_report(const char *dir, const cpl_scenario *scenarios, tdm_error *err);

#endif

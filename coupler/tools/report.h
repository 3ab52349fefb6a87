/* `tandem report DIR`: plots of a result directory, as PNG and SVG, and a page that shows them.
 *
 *   body_<name>.png, mbd.png, dem.png   every time history, columns that belong together in one panel
 *   comparison.png                      simulation against reference, when the scene names its scenario
 *   time.png                            where the time went
 *   index.html                          all of them, with the figures of the summary
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_TOOLS_REPORT_H
#define CPL_TOOLS_REPORT_H

#include "coupler/tools/verify.h"

/* Plots go into `dir` itself. Prints what was made. */
tdm_status cpl_report(const char *dir, const cpl_scenario *scenarios, tdm_error *err);

#endif

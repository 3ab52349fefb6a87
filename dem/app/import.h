/* tandem-dem import: a scene from the files of MOLDYN, BASE.cin, BASE.pin and BASE.win ([A07] Appendix A.1). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_APP_IMPORT_H
#define DEM_APP_IMPORT_H

/* The command line behind "import". Returns the exit status. */
int dem_import_main(int argc, char **argv);

#endif

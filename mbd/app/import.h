/* tandem-mbd import: a scene from an Adams data set (.adm). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_APP_IMPORT_H
#define MBD_APP_IMPORT_H

/* The command line behind "import". Returns the exit status. */
int mbd_import_main(int argc, char **argv);

#endif

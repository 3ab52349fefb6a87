/* An FMU's files, unpacked: an FMU is a zip archive. They lie in a directory of their own in TMPDIR (/tmp) that is
 * removed with the process, however that ends. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_FMI_ARCHIVE_H
#define TDM_FMI_ARCHIVE_H

#include "protocol/base/status.h"

enum { TDM_FMI_DIR_MAX = 128 };

/* Unpack a file into a new directory, whose path is written to dir (TDM_FMI_DIR_MAX bytes). Names that lead out of it
 * and archives of more than 4 GiB or 100 000 entries are refused. */
tdm_status tdm_archive_unpack(const char *file, char *dir, tdm_error *err);

/* Remove it; nothing to do when dir is "". */
void tdm_archive_remove(char *dir);

#endif

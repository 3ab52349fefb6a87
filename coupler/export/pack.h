/* An FMU as a zip archive: the same contents give the same bytes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_PACK_H
#define CPL_EXPORT_PACK_H

#include "protocol/base/status.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct cpl_pack cpl_pack;

/* A file that is there is refused unless `force`: for who wants to know before much is done. */
tdm_status cpl_pack_check(const char *file, bool force, tdm_error *err);

/* Begin a file, which is checked so. It appears under its name, whole, with cpl_pack_close. */
tdm_status cpl_pack_open(cpl_pack **pack, const char *file, bool force, tdm_error *err);

/* Add an entry from memory (borrowed until the end), or from a file. */
tdm_status cpl_pack_bytes(cpl_pack *pack, const char *name, const void *bytes, size_t size, tdm_error *err);
tdm_status cpl_pack_file(cpl_pack *pack, const char *name, const char *file, bool program, tdm_error *err);

/* Write it, or give it up when *err is set. *pack becomes NULL; it may be. */
tdm_status cpl_pack_close(cpl_pack **pack, tdm_error *err);

#endif

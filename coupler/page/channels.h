/* The time histories of a result directory, thinned for the viewer's page; they can be read on while a run writes them.
 *
 * Every CSV file whose first column is "time [s]" is one. Packed (little-endian, see pack.h):
 *
 *   u32 version, columns c, rows r, 0; f32 time (r); f32 value (c r), column after column
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_PAGE_CHANNELS_H
#define CPL_PAGE_CHANNELS_H

#include "protocol/results/thin.h"
#include "protocol/view/view.h"

#include <jansson.h>

typedef struct {
  char file[256]; /* in the directory */
  long offset;    /* read as far as this [bytes]; 0: not even the head */
  json_t *name;   /* array of the columns behind the time: "vx [m/s]" */
  tdm_thin thin;
} cpl_channels_file;

/* Zero-initialise; free with cpl_channels_free. */
typedef struct {
  char dir[4096];
  int nfile;
  cpl_channels_file *file; /* (nfile) ascending by name */
} cpl_channels;

/* Read what the directory has by now, from where the last call ended: whole lines only. A file that cannot be read, or
 * a line that is no row of numbers, ends that file's history. TDM_ERR_MEMORY; TDM_ERR_FILE: there is no such directory.
 */
tdm_status cpl_channels_read(cpl_channels *channels, const char *dir, tdm_error *err);

/* [{"file": "mbd.csv", "names": ["x [m]", ...]}, ...] (new reference; NULL: out of memory) */
json_t *cpl_channels_to_json(const cpl_channels *channels);

/* The rows of file k in place of what `bytes` holds. TDM_ERR_MEMORY. */
tdm_status cpl_channels_pack(const cpl_channels *channels, int k, tdm_view_bytes *bytes, tdm_error *err);

void cpl_channels_free(cpl_channels *channels);

#endif

/* Memory that runs out where no status can say so: inside jansson and GSL, and below functions that answer yes or no.
 *
 * It is noted for the calling thread. Who has a status to return looks whether there are more notes than before:
 *   const unsigned long before = tdm_memory_notes();
 *   ... work ...
 *   return tdm_memory_since(before, path, err);
 * So nothing goes on with a half of what it should have, and no lack of memory is taken for a wrong scene.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_BASE_MEMORY_H
#define TDM_BASE_MEMORY_H

#include "protocol/base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An allocation has failed. */
void tdm_memory_note(void);

/* How many have in this thread. */
unsigned long tdm_memory_notes(void);

/* TDM_ERR_MEMORY, in place of what came of it, if there are more notes than `before`; else err->status. */
tdm_status tdm_memory_since(unsigned long before, const char *path, tdm_error *err);

/* Note jansson's failures too. Its allocators stay the ones that the process has set. May be called again. */
void tdm_memory_watch_json(void);

#ifdef __cplusplus
}
#endif

#endif

/* Memory that runs out: see memory.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/base/memory.h"

#include <jansson.h>

static _Thread_local unsigned long notes;
static json_malloc_t json_memory; /* the process's own */

void tdm_memory_note(void) {
  notes++;
}

unsigned long tdm_memory_notes(void) {
  return notes;
}

tdm_status tdm_memory_since(unsigned long before, const char *path, tdm_error *err) {
  if (notes == before || err->status == TDM_ERR_MEMORY)
    return err->status;
  *err = (tdm_error){0};
  return tdm_fail(err, TDM_ERR_MEMORY, path, "no memory is left; end other programs, or make the scene smaller");
}

static void *watched(size_t size) {
  void *memory = json_memory(size);
  if (!memory)
    tdm_memory_note();
  return memory;
}

void tdm_memory_watch_json(void) {
  json_malloc_t memory;
  json_free_t release;
  json_get_alloc_funcs(&memory, &release);
  if (memory == watched)
    return;
  json_memory = memory;
  json_set_alloc_funcs(watched, release);
}

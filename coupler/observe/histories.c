/* Time histories of a run: see histories.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/histories.h"

#include "protocol/base/log.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const double flush_interval = 1; /* [s] wall clock: what a reader of a running run lags behind */

FILE *cpl_histories_open(cpl_histories *h, const char *name, tdm_error *err) {
  FILE **longer = realloc(h->file, ((size_t)h->nfile + 1) * sizeof *h->file);
  if (!longer) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return NULL;
  }
  h->file = longer;
  FILE *file = tdm_results_file(h->results, name, err);
  if (file)
    h->file[h->nfile++] = file;
  return file;
}

static tdm_status flush(const cpl_histories *h, tdm_error *err) {
  for (int i = 0; i < h->nfile; i++)
    if (fflush(h->file[i]) != 0 || ferror(h->file[i]))
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a time history cannot be written: %s; what is there stays readable",
                      h->results->dir, strerror(errno));
  return tdm_results_there(h->results, err);
}

tdm_status cpl_histories_written(cpl_histories *h, tdm_error *err) {
  const double now = tdm_clock();
  if (now - h->last_flush <= flush_interval)
    return TDM_OK;
  h->last_flush = now;
  return flush(h, err);
}

tdm_status cpl_histories_close(cpl_histories *h, tdm_error *err) {
  tdm_error late = {0};
  if (h->nfile > 0)
    flush(h, &late);
  for (int i = 0; i < h->nfile; i++)
    fclose(h->file[i]);
  free(h->file);
  h->file = NULL;
  h->nfile = 0;
  return late.status == TDM_OK ? TDM_OK : tdm_fail(err, late.status, NULL, "%s", late.message);
}

/* Stored states: everything that a run changes, as bytes and as files.
 *
 * Little-endian; numbers exact. A header with version, three fingerprints (fingerprint.h), number of particles and
 * size; sections of a name, a size and bytes: the arrays of particles, the histories of the contacts that touch, what
 * the model fixes the size of, counters; a checksum at the end. Lists of neighbours are no part of it, as results do
 * not depend on them: they are made anew, so only dem_lists.nrebuild may differ from then on.
 *
 * For a state in memory that is only to be gone back to in the same process, dem_data_copy is faster.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STORE_STATE_FILE_H
#define DEM_STORE_STATE_FILE_H

#include "dem/state/data.h"

typedef enum {
  DEM_STATE_WHOLE, /* go on bit-identically: the same scene (time.dt may be another) */
  DEM_STATE_BED,   /* the particles, their contacts and the lids, at the start of a run of the same bed */
  DEM_STATE_START /* the particles as they lie and move, with their contacts, ids and lids, as the start of another run;
                     forces are to be evaluated */
} dem_state_use;

/* *bytes is the caller's to free. On several ranks that of rank 0, after dem_collect(DEM_WHOLE). The model must have
 * the start of all particles, of which the state has the fingerprint (dem_model_forget_start). Errors: TDM_ERR_MEMORY.
 */
tdm_status dem_state_save(const dem_data *data, void **bytes, size_t *size);

/* Make data, which belongs to a model of the same scene, what was saved. TDM_ERR_FILE: these bytes are no state of this
 * scene, or damaged; data is as before unless the damage is one that the checksum does not see. */
tdm_status dem_state_load(dem_data *data, const void *bytes, size_t size, tdm_error *err);

/* The same with a file; `key` is the path of the scene for errors. The file is written beside its place and renamed, so
 * that no reader sees half of one. `note` goes with it; reading one of another size is an error. */
tdm_status dem_state_write(const dem_data *data, const char *file, const char *key, const void *note, size_t size,
                           tdm_error *err);
tdm_status dem_state_read(dem_data *data, dem_state_use use, const char *file, const char *key, void *note, size_t size,
                          tdm_error *err);

#endif

/* A stored bed: what settling leaves, in a file that later runs start from (dem.settle.store).
 *
 * The file (little-endian; numbers exact) has a header with the version and a fingerprint of everything that decides
 * the bed, the positions, and the histories of the contacts that touch, and ends with a checksum. Poses of the bodies
 * are part of the fingerprint. A run that starts from the file is bit-identical to the run that wrote it.
 */
#ifndef DEM_BED_H
#define DEM_BED_H

#include "dem/settle.h"

/* A number that changes when the settled bed would: materials, pairs while settling, contact laws, walls, poses,
 * particles, gravity, settle keys. It does not depend on time.dt, the coupling, restitution and friction of the run,
 * sources or sinks. */
uint64_t dem_bed_fingerprint(const dem_model *model);

/* Load settle.store into data, which is at the start; forces are not evaluated yet. *found is false when there is no
 * such file. Errors (path dem.settle.store): a file that is damaged or of another bed. */
tdm_status dem_bed_read(dem_data *data, dem_settled *settled, bool *found, tdm_error *err);

/* Refuse early what dem_bed_write could not write. */
tdm_status dem_bed_check_writable(const dem_model *model, tdm_error *err);

/* Write the bed to settle.store: to a file beside it, renamed at the end, so that no reader sees half a file. */
tdm_status dem_bed_write(const dem_data *data, const dem_settled *settled, tdm_error *err);

#endif

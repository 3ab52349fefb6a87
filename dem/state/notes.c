/* Notes of contacts: see notes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/state/notes.h"

#include <stdlib.h>
#include <string.h>

/* how many places each particle has, behind the entry of its own: first[i + 2] */
static void count_places(const dem_data *d, int *first) {
  const int n = d->state.nparticle;
  memset(first, 0, (size_t)(n + 2) * sizeof *first);
  for (size_t k = 0; k < d->lists.pairs.count; k++)
    if (d->lists.pairs.one[k] < n) {
      first[d->lists.pairs.one[k] + 2]++;
      first[d->lists.pairs.other[k] + 2]++;
    }
  for (size_t k = 0; k < d->lists.walls.count; k++)
    first[d->lists.walls.entry[k].particle + 2]++;
}

/* Places of a particle ascend. first[i + 1] is where the next one of particle i goes, and ends as the first of i + 1.
 */
static void fill_places(const dem_data *d, int *first, int *place) {
  for (size_t k = 0; k < d->lists.pairs.count; k++)
    if (d->lists.pairs.one[k] < d->state.nparticle) {
      place[first[d->lists.pairs.one[k] + 1]++] = (int)(2 * k);
      place[first[d->lists.pairs.other[k] + 1]++] = (int)(2 * k + 1);
    }
  for (size_t k = 0; k < d->lists.walls.count; k++)
    place[first[d->lists.walls.entry[k].particle + 1]++] = (int)(2 * dem_note_of_wall(d, k));
}

/* room for `size` bytes; what was there is lost */
static bool fits(void *array, size_t *capacity, size_t size) {
  void **at = array;
  if (*at && size <= *capacity)
    return true;
  free(*at);
  *at = malloc(size + size / 8 + 64);
  *capacity = *at ? size + size / 8 + 64 : 0;
  return *at != NULL;
}

tdm_status dem_notes_reserve(dem_data *d) {
  dem_notes *notes = &d->work.notes;
  const int n = d->state.nparticle;
  if (!d->model->noting || notes->valid)
    return TDM_OK;
  size_t places = d->lists.pairs.count + d->lists.walls.count;
  notes->stride = places + DEM_LANES_MAX;
  if (!fits(&notes->first, &notes->first_size, (size_t)(n + 2) * sizeof *notes->first) ||
      !fits(&notes->place, &notes->place_size, 2 * places * sizeof *notes->place) ||
      !fits(&notes->column, &notes->column_size, DEM_NOTES * notes->stride * sizeof *notes->column))
    return TDM_ERR_MEMORY;
  memset(notes->column, 0, DEM_NOTES * notes->stride * sizeof *notes->column);
  count_places(d, notes->first);
  size_t most = 0;
  for (int i = 0; i < n; i++) {
    if ((size_t)notes->first[i + 2] > most)
      most = (size_t)notes->first[i + 2];
    notes->first[i + 2] += notes->first[i + 1];
  }
  fill_places(d, notes->first, notes->place);
  notes->most = (int)most;
  notes->row = 2 * most + 2 * DEM_LANES_MAX;
  size_t room = (size_t)d->lists.nchunk * DEM_NOTE_ROWS * notes->row;
  if (!fits(&notes->room, &notes->room_size, room * sizeof *notes->room))
    return TDM_ERR_MEMORY;
  notes->valid = true;
  return TDM_OK;
}

size_t dem_note_of_contact(const dem_data *d, size_t k) {
  const dem_wall_entry *entry = d->lists.walls.entry;
  const double *width = d->work.notes.column + DEM_NOTE_WIDTH * d->work.notes.stride;
  size_t at = k;
  if (!d->work.notes.valid)
    return dem_note_of_wall(d, k);
  while (at < d->lists.walls.count && entry[at].wall == entry[k].wall && entry[at].particle == entry[k].particle &&
         !(width[dem_note_of_wall(d, at)] > 0))
    at++;
  bool found = at < d->lists.walls.count && entry[at].wall == entry[k].wall && entry[at].particle == entry[k].particle;
  return dem_note_of_wall(d, found ? at : k);
}

/* Notes of contacts: see notes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/seam/notes.h"

#include "dem/seam/visits.h"

#include <stdlib.h>
#include <string.h>

/* Contacts of home particles that other ranks have, and of those that this one has with their particles. */
static int from_others(const dem_data *d) {
  return dem_alone(d) ? 0 : d->work.homes.returned.first[d->work.homes.ranks->size];
}

static int to_others(const dem_data *d) {
  return dem_alone(d) ? 0 : d->work.homes.returning.first[d->work.homes.ranks->size];
}

static int particle_from_others(const dem_data *d, int k) {
  return d->lists.crossings.particle[d->work.homes.returned.item[k]];
}

/* Entries of a list that are of home chunks, by where its chunks begin. */
typedef struct {
  size_t first, end;
} entries;

static entries at_home(const dem_data *d, const size_t *chunk) {
  return (entries){chunk[dem_home_first(d)], chunk[dem_home_end(d)]};
}

/* how many places each home particle has, behind the entry of its own: first[i + 2] */
static void count_places(const dem_data *d, int *first) {
  const int n = d->state.nparticle, end = dem_home_end_particle(d);
  const entries pairs = at_home(d, d->lists.pairs.chunk), walls = at_home(d, d->lists.walls.chunk);
  memset(first, 0, (size_t)(n + 2) * sizeof *first);
  for (int k = 0; k < from_others(d); k++)
    first[particle_from_others(d, k) + 2]++;
  for (size_t k = pairs.first; k < pairs.end; k++)
    if (d->lists.pairs.one[k] < n) {
      first[d->lists.pairs.one[k] + 2]++;
      first[d->lists.pairs.other[k] + 2] += d->lists.pairs.other[k] < end;
    }
  for (size_t k = walls.first; k < walls.end; k++)
    first[d->lists.walls.entry[k].particle + 2]++;
}

/* Places of a particle in the order of their contacts: those of others are of earlier chunks. first[i + 1] is where the
 * next one of particle i goes, and ends as the first of i + 1. */
static void fill_places(const dem_data *d, int *first, int *place) {
  const entries pairs = at_home(d, d->lists.pairs.chunk), walls = at_home(d, d->lists.walls.chunk);
  const int end = dem_home_end_particle(d);
  for (int k = 0; k < from_others(d); k++)
    place[first[particle_from_others(d, k) + 1]++] = (int)(2 * (d->work.notes.others + (size_t)k) + 1);
  for (size_t k = pairs.first; k < pairs.end; k++)
    if (d->lists.pairs.one[k] < d->state.nparticle) {
      place[first[d->lists.pairs.one[k] + 1]++] = (int)(2 * k);
      if (d->lists.pairs.other[k] < end)
        place[first[d->lists.pairs.other[k] + 1]++] = (int)(2 * k + 1);
    }
  for (size_t k = walls.first; k < walls.end; k++)
    place[first[d->lists.walls.entry[k].particle + 1]++] = (int)(2 * dem_note_of_wall(d, k));
}

/* the pairs whose second particle is another rank's, in the order in which they are told */
static void fill_sent(const dem_data *d, size_t *sent) {
  const entries pairs = at_home(d, d->lists.pairs.chunk);
  const int *item = d->work.homes.returning.item, n = to_others(d);
  size_t k = pairs.first;
  for (int q = 0; q < n; q++) {
    const int slot = dem_crossing_slot(d, item[q]);
    if (q > 0 && item[q] < item[q - 1]) /* of the next rank: slots ascend for each */
      k = pairs.first;
    while (d->lists.pairs.reaction_slot[k] != slot)
      k++;
    sent[q] = k;
  }
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
  notes->others = d->lists.pairs.count + d->lists.walls.count;
  const size_t places = notes->others + (size_t)from_others(d);
  notes->stride = places + DEM_LANES_MAX;
  if (!fits(&notes->first, &notes->first_size, (size_t)(n + 2) * sizeof *notes->first) ||
      !fits(&notes->place, &notes->place_size, 2 * places * sizeof *notes->place) ||
      !fits(&notes->sent, &notes->sent_size, (size_t)to_others(d) * sizeof *notes->sent) ||
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
  fill_sent(d, notes->sent);
  notes->most = (int)most;
  notes->row = 2 * most + 2 * DEM_LANES_MAX;
  size_t room = (size_t)d->lists.nchunk * DEM_NOTE_ROWS * notes->row;
  if (!fits(&notes->room, &notes->room_size, room * sizeof *notes->room))
    return TDM_ERR_MEMORY;
  notes->valid = true;
  return TDM_OK;
}

/* ---- between ranks ---- */

enum { SENT = DEM_NOTE_FORCE + 1 }; /* columns that the contacts of a particle look at */

static void write_note(dem_data *d, int k, double *entry) {
  const dem_notes *notes = &d->work.notes;
  for (size_t q = 0; q < SENT; q++)
    entry[q] = notes->column[q * notes->stride + notes->sent[k]];
}

static void read_note(dem_data *d, int k, double *entry) {
  const dem_notes *notes = &d->work.notes;
  for (size_t q = 0; q < SENT; q++)
    notes->column[q * notes->stride + notes->others + (size_t)k] = entry[q];
}

static void write_side(dem_data *d, int k, double *entry) {
  const dem_notes *notes = &d->work.notes;
  *entry = notes->column[DEM_NOTE_OTHER * notes->stride + notes->others + (size_t)k];
}

static void read_side(dem_data *d, int k, double *entry) {
  const dem_notes *notes = &d->work.notes;
  notes->column[DEM_NOTE_OTHER * notes->stride + notes->sent[k]] = *entry;
}

void dem_notes_send(dem_data *d) {
  dem_homes_tell(d, DEM_TO_HOME, SENT, write_note, read_note);
}

void dem_notes_return(dem_data *d) {
  dem_homes_tell(d, DEM_FROM_HOME, 1, write_side, read_side);
}

size_t dem_note_of_contact(const dem_data *d, size_t k) {
  const dem_wall_entry *entry = d->lists.walls.entry;
  const double *width = d->work.notes.column + DEM_NOTE_WIDTH * d->work.notes.stride;
  size_t at = k;
  if (!d->work.notes.valid)
    return dem_note_of_wall(d, k);
  const int chunk = entry[k].particle / DEM_CHUNK; /* behind its entries may be another rank's */
  const size_t end = chunk < d->lists.nchunk ? d->lists.walls.chunk[chunk + 1] : d->lists.walls.count;
  while (at < end && entry[at].wall == entry[k].wall && entry[at].particle == entry[k].particle &&
         !(width[dem_note_of_wall(d, at)] > 0))
    at++;
  bool found = at < end && entry[at].wall == entry[k].wall && entry[at].particle == entry[k].particle;
  return dem_note_of_wall(d, found ? at : k);
}

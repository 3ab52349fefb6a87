/* What each contact tells the other contacts of its particles, for laws in which they act on each other
 * (contact/multi/): written by a pass over all contacts before that of the forces, and read particle by particle.
 *
 * Places: those of the pairs' list, then those of the walls' list. For each particle there is a list of its places, in
 * the order of these, made when the lists of what is near are; so nothing depends on threads or on who writes first.
 *
 * On several ranks (homes.h) home particles have lists. Behind the places of the walls are those of contacts that an
 * earlier rank has with home particles: it sends their notes, and gets back what these particles' contacts give them.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEAM_NOTES_H
#define DEM_SEAM_NOTES_H

#include "dem/state/data.h"

/* Room for the lists there are, when the model's laws take notes and they have none. Errors: TDM_ERR_MEMORY. */
tdm_status dem_notes_reserve(dem_data *data);

/* Contacts with other ranks' particles: their notes go there, and what was given to them comes back. In a process that
 * is alone nothing. */
void dem_notes_send(dem_data *data);
void dem_notes_return(dem_data *data);

/* Place of the contact of entry k's particle and wall, of whose parts k is the first: that of the part that touches. */
size_t dem_note_of_contact(const dem_data *data, size_t k);

/* Place of entry k of the walls' list. */
static inline size_t dem_note_of_wall(const dem_data *d, size_t k) {
  return d->lists.pairs.count + k;
}

#endif

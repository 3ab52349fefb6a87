/* What has output channels: sources, sinks, decks, bodies, or the run as a whole. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CHANNELS_ITEMS_H
#define DEM_CHANNELS_ITEMS_H

#include "dem/model/model.h"

/* A kind of item. */
typedef struct {
  /* The first item after this one (-1: the first of all); -1: there is no further one. */
  int (*next)(const dem_model *model, int item);
  /* Its name, which stands for the * in a channel's; NULL: there is none. */
  void (*name)(const dem_model *model, int item, char out[64]);
} dem_items;

extern const dem_items dem_items_all;     /* the run as a whole, one item */
extern const dem_items dem_items_energy;  /* the same, where the scene asks for energies */
extern const dem_items dem_items_domain;  /* the same, where there is a domain */
extern const dem_items dem_items_balance; /* the same, where particles can come or go */
extern const dem_items dem_items_fixed;   /* the same, where particles are fixed */
extern const dem_items dem_items_sources;
extern const dem_items dem_items_sinks;     /* each as a whole, then its size classes */
extern const dem_items dem_items_decks;     /* of the screening */
extern const dem_items dem_items_screens;   /* decks whose screens are watched */
extern const dem_items dem_items_traces;    /* followed particles */
extern const dem_items dem_items_screening; /* the same, where screening is measured */
extern const dem_items dem_items_containers;
extern const dem_items dem_items_loads;  /* of bodies that are not coupled and of geometries of bodies with several */
extern const dem_items dem_items_movers; /* bodies that the scene moves from their place */

/* Which sink an item of dem_items_sinks belongs to, and which of its size classes it is; -1: the sink as a whole. */
int dem_sink_of(int item);
int dem_sink_class_of(int item);

#endif

/* What has output channels: see items.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/channels/items.h"

#include "dem/flow/flow.h"

#include <stdio.h>

/* ---- which there are ---- */

static int one(bool wanted, int item) {
  return wanted && item < 0 ? 0 : -1;
}

static int always(const dem_model *m, int item) {
  (void)m;
  return one(true, item);
}

static int with_energy(const dem_model *m, int item) {
  return one(m->energy, item);
}

static int with_domain(const dem_model *m, int item) {
  return one(m->domain.wanted, item);
}

/* particles can come or go */
static int with_balance(const dem_model *m, int item) {
  return one(m->nsource + m->nsink > 0 || m->domain.open, item);
}

static int with_fixed(const dem_model *m, int item) {
  return one(m->fixes, item);
}

static int sources(const dem_model *m, int item) {
  return item + 1 < m->nsource ? item + 1 : -1;
}

/* A sink as a whole, part 0 of PARTS, then its size classes. */
enum { PARTS = DEM_EDGES_MAX + 2 };

int dem_sink_of(int item) {
  return item / PARTS;
}

int dem_sink_class_of(int item) {
  return item % PARTS - 1;
}

static int sinks(const dem_model *m, int item) {
  if (item < 0)
    return m->nsink > 0 ? 0 : -1;
  int s = dem_sink_of(item);
  if (dem_sink_class_of(item) + 1 < dem_sink_classes(&m->sink[s]))
    return item + 1;
  return s + 1 < m->nsink ? (s + 1) * PARTS : -1;
}

static int decks(const dem_model *m, int item) {
  return item + 1 < m->screening.ndeck ? item + 1 : -1;
}

/* those whose screens are watched */
static int screens(const dem_model *m, int item) {
  do
    item = decks(m, item);
  while (item >= 0 && m->screening.deck[item].screen < 0);
  return item;
}

static int traces(const dem_model *m, int item) {
  return item + 1 < m->ntrace ? item + 1 : -1;
}

static int with_screening(const dem_model *m, int item) {
  return one(m->screening.ndeck > 0, item);
}

static int containers(const dem_model *m, int item) {
  return item + 1 < m->ncontainer ? item + 1 : -1;
}

/* Loads of the samples that have channels: bodies that are not coupled and have walls; geometries of bodies that have
 * several. */
static bool has_load(const dem_model *m, int l) {
  int body = l < m->nbody ? l : m->geometry[l - m->nbody].body, many = 0;
  for (int g = 0; g < m->ngeometry; g++)
    many += m->geometry[g].body == body && m->geometry[g].nwall > 0;
  return l < m->nbody ? m->body[l].coupled < 0 && many > 0 : many > 1;
}

static int loads(const dem_model *m, int item) {
  for (int l = item + 1; l < m->nload; l++)
    if (has_load(m, l))
      return l;
  return -1;
}

/* Bodies that the scene moves from their place. */
static bool has_way(const dem_body *b) {
  const dem_drive *d = &b->drive;
  const tdm_vec3 arm = tdm_sub(b->start.pose.position, d->center);
  return d->given &&
         (tdm_norm(d->velocity) > 0 || tdm_norm(d->amplitude) > 0 || tdm_norm(tdm_cross(d->angular, arm)) > 0);
}

static int movers(const dem_model *m, int item) {
  for (int b = item + 1; b < m->nbody; b++)
    if (has_way(&m->body[b]))
      return b;
  return -1;
}

/* ---- their names ---- */

static void source_name(const dem_model *m, int item, char out[64]) {
  snprintf(out, 64, "%s", m->source[item].name);
}

static void sink_name(const dem_model *m, int item, char out[64]) {
  const char *name = m->sink[dem_sink_of(item)].name;
  if (dem_sink_class_of(item) < 0)
    snprintf(out, 64, "%s", name);
  else
    snprintf(out, 64, "%s.class%d", name, dem_sink_class_of(item));
}

static void deck_name(const dem_model *m, int item, char out[64]) {
  snprintf(out, 64, "%s", m->screening.deck[item].name);
}

static void trace_name(const dem_model *m, int item, char out[64]) {
  snprintf(out, 64, "%s", m->trace[item].name);
}

static void container_name(const dem_model *m, int item, char out[64]) {
  snprintf(out, 64, "%s", m->container[item].name);
}

static void load_name(const dem_model *m, int item, char out[64]) {
  if (item < m->nbody) {
    snprintf(out, 64, "%s", m->body[item].name);
    return;
  }
  const dem_geometry *g = &m->geometry[item - m->nbody];
  snprintf(out, 64, "%s.shape%d", m->body[g->body].name, g->number);
}

/* ---- the kinds of items ---- */

const dem_items dem_items_all = {always, NULL};
const dem_items dem_items_energy = {with_energy, NULL};
const dem_items dem_items_domain = {with_domain, NULL};
const dem_items dem_items_balance = {with_balance, NULL};
const dem_items dem_items_fixed = {with_fixed, NULL};
const dem_items dem_items_sources = {sources, source_name};
const dem_items dem_items_sinks = {sinks, sink_name};
const dem_items dem_items_decks = {decks, deck_name};
const dem_items dem_items_screens = {screens, deck_name};
const dem_items dem_items_traces = {traces, trace_name};
const dem_items dem_items_screening = {with_screening, NULL};
const dem_items dem_items_containers = {containers, container_name};
const dem_items dem_items_loads = {loads, load_name};
const dem_items dem_items_movers = {movers, load_name};

/* What the model tells of itself, and its end. What it contains is read in scene/scene.c. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/model/model.h"

#include <stdlib.h>
#include <string.h>

int dem_find_material(const dem_model *m, const char *name) {
  for (int i = 0; i < m->nmaterial; i++)
    if (m->material[i].name && strcmp(m->material[i].name, name) == 0)
      return i;
  return -1;
}

int dem_find_body(const dem_model *m, const char *name) {
  for (int i = 0; i < m->nbody; i++)
    if (m->body[i].name && strcmp(m->body[i].name, name) == 0)
      return i;
  return -1;
}

void dem_model_forget_start(dem_model *m) {
  void *arrays[] = {m->radius, m->mass, m->particle_material, m->position, m->velocity, m->spin, m->orientation};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  m->radius = m->mass = NULL;
  m->particle_material = NULL;
  m->position = m->velocity = m->spin = NULL;
  m->orientation = NULL;
}

void dem_model_destroy(dem_model **model) {
  dem_model *m = *model;
  if (!m)
    return;
  for (int i = 0; m->material && i < m->nmaterial; i++)
    free(m->material[i].name);
  for (int i = 0; m->body && i < m->nbody; i++)
    free(m->body[i].name);
  for (int i = 0; m->source && i < m->nsource; i++)
    free(m->source[i].name);
  for (int i = 0; m->sink && i < m->nsink; i++)
    free(m->sink[i].name);
  for (int k = 0; m->screening.deck && k < m->screening.ndeck; k++)
    free(m->screening.deck[k].name);
  for (int k = 0; m->trace && k < m->ntrace; k++)
    free(m->trace[k].name);
  for (int i = 0; m->container && i < m->ncontainer; i++)
    free(m->container[i].name);
  for (int w = 0; w < m->nwall; w++)
    dem_wall_release(&m->wall[w]);
  free(m->settle.store);
  free(m->start);
  dem_model_forget_start(m);
  void *arrays[] = {m->pouring,        m->source,         m->sink,  m->box,         m->material,
                    m->geometry,       m->first_triangle, m->pair,  m->settle_pair, m->body,
                    m->coupled_body,   m->wall,           m->group, m->still,       m->trace,
                    m->screening.deck, m->container};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  free(m);
  *model = NULL;
}

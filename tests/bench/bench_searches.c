/* [A07] Fig. 2.17: discs of three sizes fall in a circular container, with each search. Prints the time of a particle
 * and step, and its shares by phase from one clock. Not a test.
 *
 *   bench_searches [steps]
 *
 * 2278 discs of 10 mm, 1716 of 15 mm and 342 of 20 mm, k = 720 N/m, e = 0.2, dt = 1e-5 s as in the thesis; its four
 * smaller groups, whose numbers it does not give, are fifths of this one. Density (100 kg/m3) and the container's
 * radius (1.97 m) are not given either.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/create.h"
#include "dem/scene/scene.h"
#include "dem/state/data.h"
#include "dem/step/forces.h"
#include "dem/step/step.h"

#include <stdio.h>
#include <stdlib.h>

/* the discs of a fifth, two fifths, … of each size */
static json_t *scene(const char *search, int group) {
  static const int counts[] = {2278, 1716, 342};
  static const double radii[] = {0.01, 0.015, 0.02};
  char text[4096];
  snprintf(text, sizeof text,
           "{\"dimension\":2,\"gravity\":[0,0,-9.81],\"search\":\"%s\",\"guard\":{\"every\":0},"
           "\"contact\":{\"normal\":\"hooke\",\"tangential\":\"none\"},"
           "\"materials\":[{\"name\":\"a\",\"density\":100}],"
           "\"pairs\":[{\"materials\":[\"a\",\"a\"],\"stiffness\":720,\"restitution\":0.2}],"
           "\"bodies\":[{\"name\":\"drum\",\"material\":\"a\",\"shapes\":[{\"type\":\"cylinder\",\"side\":\"inside\","
           "\"axis\":[0,1,0],\"radius\":1.97}]}]}",
           search);
  json_t *json = json_loads(text, 0, NULL), *groups = json_array();
  int n = 0, all = 0, left[3];
  for (int k = 0; k < 3; k++)
    all += left[k] = (counts[k] * group + 2) / 5;
  /* a lattice, the sizes mixed: each place takes the size of which the largest share is left */
  const double pitch = 0.0405;
  const int across = 67;
  json_t *places[3] = {json_array(), json_array(), json_array()};
  for (; n < all; n++) {
    int pick = 0;
    for (int k = 1; k < 3; k++)
      pick = left[k] * counts[pick] > left[pick] * counts[k] ? k : pick;
    left[pick]--;
    json_array_append_new(places[pick], json_pack("[f,f,f]", pitch * (n % across - 0.5 * (across - 1)), 0.0,
                                                  -1.35 + pitch * (n / across)));
  }
  for (int k = 0; k < 3; k++)
    json_array_append_new(groups, json_pack("{s:s, s:s, s:f, s:o}", "type", "list", "material", "a", "radius", radii[k],
                                            "positions", places[k]));
  json_object_set_new(json, "particles", groups);
  return json;
}

static void print(const char *name, const dem_data *d, double steps) {
  double all = 0;
  for (int k = 0; k < DEM_PHASES; k++)
    all += d->work.timers->spent[k];
  printf("%-12s %5d discs  %7.1f ns a disc and step  every %6.1f steps a list ", name, d->state.nparticle,
         1e9 * all / steps / d->state.nparticle, steps / (double)(d->lists.nrebuild ? d->lists.nrebuild : 1));
#define X(phase, title) printf("  " title " %4.1f %%", 100 * d->work.timers->spent[DEM_PHASE_##phase] / all);
  DEM_PHASE_LIST(X)
#undef X
  putchar('\n');
  fflush(stdout);
}

static bool run(const char *name, int group, long steps) {
  tdm_error err = {0};
  tdm_assignment assignment = {.scene = scene(name, group), .dt = 1e-5, .n = 1};
  dem_model *model = NULL;
  dem_data *d = dem_model_read(&model, &assignment, &err) == TDM_OK ? dem_data_create(model) : NULL;
  dem_timers timers = {0};
  bool good = d && dem_forces_begin(d, &err) == TDM_OK;
  if (!good)
    fprintf(stderr, "%s: %s\n", err.path, err.message);
  if (good) {
    d->work.timers = &timers;
    d->lists.nrebuild = 0;
  }
  timers.mark = tdm_clock();
  for (long k = 0; good && k < steps; k++)
    good = dem_step(d, &(dem_step_task){.dt = d->model->dt}, &err) == TDM_OK;
  if (good)
    print(name, d, (double)steps);
  dem_data_destroy(&d);
  dem_model_destroy(&model);
  json_decref(assignment.scene);
  return good;
}

int main(int argc, char **argv) {
  static const char *const searches[] = {"verlet-1967", "linked-linear", "sweep", "cells", "grid"};
  long steps = argc > 1 ? atol(argv[1]) : 20000;
  for (int group = 1; group <= 5; group++)
    for (int s = 0; s < 5; s++)
      if (!run(searches[s], group, steps))
        return EXIT_FAILURE;
  return EXIT_SUCCESS;
}

/* [A07] Fig. 2.17: discs of three sizes fall in a circular container, with each search. Prints the time of a particle
 * and step and the shares of search, list, contacts and integration. Not a test.
 *
 *   bench_searches [steps]
 *
 * 2278 discs of 10 mm, 1716 of 15 mm and 342 of 20 mm, k = 720 N/m, e = 0.2, dt = 1e-5 s as in the thesis; its four
 * smaller groups, whose numbers it does not give, are fifths of this one. Density (100 kg/m3) and the container's
 * radius (1.97 m) are not given either.
 */
#include "dem/data.h"
#include "dem/step.h"
#include "protocol/log.h"

#include <stdio.h>
#include <stdlib.h>

static json_t *scene(const char *search, double share) {
  char text[4096];
  snprintf(text, sizeof text,
           "{\"dimension\":2,\"gravity\":[0,0,-9.81],\"search\":\"%s\",\"guard\":{\"every\":0},"
           "\"contact\":{\"normal\":\"hooke\",\"tangential\":\"none\"},"
           "\"materials\":[{\"name\":\"a\",\"density\":100}],"
           "\"pairs\":[{\"materials\":[\"a\",\"a\"],\"stiffness\":720,\"restitution\":0.2}],"
           "\"bodies\":[{\"name\":\"drum\",\"material\":\"a\",\"shapes\":[{\"type\":\"cylinder\",\"side\":\"inside\","
           "\"axis\":[0,1,0],\"radius\":1.97}]}],\"particles\":[{\"type\":\"random\",\"material\":\"a\",\"count\":%d,"
           "\"radius\":{\"distribution\":\"list\",\"radii\":[0.01,0.015,0.02],\"shares\":[2278,1716,342]},"
           "\"region\":{\"min\":[-1.37,-0.0201,-1.37],\"max\":[1.37,0.0201,%g]}}]}",
           search, (int)(4336 * share + 0.5), -1.37 + 0.1 + 2.6 * share);
  return json_loads(text, 0, NULL);
}

typedef struct {
  double step, rebuild, search, contacts; /* sums [s] */
  long steps, rebuilds, looks;
} times;

/* one step, its time by kind; `probe` repeats the search of each new list */
static bool step(dem_data *d, dem_search *probe, dem_rows *rows, times *t) {
  uint64_t before = d->nrebuild;
  double begin = tdm_clock();
  if (!dem_step(d, NULL, 0, 1, false, d->model->dt))
    return false;
  double took = tdm_clock() - begin;
  if (d->nrebuild == before) {
    t->step += took;
    t->steps++;
    return true;
  }
  t->rebuild += took;
  t->rebuilds++;
  dem_search_input input = {.sphere = d->sphere, .n = d->nparticle, .skin = d->skin, .nthread = 1};
  begin = tdm_clock();
  bool good = dem_search_run(probe, &input, rows);
  t->search += tdm_clock() - begin;
  return good;
}

static void print(const char *name, const dem_data *d, const times *t) {
  double plain = t->step / (double)(t->steps ? t->steps : 1), n = (double)(t->steps + t->rebuilds);
  double lists = t->rebuild - plain * (double)t->rebuilds, all = t->step + t->rebuild;
  double contacts = t->contacts / (double)t->looks * n;
  printf(
      "%-12s %5d discs  %7.1f ns a disc and step  every %6.1f steps a list   search %4.1f %%  list %4.1f %%  contacts "
      "%4.1f %%  integration %4.1f %%\n",
      name, d->nparticle, 1e9 * all / n / d->nparticle, n / (double)(t->rebuilds ? t->rebuilds : 1),
      100 * t->search / all, 100 * fmax(0, lists - t->search) / all, 100 * contacts / all,
      100 * fmax(0, all - fmax(lists, t->search) - contacts) / all);
  fflush(stdout);
}

static bool run(const char *name, double share, long steps) {
  tdm_error err = {0};
  tdm_assignment assignment = {.scene = scene(name, share), .dt = 1e-5, .n = 1};
  dem_model *model = NULL;
  dem_data *d = dem_model_load(&model, &assignment, &err) == TDM_OK ? dem_data_create(model) : NULL;
  dem_search *probe = dem_search_create(name);
  dem_rows rows = {0};
  times t = {0};
  bool good = d && probe;
  if (!good)
    fprintf(stderr, "%s: %s\n", err.path, err.message);
  for (long k = 0; good && k < steps; k++) {
    good = step(d, probe, &rows, &t);
    if (k % 50 == 0) { /* forces alone; histories there are none */
      double begin = tdm_clock();
      dem_forces_again(d, false, 0);
      t.contacts += tdm_clock() - begin;
      t.looks++;
    }
  }
  if (good)
    print(name, d, &t);
  dem_search_destroy(&probe);
  dem_data_destroy(&d);
  dem_model_destroy(&model);
  json_decref(assignment.scene);
  return good;
}

int main(int argc, char **argv) {
  static const char *const searches[] = {"verlet-1967", "sweep", "cells", "grid"};
  long steps = argc > 1 ? atol(argv[1]) : 20000;
  for (int group = 1; group <= 5; group++)
    for (int s = 0; s < 4; s++)
      if (!run(searches[s], group / 5.0, steps))
        return EXIT_FAILURE;
  return EXIT_SUCCESS;
}

/* Speed of the DEM engine: particle-steps a second of a settled bed in a box that shakes. Not a test.
 *
 *   bench_dem [particles [steps [skin/R]]]
 */
#include "dem/data.h"
#include "dem/settle.h"
#include "dem/step.h"
#include "protocol/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* a box with n particles of 50 mm above its floor */
static json_t *bed(int n, double skin) {
  char text[4096];
  snprintf(text, sizeof text,
           "{\"materials\": [{\"name\":\"a\",\"density\":1000,\"young_modulus\":2.4e8,\"poisson_ratio\":0.2}],"
           "\"pairs\": [{\"materials\":[\"a\",\"a\"],\"restitution\":0.5,\"friction\":0.5}],"
           "\"bodies\": [{\"name\":\"box\",\"material\":\"a\",\"shapes\":[{\"type\":\"box\",\"side\":\"inside\","
           "\"size\":[0.8,0.8,2],\"center\":[0,0,1],\"open\":[\"+z\"]}]}],\"settle\": {\"speed\": 0.01},"
           "\"skin\": %g,"
           "\"particles\": [{\"type\":\"random\",\"material\":\"a\",\"count\":%d,\"radius\":0.05,"
           "\"region\":{\"min\":[-0.4,-0.4,0],\"max\":[0.4,0.4,%g]}}]}",
           0.05 * skin, n, 0.12 * (n / 36 + 1));
  return json_loads(text, 0, NULL);
}

int main(int argc, char **argv) {
  int n = argc > 1 ? atoi(argv[1]) : 500;
  long steps = argc > 2 ? atol(argv[2]) : 20000;
  tdm_error err = {0};
  tdm_assigned_body body = {.name = "box", .mass = 100, .state.pose.orientation.w = 1};
  tdm_assignment assignment = {
      .scene = bed(n, argc > 3 ? atof(argv[3]) : 0.1), .dt = 1e-4, .n = 1, .nbody = 1, .body = &body};
  dem_model *model = NULL;
  dem_settled settled = {0};
  dem_data *data = NULL;
  if (!dem_model_load(&model, &assignment, &err))
    data = dem_data_create(model);
  if (data)
    dem_settle(data, NULL, &settled, &err);
  if (err.status || !data) {
    fprintf(stderr, "%s: %s\n", err.path, err.message);
    return EXIT_FAILURE;
  }
  uint64_t before = data->nrebuild;
  double begin = tdm_clock();
  tdm_state now = body.state;
  for (long k = 1; k <= steps; k++) {
    tdm_state next = now;
    next.pose.position.z = 0.05 * sin(6 * (double)k * model->dt);
    dem_motion path = dem_motion_make(&now, &next, model->dt, TDM_LINEAR);
    dem_step(data, &path, 1, 1, false, model->dt);
    now = next;
  }
  double wall = tdm_clock() - begin;
  printf("particles %d  contacts %ld  settled in %.3g s  steps %ld  rebuilds %llu  %.3g s  %.3g million "
         "particle-steps/s\n",
         n, data->ncontact, settled.time, steps, (unsigned long long)(data->nrebuild - before), wall,
         n * (double)steps / wall * 1e-6);
  json_decref(assignment.scene);
  dem_data_destroy(&data);
  dem_model_destroy(&model);
  return EXIT_SUCCESS;
}

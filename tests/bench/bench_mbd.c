/* Wall time a window of the multibody solver in each formulation: the spring-damper box on a prismatic joint, with a
 * smooth load and with one that jumps at every window. Not a test: bench_mbd [WINDOWS [FORMULATION]]
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/integrator.h"
#include "mbd/mbd.h"
#include "protocol/base/log.h"
#include "protocol/math/random.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char scene_text[] =
    "{\"bodies\":[{\"name\":\"box\",\"mass\":100,\"inertia\":[10,10,10],\"position\":[0,0,0]}],"
    "\"joints\":[{\"name\":\"guide\",\"type\":\"prismatic\",\"bodies\":[\"ground\",\"box\"],\"point\":[0,0,0],"
    "\"axis\":[0,0,1]}],\"forces\":[{\"name\":\"spring\",\"type\":\"spring_damper\",\"bodies\":[\"ground\",\"box\"],"
    "\"points\":[[0,0,2],[0,0,0]],\"stiffness\":5000,\"damping\":100,\"preload\":100}]}";

/* Noise of `size` N around a slow force; us a window. */
static double measure(const char *formulation, long windows, double H, double size) {
  tdm_error err = {0};
  json_t *scene = json_loads(scene_text, 0, NULL);
  json_object_set_new(scene, "formulation", json_string(formulation));
  tdm_assigned_body body = {.name = "box"};
  tdm_assignment a = {.scene = scene, .time_end = 1, .dt = H, .n = 1, .nbody = 1, .body = &body};
  mbd_engine *self = NULL;
  if (mbd_engine_create(&self, &a, NULL, &err))
    printf("%s: %s\n", err.path, err.message);
  tdm_state state;
  const mbd_outcome out = {.state = &state};
  uint64_t draw = 1;
  double start = tdm_clock();
  for (long k = 0; k < windows && !err.status; k++) {
    tdm_wrench load[3] = {{{0, 0, 0}, {0, 0, 0}}};
    load[0].force.z = -2500 + 500 * sin(5 * k * H) + size * (2 * tdm_random_next(&draw) - 1);
    load[1].force.z = 2500 * H * cos(5 * k * H);
    const mbd_window in = {.t0 = k * H, .t1 = (k + 1) * H, .nload = 3, .load = load};
    if (mbd_engine_advance(self, &in, &out, &err))
      printf("window %ld: %s\n", k, err.message);
  }
  double us = (tdm_clock() - start) / (double)windows * 1e6;
  mbd_engine_destroy(&self);
  json_decref(scene);
  return us;
}

int main(int argc, char **argv) {
  long windows = argc > 1 ? atol(argv[1]) : 100000;
  const double H[] = {1e-5, 1e-4, 1e-3}, size[] = {0, 0.01, 1, 100};
  printf("us a window %12s", "");
  for (int i = 0; i < 4; i++)
    printf("  noise %4g N", size[i]);
  for (int f = 0; f < MBD_FORMULATIONS; f++)
    for (int h = 0; h < 3 && (argc < 3 || strcmp(argv[2], mbd_formulation_table[f].name) == 0); h++) {
      printf("\n%-8s H = %6g s", mbd_formulation_table[f].name, H[h]);
      for (int i = 0; i < 4; i++) {
        printf(" %12.2f", measure(mbd_formulation_table[f].name, h == 0 ? windows : windows / 10, H[h], size[i]));
        fflush(stdout);
      }
    }
  printf("\n");
  return 0;
}

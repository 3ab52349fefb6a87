/* A solver outside of tandem's source, in the place of the DEM engine: a spring pulls each coupled body to the origin.
 *
 * It is built against an installed tandem alone. Its section is "dem": {"stiffness": 100} [N/m].
 */
/* SPDX-License-Identifier: MIT */
#include <protocol/version.h>
#include <protocol/wire/participant.h>

#include <stdlib.h>

typedef struct {
  int nbody;
  double stiffness; /* [N/m] */
  tdm_wrench *load; /* (nbody) at the start */
} springs;

static tdm_vec3 pull(const springs *s, tdm_vec3 position) {
  return tdm_scale(-s->stiffness, position);
}

static tdm_status create(void **self, const tdm_assignment *a, tdm_ready *ready, tdm_participant *p, tdm_error *err) {
  (void)p;
  springs *s = *self = calloc(1, sizeof *s);
  if (s)
    s->load = calloc((size_t)a->nbody + 1, sizeof *s->load);
  if (!s || !s->load)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  s->nbody = a->nbody;
  tdm_object scene = tdm_object_open(a->scene, "dem", err);
  s->stiffness = tdm_get_number(&scene, "stiffness", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  tdm_object_close(&scene);
  for (int i = 0; i < s->nbody; i++)
    s->load[i].force = pull(s, a->body[i].state.pose.position);
  ready->load = s->load;
  return err->status;
}

/* The mean load over the window: the body's path is taken as straight. */
static tdm_status step(void *self, const tdm_step *step, tdm_result *result, tdm_error *err) {
  const springs *s = self;
  for (int i = 0; i < s->nbody; i++) {
    const tdm_vec3 from = step->start[i].pose.position, to = step->end[i].pose.position;
    result->load[i].force = pull(s, tdm_scale(0.5, tdm_add(from, to)));
    for (int k = 0; k < step->nsample; k++)
      result->sample_load[k * s->nbody + i] = result->load[i];
  }
  return err->status;
}

static void destroy(void *self) {
  springs *s = self;
  if (s)
    free(s->load);
  free(s);
}

int main(int argc, char **argv) {
  static const tdm_solver_ops ops = {.role = "dem",
                                     .software = "spring_solver with tandem " TDM_VERSION,
                                     .create = create,
                                     .step = step,
                                     .destroy = destroy};
  return tdm_solver_main(&ops, argc, argv);
}

/* A stream of particles pushes a cube, [L18] Section 3.1: position and velocity of the cube against the exact sequence
 * of binary collisions.
 *
 * Particle k starts at t = k/rate with the speed u_k = u_0 - v_c(t), flies freely, hits, and is taken away after its
 * rebound:
 *   v_c' = v_c + m_p (1 + e) (u_k - v_c)/(m_p + m_c)                                                     [L18] Eq. 17
 * so the velocity is a staircase and the position a chain of straight lines.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/support.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double least_nse = 0.9995;
enum { FLIGHT_MAX = 4096 };

typedef struct {
  double body_mass, mass, radius, restitution, rate, speed, start, factor; /* of the scene; start: of a centre [m] */
  double face;                                                             /* of the cube at t = 0 [m] */
} stream_parameters;

typedef struct {
  double x, u; /* centre [m] and speed [m/s] at the time of the flight's state */
} flying;

/* The cube and what flies towards it. */
typedef struct {
  double t, x, v; /* of the cube: displacement [m], velocity [m/s] */
  long created;
  int nflying;
  flying particle[FLIGHT_MAX]; /* oldest first: they do not overtake each other */
} stream_state;

static void advance(stream_state *s, double dt) {
  s->t += dt;
  s->x += dt * s->v;
  for (int i = 0; i < s->nflying; i++)
    s->particle[i].x += dt * s->particle[i].u;
}

/* Time until the oldest particle touches the cube; infinite when none flies or none catches up. */
static double until_hit(const stream_parameters *p, const stream_state *s) {
  if (s->nflying == 0 || s->particle[0].u <= s->v)
    return INFINITY;
  return (p->face + s->x - p->radius - s->particle[0].x) / (s->particle[0].u - s->v);
}

static void hit(const stream_parameters *p, stream_state *s) {
  s->v += p->mass * (1 + p->restitution) * (s->particle[0].u - s->v) / (p->mass + p->body_mass);
  s->nflying--;
  for (int i = 0; i < s->nflying; i++)
    s->particle[i] = s->particle[i + 1];
}

/* Go through the collisions up to time t. */
static void exact_until(const stream_parameters *p, stream_state *s, double t, tdm_error *err) {
  while (err->status == TDM_OK) {
    double birth = (double)s->created / p->rate - s->t, contact = until_hit(p, s), rest = t - s->t;
    if (birth > rest && contact > rest) {
      advance(s, rest);
      return;
    }
    advance(s, fmax(0, fmin(birth, contact)));
    if (contact <= birth) {
      hit(p, s);
    } else if (s->nflying == FLIGHT_MAX) {
      tdm_fail(err, TDM_ERR_NUMERIC, NULL, "stream: more than %d particles fly at once", FLIGHT_MAX);
    } else {
      s->particle[s->nflying++] = (flying){p->start, p->speed + p->factor * s->v};
      s->created++;
    }
  }
}

static void read_parameters(const scn_result *r, stream_parameters *p, tdm_error *err) {
  *p = (stream_parameters){.body_mass = scn_number(r->scene, "mbd.bodies[0].mass", err),
                           .mass = scn_number(r->scene, "dem.sources[0].mass", err),
                           .radius = scn_number(r->scene, "dem.sources[0].radius", err),
                           .restitution = scn_number(r->scene, "dem.pairs[0].restitution", err),
                           .rate = scn_number(r->scene, "dem.sources[0].rate", err),
                           .speed = scn_number(r->scene, "dem.sources[0].velocity[0]", err),
                           .start = scn_number(r->scene, "dem.sources[0].position[0]", err),
                           .factor = scn_number_or(r->scene, "dem.sources[0].relative_to.factor", 0)};
  p->face = scn_number(r->scene, "mbd.bodies[0].position[0]", err) -
            0.5 * scn_number(r->scene, "dem.bodies[0].shapes[0].size[0]", err);
}

tdm_status scn_stream_compare(const char *dir, cpl_comparison *c, tdm_error *err) {
  scn_result r = {0};
  stream_parameters p = {0};
  stream_state *s = calloc(1, sizeof *s);
  if (scn_result_read(&r, dir, err) == TDM_OK)
    read_parameters(&r, &p, err);
  if (!s)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  const double *time = err->status == TDM_OK ? cpl_table_column(&r.body, "time", err) : NULL;
  const double *x = time ? cpl_table_column(&r.body, "x", err) : NULL;
  const double *vx = x ? cpl_table_column(&r.body, "vx", err) : NULL;
  const double *waiting = vx ? cpl_table_column(&r.dem, "source.feeder.waiting", NULL) : NULL;
  for (int i = 0; waiting && i < r.dem.nrow; i++)
    if (waiting[i] > 0) {
      tdm_fail(err, TDM_ERR_SCENE, "dem.sources[0].rate",
               "particles had to wait for room: the reference does not know that");
      break;
    }
  if (err->status == TDM_OK && vx && cpl_comparison_init(c, r.body.nrow, time, err) == TDM_OK) {
    cpl_compared *position = cpl_comparison_add(c, "x", "m", CPL_STATE, "Displacement of the cube", err);
    cpl_compared *velocity = cpl_comparison_add(c, "v", "m/s", CPL_STATE, "Velocity of the cube", err);
    for (int i = 0; err->status == TDM_OK && i < c->nrow; i++) {
      exact_until(&p, s, time[i], err);
      position->simulation[i] = x[i] - x[0];
      velocity->simulation[i] = vx[i];
      position->reference[i] = s->x;
      velocity->reference[i] = s->v;
    }
  }
  free(s);
  scn_result_free(&r);
  return err->status;
}

/* "Their own initial speed of 2 m/s minus the current speed of the cube" has two readings: launched so (the scene,
 * factor -1), or launched at 2 m/s, the difference being the speed at which they hit (factor 0). */
tdm_status scn_stream(cpl_verify *v, tdm_error *err) {
  static const char *const readings[] = {"", "factor=0"}, *const schemes[] = {"lommen", "proxy"};
  enum { NRUN = 4 };
  cpl_verify_case run[NRUN] = {0};
  for (int k = 0; k < NRUN; k++) {
    const bool other = k / 2, proxy = k % 2;
    snprintf(run[k].name, sizeof run[k].name, "%s%s%s", readings[other], other && proxy ? " " : "",
             proxy ? "scheme=proxy" : "");
    cpl_verify_case_set(&run[k], "coupling.scheme=%s", schemes[proxy]);
    cpl_verify_case_set(&run[k], "dem.sources[0].relative_to.factor=%d", other ? 0 : -1);
  }
  cpl_verify_run_many(v, NRUN, run, 0, err);
  for (int k = 0; err->status == TDM_OK && k < NRUN; k++) {
    cpl_comparison c = {0};
    if (scn_verify_measure(v, &run[k], least_nse, &c, err) == TDM_OK) {
      cpl_verify_measure(v, "v_at_the_end", run[k].name, c.curve[1].simulation[c.nrow - 1], CPL_NO_LIMIT, 0);
      cpl_verify_measure(v, "v_at_the_end_theory", run[k].name, c.curve[1].reference[c.nrow - 1], CPL_NO_LIMIT, 0);
    }
    cpl_comparison_free(&c);
  }
  return err->status;
}

/* Containers: see container.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/container.h"

#include "dem/seam/homes.h"
#include "dem/seam/sums.h"
#include "protocol/scene/remark.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

/* ---- counting ---- */

static bool within(const dem_container *c, tdm_vec3 x) {
  return x.x >= c->low.x && x.x <= c->high.x && x.y >= c->low.y && x.y <= c->high.y && x.z >= c->low.z &&
         x.z <= c->high.z;
}

/* A container that is being counted, and its axes. */
typedef struct {
  int container;
  tdm_pose frame;
  tdm_mat3 axes;
} counting;

/* a chunk's particles inside: their mass, their number, how many of them entered, which are held from now on */
static void add_inside(const dem_data *d, int chunk, const void *of, double *sums) {
  const counting *count = of;
  const dem_container *c = &d->model->container[count->container];
  const uint32_t bit = (uint32_t)1 << count->container;
  for (int i = dem_chunk_start(d, chunk), end = dem_chunk_start(d, chunk + 1); i < end; i++) {
    const tdm_vec3 x = d->state.sphere[i].position;
    if (!within(c, c->frame < 0 ? x : tdm_m3_tmul(count->axes, tdm_sub(x, count->frame.position))))
      continue;
    sums[0] += d->state.mass[i];
    sums[1]++;
    sums[2] += !(d->state.held[i] & bit);
    d->state.held[i] |= bit;
  }
}

static void count_inside(dem_data *d, int k) {
  const dem_container *c = &d->model->container[k];
  dem_container_state *now = &d->state.container[k];
  const tdm_pose frame = c->frame < 0 ? (tdm_pose){{0, 0, 0}, tdm_quat_identity()} : d->state.pose[c->frame];
  double sums[3];
  dem_sum_chunks(d, 3, add_inside, &(counting){k, frame, tdm_quat_to_matrix(frame.orientation)}, sums);
  now->mass = sums[0];
  now->number = (uint64_t)sums[1];
  now->entered += (uint64_t)sums[2];
}

/* how many have left when so many tenths of the content have */
static uint64_t tenths(const dem_container_state *now, uint64_t many) {
  return (many * now->content + 9) / 10;
}

static void note_left(dem_container_state *now, uint64_t left, double t) {
  if (now->left == 0)
    now->content = now->entered;
  now->left = left;
  now->last = t;
  for (; now->marks < 2 && left >= tenths(now, now->marks == 0 ? 1 : 9); now->marks++)
    now->mark[now->marks] = t;
}

double dem_container_mean_rate(const dem_container_state *c) {
  const double time = c->mark[1] - c->mark[0];
  return c->marks == 2 && time > 0 ? (double)(tenths(c, 9) - tenths(c, 1)) / time : NAN;
}

/* ---- jams ---- */

static void tell(const dem_data *d, int k, bool jam, double t) {
  const dem_container *c = &d->model->container[k];
  const dem_container_state *now = &d->state.container[k];
  char event[96], path[TDM_PATH_MAX];
  snprintf(event, sizeof event, "%s.%s", jam ? "jam" : "flows_again", c->name);
  snprintf(path, sizeof path, "dem.containers[%d]", k);
  if (jam)
    tdm_remark(TDM_WARNING, event, path, t,
               "the container \"%s\" is jammed: %" PRIu64 " particles are inside and none has left since t = %.6g s; "
               "enlarge its outlet, shake it, or give a longer jam_time if that is no jam",
               c->name, now->number, now->last);
  else
    tdm_remark(TDM_NOTICE, event, path, t, "the container \"%s\" flows again at t = %.6g s, after %.3g s", c->name, t,
               t - now->last);
}

/* `left` have left by now */
static void watch(dem_data *d, int k, uint64_t left, double t) {
  const dem_container *c = &d->model->container[k];
  dem_container_state *now = &d->state.container[k];
  if (left > now->left) {
    if (now->jammed)
      tell(d, k, false, t);
    now->jammed = 0;
    note_left(now, left, t);
  } else if (now->number == 0 || (now->left == 0 && !(t > c->jam_start))) {
    now->jammed = 0;
    now->last = t;
  } else if (!now->jammed && t - now->last >= c->jam_time) {
    now->jammed = 1;
    now->jams++;
    tell(d, k, true, t);
  }
}

void dem_containers_step(dem_data *d, double t) {
  if (d->model->ncontainer > 0)
    dem_parted(d, DEM_MOTION); /* home particles are held */
  for (int k = 0; k < d->model->ncontainer; k++) {
    count_inside(d, k);
    watch(d, k, d->state.container[k].entered - d->state.container[k].number, t);
  }
}

/* ---- outputs ---- */

void dem_containers_sample(dem_data *d, double duration) {
  for (int k = 0; k < d->model->ncontainer && duration > 0; k++) {
    dem_container_state *now = &d->state.container[k];
    now->rate = (double)(now->left - now->sampled) / duration;
    now->sampled = now->left;
  }
}

/* What an integrator does, and the table of formulations that a scene may choose (key "formulation"): each is solved by
 * one integrator. To add one: a file that defines its operations, a row in integrator.c, a line in CMakeLists.txt and
 * in docs/theory/mbd.md.
 *
 * An integrator never steps past the end of a window: the load ends there.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_INTEGRATE_INTEGRATOR_H
#define MBD_INTEGRATE_INTEGRATOR_H

#include "mbd/consistent/consistent.h"

/* Called for each sample time with the state there (dense output); y is borrowed. */
typedef tdm_status (*mbd_sample_fn)(void *context, int sample, double t, const double *y, tdm_error *err);

/* Called after each of the integrator's steps; true asks it to stop. */
typedef bool (*mbd_stop_fn)(void *context);

typedef struct {
  /* Borrows model, data and kkt, which must outlive it. `stop` may be NULL. */
  tdm_status (*create)(void **self, const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_stop_fn stop,
                       void *context, tdm_error *err);
  /* Start (or start again) at time t from data's positions and velocities, which are consistent, with data's load.
   * Counts on in data's angles and statistics. */
  tdm_status (*start)(void *self, double t, tdm_error *err);
  /* Integrate to t1 with data's load; data->y is the state at t1 then. sample_time (nsample) lies in (t, t1],
   * ascending. */
  tdm_status (*advance)(void *self, double t1, int nsample, const double *sample_time, mbd_sample_fn sample,
                        void *context, tdm_error *err);
  /* Bring the counters of data->stats up to date. */
  void (*stats)(void *self);
  void (*destroy)(void *self); /* NULL does nothing */
  /* Keep in *kept (NULL: to be made) what the integrator knows beside data, and go back to it. The three are NULL when
   * that cannot be copied: it has to start again then, also where it was saved, so that both go on alike. */
  tdm_status (*save)(const void *self, void **kept, tdm_error *err);
  tdm_status (*restore)(void *self, const void *kept, tdm_error *err);
  void (*release)(void *kept); /* NULL does nothing */
} mbd_integrator_ops;

typedef struct {
  const char *name;
  const mbd_integrator_ops *integrator;
} mbd_formulation;

/* indexed by mbd_settings.formulation */
extern const mbd_formulation mbd_formulation_table[];

/* Words for an error: what may help where IDA fails, and is not so already. */
void mbd_advise(const mbd_model *model, char *out, size_t size);

extern const mbd_integrator_ops mbd_ida, mbd_one_step;

#endif

/* The integrator: SUNDIALS IDA (variable-order, fixed-leading-coefficient BDF). The only file that knows it is ida.c.
 *
 * IDA never steps past the end of a window (its load ends there) and keeps its history over windows.
 */
#ifndef MBD_IDA_H
#define MBD_IDA_H

#include "mbd/assemble.h"

typedef struct mbd_ida mbd_ida;

/* Called for each sample time with the state there (dense output); y is borrowed. */
typedef tdm_status (*mbd_sample_fn)(void *context, int sample, double t, const double *y, tdm_error *err);

/* Called after each of the integrator's steps; true asks it to stop. */
typedef bool (*mbd_stop_fn)(void *context);

/* Borrows model, data and kkt, which must outlive it. `stop` may be NULL. */
tdm_status mbd_ida_create(mbd_ida **ida, const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_stop_fn stop,
                          void *context, tdm_error *err);
void mbd_ida_destroy(mbd_ida **ida);

/* Start at time t from data's positions and velocities, which are consistent, with data's load. */
tdm_status mbd_ida_start(mbd_ida *ida, double t, tdm_error *err);

/* Integrate to t1 with data's load; data->y is the state at t1 then. sample_time (nsample) lies in (t, t1], ascending.
 */
tdm_status mbd_ida_advance(mbd_ida *ida, double t1, int nsample, const double *sample_time, mbd_sample_fn sample,
                           void *context, tdm_error *err);

/* Fill the counters of data->stats that IDA keeps. */
void mbd_ida_stats(mbd_ida *ida);

#endif

/* IDA's own clock.
 *
 * IDA raises its order only after steps that are equal to the last bit, and lowers it whenever its estimates are
 * rounding. Where one step is a window, the ends of windows, which are rounded, make steps differ in their last bits:
 * the order could only fall, to 1 at last (windows of 1e-6 s: an error of 1e-5). So IDA has a clock of its own, tau, on
 * which windows of one step are equally long: each step ends where the one before lets it, and the true time t is
 * counted from the start of the step. The clocks differ by rounding; what adds up, 1e-7 of a window at most, is taken
 * back.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_INTEGRATE_PACE_H
#define MBD_INTEGRATE_PACE_H

typedef struct {
  double t, tau;  /* true time and IDA's at the end of the last step [s] */
  double longest; /* step that IDA may take [s], 0: any */
  double start;   /* of the equal windows of one step [s] */
  long count;     /* of them */
  double ahead;   /* what IDA's clock has gained on the true one since then [s] */
  double length;  /* of the step under way, by IDA's clock [s] */
  double end;     /* where it must stop, by the true clock [s] */
} mbd_pace;

/* Both clocks show t. */
void mbd_pace_reset(mbd_pace *pace, double t);

/* A step is to begin in the window from t0 to t1, and IDA wants it to be `wanted` [s] (0: it has not said). Returns
 * the stop time by IDA's clock: at the window's end, or half way there when the wanted step would leave a rest smaller
 * than itself, so that no window ends with a sliver that the next step has to grow out of. Sets pace->longest. */
double mbd_pace_stop(mbd_pace *pace, double t0, double t1, double wanted);

/* The step has come to tau by IDA's clock, `stopped`: to the stop. Returns the true time. */
double mbd_pace_reach(mbd_pace *pace, double tau, int stopped);

/* True time of a time in the step under way by IDA's clock. */
static inline double mbd_pace_true(const mbd_pace *pace, double tau) {
  return pace->t + (tau - pace->tau);
}

#endif

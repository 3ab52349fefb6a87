/* lommen and hold: MBD goes first, on loads continued from the windows before; DEM follows on MBD's path ([L18] Sec.
 * 2).
 *
 *   window k:  W(t) on [t_k, t_k + H] = polynomial through the last means        [L18] Eq. 5-12, in local time
 *              MBD  integrates to t_k + H under W(t)
 *              DEM  moves the bodies from pose k to pose k+1 and returns the mean load of its n steps   [L18] Eq. 2
 *
 * The mean of a window is assigned to the window's end, as in the paper. The polynomial is evaluated inside the window,
 * not only at its end. It is the constant, the line or the parabola through what there is: the load at t = 0 is known
 * from DEM, each window adds one mean. `hold` always keeps the constant.
 */
#include "coupler/window.h"

static tdm_status mbd_first(cpl_loop *loop, int nmean, tdm_error *err) {
  int ncoefficient = 1;
  for (int i = 0; i < loop->nbody; i++)
    ncoefficient = cpl_extrapolate(&loop->history[i], nmean, loop->t0, loop->t1, &loop->load[i * CPL_HISTORY_MAX]);
  if (cpl_solve_mbd(loop, ncoefficient, err) != TDM_OK)
    return err->status;
  if (cpl_solve_dem(loop, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++)
    cpl_history_push(&loop->history[i], loop->t1, loop->mean[i]);
  return TDM_OK;
}

static tdm_status lommen_advance(cpl_loop *loop, tdm_error *err) {
  return mbd_first(loop, 3, err);
}

static tdm_status hold_advance(cpl_loop *loop, tdm_error *err) {
  return mbd_first(loop, 1, err);
}

const cpl_scheme cpl_scheme_lommen = {
    .name = "lommen",
    .summary = "MBD first, on the parabola through the last three window means",
    .advance = lommen_advance,
};

const cpl_scheme cpl_scheme_hold = {
    .name = "hold",
    .summary = "MBD first, on the last window mean held",
    .advance = hold_advance,
};

/* lommen: MBD goes first, on loads continued from the windows before; DEM follows on MBD's path ([L18] Sec. 2).
 *
 *   window k:  W(t) on [t_k, t_k + H] = polynomial through the last three means   [L18] Eq. 5-12, in local time
 *              MBD  integrates to t_k + H under W(t)
 *              DEM  moves the bodies from pose k to pose k+1 and returns the mean load of its n steps   [L18] Eq. 2
 *
 * The mean of a window is assigned to the window's end, as in the paper. The polynomial is evaluated inside the window,
 * not only at its end. It is the constant, the line or the parabola through what there is: the load at t = 0 is known
 * from DEM, each window adds one mean.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/extrapolate.h"
#include "coupler/scheme/schemes.h"

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  return cpl_mbd_first(loop, 3, err);
}

const cpl_scheme cpl_scheme_lommen = {
    .name = "lommen",
    .in_paper = true, /* [L18] */
    .summary = "MBD first, on the parabola through the last three window means",
    .better = "proxy",
    .memory = cpl_history_memory,
    .open = cpl_history_begin,
    .advance = advance,
};

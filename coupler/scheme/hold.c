/* hold: as lommen, but MBD goes on the last mean, held over the window:  W(t) = mean of window k-1.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/extrapolate.h"
#include "coupler/scheme/schemes.h"

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  return cpl_mbd_first(loop, cpl_history_continue(loop, 1), err);
}

const cpl_scheme cpl_scheme_hold = {
    .name = "hold",
    .summary = "MBD first, on the last window mean held",
    .better = "proxy",
    .order = 1,
    .memory = cpl_history_memory,
    .open = cpl_history_begin,
    .advance = advance,
};

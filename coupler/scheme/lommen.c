/* lommen: MBD goes first, on loads continued from the windows before; DEM follows on MBD's path ([L18] Sec. 2).
 *
 *   window k:  F(t) = polynomial through the last three means     [L18] Eq. 5-12, in local time
 *              MBD  integrates to t_k + H under W(t):
 *                   polynomial   W = F inside the window
 *                   end-held     W = F(t_k + H)                   the one value that the paper hands over
 *                   end-ramped   W goes straight to it from that of the window before
 *              DEM  moves the bodies from pose k to pose k+1 and returns the mean load of its n steps   [L18] Eq. 2;
 *                   its contacts feel the derivative of that path, or ("sent") the velocity of MBD's state k+1
 *
 * The mean of a window is assigned to the window's end, as in the paper. F is the constant, the line or the parabola
 * through what there is: the load at t = 0 is known from DEM, each window adds one mean.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/extrapolate.h"
#include "coupler/scheme/schemes.h"

typedef enum { POLYNOMIAL, END_HELD, END_RAMPED, SHAPES } shape;

/* coupling.lommen */
typedef struct {
  shape load;
  bool sent; /* DEM's contacts take the velocity that MBD has at the window's end */
} settings;

static void read_settings(void *own, tdm_object *o) {
  static const char *const loads[SHAPES] = {"polynomial", "end-held", "end-ramped"};
  static const char *const velocities[] = {"path", "sent"};
  settings *s = own;
  s->load = (shape)tdm_get_choice(o, "load", loads, SHAPES, POLYNOMIAL);
  s->sent = tdm_get_choice(o, "wall_velocity", velocities, 2, 0) == 1;
}

static unsigned needs_too(const void *own, cpl_role role) {
  return role == CPL_DEM && ((const settings *)own)->sent ? CPL_SENT_VELOCITY : 0;
}

/* (nbody) F at the end of the window before, behind the histories */
static tdm_wrench *last_ends(const cpl_loop *loop) {
  return (tdm_wrench *)(void *)(loop->memory + cpl_history_memory(loop->nbody));
}

static size_t memory_size(int nbody) {
  return cpl_history_memory(nbody) + (size_t)nbody * sizeof(tdm_wrench);
}

static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  for (int i = 0; i < loop->nbody; i++)
    last_ends(loop)[i] = loop->session->load[i];
  return cpl_history_begin(loop, err);
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  const shape as = ((const settings *)loop->scheme_settings)->load;
  const int continued = cpl_history_continue(loop, 3);
  int ncoefficient = continued;
  for (int i = 0; i < loop->nbody && as != POLYNOMIAL; i++) {
    tdm_wrench *c = &loop->load[i * TDM_LOAD_MAX];
    ncoefficient = as == END_HELD ? cpl_hold_end(continued, c) : cpl_ramp_to_end(continued, c, &last_ends(loop)[i]);
  }
  return cpl_mbd_first(loop, ncoefficient, err);
}

const cpl_scheme cpl_scheme_lommen = {
    .name = "lommen",
    .in_paper = true, /* [L18] */
    .summary = "MBD first, on the parabola through the last three window means",
    .better = "proxy",
    .order = 1,
    .settings_size = sizeof(settings),
    .read = read_settings,
    .needs_too = needs_too,
    .memory = memory_size,
    .open = begin,
    .advance = advance,
};

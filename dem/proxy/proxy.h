/* The proxy: DEM carries the mechanism of its coupled bodies through a window (PROTOCOL.md, sections 6 and 7).
 *
 * With the f independent velocities u' of the mechanism, increments since the window's start, and W the loads that
 * contacts put on the bodies:
 *   u'' = u''_0 + B(tau) (W - W_0) - A_c (u' - u'_0) - A_k delta u,    V = V_0 + J(tau) u' - J_0 u'_0 + tau a_t
 * One step of dt is, as velocity Verlet for the particles,
 *   half a kick   u' += dt/2 B (W - W_0), with the loads of the last evaluation
 *   the flow      exact under u''_0, A_c and A_k alone: exponential of the linear system, whatever their stiffness
 *   half a kick   with the new loads
 * so bodies and particles exchange momentum without loss, and stiff bushings do not bind dt. Contacts see the body with
 * the velocity predicted for the end of the step, as they see particles (integrate.h).
 *
 * Where a STEP has nodes of a path (what drivers prescribe bends within the window), the mechanism goes along that, and
 * u are its deviations from it:
 *   u'' = B(tau) (W - W_0) - A_c u' - A_k u,  u = u' = 0 at the start,    V = V_path(tau) + J(tau) u'
 *
 * J and B are those of the window's start, turning with the body where they do (a hinge, a slider on the fixed world),
 * else on the line that the multibody solver gives.
 *
 * A body never jumps: e, what it stood away from the multibody solver's state at the start, is closed by
 *   e(tau) = Hermite's cubic from (e_0, e'_0) to (0, 0) over T = max(H, half the shortest contact time, 10 dt)
 * and what is left at the window's end is part of the next one's e_0. A correction c at the end is reached likewise
 * from (0, 0).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_PROXY_PROXY_H
#define DEM_PROXY_PROXY_H

#include "dem/bodies/path.h"
#include "dem/state/data.h"
#include "protocol/wire/participant.h"

typedef struct dem_proxy dem_proxy;

/* For the coupled bodies of a model and an assignment, which says if windows are to find the load that ends where the
 * proxy does (matched.h). NULL: no memory. */
dem_proxy *dem_proxy_create(const dem_model *model, const tdm_assignment *assignment);
void dem_proxy_destroy(dem_proxy **proxy);

/* What a window learns from those before it, for states that are saved: whether the (one) body's freedoms turn with it.
 */
bool dem_proxy_turned(const dem_proxy *proxy);
void dem_proxy_turn(dem_proxy *proxy, bool turned);

/* The window through which the mechanism is carried. */
typedef struct {
  double t0;           /* [s] */
  uint64_t nstep;      /* steps */
  double dt;           /* of each [s] */
  double contact_time; /* the shortest that is expected [s] */
} dem_proxy_window;

/* Take up a window. What `mechanism` points to must outlive it. Errors: TDM_ERR_MEMORY. */
tdm_status dem_proxy_begin(dem_proxy *proxy, const dem_data *data, const dem_mechanism *mechanism,
                           const dem_proxy_window *window, tdm_error *err);

/* Half a kick by the present loads and the flow over dt; puts the bodies and their walls where they are then. */
void dem_proxy_drift(dem_proxy *proxy, dem_data *data);

/* Half a kick by the new loads. */
void dem_proxy_kick(dem_proxy *proxy, const dem_data *data);

/* Largest square of a frequency of the bodies on the springs of their contacts now (dem_walls_rate2) [1/s2]. */
tdm_status dem_proxy_rate2(const dem_proxy *proxy, dem_data *data, double *rate2, tdm_error *err);

/* After the last step: gives the bodies their velocities at the end, and tells where they went, and works. `further`
 * (bodies x TDM_FURTHER) is for a proxy that matches, from the moments in `body`. Both may be NULL. */
void dem_proxy_end(dem_proxy *proxy, dem_data *data, tdm_interface *body, tdm_wrench *further);

#endif

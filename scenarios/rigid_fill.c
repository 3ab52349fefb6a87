/* A box and its fill, taken as one rigid body that turns about the z axis through the origin: see rigid_fill.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/rigid_fill.h"

#include <math.h>

tdm_status scn_rigid_fill_read(const scn_result *r, scn_rigid_fill *f, tdm_error *err) {
  double box = scn_number(r->scene, "mbd.bodies[0].mass", err),
         z = scn_number(r->scene, "mbd.bodies[0].inertia[2]", err);
  double x = scn_number(r->scene, "mbd.bodies[0].position[0]", err),
         y = scn_number(r->scene, "mbd.bodies[0].position[1]", err);
  f->gravity = -scn_number_or(r->scene, "mbd.gravity[1]", scn_number_or(r->scene, "gravity[1]", 0));
  f->fill_mass = scn_number(r->summary, "solvers.dem.report.fill.mass", err);
  f->fill_x = scn_number(r->summary, "solvers.dem.report.fill.com[0]", err);
  f->fill_y = scn_number(r->summary, "solvers.dem.report.fill.com[1]", err);
  f->fill_inertia = scn_number(r->summary, "solvers.dem.report.fill.inertia[8]", err) +
                    f->fill_mass * (f->fill_x * f->fill_x + f->fill_y * f->fill_y);
  f->radius = hypot(x, y);
  f->mass = box + f->fill_mass;
  f->x = (box * x + f->fill_mass * f->fill_x) / f->mass;
  f->y = (box * y + f->fill_mass * f->fill_y) / f->mass;
  f->inertia = z + box * f->radius * f->radius + f->fill_inertia;
  return err->status;
}

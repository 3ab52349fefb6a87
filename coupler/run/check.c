/* `tandem check`: see check.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/run/check.h"

#include "coupler/settings/scheme.h"
#include "protocol/parameters/load.h"
#include "protocol/results/print.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* a coupled body: its names, and what mbd says of it at the start */
static void print_body(const cpl_body_names *names, const tdm_assigned_body *b, const tdm_wrench *load, bool first) {
  const tdm_vec3 c = b->state.pose.position, o = b->origin;
  const double(*i)[3] = b->inertia.m;
  printf("  %-28s \"%s\" (mbd) is \"%s\" (dem), %g kg, load at the start %.6g N\n", first ? "coupled bodies" : "",
         names->name[CPL_MBD], names->name[CPL_DEM], b->mass, tdm_norm(load->force));
  printf("  %-28s centre of mass at [%.6g, %.6g, %.6g] m, world\n", "", c.x, c.y, c.z);
  printf("  %-28s inertia %.6g %.6g %.6g, products %.6g %.6g %.6g kg m2, body axes\n", "", i[0][0], i[1][1], i[2][2],
         i[0][1], i[0][2], i[1][2]);
  if (b->mesh)
    printf("  %-28s origin of \"%s\" at [%.6g, %.6g, %.6g] m from there, body axes\n", "", b->mesh, o.x, o.y, o.z);
}

static void print_coupling(const cpl_settings *s, const cpl_session *session) {
  char schemes[256];
  printf("run\n");
  printf("  %-28s %g s in %llu DEM steps of %g s\n", "time", s->time_end, (unsigned long long)cpl_total_steps(s),
         s->dt);
  if (s->adapt.on)
    printf("  %-28s n from %ld to %ld: %g s to %g s, by their mismatch\n", "windows", s->adapt.n_min, s->adapt.n_max,
           (double)s->adapt.n_min * s->dt, (double)s->adapt.n_max * s->dt);
  else
    printf("  %-28s n = %ld: %llu windows of %g s\n", "windows", s->n, (unsigned long long)cpl_total_windows(s),
           (double)s->n * s->dt);
  printf("  %-28s %s: %s\n", session->scheme == s->scheme ? "scheme" : "scheme (the fallback)", session->scheme->name,
         session->scheme->summary);
  printf("  %-28s %s\n", "schemes both support", cpl_session_schemes(session, schemes, sizeof schemes));
  printf("  %-28s every %g s: %.0f rows\n", "time histories", s->output_interval,
         ceil((double)cpl_total_steps(s) * s->dt / s->output_interval - 1e-6) + 1);
  tdm_outputs_print(&s->outputs, s->time_end);
  for (int i = 0; i < s->nbody; i++)
    print_body(&s->body[i], &session->body[i], &session->load[i], i == 0);
}

/* What a partner can do beside the exchange's own, and what it cannot of what schemes and records use. */
static void print_capabilities(const cpl_session *session, cpl_role role) {
  static const char *const known[CPL_NROLE][11] = {
      [CPL_MBD] = {"acceleration", "mobility", "restore", "energy", "ahead", "matched_load", "view", NULL},
      [CPL_DEM] = {"interface", "proxy", "restore", "energy", "path", "matched_load", "sent_velocity", "view", NULL}};
  for (int can = 1; can >= 0; can--) {
    char list[256] = "";
    int used = 0;
    for (const char *const *name = known[role]; *name; name++)
      if (cpl_session_has(session, role, *name) == can)
        used += snprintf(list + used, sizeof list - (size_t)used, "%s%s", used ? ", " : "", *name);
    printf("  %-28s %s\n", can ? "can" : "cannot", used ? list : "-");
  }
}

void cpl_check_print(const tdm_scene *scene, const cpl_settings *settings, const cpl_session *session) {
  tdm_scene_print_parameters(scene);
  print_coupling(settings, session);
  for (int r = 0; r < CPL_NROLE; r++) {
    const cpl_partner *p = &session->partner[r];
    printf("%s: %s\n", cpl_role_names[r], p->software);
    print_capabilities(session, (cpl_role)r);
    tdm_print_json(p->report);
  }
  printf("%zu warning%s\n", json_array_size(session->warnings), json_array_size(session->warnings) == 1 ? "" : "s");
}

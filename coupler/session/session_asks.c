/* What the solvers of a session can do, what is asked of them, and the scheme that follows: see session.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/session/session.h"
#include "coupler/settings/scheme.h"
#include "protocol/scene/remark.h"

#include <stdio.h>
#include <string.h>

const char *const cpl_need_names[CPL_NNEED] = {"acceleration", "mobility", "interface",
                                               "proxy",        "restore",  "sent_velocity"};

const char *cpl_session_name(const cpl_session *session, cpl_role role) {
  const cpl_partner *p = &session->partner[role];
  return p->name[0] ? p->name : cpl_role_names[role];
}

bool cpl_session_has(const cpl_session *s, cpl_role role, const char *capability) {
  size_t i;
  json_t *entry;
  json_array_foreach(s->partner[role].capabilities, i, entry) {
    const char *name = json_string_value(entry);
    if (name && strcmp(name, capability) == 0)
      return true;
  }
  return false;
}

/* What a scheme needs of a role's solver, as its settings are. */
static unsigned needs_of(const cpl_session *s, const cpl_scheme *scheme, int role) {
  return scheme->needs[role] |
         (scheme->needs_too ? scheme->needs_too(cpl_scheme_settings(s->settings, scheme), (cpl_role)role) : 0);
}

unsigned cpl_session_needs(const cpl_session *s, cpl_role role) {
  return needs_of(s, s->scheme, (int)role) | s->further[role];
}

/* The first capability that a scheme needs and a role's solver lacks, as bit of cpl_need; -1: none. */
static int lacks(const cpl_session *s, const cpl_scheme *scheme, int role) {
  const unsigned needs = needs_of(s, scheme, role);
  for (int k = 0; k < CPL_NNEED; k++)
    if (needs & (1u << k) && !cpl_session_has(s, (cpl_role)role, cpl_need_names[k]))
      return k;
  return -1;
}

const char *cpl_session_schemes(const cpl_session *s, char *out, size_t size) {
  int used = 0;
  out[0] = 0;
  for (int with_n = 0; with_n < 2; with_n++) { /* windows that choose their length go with those that see their error */
    bool first = true;
    for (const cpl_scheme *const *scheme = s->settings->schemes; *scheme && used < (int)size; scheme++) {
      const bool needs_n = s->settings->adapt.on && (*scheme)->mismatch_order == 0;
      if (lacks(s, *scheme, CPL_MBD) >= 0 || lacks(s, *scheme, CPL_DEM) >= 0 || needs_n != (with_n == 1))
        continue;
      used += snprintf(out + used, size - (size_t)used, "%s%s",
                       first && with_n ? "; with a given coupling.n "
                       : first         ? ""
                                       : ", ",
                       (*scheme)->name);
      first = false;
    }
  }
  return out;
}

/* A role's solver lacks what the scheme needs, and there is no other to take. */
static tdm_status refuse(const cpl_session *s, int role, int missing, tdm_error *err) {
  const cpl_scheme *scheme = s->scheme, *fallback = s->settings->fallback;
  const bool by_settings = !(scheme->needs[role] & (1u << missing));
  char path[64], others[256];
  snprintf(path, sizeof path, "coupling.%s",
           by_settings                     ? scheme->name
           : scheme == s->settings->scheme ? "scheme"
                                           : "fallback");
  return tdm_fail(err, TDM_ERR_SCENE, path,
                  "the scheme %s needs the capability \"%s\"%s, which %s does not have; take %sanother solver, or a "
                  "scheme that both support (%s)%s",
                  scheme->name, cpl_need_names[missing], by_settings ? " for its settings" : "",
                  cpl_session_name(s, (cpl_role)role), by_settings ? "other settings, " : "",
                  cpl_session_schemes(s, others, sizeof others), fallback ? "" : ", also as coupling.fallback");
}

const cpl_extra cpl_extras[CPL_NEXTRA] = {
    {.name = "acceleration", .need = CPL_ACCELERATION, .per_body = true},
    {.name = "mobility", .need = CPL_MOBILITY},
    {.name = "interface", .need = CPL_INTERFACE, .always = true, .per_body = true},
    {.name = "energy", .always = true},
    {.name = "matched_load", .per_body = true},
    {.name = "ahead", .always = true, .per_body = true, .may_lack = true}};

/* Further coefficients of the load: of a DEM solver that carries a proxy, if it can and mbd takes so many. */
static bool matches(const cpl_session *s) {
  static const char name[] = "matched_load";
  return s->scheme->needs[CPL_DEM] & CPL_PROXY && cpl_session_has(s, CPL_DEM, name) &&
         cpl_session_has(s, CPL_MBD, name);
}

bool cpl_session_asks(const cpl_session *s, cpl_role role, const char *extra) {
  if (strcmp(extra, "matched_load") == 0)
    return role == CPL_DEM && matches(s);
  for (int i = 0; i < CPL_NEXTRA; i++)
    if (strcmp(cpl_extras[i].name, extra) == 0)
      return (s->scheme->needs[role] | s->further[role]) & cpl_extras[i].need ||
             (cpl_extras[i].always && cpl_session_has(s, role, extra));
  return false;
}

bool cpl_session_sees(const cpl_session *s, cpl_role role, double t) {
  return (s->seen_next || t >= s->seen_from - 1e-6 * s->settings->dt) && cpl_session_has(s, role, "view");
}

bool cpl_session_restores(const cpl_session *s) {
  return cpl_session_needs(s, CPL_MBD) & CPL_RESTORE ||
         (s->settings->adapt.on && cpl_session_has(s, CPL_MBD, "restore") && cpl_session_has(s, CPL_DEM, "restore"));
}

tdm_interpolation cpl_session_interpolation(const cpl_session *s) {
  return s->settings->interpolates ? s->settings->interpolation : s->scheme->interpolation;
}

static bool goes_without(const cpl_scheme *scheme) {
  return !(scheme->needs[CPL_MBD] & CPL_MOBILITY);
}

/* Bodies of this run whose reduced model fits into a message; its size goes with the square of their number. */
static int count_fitting(const cpl_session *s) {
  const size_t room = TDM_FRAME_MAX - (1 << 20); /* the rest of a message: states, samples */
  int most = s->settings->nbody;
  while (8 * tdm_mobility_doubles(&(tdm_mobility){.nbody = most, .nfree = TDM_FREE_MAX}) > room)
    most--;
  return most;
}

bool cpl_session_fits_mobility(const cpl_session *s) {
  return count_fitting(s) == s->settings->nbody;
}

/* The scheme's messages have room for the bodies. */
static tdm_status check_size(const cpl_session *s, tdm_error *err) {
  const int most = count_fitting(s);
  char others[256];
  if (!(s->scheme->needs[CPL_MBD] & CPL_MOBILITY) || most == s->settings->nbody)
    return TDM_OK;
  return tdm_fail(
      err, TDM_ERR_SCENE, "coupling.bodies",
      "has %d entries, but the scheme %s sends how every body moves every other one, and a message has room "
      "for %d; couple fewer bodies (parts that a joint fixes are one), or take %s as coupling.scheme",
      s->settings->nbody, s->scheme->name, most, cpl_scheme_names(s->settings, goes_without, others, sizeof others));
}

tdm_status cpl_session_choose(cpl_session *s, tdm_error *err) {
  const cpl_scheme *wanted = s->settings->scheme, *fallback = s->settings->fallback;
  s->scheme = wanted;
  for (int r = 0; r < CPL_NROLE; r++) {
    const int missing = lacks(s, s->scheme, r);
    if (missing < 0)
      continue;
    if (!fallback || s->scheme == fallback)
      return refuse(s, r, missing, err);
    tdm_remark(TDM_NOTICE, "fallback", "coupling.fallback", 0,
               "the scheme %s needs the capability \"%s\", which %s does not have: %s was taken instead", wanted->name,
               cpl_need_names[missing], cpl_session_name(s, (cpl_role)r), fallback->name);
    s->scheme = fallback;
    r = -1; /* what it needs, of both */
  }
  return check_size(s, err);
}

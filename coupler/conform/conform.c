/* `tandem conform`: see conform.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/conform.h"

#include "coupler/conform/meeting.h"
#include "coupler/run/private.h"
#include "protocol/base/interrupt.h"
#include "protocol/results/results.h"
#include "protocol/version.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const cpl_rule *const tables[] = {cpl_rules_exchange, cpl_rules_mbd,   cpl_rules_mobility, cpl_rules_ahead,
                                         cpl_rules_dem,      cpl_rules_path,  cpl_rules_proxy,    cpl_rules_gravity,
                                         cpl_rules_state,    cpl_rules_faults};
enum { NTABLE = sizeof tables / sizeof tables[0] };

static const char *const words[] = {
    [CPL_KEPT] = "kept", [CPL_BROKEN] = "broken", [CPL_NOT_CLAIMED] = "not claimed", [CPL_NOT_SEEN] = "not seen"};

/* The scene for who gives none: one body of 1 kg that falls, held by nothing, and an empty section of the solver's. */
static const char own_scene[] =
    "{\"time\": {\"end\": 1, \"dt\": 1e-4}, \"coupling\": {\"n\": 10, \"bodies\": [{\"mbd\": \"body\", \"dem\": "
    "\"body\"}]},\n \"mbd\": %s,\n \"dem\": %s}\n";
static const char own_mbd[] =
    "{\"bodies\": [{\"name\": \"body\", \"mass\": 1, \"inertia\": [0.01, 0.02, 0.03], \"position\": [0, 0, 0]}]}";

static tdm_status write_scene(const char *file, cpl_role role, tdm_error *err) {
  FILE *out = fopen(file, "we");
  if (out && fprintf(out, own_scene, role == CPL_MBD ? "{}" : own_mbd, "{}") > 0 && fclose(out) == 0)
    return TDM_OK;
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written", file);
}

/* ---- the role ---- */

/* What the solver's HELLO says: it is started alone. */
static tdm_status find_role(cpl_candidate *c, tdm_error *err) {
  const cpl_settings settings = {.timeout = c->timeout};
  cpl_session session;
  char endpoint[256], log[256];
  snprintf(endpoint, sizeof endpoint, "ipc://%s/server%d", c->dir, c->meetings++);
  snprintf(log, sizeof log, "%s/solver.log", c->dir);
  cpl_session_open(&session, &settings, endpoint, NULL, err);
  cpl_child **child = &session.partner[CPL_MBD].child;
  if (err->status == TDM_OK)
    cpl_launch_process(child, c->command, endpoint, "solver", log, c->timeout, err);
  tdm_header header;
  if (err->status == TDM_OK && cpl_session_wait(&session, CPL_MBD, TDM_HELLO, &header, err) == TDM_OK)
    c->role = session.partner[CPL_DEM].connected ? CPL_DEM : CPL_MBD;
  cpl_child *solver = *child;
  cpl_session_close(&session, err);
  cpl_child_stop(&solver, 1);
  return err->status;
}

static tdm_status choose_role(cpl_candidate *c, const char *role, tdm_error *err) {
  if (!role)
    return find_role(c, err);
  for (int r = 0; r < CPL_NROLE; r++)
    if (strcmp(role, cpl_role_names[r]) == 0) {
      c->role = (cpl_role)r;
      return TDM_OK;
    }
  return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "conform: --role %s: give \"dem\" or \"mbd\"", role);
}

/* ---- the report ---- */

static void print_row(const cpl_rule *rule, const cpl_verdict *v) {
  printf("  %-11s  %-18s %s (section %s)\n", words[v->kind], rule->name, rule->text, rule->section);
  if (v->kind == CPL_BROKEN)
    printf("               expected: %s\n               came:     %s\n", v->expected, v->came);
  else if (v->kind == CPL_NOT_SEEN)
    printf("               %s\n", v->came);
  fflush(stdout);
}

static json_t *row_of(const cpl_rule *rule, const cpl_verdict *v) {
  json_t *row = json_pack("{s:s, s:s, s:s, s:s}", "name", rule->name, "section", rule->section, "text", rule->text,
                          "verdict", words[v->kind]);
  if (v->kind == CPL_BROKEN)
    json_object_set_new(row, "expected", json_string(v->expected));
  if (v->kind == CPL_BROKEN || v->kind == CPL_NOT_SEEN)
    json_object_set_new(row, v->kind == CPL_BROKEN ? "came" : "why", json_string(v->came));
  return row;
}

/* Is this rule among those that are wanted? HELLO tells what is claimed, so it always is. */
static bool is_wanted(const char *const *wanted, const char *name) {
  bool is = !wanted || strcmp(name, "hello") == 0;
  for (; !is && *wanted; wanted++)
    is = strcmp(*wanted, name) == 0;
  return is;
}

static tdm_status check_wanted(const char *const *wanted, tdm_error *err) {
  const char *names[64];
  int n = 0;
  for (size_t t = 0; t < NTABLE; t++)
    for (const cpl_rule *rule = tables[t]; rule->name && n < 64; rule++)
      names[n++] = rule->name;
  for (; wanted && *wanted; wanted++) {
    int k = 0;
    while (k < n && strcmp(*wanted, names[k]) != 0)
      k++;
    const char *near = tdm_nearest(*wanted, names, n);
    if (k == n)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                      "conform: there is no rule \"%s\"%s%s; without --rule all are listed", *wanted,
                      near ? "; did you mean " : "", near ? near : "");
  }
  return TDM_OK;
}

static json_t *test_all(cpl_candidate *c, const char *const *wanted, int count[4]) {
  json_t *rows = json_array();
  for (size_t t = 0; t < NTABLE; t++)
    for (const cpl_rule *rule = tables[t]; rule->name && !tdm_interrupted; rule++) {
      cpl_verdict v = {.kind = CPL_KEPT};
      if (!(rule->roles & 1u << c->role) || !is_wanted(wanted, rule->name))
        continue;
      if (rule->capability && !cpl_claims(c, rule->capability))
        v.kind = CPL_NOT_CLAIMED;
      else
        rule->test(c, &v);
      if (tdm_interrupted)
        break;
      count[v.kind]++;
      print_row(rule, &v);
      json_array_append_new(rows, row_of(rule, &v));
      if (!c->capabilities) /* there was no HELLO: nothing else can be tested */
        return rows;
    }
  return rows;
}

static tdm_status test(cpl_candidate *c, const cpl_conform_options *o, tdm_error *err) {
  int count[4] = {0};
  printf("%s as %s, against version %d of the protocol\n", c->command, cpl_role_names[c->role], TDM_PROTOCOL_VERSION);
  json_t *rows = test_all(c, o->rule, count);
  printf("%d kept, %d broken, %d not claimed, %d not seen\n", count[CPL_KEPT], count[CPL_BROKEN],
         count[CPL_NOT_CLAIMED], count[CPL_NOT_SEEN]);
  json_t *report =
      json_pack("{s:s, s:s, s:s, s:O, s:i, s:i, s:i, s:i, s:o}", "solver", c->command, "role", cpl_role_names[c->role],
                "software", c->software, "capabilities", c->capabilities ? c->capabilities : json_null(), "kept",
                count[CPL_KEPT], "broken", count[CPL_BROKEN], "not_claimed", count[CPL_NOT_CLAIMED], "not_seen",
                count[CPL_NOT_SEEN], "rules", rows);
  if (o->json && report && json_dump_file(report, o->json, JSON_INDENT(2)) != 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written", o->json);
  json_decref(report);
  if (tdm_interrupted)
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted");
  if (err->status == TDM_OK && count[CPL_BROKEN] > 0)
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "%d rule%s of the protocol %s broken", count[CPL_BROKEN],
             count[CPL_BROKEN] == 1 ? "" : "s", count[CPL_BROKEN] == 1 ? "is" : "are");
  return err->status;
}

tdm_status cpl_conform(const cpl_conform_options *o, tdm_error *err) {
  cpl_private own = {0};
  cpl_candidate c = {.scene = o->scene, .set = o->set, .command = o->command, .timeout = o->timeout};
  char scene[256];
  memcpy(c.solver, o->solver, sizeof c.solver);
  if (check_wanted(o->rule, err) != TDM_OK)
    return err->status;
  if ((o->json && tdm_check_writable(o->json, err) != TDM_OK) || cpl_private_make(&own, err) != TDM_OK)
    return err->status;
  c.dir = own.dir;
  if (choose_role(&c, o->role, err) == TDM_OK && !o->scene) {
    snprintf(scene, sizeof scene, "%s/scene.json", own.dir);
    c.scene = scene;
    write_scene(scene, c.role, err);
  }
  if (err->status == TDM_OK && cpl_meeting_check(&c, err) == TDM_OK)
    test(&c, o, err);
  json_decref(c.capabilities);
  free(c.answer);
  cpl_private_remove(&own);
  return err->status;
}

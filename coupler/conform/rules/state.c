/* Rules of states that are kept and brought back, and of what there is to see. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BODIES_MAX = 64 };

typedef enum { ALONG, CARRIED } way; /* DEM moves its bodies along paths, or they stand, each time a little elsewhere */

static bool has_room(const cpl_meeting *m) {
  if (m->settings.nbody > BODIES_MAX)
    cpl_not_seen(m->verdict, "the scene has more coupled bodies than this test takes: 64");
  return m->settings.nbody <= BODIES_MAX;
}

/* A window under some load, or for DEM of some way, w telling them apart. */
static bool some(cpl_meeting *m, way how, int w, tdm_result *r) {
  if (!has_room(m))
    return false;
  tdm_step step = cpl_meeting_next(m, 3 + w);
  const int n = step.nbody;
  tdm_state start[BODIES_MAX], end[BODIES_MAX];
  tdm_wrench load[BODIES_MAX];
  const double time = step.t0 + 0.6 * (step.t1 - step.t0); /* what is summed up since then is part of the state */
  step.sample_time = &time;
  step.nsample = 1;
  step.seen = cpl_claims(m->candidate, "view");
  for (int i = 0; i < n; i++) {
    const tdm_vec3 velocity = {0.01, 0, -0.01};
    start[i] = m->session.body[i].state;
    start[i].twist = (tdm_twist){.velocity = velocity};
    start[i].pose.position = tdm_axpy(step.t0, velocity, start[i].pose.position);
    end[i] = start[i];
    end[i].pose.position = tdm_axpy(step.t1 - step.t0, velocity, start[i].pose.position);
    load[i] = (tdm_wrench){.force = {0.1 * (w + 1), 0.2, -0.1}, .moment = {0, 0.01 * w, 0.01}};
  }
  double *zeros = NULL;
  if (m->candidate->role == CPL_DEM) {
    step.nstate = step.nbody;
    step.start = start;
    step.end = end;
  } else {
    step.nload = 1;
    step.load = load;
  }
  if (m->candidate->role == CPL_DEM && how == CARRIED) {
    tdm_mobility still = {.nbody = n};
    zeros = calloc(tdm_mobility_doubles(&still) + 18 * (size_t)n + 1, sizeof *zeros);
    memset(load, 0, sizeof load);
    for (int i = 0; i < n; i++) {
      start[i] = m->session.body[i].state;
      start[i].twist = (tdm_twist){0};
      start[i].pose.position.z -= 1e-6 * w;
    }
    if (zeros)
      tdm_mobility_point(&still, zeros + 18 * n);
    step.end = start;
    step.has_proxy = true;
    step.proxy = (tdm_proxy){.acceleration = zeros, .load = load, .correction = zeros + 6 * n, .mobility = still};
    if (!zeros)
      return false;
  }
  const bool good = cpl_meeting_solve(m, &step, r);
  free(zeros);
  return good;
}

/* The arrays of the last RESULT, behind those that are kept already. */
static bool keep(const cpl_meeting *m, tdm_frame *kept) {
  const tdm_frame *store = &m->session.partner[m->candidate->role].store;
  uint8_t *grown = realloc(kept->data, kept->size + store->size + 1);
  if (!grown)
    return false;
  kept->data = grown;
  memcpy(grown + kept->size, store->data, store->size);
  kept->size += store->size;
  return true;
}

static bool save_or_restore(cpl_meeting *m, bool save, int slot) {
  tdm_error err = {0};
  const cpl_role role = m->candidate->role;
  if ((save ? cpl_session_save : cpl_session_restore)(&m->session, role, slot, &err) != TDM_OK)
    cpl_broken(m->verdict, save ? "an answer to SAVE" : "an answer to RESTORE", "%s", err.message);
  return err.status == TDM_OK;
}

/* Three windows from `step` on, their arrays in *kept; a slot is saved on the way if `saves`. */
static bool go_on(cpl_meeting *m, way how, uint64_t window, uint64_t step, bool saves, tdm_frame *kept) {
  tdm_result r;
  bool good = true;
  m->window = window;
  m->step = step;
  for (int w = 1; good && w < 4; w++)
    good = some(m, how, w, &r) && keep(m, kept) && (!saves || w != 2 || save_or_restore(m, true, 15));
  return good;
}

static void compare(cpl_verdict *v, const char *expected, const tdm_frame *first, const tdm_frame *again) {
  size_t at = 0;
  while (at < first->size && at < again->size && first->data[at] == again->data[at])
    at++;
  if (at < first->size || at < again->size)
    cpl_broken(v, expected, "they differ from byte %zu of %zu on", at, first->size);
}

/* Save, go on, go back, go on the same way: the same bits, also with a second slot between. */
static void repeat(cpl_candidate *c, way how, cpl_verdict *v) {
  cpl_meeting m;
  tdm_result r;
  tdm_frame first = {0}, again = {0};
  if (!cpl_meeting_open(&m, c, v))
    return;
  bool good = some(&m, how, 0, &r) && save_or_restore(&m, true, 3);
  const uint64_t window = m.window, step = m.step;
  good = good && go_on(&m, how, window, step, true, &first) && save_or_restore(&m, false, 3) &&
         go_on(&m, how, window, step, false, &again);
  if (good)
    compare(v, "the same bits after RESTORE as after SAVE", &first, &again);
  free(first.data);
  free(again.data);
  if (good)
    cpl_meeting_finish(&m);
  else
    cpl_meeting_drop(&m);
}

static void test_repeats(cpl_candidate *c, cpl_verdict *v) {
  repeat(c, ALONG, v);
  if (v->kind == CPL_KEPT && c->role == CPL_DEM && cpl_claims(c, "proxy"))
    repeat(c, CARRIED, v);
}

static void test_empty_slot(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_error err = {0};
  if (!cpl_meeting_open(&m, c, v))
    return;
  if (cpl_session_restore(&m.session, c->role, 7, &err) == TDM_OK)
    cpl_broken(v, "ERROR to a RESTORE of a slot that nothing was saved under", "RESTORE");
  else if (err.status == TDM_ERR_LOST || err.status == TDM_ERR_TIMEOUT)
    cpl_broken(v, "ERROR to a RESTORE of a slot that nothing was saved under", "%s", err.message);
  cpl_meeting_drop(&m);
}

/* ---- checkpoints ---- */

/* CHECKPOINT of a file, and its answer. */
static tdm_status checkpoint(cpl_meeting *m, const char *mode, const char *file, tdm_error *err) {
  tdm_header header;
  tdm_frame frame = {0};
  json_t *question = json_pack("{s:s, s:s}", "file", file, "mode", mode), *answer = NULL;
  if (tdm_control_write(&frame, TDM_CHECKPOINT, 0, question, err) == TDM_OK && cpl_meeting_send(m, &frame) &&
      cpl_session_wait(&m->session, m->candidate->role, TDM_CHECKPOINT, &header, err) == TDM_OK &&
      tdm_control_read(&header, &answer, err) == TDM_OK && !json_equal(question, answer))
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "an answer without \"file\" and \"mode\" as they were asked for");
  json_decref(question);
  json_decref(answer);
  tdm_frame_free(&frame);
  return err->status;
}

static bool write_or_read(cpl_meeting *m, const char *mode, const char *file) {
  tdm_error err = {0};
  if (checkpoint(m, mode, file, &err) != TDM_OK)
    cpl_broken(m->verdict, "an answer to CHECKPOINT", "%s: %s", mode, err.message);
  return err.status == TDM_OK;
}

/* Write, go on, read, go on the same way; and in another process, which reads before its first window. */
static void test_checkpoint(cpl_candidate *c, cpl_verdict *v) {
  char file[512];
  cpl_meeting m;
  tdm_result r;
  tdm_frame first = {0}, again = {0}, elsewhere = {0};
  snprintf(file, sizeof file, "%s/checkpoint", c->dir);
  if (!cpl_meeting_open(&m, c, v))
    return;
  bool good = some(&m, ALONG, 0, &r) && write_or_read(&m, "write", file);
  const uint64_t window = m.window, step = m.step;
  good = good && go_on(&m, ALONG, window, step, false, &first) && write_or_read(&m, "read", file) &&
         go_on(&m, ALONG, window, step, false, &again);
  cpl_meeting_drop(&m);
  if (good)
    compare(v, "the same bits after a checkpoint is read as after it was written", &first, &again);
  if (good && cpl_meeting_open(&m, c, v)) {
    if (write_or_read(&m, "read", file) && go_on(&m, ALONG, window, step, false, &elsewhere))
      compare(v, "the same bits in a run that continues from a checkpoint as in the one that wrote it", &first,
              &elsewhere);
    cpl_meeting_drop(&m);
  }
  remove(file);
  free(first.data);
  free(again.data);
  free(elsewhere.data);
}

static void test_no_checkpoint(cpl_candidate *c, cpl_verdict *v) {
  static const char *const modes[] = {"read", "write"};
  char file[512];
  snprintf(file, sizeof file, "%s/no_such_folder/checkpoint", c->dir);
  for (int k = 0; k < 2; k++) {
    cpl_meeting m;
    tdm_error err = {0};
    if (!cpl_meeting_open(&m, c, v))
      return;
    if (checkpoint(&m, modes[k], file, &err) == TDM_OK)
      cpl_broken(v, "ERROR to a CHECKPOINT of a file that cannot be", "CHECKPOINT (%s)", modes[k]);
    else if (err.status == TDM_ERR_LOST || err.status == TDM_ERR_TIMEOUT)
      cpl_broken(v, "ERROR to a CHECKPOINT of a file that cannot be", "%s: %s", modes[k], err.message);
    cpl_meeting_drop(&m);
  }
}

/* ---- views ---- */

static void test_view(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_header header;
  tdm_error err = {0};
  tdm_result r;
  tdm_scenery scenery = {0};
  tdm_snapshot snapshot = {0};
  if (!cpl_meeting_open(&m, c, v))
    return;
  bool seen = false;
  if (cpl_session_view(&m.session, c->role, CPL_SCENERY, &header, &err) == TDM_OK && header.size > 0)
    seen = tdm_scenery_decode(&scenery, header.payload, header.size, &err) == TDM_OK;
  if (seen && some(&m, ALONG, 0, &r) && cpl_session_view(&m.session, c->role, CPL_SNAPSHOT, &header, &err) == TDM_OK &&
      tdm_snapshot_decode(&snapshot, header.payload, header.size, &err) == TDM_OK)
    tdm_snapshot_check(&snapshot, &scenery, &err);
  if (err.status != TDM_OK)
    cpl_broken(v, "a scenery and a snapshot as section 10 has them", "%s", err.message);
  else if (!seen)
    cpl_not_seen(v, "it has no scenery");
  tdm_scenery_free(&scenery);
  tdm_snapshot_free(&snapshot);
  cpl_meeting_drop(&m);
}

/* The one contact of a particle (k among those of the snapshot); NULL: none, or more. */
static const tdm_view_contact *only_contact(const tdm_snapshot *s, int k) {
  const tdm_view_contact *found = NULL;
  int n = 0;
  for (int i = 0; i < s->ncontact; i++)
    if (s->contact[i].particle == s->id[k] || s->contact[i].other == s->id[k]) {
      found = &s->contact[i];
      n++;
    }
  return n == 1 ? found : NULL;
}

/* A particle that one contact alone pushes feels the contact's force, away from the other one. */
static void look_at_contacts(const tdm_snapshot *s, cpl_verdict *v) {
  bool seen = false;
  double largest = 0;
  for (int i = 0; i < s->ncontact; i++)
    largest = fmax(largest, fabs(s->contact[i].force));
  for (int k = 0; k < s->nparticle && k < 1000; k++) {
    const tdm_view_contact *contact = only_contact(s, k);
    if (!contact || fabs(contact->force) < 1e-3 * largest || largest == 0)
      continue;
    seen = true;
    const double sign = contact->particle == s->id[k] ? -1 : 1;
    const double is = sign * tdm_dot(s->force[k], tdm_unit(tdm_sub(contact->to, contact->from)));
    if (fabs(is - contact->force) >
        0.5 * fmax(fabs(is), fabs(contact->force))) /* it may be from before the last kick */
      cpl_broken(v, "a contact's force > 0 where it pushes its particle away from the other one",
                 "particle %lld: %g N, on the particle act %g N", (long long)s->id[k], contact->force, is);
  }
  if (!seen)
    cpl_not_seen(v, "no particle has a contact of its own in this scene");
}

static void test_contacts(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_header header;
  tdm_error err = {0};
  tdm_result r;
  tdm_snapshot snapshot = {0};
  if (!cpl_meeting_open(&m, c, v))
    return;
  if (some(&m, ALONG, 0, &r) &&
      cpl_session_view(&m.session, c->role, CPL_SNAPSHOT_WITH_CONTACTS, &header, &err) == TDM_OK && header.size > 0 &&
      tdm_snapshot_decode(&snapshot, header.payload, header.size, &err) == TDM_OK)
    look_at_contacts(&snapshot, v);
  else if (err.status != TDM_OK)
    cpl_broken(v, "a snapshot with contacts as section 10 has it", "%s", err.message);
  else
    cpl_not_seen(v, "it has no snapshot");
  tdm_snapshot_free(&snapshot);
  cpl_meeting_drop(&m);
}

const cpl_rule cpl_rules_state[] = {{.name = "restore",
                                     .section = "9",
                                     .roles = CPL_OF_BOTH,
                                     .capability = "restore",
                                     .text = "what follows RESTORE has the bits of what followed SAVE",
                                     .test = test_repeats},
                                    {.name = "restore.empty",
                                     .section = "9",
                                     .roles = CPL_OF_BOTH,
                                     .capability = "restore",
                                     .text = "RESTORE of an empty slot is an ERROR",
                                     .test = test_empty_slot},
                                    {.name = "checkpoint",
                                     .section = "9",
                                     .roles = CPL_OF_BOTH,
                                     .capability = "checkpoint",
                                     .text = "a run goes on from its checkpoint bit for bit",
                                     .test = test_checkpoint},
                                    {.name = "checkpoint.none",
                                     .section = "9",
                                     .roles = CPL_OF_BOTH,
                                     .capability = "checkpoint",
                                     .text = "a CHECKPOINT that cannot be is an ERROR",
                                     .test = test_no_checkpoint},
                                    {.name = "view",
                                     .section = "10",
                                     .roles = CPL_OF_BOTH,
                                     .capability = "view",
                                     .text = "there is something to see",
                                     .test = test_view},
                                    {.name = "view.contacts",
                                     .section = "10",
                                     .roles = CPL_OF_DEM,
                                     .capability = "view",
                                     .text = "contacts push their particles as they say",
                                     .test = test_contacts},
                                    {.name = NULL}};

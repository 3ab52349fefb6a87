/* The solvers of an FMU's side: see stage.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/serve/stage.h"

#include "coupler/scheme/schemes.h"
#include "protocol/parameters/load.h"

#include <stdio.h>
#include <string.h>

static const double grace = 3; /* time that solvers get to end after FINISH [s] */

tdm_status cpl_stage_load(cpl_stage *s, cpl_export_side side, unsigned roles, const char *scene, const char *const *set,
                          tdm_error *err) {
  *s = (cpl_stage){.side = side};
  if (tdm_scene_load(&s->scene, scene, set, err) == TDM_OK &&
      cpl_settings_read(&s->settings, &s->scene, cpl_schemes, err) == TDM_OK)
    for (int r = 0; r < CPL_NROLE && err->status == TDM_OK; r++)
      if (s->settings.by_hand[r] && roles & 1u << r)
        tdm_fail(err, TDM_ERR_SCENE, s->settings.solver_path[r],
                 "is null: export and FMUs start the solvers themselves; name a command, or leave it out");
  tdm_scene_locate(&s->scene, err);
  return err->status;
}

tdm_status cpl_stage_open(cpl_stage *s, tdm_error *err) {
  char endpoint[256];
  if (s->open)
    return TDM_OK;
  if (!s->own.dir[0] && cpl_private_make(&s->own, err) != TDM_OK)
    return err->status;
  snprintf(endpoint, sizeof endpoint, "ipc://%s/server", s->own.dir);
  s->open = true;
  if (cpl_session_open(&s->session, &s->settings, endpoint, NULL, err) != TDM_OK)
    return err->status;
  s->alone = (cpl_scheme){.name = "export", .interpolation = TDM_HERMITE};
  s->session.scheme = &s->alone;
  tdm_progress_begin(&s->session.progress, 0, "", !s->talks);
  return TDM_OK;
}

tdm_status cpl_stage_bodies(cpl_stage *s, json_t *bodies, tdm_error *err) {
  tdm_frame frame = {0};
  tdm_header header;
  json_t *ready = json_pack("{s:O, s:[], s:[]}", "bodies", bodies, "loads", "channels");
  if (!ready)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  else if (tdm_control_write(&frame, TDM_READY, 0, ready, err) == TDM_OK &&
           tdm_header_read(&header, frame.data, frame.size, err) == TDM_OK)
    cpl_session_read_ready(&s->session, CPL_MBD, &header, err);
  json_decref(ready);
  tdm_frame_free(&frame);
  return err->status;
}

static tdm_status launch(cpl_stage *s, int role, const char *program, tdm_error *err) {
  char log[256], text[256];
  const char *command = cpl_launch_command(&s->settings, (cpl_role)role, program, text, sizeof text);
  snprintf(log, sizeof log, "%s/%s.log", s->own.dir, cpl_role_names[role]);
  cpl_launch_process(&s->session.partner[role].child, command, tdm_transport_endpoint(s->session.transport),
                     cpl_role_names[role], log, s->settings.timeout, err);
  if (err->status != TDM_OK && s->settings.command[role])
    snprintf(err->path, sizeof err->path, "%s", s->settings.solver_path[role]);
  return err->status;
}

/* What the FMU tells beside what its exchange needs: accelerations, how loads change them, states that are kept. */
static void ask_for_more(cpl_stage *s, unsigned roles) {
  cpl_session *session = &s->session;
  bool all_restore = true;
  s->restores = true;
  for (int r = 0; r < CPL_NROLE; r++) {
    const bool restores = !(roles & 1u << r) || cpl_session_has(session, (cpl_role)r, "restore");
    s->restores = s->restores && (restores || !cpl_export_has(s->side, (cpl_role)r));
    all_restore = all_restore && restores;
  }
  if (all_restore)
    session->further[CPL_MBD] |= CPL_RESTORE; /* that is where the session looks, for all */
  if (s->side == CPL_EXPORT_DEM || !cpl_session_has(session, CPL_MBD, "acceleration"))
    return;
  session->further[CPL_MBD] |= CPL_ACCELERATION;
  if (cpl_session_has(session, CPL_MBD, "mobility") && cpl_session_fits_mobility(session))
    session->further[CPL_MBD] |= CPL_MOBILITY; /* without accelerations there is nothing that it changes */
}

tdm_status cpl_stage_start(cpl_stage *s, unsigned roles, const char *const program[CPL_NROLE], tdm_error *err) {
  cpl_stage_open(s, err);
  for (int r = 0; r < CPL_NROLE && err->status == TDM_OK; r++)
    if (roles & 1u << r)
      launch(s, r, program[r], err);
  for (int r = 0; r < CPL_NROLE && err->status == TDM_OK; r++)
    if (roles & 1u << r)
      cpl_session_meet(&s->session, (cpl_role)r, err);
  if (err->status == TDM_OK && s->side == CPL_EXPORT_BOTH)
    cpl_session_choose(&s->session, err);
  if (err->status == TDM_OK)
    ask_for_more(s, roles);
  for (int r = 0; r < CPL_NROLE && err->status == TDM_OK; r++)
    if (roles & 1u << r)
      cpl_session_assign(&s->session, (cpl_role)r, &s->scene, err);
  tdm_progress_end(&s->session.progress);
  if (err->status == TDM_OK && s->side == CPL_EXPORT_BOTH)
    cpl_session_compare(&s->session);
  return err->status;
}

void cpl_stage_stop(cpl_stage *s, const tdm_error *err) {
  cpl_child *child[CPL_NROLE]; /* the session forgets them */
  if (!s->open)
    return;
  for (int r = 0; r < CPL_NROLE; r++)
    child[r] = s->session.partner[r].child;
  cpl_session_close(&s->session, err);
  for (int r = 0; r < CPL_NROLE; r++)
    cpl_child_stop(&child[r], err && err->status != TDM_OK ? 0.5 : grace);
  s->open = false;
}

void cpl_stage_free(cpl_stage *s) {
  cpl_stage_stop(s, NULL);
  cpl_private_remove(&s->own);
  cpl_settings_free(&s->settings);
  tdm_scene_destroy(&s->scene);
}

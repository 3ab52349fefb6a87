/* What both solvers have to see: see eyes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/eyes.h"

#include "protocol/scene/remark.h"

/* Ask a solver and decode its answer. *seen: there was one. An error is one of the session, and ends the run. */
static tdm_status ask(cpl_eyes *e, cpl_role role, bool scenery, double t, bool *seen, tdm_error *err) {
  tdm_header header;
  tdm_error own = {0};
  *seen = false;
  const cpl_sight sight = scenery ? CPL_SCENERY : e->with_contacts ? CPL_SNAPSHOT_WITH_CONTACTS : CPL_SNAPSHOT;
  if (cpl_session_view(e->session, role, sight, &header, err) != TDM_OK)
    return err->status;
  if (header.size == 0) /* it has said why */
    return TDM_OK;
  if (scenery)
    tdm_scenery_decode(&e->scenery[role], header.payload, header.size, &own);
  else if (tdm_snapshot_decode(&e->snapshot[role], header.payload, header.size, &own) == TDM_OK)
    tdm_snapshot_check(&e->snapshot[role], &e->scenery[role], &own);
  *seen = own.status == TDM_OK;
  if (!*seen)
    tdm_remark(TDM_WARNING, "unseen", NULL, t, "what %s tells of what there is to see is of no use: %.800s",
               cpl_session_name(e->session, role), own.message);
  return TDM_OK;
}

tdm_status cpl_eyes_open(cpl_eyes *e, const cpl_settings *settings, cpl_session *session, tdm_scenery *both,
                         tdm_error *err) {
  e->session = session;
  for (int r = 0; r < CPL_NROLE; r++) {
    if (!cpl_session_has(session, (cpl_role)r, "view"))
      tdm_remark(TDM_NOTICE, "unseen", NULL, 0,
                 "%s does not have the capability \"view\": frames and pictures are without what is in it",
                 cpl_session_name(session, (cpl_role)r));
    else if (ask(e, (cpl_role)r, true, 0, &e->sees[r], err) != TDM_OK)
      return err->status;
    if (!e->sees[r])
      tdm_scenery_clear(&e->scenery[r]);
  }
  return cpl_join_sceneries(&e->join, settings, e->scenery, both, err);
}

tdm_status cpl_eyes_look(cpl_eyes *e, double t, tdm_snapshot *both, bool *seen, tdm_error *err) {
  *seen = true;
  e->with_contacts = both->with_contacts;
  for (int r = 0; r < CPL_NROLE; r++) {
    bool answers = true;
    if (e->sees[r] && ask(e, (cpl_role)r, false, t, &answers, err) != TDM_OK)
      return err->status;
    *seen = *seen && answers;
  }
  if (*seen && cpl_join_snapshots(&e->join, e->snapshot, both, err) == TDM_OK)
    both->time = t;
  return err->status;
}

void cpl_eyes_free(cpl_eyes *e) {
  for (int r = 0; r < CPL_NROLE; r++) {
    tdm_scenery_free(&e->scenery[r]);
    tdm_snapshot_free(&e->snapshot[r]);
  }
  cpl_join_free(&e->join);
}

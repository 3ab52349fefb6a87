/* Observers of the coupled loop: see observer.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/observer.h"

tdm_status cpl_observers_open(cpl_observers *o, const cpl_observer *row, const cpl_loop *loop, const cpl_outlet *outlet,
                              tdm_error *err) {
  if (o->count == CPL_OBSERVERS_MAX)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "more than %d observers of a run", CPL_OBSERVERS_MAX);
  const int k = o->count++;
  o->row[k] = row;
  o->own[k] = NULL;
  return row->open ? row->open(row, loop, outlet, &o->own[k], err) : TDM_OK;
}

tdm_status cpl_observers_window(const cpl_observers *o, const cpl_loop *loop, tdm_error *err) {
  for (int k = 0; k < o->count; k++)
    if (o->row[k]->window && o->row[k]->window(o->own[k], loop, err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

void cpl_observers_end(const cpl_observers *o, const cpl_loop *loop, tdm_error *err) {
  const bool failed = err->status != TDM_OK;
  for (int k = 0; k < o->count; k++)
    if (failed && o->row[k]->failed)
      o->row[k]->failed(o->own[k], loop, err);
    else if (!failed && o->row[k]->done)
      o->row[k]->done(o->own[k], loop);
  for (int k = 0; k < o->count; k++)
    if (o->row[k]->close)
      o->row[k]->close(o->own[k], err);
}

void cpl_observers_enter(const cpl_observers *o, json_t *summary) {
  for (int k = 0; k < o->count; k++)
    if (o->row[k]->enter)
      o->row[k]->enter(o->own[k], summary);
}

void cpl_observers_free(cpl_observers *o) {
  for (int k = 0; k < o->count; k++)
    if (o->row[k]->free)
      o->row[k]->free(o->own[k]);
  o->count = 0;
}

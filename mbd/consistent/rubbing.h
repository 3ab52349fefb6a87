/* Friction by reactions that depend on friction. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_CONSISTENT_RUBBING_H
#define MBD_CONSISTENT_RUBBING_H

#include "mbd/consistent/kkt.h"

/* After a solution for the accelerations without any reaction in the normal forces, with kkt's factors at time t: what
 * the reactions make of friction, which changes the reactions, and so on, into data's acceleration, lambda, wrench and
 * normal forces. Newton's method on the normal forces of what slides. false: it finds none, as where friction jams a
 * joint that moves (Painleve's paradox). */
bool mbd_rubbing_respond(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t);

/* Refuse friction by a reaction that redundant rows leave undetermined, at data's assembled state. */
tdm_status mbd_rubbing_check(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, tdm_error *err);

#endif

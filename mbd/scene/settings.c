/* Reading the settings of the integrator: see settings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/scene/settings.h"

#include "mbd/integrate/integrator.h"

static void read_guard(mbd_guard_settings *guard, tdm_object *section) {
  static const char *const actions[] = {"stop", "warn", "off"};
  tdm_object o = tdm_get_object(section, "guard", false);
  guard->energy = tdm_get_number(&o, "energy", 0.1, TDM_POSITIVE);
  guard->action = (mbd_guard_action)tdm_get_choice(&o, "action", actions, 3, MBD_GUARD_STOP);
  tdm_object_close(&o);
}

void mbd_settings_read(mbd_settings *s, tdm_object *section, const mbd_model *model, bool coupled) {
  const char *formulations[MBD_FORMULATIONS];
  static const char *const correctors[] = {"original", "modified"};
  for (int i = 0; i < MBD_FORMULATIONS; i++)
    formulations[i] = mbd_formulation_table[i].name;
  bool named = tdm_has(section, "formulation") || tdm_has(section, "corrector");
  s->formulation = (mbd_formulation_id)tdm_get_choice(section, "formulation", formulations, MBD_FORMULATIONS, MBD_GGL);
  s->modified = tdm_get_choice(section, "corrector", correctors, 2, s->formulation == MBD_INDEX3) == 1;
  s->restart_each_window = tdm_get_bool(section, "restart_each_window", false);
  read_guard(&s->guard, section);
  tdm_object o = tdm_get_object(section, "solver", false);
  s->relative_tolerance = tdm_get_number(&o, "relative_tolerance", 1e-8, TDM_POSITIVE);
  s->absolute_tolerance = tdm_get_number(&o, "absolute_tolerance",
                                         fmax(0.01 * s->relative_tolerance, mbd_model_finest(model)), TDM_POSITIVE);
  named = tdm_has(&o, "max_order") || named; /* as the corrector, it is of IDA alone */
  s->max_order = (int)tdm_get_integer(&o, "max_order", 5, 1);
  s->max_step = tdm_get_number(&o, "max_step", 0, TDM_NOT_NEGATIVE);
  s->spectral_radius = tdm_get_number(&o, "spectral_radius", 0.8, TDM_NOT_NEGATIVE);
  tdm_object_close(&o);
  if (!o.err->status && s->modified && s->formulation == MBD_ONE_STEP)
    tdm_object_fail(section, "corrector",
                    "\"modified\" is for ggl and index3; one_step has no corrector of its own: remove the key, or use "
                    "\"original\"");
  if (!o.err->status && s->max_order > 5)
    tdm_object_fail(&o, "max_order", "must be 1 to 5: backward differentiation formulas above 5 are not stable enough");
  if (!o.err->status && s->spectral_radius > 1)
    tdm_object_fail(&o, "spectral_radius", "is %g; use 0 (most damping) to 1 (none)", s->spectral_radius);
  if (!o.err->status && (s->relative_tolerance < 1e-13 || s->relative_tolerance > 0.1))
    tdm_object_fail(&o, "relative_tolerance", "is %g; use 1e-13 to 0.1", s->relative_tolerance);
  if (coupled && !named)
    s->formulation = MBD_ONE_STEP;
}

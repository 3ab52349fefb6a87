/* The table of observers: see observer.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/observer.h"

#include <stddef.h>

const cpl_observer *cpl_observers[CPL_OBSERVERS_MAX + 1] = {
    &cpl_observer_record, /* time histories */
    &cpl_observer_ledger, /* what goes through the interface, and whether energy comes from nowhere */
};

bool cpl_observer_register(const cpl_observer *observer) {
  for (int i = 0; i < CPL_OBSERVERS_MAX; i++)
    if (!cpl_observers[i]) {
      cpl_observers[i] = observer;
      return true;
    }
  return false;
}

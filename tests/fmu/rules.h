/* The rules of FMI 2.0 and 3.0 for a modelDescription.xml of co-simulation, as far as tandem's own have what they speak
 * of. Written from the standards' text (FMI 2.0.4 Sections 2.2 and 4.3, FMI 3.0.2 Sections 2.4 and 4.4). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_FMU_RULES_H
#define TEST_FMU_RULES_H

#include <stddef.h>

/* The first rule that a description breaks, "": it keeps all. In `out` (size bytes), which is returned. */
const char *fmu_rules_broken(const char *xml, char *out, size_t size);

#endif

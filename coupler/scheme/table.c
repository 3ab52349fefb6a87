/* The table of coupling schemes: see schemes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/schemes.h"

#include <stddef.h>

const cpl_scheme *const cpl_schemes[] = {
#define X(name) &cpl_scheme_##name,
    CPL_SCHEME_LIST(X)
#undef X
        NULL,
};

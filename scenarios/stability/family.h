/* A family of cases: one scene, and values of its parameters.
 *
 * families/NAME.json: {"title", "scene", "file", "column", "floor", "cases": [...],
 * "full": [...]}. A case is an object of parameters; one with lists stands for all combinations. "full" are those of
 * --full alone. `column` of the result `file` is what runs are compared by; differences below `floor` (its unit) are
 * nothing.
 *
 * Every scene has the parameters dt and H, step and window [s], ratio, mass of the particles over that of the body, and
 * nudge, by which the start is off by a relative amount. Where windows of length H may be too long, or steps, for the
 * models that schemes stand on, parameters say so by the scene's own numbers, 1 or 0: beyond, coarse (README.md).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_STABILITY_FAMILY_H
#define SCN_STABILITY_FAMILY_H

#include "coupler/verify/verify.h"

typedef struct {
  char name[96]; /* "ratio=10 H=0.001" */
  json_t *set;   /* object: parameters and their values */
  int physics;   /* cases that differ in H alone have the same number */
} scn_stability_case;

/* Zero-initialise; free with scn_family_free also after an error. */
typedef struct {
  json_t *json; /* the file, whose texts the following are */
  const char *title;
  char scene[4096];
  const char *file, *column;
  double floor;
  int ncase, nphysics;
  scn_stability_case *at; /* (ncase) */
} scn_family;

/* Read the family `name`; `full`: with the cases of --full. */
tdm_status scn_family_read(scn_family *f, const cpl_verify *v, const char *name, bool full, tdm_error *err);
void scn_family_free(scn_family *f);

#endif

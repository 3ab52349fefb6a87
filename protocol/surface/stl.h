/* Reading and writing STL files: loose triangles, as text or binary.
 *
 * A file whose size is exactly 84 + 50 n bytes for the n in its header is binary, also when it begins with "solid"
 * (many programs write that); else one that begins with "solid" and has no zero bytes at its beginning is text. The
 * normals of the file are ignored: the corners' order gives them.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_SURFACE_STL_H
#define TDM_SURFACE_STL_H

#include "protocol/base/status.h"
#include "protocol/math/vec3.h"

typedef struct {
  int count;
  tdm_vec3 *corner; /* (count x 3) in the file's order, times the scale [m] */
} tdm_stl;

/* Read `file`, every coordinate times `scale`. An error names the file and its line or byte; `path` is the scene key
 * that named the file, or NULL. The caller destroys *stl (also after an error). */
tdm_status tdm_stl_read(tdm_stl *stl, const char *file, double scale, const char *path, tdm_error *err);

/* Write a binary file; coordinates are rounded to float32. */
tdm_status tdm_stl_write(const tdm_stl *stl, const char *file, tdm_error *err);

void tdm_stl_destroy(tdm_stl *stl);

#endif

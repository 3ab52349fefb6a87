/* What the viewer's page is shown, packed: the bytes that web/data.js reads. The page of a run that is over has them as
 * base64, the live view sends them as they are.
 *
 * Little-endian, without gaps. A frame is the state of one instant; a roster is what particles keep (id, radius,
 * material, place of birth), made again only when particles came or went. Sizes of n particles, b bodies, l lines, p
 * points, q polygons with c corners in all:
 *
 *   frame    u32 version, serial of its roster; f64 time; u32 n, b, l, p; f32 low (3), size (3) of the particles' box;
 *            f32 scale of velocity, spin, force; f32 greatest speed, spin, force, load on a body;
 *            f32 pose (7 b: x y z, w x y z); f32 load of the particles (3 b; NaN: not known); u32 line end (l);
 *            f32 point (3 p); u16 position (3 n) in the box; f16 velocity, spin, force (3 n each) by their scales
 *   roster   u32 version, serial, n, 0; f32 low (3), size (3) of the box of births; u32 id (n); f32 radius (n);
 *            u16 born (3 n) in that box; u8 material (n); i8 size class (n)
 *   surface  u32 version, q, c, 0; u32 body (q); u32 corners + 256 if solid (q); f32 corner (3 c)
 *
 * Positions are exact to 1/65535 of the box, vectors to three digits whatever their size.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_PAGE_PACK_H
#define CPL_PAGE_PACK_H

#include "protocol/view/view.h"

enum { CPL_PACK_VERSION = 1 };

/* A number in half precision, rounded to nearest; what is too large becomes infinite. */
uint16_t cpl_pack_half(float x);

/* Put each in place of what `bytes` holds. The snapshot belongs to the scenery. TDM_ERR_MEMORY. */
tdm_status cpl_pack_frame(const tdm_scenery *scenery, const tdm_snapshot *snapshot, uint32_t roster,
                          tdm_view_bytes *bytes, tdm_error *err);
tdm_status cpl_pack_roster(const tdm_snapshot *snapshot, uint32_t serial, tdm_view_bytes *bytes, tdm_error *err);
tdm_status cpl_pack_surface(const tdm_scenery *scenery, tdm_view_bytes *bytes, tdm_error *err);

/* Whether the roster of one snapshot is that of another. */
bool cpl_pack_same_roster(const tdm_snapshot *a, const tdm_snapshot *b);

#endif

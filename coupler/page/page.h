/* The viewer's page: one file of HTML that needs no network. `tandem view` and the live view write the same one; they
 * differ in where its script finds the data.
 *
 *   <script type="application/json" id="meta">     what there is (cpl_page_meta)
 *   <script type="text/plain" id="surface">        base64 of cpl_pack_surface
 *   ... id="frame0", "frame1", ...                 of cpl_pack_frame
 *   ... id="roster0", ...                          of cpl_pack_roster
 *   ... id="channels0", ...                        of cpl_channels_pack
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_PAGE_PAGE_H
#define CPL_PAGE_PAGE_H

#include "protocol/view/view.h"

#include <jansson.h>
#include <stdio.h>

/* Everything up to the data, and everything behind it; the title is any text. */
void cpl_page_begin(FILE *page, const char *title);
void cpl_page_end(FILE *page);

/* Data blocks. The id is plain; the JSON may hold any text. */
void cpl_page_json(FILE *page, const char *id, const json_t *json);
void cpl_page_bytes(FILE *page, const char *id, const tdm_view_bytes *bytes);

/* {"bodies": [{"name", "dem", "mbd", "still", "marked"}], "lines": [{"name", "kind", "text"}], "materials": [names],
 * "edges": [m], "gravity": [m/s2]} (new reference; NULL: out of memory) */
json_t *cpl_page_scenery(const tdm_scenery *scenery);

#endif

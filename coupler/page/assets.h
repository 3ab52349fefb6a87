/* The page's fixed parts, taken into the program when it is built: our own (web/) and three.js from Debian. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_PAGE_ASSETS_H
#define CPL_PAGE_ASSETS_H

typedef struct {
  const char *name;       /* of the file */
  const char *text, *end; /* its first byte, and the one behind its last */
} cpl_asset;

/* page.html, page.css, the scripts in the order in which they are to run; a NULL name ends the list. */
extern const cpl_asset cpl_assets[];

/* The asset of that name, which is there. */
const cpl_asset *cpl_asset_of(const char *name);

#endif

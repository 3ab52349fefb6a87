/* The page's fixed parts: see assets.h. The assembler takes them in as they lie in their files. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/page/assets.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

/* symbol, name, file; the folder CPL_WEB and the files of three.js are named by the build, which also knows that this
 * file is to be compiled anew when one of them changes (coupler/CMakeLists.txt) */
#define ASSETS(X)                                 \
  X(html, "page.html", CPL_WEB "/page.html")      \
  X(css, "page.css", CPL_WEB "/page.css")         \
  X(three, "three.min.js", CPL_THREE)             \
  X(orbit, "OrbitControls.js", CPL_ORBIT)         \
  X(data, "data.js", CPL_WEB "/data.js")          \
  X(live, "live.js", CPL_WEB "/live.js")          \
  X(colours, "colours.js", CPL_WEB "/colours.js") \
  X(grains, "grains.js", CPL_WEB "/grains.js")    \
  X(machine, "machine.js", CPL_WEB "/machine.js") \
  X(space, "space.js", CPL_WEB "/space.js")       \
  X(curves, "curves.js", CPL_WEB "/curves.js")    \
  X(page, "page.js", CPL_WEB "/page.js")

#define X(symbol, name, file)                                                                                  \
  __asm__(".pushsection .rodata,\"a\"\n.global cpl_asset_" #symbol "\ncpl_asset_" #symbol ":\n.incbin \"" file \
          "\"\n.global cpl_asset_end_" #symbol "\ncpl_asset_end_" #symbol ":\n.byte 0\n.popsection\n");        \
  extern const char cpl_asset_##symbol[], cpl_asset_end_##symbol[];
ASSETS(X)
#undef X

const cpl_asset cpl_assets[] = {
#define X(symbol, name, file) {name, cpl_asset_##symbol, cpl_asset_end_##symbol},
    ASSETS(X)
#undef X
        {NULL, NULL, NULL}};

const cpl_asset *cpl_asset_of(const char *name) {
  const cpl_asset *a = cpl_assets;
  while (a->name && strcmp(a->name, name) != 0)
    a++;
  assert(a->name);
  return a;
}

/* The viewer's page: see page.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/page/page.h"

#include "coupler/page/assets.h"

#include <stdlib.h>
#include <string.h>

/* ---- text ---- */

static void put(FILE *page, const char *text, size_t size) {
  fwrite(text, 1, size, page);
}

/* Text in which HTML finds no tag. */
static void put_escaped(FILE *page, const char *text) {
  for (; *text; text++)
    if (*text == '<' || *text == '&')
      fprintf(page, "&#%d;", *text);
    else
      fputc(*text, page);
}

void cpl_page_begin(FILE *page, const char *title) {
  const cpl_asset *html = cpl_asset_of("page.html"), *css = cpl_asset_of("page.css");
  fputs("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<link rel=\"icon\" href=\"data:,\">\n<title>",
        page);
  put_escaped(page, title);
  fputs("</title>\n<style>\n", page);
  put(page, css->text, (size_t)(css->end - css->text));
  fputs("</style>\n</head>\n<body>\n", page);
  put(page, html->text, (size_t)(html->end - html->text));
}

void cpl_page_end(FILE *page) {
  for (const cpl_asset *a = cpl_assets; a->name; a++) {
    const size_t n = strlen(a->name);
    if (strcmp(a->name + n - 3, ".js") != 0)
      continue;
    fputs("<script>\n", page);
    put(page, a->text, (size_t)(a->end - a->text));
    fputs("</script>\n", page);
  }
  fputs("</body>\n</html>\n", page);
}

/* ---- data ---- */

void cpl_page_json(FILE *page, const char *id, const json_t *json) {
  char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(9));
  fprintf(page, "<script type=\"application/json\" id=\"%s\">", id);
  for (const char *c = text ? text : "null"; *c; c++) /* in JSON a tag can begin in strings only */
    if (*c == '<')
      fputs("\\u003c", page);
    else
      fputc(*c, page);
  fputs("</script>\n", page);
  free(text);
}

void cpl_page_bytes(FILE *page, const char *id, const tdm_view_bytes *bytes) {
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char out[4096];
  size_t n = 0;
  fprintf(page, "<script type=\"text/plain\" id=\"%s\">", id);
  for (size_t i = 0; i < bytes->size; i += 3) {
    const size_t left = bytes->size - i;
    const uint8_t *b = bytes->data + i;
    const uint32_t x = (uint32_t)b[0] << 16 | (left > 1 ? (uint32_t)b[1] << 8 : 0) | (left > 2 ? b[2] : 0);
    out[n++] = digit[x >> 18];
    out[n++] = digit[x >> 12 & 63];
    out[n++] = left > 1 ? digit[x >> 6 & 63] : '=';
    out[n++] = left > 2 ? digit[x & 63] : '=';
    if (n == sizeof out) {
      put(page, out, n);
      n = 0;
    }
  }
  put(page, out, n);
  fputs("</script>\n", page);
}

/* ---- the scenery ---- */

/* a name that came with a file, as good text */
static json_t *name_of(const char *from) {
  char name[TDM_VIEW_NAME_MAX];
  snprintf(name, sizeof name, "%s", from);
  tdm_utf8_clean(name);
  return json_string(name);
}

json_t *cpl_page_scenery(const tdm_scenery *s) {
  static const char *const kinds[] = {
#define X(name, text) #name,
      TDM_VIEW_LINE_LIST(X)
#undef X
  };
  static const char *const texts[] = {
#define X(name, text) text,
      TDM_VIEW_LINE_LIST(X)
#undef X
  };
  json_t *bodies = json_array(), *lines = json_array(), *materials = json_array(), *edges = json_array();
  for (int i = 0; i < s->nbody; i++) {
    const tdm_view_body *b = &s->body[i];
    json_array_append_new(bodies, json_pack("{s:o, s:b, s:b, s:b, s:b}", "name", name_of(b->name), "dem", b->dem, "mbd",
                                            b->mbd, "still", b->still, "marked", b->marked));
  }
  for (int i = 0; i < s->nline; i++)
    json_array_append_new(lines, json_pack("{s:o, s:s, s:s}", "name", name_of(s->line[i].name), "kind",
                                           kinds[s->line[i].kind], "text", texts[s->line[i].kind]));
  for (int i = 0; i < s->nmaterial; i++)
    json_array_append_new(materials, name_of(s->material[i].name));
  for (int i = 0; i < s->nedge; i++)
    json_array_append_new(edges, json_real(s->edge[i]));
  return json_pack("{s:o, s:o, s:o, s:o, s:[f,f,f]}", "bodies", bodies, "lines", lines, "materials", materials, "edges",
                   edges, "gravity", s->gravity.x, s->gravity.y, s->gravity.z);
}

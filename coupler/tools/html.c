/* The little HTML that reports and sweeps write: see html.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/tools/html.h"

#include <string.h>

void cpl_html_head(FILE *page, const char *title) {
  fputs("<!doctype html>\n<meta charset=\"utf-8\">\n<title>", page);
  cpl_html_text(page, title);
  fputs("</title>\n<style>body{font-family:sans-serif;margin:2em "
        "auto;max-width:80em}img{display:block;max-width:60em;width:100%}"
        "td,th{padding:0.2em 0.8em;text-align:right}.good{background:#cdeccd}</style>\n<h1>",
        page);
  cpl_html_text(page, title);
  fputs("</h1>\n", page);
}

void cpl_html_text(FILE *page, const char *text) {
  static const struct {
    char c;
    const char *entity;
  } entities[] = {{'<', "&lt;"}, {'>', "&gt;"}, {'&', "&amp;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  for (; *text; text++) {
    int i = 0;
    while (i < 5 && entities[i].c != *text)
      i++;
    if (i < 5)
      fputs(entities[i].entity, page);
    else
      fputc(*text, page);
  }
}

void cpl_html_link(FILE *page, const char *path) {
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/=+";
  fputs(strchr(path, ':') ? "./" : "", page); /* no scheme in front: javascript: */
  for (; *path; path++)
    fprintf(page, strchr(plain, *path) ? "%c" : "%%%02X", (unsigned char)*path);
}

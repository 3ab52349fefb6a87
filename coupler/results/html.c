/* The little HTML that reports and sweeps write: see html.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/html.h"

#include <string.h>

static const char style[] =
    "body{font-family:sans-serif;margin:2em auto;max-width:80em;padding:0 1em;color:#222}\n"
    "h2{margin-top:2em;border-bottom:1px solid #ccc}h3{margin-bottom:0.4em}\n"
    "img{display:block;max-width:100%;height:auto}\n"
    "table{border-collapse:collapse}td,th{padding:0.2em 0.8em;text-align:right;border-bottom:1px solid #eee}\n"
    "td.text,th.text{text-align:left}.good{background:#cdeccd}\n"
    ".box{padding:0.5em 1em;margin:1em 0;border-left:6px solid #999;background:#f4f4f4}\n"
    ".error{border-color:#b3261e;background:#fbe9e7}.warning{border-color:#d98c00;background:#fff6e0}\n"
    ".shots{display:flex;flex-wrap:wrap;gap:0.5em}.shots img{height:20em;width:auto}\n"
    ".bar{background:#5b8db8;height:0.8em}summary{cursor:pointer;color:#345}.quiet{color:#666}\n"
    "pre{background:#f4f4f4;padding:0.5em 1em;overflow-x:auto}\n";

void cpl_html_head(FILE *page, const char *title) {
  fputs("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>", page);
  cpl_html_text(page, title);
  fprintf(page, "</title>\n<style>\n%s</style>\n<h1>", style);
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

void cpl_html_cell(FILE *page, const char *text) {
  fputs("<td class=\"text\">", page);
  cpl_html_text(page, text);
  fputs("</td>", page);
}

void cpl_html_link(FILE *page, const char *path) {
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/=+";
  fputs(strchr(path, ':') ? "./" : "", page); /* no scheme in front: javascript: */
  for (; *path; path++)
    fprintf(page, strchr(plain, *path) ? "%c" : "%%%02X", (unsigned char)*path);
}

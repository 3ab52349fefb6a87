#include "coupler/html.h"

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
  for (; *text; text++)
    if (*text == '<')
      fputs("&lt;", page);
    else if (*text == '&')
      fputs("&amp;", page);
    else
      fputc(*text, page);
}

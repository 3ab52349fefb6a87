/* The little HTML that reports and sweeps write. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RESULTS_HTML_H
#define CPL_RESULTS_HTML_H

#include <stdio.h>

/* A page's head, with its title as heading, and the styles of tables and pictures. */
void cpl_html_head(FILE *page, const char *title);

/* Text, also within an attribute's quotes: what HTML would take for its own becomes entities. */
void cpl_html_text(FILE *page, const char *text);

/* A table's cell of text. */
void cpl_html_cell(FILE *page, const char *text);

/* A relative path as a link, percent-encoded. */
void cpl_html_link(FILE *page, const char *path);

#endif

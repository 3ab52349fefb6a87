/* A headless Chromium that tests drive: by its debugging protocol, JSON over a pair of pipes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TESTS_BROWSER_CHROME_H
#define TESTS_BROWSER_CHROME_H

#include <jansson.h>
#include <stdbool.h>
#include <sys/types.h>

/* Exit status of a test that is skipped, because there is no Chromium. */
enum { CHROME_SKIPPED = 77 };

typedef struct {
  pid_t pid; /* of the browser, a process group of its own */
  int to, from;
  char *data; /* bytes that came, of messages that are not taken yet */
  size_t size, capacity;
  json_int_t last; /* id of the last command */
  char session[128];
  char profile[256]; /* directory, removed at the end */
  int loaded;        /* pages so far */
  const char *doing; /* what is waited for, for the message when it never comes */
  char errors[4096]; /* what pages said is wrong, one a line: exceptions, console errors, files that are missing */
} chrome;

/* Whether there is one: chromium or chromium-browser in PATH. */
bool chrome_is_there(void);

/* Start it with a window of this size. Ends the test when that fails (check's ck_abort). */
void chrome_open(chrome *c, int width, int height);

/* Load a page and wait until it has loaded. */
void chrome_go(chrome *c, const char *url);

/* The value of an expression of the page; a promise is waited for. The caller decrefs. */
json_t *chrome_value(chrome *c, const char *expression);
double chrome_number(chrome *c, const char *expression);
/* The expression is not false by now, or becomes so. */
void chrome_wait(chrome *c, const char *expression);

/* Click at a place of the window [pixels]; press a key ("ArrowRight", " "). */
void chrome_click(chrome *c, double x, double y);
void chrome_key(chrome *c, const char *key);

/* The window as a PNG file. */
void chrome_picture(chrome *c, const char *file);

void chrome_close(chrome *c);

#endif

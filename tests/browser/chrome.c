/* A headless Chromium that tests drive: see chrome.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/browser/chrome.h"

#include <check.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const int hangs = 60000; /* no word from it for so long: it is given up [ms] */

/* ---- the process ---- */

static const char *program(void) {
  static const char *const names[] = {"chromium", "chromium-browser"};
  static char path[4096];
  for (int k = 0; k < 2; k++) {
    char *all = strdup(getenv("PATH") ? getenv("PATH") : ""), *rest = all;
    for (char *dir; (dir = strsep(&rest, ":")) != NULL;) {
      snprintf(path, sizeof path, "%s/%s", dir, names[k]);
      if (access(path, X_OK) == 0) {
        free(all);
        return path;
      }
    }
    free(all);
  }
  return NULL;
}

bool chrome_is_there(void) {
  return program() != NULL;
}

/* In the child: the browser's pipes are descriptors 3 and 4. */
static void run_browser(const chrome *c, int in, int out, int width, int height) {
  char profile[300], size[64];
  snprintf(profile, sizeof profile, "--user-data-dir=%s", c->profile);
  snprintf(size, sizeof size, "--window-size=%d,%d", width, height);
  const int from = fcntl(in, F_DUPFD, 10), to = fcntl(out, F_DUPFD, 10), quiet = open("/dev/null", O_WRONLY);
  dup2(from, 3);
  dup2(to, 4);
  if (!getenv("TANDEM_TEST_CHROME_TALKS"))
    dup2(quiet, 2);
  setpgid(0, 0);
  for (int fd = 5; fd < 64; fd++)
    close(fd);
  execl(program(), "chromium", "--headless", "--no-sandbox", "--remote-debugging-pipe", "--disable-gpu",
        "--enable-unsafe-swiftshader", "--disable-gpu-vsync", "--disable-gpu-watchdog", "--hide-scrollbars",
        "--no-first-run", "--disable-extensions", "--disable-background-networking", "--disable-dev-shm-usage", profile,
        size, "about:blank", (char *)NULL);
  _exit(127);
}

/* ---- messages ---- */

static void send_message(chrome *c, const char *method, json_t *params, bool to_page) {
  json_t *message = json_pack("{s:I, s:s, s:o}", "id", ++c->last, "method", method, "params", params);
  if (to_page)
    json_object_set_new(message, "sessionId", json_string(c->session));
  char *text = json_dumps(message, JSON_COMPACT);
  const size_t size = strlen(text) + 1;
  for (size_t done = 0; done < size;) {
    ssize_t n = write(c->to, text + done, size - done);
    ck_assert_msg(n > 0 || errno == EINTR, "Chromium does not listen: %s", strerror(errno));
    done += n > 0 ? (size_t)n : 0;
  }
  free(text);
  json_decref(message);
}

static void note_error(chrome *c, const char *text) {
  const size_t n = strlen(c->errors);
  snprintf(c->errors + n, sizeof c->errors - n, "%s\n", text ? text : "an error without words");
}

/* what the page says by itself */
static void take_event(chrome *c, const json_t *message) {
  const char *method = json_string_value(json_object_get(message, "method"));
  json_t *params = json_object_get(message, "params"), *details;
  const char *text = NULL, *level = NULL;
  if (!method)
    return;
  if (strcmp(method, "Page.loadEventFired") == 0) {
    c->loaded++;
  } else if (strcmp(method, "Runtime.exceptionThrown") == 0) {
    details = json_object_get(params, "exceptionDetails");
    text = json_string_value(json_object_get(json_object_get(details, "exception"), "description"));
    note_error(c, text ? text : json_string_value(json_object_get(details, "text")));
  } else if (strcmp(method, "Log.entryAdded") == 0) {
    details = json_object_get(params, "entry");
    level = json_string_value(json_object_get(details, "level"));
    if (level && strcmp(level, "error") == 0)
      note_error(c, json_string_value(json_object_get(details, "text")));
  } else if (strcmp(method, "Runtime.consoleAPICalled") == 0) {
    level = json_string_value(json_object_get(params, "type"));
    details = json_array_get(json_object_get(params, "args"), 0);
    if (level && (strcmp(level, "error") == 0 || strcmp(level, "assert") == 0))
      note_error(c, json_string_value(json_object_get(details, "value")));
  }
}

/* The next message; waits. */
static json_t *receive(chrome *c) {
  char *end;
  while (!c->size || !(end = memchr(c->data, 0, c->size))) {
    struct pollfd fd = {.fd = c->from, .events = POLLIN};
    const int ready = poll(&fd, 1, hangs);
    ck_assert_msg(ready > 0 || (ready < 0 && errno == EINTR), "Chromium says nothing any more; waited for: %s\n%s",
                  c->doing, c->errors);
    if (ready < 0)
      continue;
    if (c->capacity - c->size < 65536)
      c->data = realloc(c->data, c->capacity = 2 * c->capacity + 65536);
    const ssize_t n = read(c->from, c->data + c->size, c->capacity - c->size);
    ck_assert_msg(n > 0, "Chromium has ended");
    c->size += (size_t)n;
  }
  json_error_t bad;
  json_t *message = json_loads(c->data, JSON_ALLOW_NUL, &bad);
  const size_t used = (size_t)(end - c->data) + 1;
  ck_assert_msg(message != NULL, "Chromium speaks no JSON: %s", bad.text);
  memmove(c->data, c->data + used, c->size - used);
  c->size -= used;
  return message;
}

/* Send a command and wait for its result (new reference). */
static json_t *command(chrome *c, const char *method, json_t *params, bool to_page) {
  send_message(c, method, params, to_page);
  for (;;) {
    json_t *message = receive(c), *error = json_object_get(message, "error");
    if (json_integer_value(json_object_get(message, "id")) == c->last) {
      ck_assert_msg(!error, "%s: %s", method, json_string_value(json_object_get(error, "message")));
      json_t *result = json_incref(json_object_get(message, "result"));
      json_decref(message);
      return result;
    }
    take_event(c, message);
    json_decref(message);
  }
}

static void tell(chrome *c, const char *method, json_t *params) {
  json_decref(command(c, method, params, true));
}

void chrome_open(chrome *c, int width, int height) {
  int to[2], from[2];
  *c = (chrome){.doing = "its start"};
  snprintf(c->profile, sizeof c->profile, "%s/tandem-chrome-XXXXXX", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  ck_assert_ptr_nonnull(mkdtemp(c->profile));
  ck_assert(pipe(to) == 0 && pipe(from) == 0);
  c->pid = fork();
  ck_assert_int_ge(c->pid, 0);
  if (c->pid == 0)
    run_browser(c, to[0], from[1], width, height);
  close(to[0]);
  close(from[1]);
  c->to = to[1];
  c->from = from[0];
  fcntl(c->to, F_SETFD, FD_CLOEXEC);
  fcntl(c->from, F_SETFD, FD_CLOEXEC);
  json_t *page = command(c, "Target.createTarget", json_pack("{s:s}", "url", "about:blank"), false);
  json_t *attached =
      command(c, "Target.attachToTarget",
              json_pack("{s:O, s:b}", "targetId", json_object_get(page, "targetId"), "flatten", 1), false);
  snprintf(c->session, sizeof c->session, "%s", json_string_value(json_object_get(attached, "sessionId")));
  json_decref(page);
  json_decref(attached);
  tell(c, "Page.enable", json_object());
  tell(c, "Runtime.enable", json_object());
  tell(c, "Log.enable", json_object());
  tell(c, "Emulation.setDeviceMetricsOverride",
       json_pack("{s:i, s:i, s:i, s:b}", "width", width, "height", height, "deviceScaleFactor", 1, "mobile", 0));
}

void chrome_close(chrome *c) {
  char remove[400];
  if (c->pid > 0) {
    kill(-c->pid, SIGKILL);
    waitpid(c->pid, NULL, 0);
  }
  close(c->to);
  close(c->from);
  free(c->data);
  snprintf(remove, sizeof remove, "rm -rf '%s'", c->profile);
  if (system(remove) != 0)
    fprintf(stderr, "%s stays\n", c->profile);
}

/* ---- pages ---- */

void chrome_go(chrome *c, const char *url) {
  const int before = c->loaded;
  c->doing = url;
  tell(c, "Page.navigate", json_pack("{s:s}", "url", url));
  while (c->loaded == before) {
    json_t *message = receive(c);
    take_event(c, message);
    json_decref(message);
  }
}

json_t *chrome_value(chrome *c, const char *expression) {
  c->doing = expression;
  json_t *result =
      command(c, "Runtime.evaluate",
              json_pack("{s:s, s:b, s:b}", "expression", expression, "returnByValue", 1, "awaitPromise", 1), true);
  json_t *exception = json_object_get(json_object_get(result, "exceptionDetails"), "exception");
  const char *why = json_string_value(json_object_get(exception, "description"));
  ck_assert_msg(!exception, "%s: %s", expression, why ? why : "an exception");
  json_t *value = json_incref(json_object_get(json_object_get(result, "result"), "value"));
  json_decref(result);
  return value;
}

double chrome_number(chrome *c, const char *expression) {
  json_t *value = chrome_value(c, expression);
  ck_assert_msg(json_is_number(value), "%s: not a number", expression);
  const double x = json_number_value(value);
  json_decref(value);
  return x;
}

void chrome_wait(chrome *c, const char *expression) {
  char text[2048];
  snprintf(text, sizeof text,
           "new Promise((done) => { const look = () => (%s) ? done(true) : setTimeout(look, 20); look(); })",
           expression);
  json_decref(chrome_value(c, text));
}

void chrome_click(chrome *c, double x, double y) {
  static const char *const types[] = {"mouseMoved", "mousePressed", "mouseReleased"};
  for (int k = 0; k < 3; k++)
    tell(c, "Input.dispatchMouseEvent",
         json_pack("{s:s, s:f, s:f, s:s, s:i}", "type", types[k], "x", x, "y", y, "button", k ? "left" : "none",
                   "clickCount", k ? 1 : 0));
}

void chrome_key(chrome *c, const char *key) {
  static const char *const types[] = {"keyDown", "keyUp"};
  for (int k = 0; k < 2; k++)
    tell(c, "Input.dispatchKeyEvent", json_pack("{s:s, s:s}", "type", types[k], "key", key));
}

void chrome_picture(chrome *c, const char *file) {
  json_t *result = command(c, "Page.captureScreenshot", json_object(), true);
  const char *text = json_string_value(json_object_get(result, "data"));
  FILE *f = fopen(file, "wb");
  ck_assert(f && text);
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  unsigned bits = 0;
  int n = 0;
  for (; *text && *text != '='; text++) {
    bits = bits << 6 | (unsigned)(strchr(digits, *text) - digits);
    n += 6;
    if (n >= 8)
      fputc((int)(bits >> (n -= 8) & 255), f);
  }
  fclose(f);
  json_decref(result);
}

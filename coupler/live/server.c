/* The HTTP server of a live view: see server.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/live/server.h"

#include "coupler/page/channels.h"
#include "coupler/page/pack.h"
#include "coupler/page/page.h"
#include "protocol/base/log.h"

#include <civetweb.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

enum { SECRET = 32, THREADS = 8, AWAKE = 3 /* a viewer without a question for so long has gone [s] */ };

/* Bytes that several threads send at a time; the last one to let go frees them. */
typedef struct {
  int users;
  size_t size;
  uint8_t *data;
} blob;

struct cpl_server {
  struct mg_context *web;
  char token[SECRET + 1], session[SECRET + 1]; /* of the address; of the cookie, once the token was used */
  char host[2][32], cookie[24];                /* names by which it may be called; the cookie's */
  char address[128];
  void (*stop)(void *);
  void *context;
  pthread_mutex_t lock; /* of what follows; never held while something is sent */
  pthread_cond_t told;
  bool used;                   /* the token */
  blob *page, *roster, *frame; /* NULL: none yet */
  uint32_t number;             /* of the frame */
  char *state;
  bool last, last_told; /* the state will not change any more; a viewer knows it */
  bool parted;          /* and has asked for the histories after it, the last that it asks for, and got them */
  double watched;       /* when a frame was last asked for [s] */
  double polled;        /* when the state was [s] */
  char dir[4096];
  pthread_mutex_t reading; /* of the histories */
  cpl_channels channels;
};

/* ---- blobs ---- */

/* takes the data over */
static blob *blob_new(void *data, size_t size) {
  blob *b = malloc(sizeof *b);
  if (b)
    *b = (blob){.users = 1, .size = size, .data = data};
  else
    free(data);
  return b;
}

/* under the lock */
static void blob_drop(blob *b) {
  if (b && --b->users == 0) {
    free(b->data);
    free(b);
  }
}

static blob *blob_take(cpl_server *s, blob *const *which) {
  pthread_mutex_lock(&s->lock);
  blob *b = *which;
  if (b)
    b->users++;
  pthread_mutex_unlock(&s->lock);
  return b;
}

static void blob_give(cpl_server *s, blob *b) {
  pthread_mutex_lock(&s->lock);
  blob_drop(b);
  pthread_mutex_unlock(&s->lock);
}

/* ---- answers ---- */

static const char common[] =
    "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
    "X-Frame-Options: DENY\r\n";

static int answer(struct mg_connection *c, int status, const char *reason, const char *type, const char *more,
                  size_t size) {
  mg_printf(c, "HTTP/1.1 %d %s\r\nContent-Type: %s\r\nContent-Length: %zu\r\n%s%s\r\n", status, reason, type, size,
            common, more);
  return status;
}

static int refuse(struct mg_connection *c, int status, const char *reason, const char *text) {
  answer(c, status, reason, "text/plain; charset=utf-8", "Connection: close\r\n", strlen(text));
  mg_write(c, text, strlen(text));
  return status;
}

static const char bytes_type[] = "application/octet-stream";

/* ---- who asks ---- */

static bool same_secret(const char *a, const char *b) {
  unsigned differ = strlen(a) != SECRET;
  for (int k = 0; !differ && k < SECRET; k++)
    differ |= (unsigned)(a[k] ^ b[k]);
  return !differ;
}

static bool secret_make(char *out) {
  unsigned char random[SECRET / 2];
  if (getrandom(random, sizeof random, 0) != (ssize_t)sizeof random)
    return false;
  for (size_t k = 0; k < sizeof random; k++)
    snprintf(out + 2 * k, 3, "%02x", random[k]);
  return true;
}

/* Called by a name of ours, and not by the script of a page that came from elsewhere. */
static bool called_rightly(const cpl_server *s, struct mg_connection *c) {
  const char *host = mg_get_header(c, "Host"), *origin = mg_get_header(c, "Origin");
  for (int k = 0; host && k < 2; k++)
    if (strcmp(host, s->host[k]) == 0)
      return !origin || (strncmp(origin, "http://", 7) == 0 && strcmp(origin + 7, host) == 0);
  return false;
}

static bool has_session(const cpl_server *s, struct mg_connection *c) {
  char value[SECRET + 2];
  const char *cookie = mg_get_header(c, "Cookie");
  return cookie && mg_get_cookie(cookie, s->cookie, value, sizeof value) == SECRET && same_secret(value, s->session);
}

/* The first one with the token gets the session. */
static int enter(cpl_server *s, struct mg_connection *c, const char *query) {
  char token[SECRET + 2], more[256];
  if (mg_get_var(query, strlen(query), "token", token, sizeof token) != SECRET || !same_secret(token, s->token))
    return refuse(c, 403, "Forbidden", "This is not the address that tandem printed.\n");
  pthread_mutex_lock(&s->lock);
  const bool first = !s->used;
  s->used = true;
  pthread_mutex_unlock(&s->lock);
  if (!first && !has_session(s, c))
    return refuse(c, 403, "Forbidden", "This address was used already; it is good once, for one browser.\n");
  snprintf(more, sizeof more, "Location: /\r\nSet-Cookie: %s=%s; HttpOnly; SameSite=Strict; Path=/\r\n", s->cookie,
           s->session);
  return answer(c, 303, "See Other", "text/plain", more, 0);
}

/* ---- what there is ---- */

static int send_page(cpl_server *s, struct mg_connection *c) {
  static const char wait[] = "<!doctype html><meta charset=\"utf-8\"><link rel=\"icon\" href=\"data:,\"><meta "
                             "http-equiv=\"refresh\" content=\"1\">"
                             "<title>tandem</title><p>The run is starting: its solvers get ready.</p>\n";
  blob *page = blob_take(s, &s->page);
  answer(c, 200, "OK", "text/html; charset=utf-8", "", page ? page->size : sizeof wait - 1);
  mg_write(c, page ? (const void *)page->data : wait, page ? page->size : sizeof wait - 1);
  if (page)
    blob_give(s, page);
  return 200;
}

static int send_state(cpl_server *s, struct mg_connection *c) {
  pthread_mutex_lock(&s->lock);
  char *state = strdup(s->state ? s->state : "{}");
  const bool last = s->last;
  s->polled = tdm_clock();
  pthread_mutex_unlock(&s->lock);
  if (!state)
    return refuse(c, 500, "Internal Server Error", "out of memory\n");
  answer(c, 200, "OK", "application/json", "", strlen(state));
  mg_write(c, state, strlen(state));
  free(state);
  if (last) {
    pthread_mutex_lock(&s->lock);
    s->last_told = true;
    pthread_mutex_unlock(&s->lock);
  }
  return 200;
}

static int send_frame(cpl_server *s, struct mg_connection *c, const char *query) {
  char after[16] = "0";
  mg_get_var(query, strlen(query), "after", after, sizeof after);
  pthread_mutex_lock(&s->lock);
  s->watched = tdm_clock();
  const uint32_t number = s->number;
  blob *roster = s->roster, *frame = s->frame;
  const bool newer = frame && roster && number > strtoul(after, NULL, 10);
  if (newer)
    roster->users++, frame->users++;
  pthread_mutex_unlock(&s->lock);
  if (!newer)
    return answer(c, 204, "No Content", bytes_type, "", 0);
  const uint32_t head[2] = {number, (uint32_t)roster->size};
  answer(c, 200, "OK", bytes_type, "", sizeof head + roster->size + frame->size);
  if (mg_write(c, head, sizeof head) > 0 && mg_write(c, roster->data, roster->size) > 0)
    mg_write(c, frame->data, frame->size);
  blob_give(s, roster);
  blob_give(s, frame);
  return 200;
}

static void append(FILE *out, const void *data, size_t size) {
  const uint32_t length = (uint32_t)size;
  fwrite(&length, sizeof length, 1, out);
  fwrite(data, 1, size, out);
}

static int send_channels(cpl_server *s, struct mg_connection *c) {
  char *all = NULL, *text = NULL;
  size_t size = 0;
  tdm_error err = {0};
  tdm_view_bytes bytes = {0};
  FILE *out = open_memstream(&all, &size);
  pthread_mutex_lock(&s->lock);
  const bool parting = s->last_told;
  pthread_mutex_unlock(&s->lock);
  pthread_mutex_lock(&s->reading);
  const bool begun = s->dir[0] != 0;
  if (out && begun && cpl_channels_read(&s->channels, s->dir, &err) == TDM_OK) {
    json_t *names = cpl_channels_to_json(&s->channels);
    text = json_dumps(names, JSON_COMPACT);
    json_decref(names);
    append(out, text ? text : "[]", text ? strlen(text) : 2);
    for (int k = 0; k < s->channels.nfile; k++) {
      cpl_channels_pack(&s->channels, k, &bytes, &err);
      append(out, bytes.data, bytes.size);
    }
  }
  pthread_mutex_unlock(&s->reading);
  const bool good = out && fclose(out) == 0 && err.status == TDM_OK;
  if (good && !begun) {
    answer(c, 204, "No Content", bytes_type, "", 0);
  } else if (good) {
    answer(c, 200, "OK", bytes_type, "", size);
    mg_write(c, all, size);
  } else {
    refuse(c, 500, "Internal Server Error", err.status != TDM_OK ? err.message : "out of memory\n");
  }
  pthread_mutex_lock(&s->lock);
  s->parted = s->parted || parting;
  pthread_cond_broadcast(&s->told);
  pthread_mutex_unlock(&s->lock);
  tdm_view_bytes_free(&bytes);
  free(text);
  free(all);
  return good ? 200 : 500;
}

static int handle(struct mg_connection *c, void *of) {
  cpl_server *s = of;
  const struct mg_request_info *request = mg_get_request_info(c);
  const char *query = request->query_string ? request->query_string : "", *path = request->local_uri;
  const bool get = strcmp(request->request_method, "GET") == 0;
  if (!called_rightly(s, c))
    return refuse(c, 403, "Forbidden", "Not for this name, or not for a page from elsewhere.\n");
  if (get && strcmp(path, "/") == 0 && *query)
    return enter(s, c, query);
  if (!has_session(s, c))
    return refuse(c, 403, "Forbidden", "Open the address that tandem printed.\n");
  if (!get && !(strcmp(request->request_method, "POST") == 0 && strcmp(path, "/stop") == 0))
    return refuse(c, 405, "Method Not Allowed", "Only what the page asks for.\n");
  if (!get) {
    s->stop(s->context);
    return answer(c, 204, "No Content", bytes_type, "", 0);
  }
  return strcmp(path, "/") == 0           ? send_page(s, c)
         : strcmp(path, "/state") == 0    ? send_state(s, c)
         : strcmp(path, "/frame") == 0    ? send_frame(s, c, query)
         : strcmp(path, "/channels") == 0 ? send_channels(s, c)
                                          : refuse(c, 404, "Not Found", "There is no such thing.\n");
}

static int be_silent(const struct mg_connection *c, const char *message) {
  (void)c, (void)message;
  return 1;
}

/* ---- those who run the simulation ---- */

tdm_status cpl_server_open(cpl_server **server, int port, void (*stop)(void *), void *context, tdm_error *err) {
  char where[32], threads[8], why[256] = "";
  unsigned code = 0;
  struct mg_server_port bound[1];
  cpl_server *s = *server = calloc(1, sizeof *s);
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  pthread_mutex_init(&s->lock, NULL);
  pthread_mutex_init(&s->reading, NULL);
  pthread_cond_init(&s->told, NULL);
  s->stop = stop;
  s->context = context;
  snprintf(where, sizeof where, "127.0.0.1:%d", port);
  snprintf(threads, sizeof threads, "%d", THREADS);
  const char *options[] = {"listening_ports",
                           where,
                           "num_threads",
                           threads,
                           "request_timeout_ms",
                           "10000",
                           "max_request_size",
                           "8192",
                           "enable_keep_alive",
                           "yes",
                           "keep_alive_timeout_ms",
                           "5000",
                           NULL};
  const struct mg_callbacks callbacks = {.log_message = be_silent};
  struct mg_init_data init = {.callbacks = &callbacks, .user_data = s, .configuration_options = options};
  struct mg_error_data error = {.code = &code, .text = why, .text_buffer_size = sizeof why};
  sigset_t all, before; /* signals are for the thread that runs the simulation */
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  mg_init_library(0);
  s->web = secret_make(s->token) && secret_make(s->session) ? mg_start2(&init, &error) : NULL;
  pthread_sigmask(SIG_SETMASK, &before, NULL);
  if (!s->web || mg_get_server_ports(s->web, 1, bound) != 1)
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL,
                    "--live %d: nothing can be served at 127.0.0.1:%d (%s): another program may listen there; give "
                    "another port, or none for a free one",
                    port, port, why[0] ? why : "no further reason");
  snprintf(s->host[0], sizeof s->host[0], "127.0.0.1:%d", bound[0].port);
  snprintf(s->host[1], sizeof s->host[1], "localhost:%d", bound[0].port);
  snprintf(s->cookie, sizeof s->cookie, "tandem_%d", bound[0].port); /* cookies know no ports */
  snprintf(s->address, sizeof s->address, "http://%s/?token=%s", s->host[0], s->token);
  mg_set_request_handler(s->web, "/", handle, s);
  return TDM_OK;
}

const char *cpl_server_address(const cpl_server *s) {
  return s->address;
}

tdm_status cpl_server_run(cpl_server *s, const char *dir, const tdm_scenery *scenery, const json_t *meta,
                          tdm_error *err) {
  char *text = NULL;
  size_t size = 0;
  tdm_view_bytes surface = {0};
  FILE *page = open_memstream(&text, &size);
  if (page && cpl_pack_surface(scenery, &surface, err) == TDM_OK) {
    cpl_page_begin(page, "tandem: live");
    cpl_page_json(page, "meta", meta);
    cpl_page_bytes(page, "surface", &surface);
    cpl_page_end(page);
  }
  tdm_view_bytes_free(&surface);
  if (!page || fclose(page) != 0)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory for the page of the live view");
  blob *made = err->status == TDM_OK ? blob_new(text, size) : NULL;
  if (!made)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory for the page of the live view");
  pthread_mutex_lock(&s->reading);
  snprintf(s->dir, sizeof s->dir, "%s", dir);
  pthread_mutex_unlock(&s->reading);
  pthread_mutex_lock(&s->lock);
  blob_drop(s->page);
  s->page = made;
  pthread_mutex_unlock(&s->lock);
  return TDM_OK;
}

void cpl_server_state(cpl_server *s, const json_t *state) {
  char *text = json_dumps(state, JSON_COMPACT | JSON_REAL_PRECISION(9));
  pthread_mutex_lock(&s->lock);
  free(s->state);
  s->state = text;
  s->last = json_is_true(json_object_get(state, "over"));
  pthread_mutex_unlock(&s->lock);
}

/* the buffer's contents as a blob */
static blob *take_over(tdm_view_bytes *bytes) {
  blob *b = blob_new(bytes->data, bytes->size);
  *bytes = (tdm_view_bytes){0};
  return b;
}

void cpl_server_frame(cpl_server *s, tdm_view_bytes *roster, tdm_view_bytes *frame) {
  blob *next = take_over(frame), *kept = roster->size > 0 ? take_over(roster) : NULL;
  pthread_mutex_lock(&s->lock);
  if (next) {
    if (kept) {
      blob_drop(s->roster);
      s->roster = kept;
    }
    blob_drop(s->frame);
    s->frame = next;
    s->number++;
  }
  pthread_mutex_unlock(&s->lock);
}

bool cpl_server_watched(const cpl_server *server) {
  cpl_server *s = (cpl_server *)server; /* the lock is no part of what it says */
  pthread_mutex_lock(&s->lock);
  const bool watched = s->watched > 0 && tdm_clock() - s->watched < AWAKE;
  pthread_mutex_unlock(&s->lock);
  return watched;
}

void cpl_server_close(cpl_server **server) {
  cpl_server *s = *server;
  if (!s)
    return;
  if (s->web) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += AWAKE;
    pthread_mutex_lock(&s->lock);
    const bool awake = s->polled > 0 && tdm_clock() - s->polled < AWAKE; /* who does not read is not waited for */
    while (awake && s->last && !s->parted && pthread_cond_timedwait(&s->told, &s->lock, &until) == 0)
      ;
    pthread_mutex_unlock(&s->lock);
  }
  if (s->web)
    mg_stop(s->web);
  mg_exit_library();
  blob_drop(s->page);
  blob_drop(s->roster);
  blob_drop(s->frame);
  free(s->state);
  cpl_channels_free(&s->channels);
  pthread_mutex_destroy(&s->lock);
  pthread_mutex_destroy(&s->reading);
  pthread_cond_destroy(&s->told);
  free(s);
  *server = NULL;
}

/* The server of the live view: who gets in, what is sent, readers that do not read. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/live/server.h"
#include "tests/browser/http.h"
#include "tests/browser/invented.h"
#include "tests/command.h"
#include "tests/test_main.h"

static int stops;

static void stop(void *context) {
  (void)context;
  stops++;
}

static cpl_server *open_server(int *port, char *path, size_t size) {
  cpl_server *s = NULL;
  tdm_error err = {0};
  ck_assert_msg(cpl_server_open(&s, 0, stop, NULL, &err) == TDM_OK, "%s", err.message);
  *port = http_address(cpl_server_address(s), path, size);
  return s;
}

static void enter(int port, const char *path) {
  ck_assert_int_eq(http_get(port, path), 303);
  ck_assert_ptr_nonnull(strstr(http_head, "HttpOnly; SameSite=Strict"));
}

START_TEST(only_one_gets_in) {
  int port;
  char path[128], wrong[128], cookie[128];
  cpl_server *s = open_server(&port, path, sizeof path);
  snprintf(wrong, sizeof wrong, "%s", path);
  wrong[strlen(wrong) - 1] ^= 1;
  ck_assert_int_eq(http_get(port, "/"), 403);
  ck_assert_int_eq(http_get(port, "/state"), 403);
  ck_assert_int_eq(http_get(port, wrong), 403);
  ck_assert_int_eq(http_get(port, "/?token="), 403);
  ck_assert_int_eq(http_ask(port, "POST", "/stop", NULL, "Content-Length: 0\r\n"), 403);
  ck_assert_int_eq(http_ask(port, "GET", path, "elsewhere.example", ""), 403);
  enter(port, path);
  ck_assert_int_eq(http_get(port, "/"), 200);
  ck_assert_int_eq(http_get(port, path), 303); /* the same browser */
  snprintf(cookie, sizeof cookie, "%s", http_cookie);
  http_cookie[0] = 0;
  ck_assert_int_eq(http_get(port, path), 403); /* another one */
  snprintf(http_cookie, sizeof http_cookie, "%.*s0", (int)strlen(cookie) - 1, cookie);
  http_cookie[strlen(http_cookie) - 1] = cookie[strlen(cookie) - 1] == '0' ? '1' : '0';
  ck_assert_int_eq(http_get(port, "/state"), 403);
  cpl_server_close(&s);
}
END_TEST

START_TEST(requests_from_elsewhere) {
  int port;
  char path[128], large[12000];
  cpl_server *s = open_server(&port, path, sizeof path);
  enter(port, path);
  /* a name that leads here, and a page from elsewhere, whose requests carry the cookie */
  ck_assert_int_eq(http_ask(port, "GET", "/state", "elsewhere.example", ""), 403);
  ck_assert_int_eq(http_ask(port, "GET", "/state", "127.0.0.1", ""), 403);
  ck_assert_int_eq(http_ask(port, "POST", "/stop", NULL, "Origin: http://elsewhere.example\r\nContent-Length: 0\r\n"),
                   403);
  /* unknown paths and methods */
  ck_assert_int_eq(http_get(port, "/../../etc/passwd"), 404);
  ck_assert_int_eq(http_get(port, "/%2e%2e/%2e%2e/etc/passwd"), 404);
  ck_assert_int_eq(http_get(port, "/stop"), 404);
  ck_assert_int_eq(http_ask(port, "DELETE", "/", NULL, ""), 405);
  ck_assert_int_eq(http_ask(port, "POST", "/state", NULL, "Content-Length: 0\r\n"), 405);
  /* a head that is too large */
  snprintf(large, sizeof large, "X: %0*d\r\n", 11000, 0);
  ck_assert_int_ne(http_ask(port, "GET", "/state", NULL, large), 200);
  ck_assert_int_eq(stops, 0);
  ck_assert_int_eq(http_ask(port, "POST", "/stop", NULL, "Content-Length: 0\r\n"), 204);
  ck_assert_int_eq(stops, 1);
  cpl_server_close(&s);
}
END_TEST

START_TEST(taken_ports_are_an_error) {
  int port;
  char path[128];
  tdm_error err = {0};
  cpl_server *s = open_server(&port, path, sizeof path), *other = NULL;
  ck_assert_int_eq(cpl_server_open(&other, port, stop, NULL, &err), TDM_ERR_SYSTEM);
  ck_assert_ptr_nonnull(strstr(err.message, "give another port, or none"));
  cpl_server_close(&other);
  cpl_server_close(&s);
}
END_TEST

static void fill(tdm_view_bytes *bytes, size_t size, int with) {
  *bytes = (tdm_view_bytes){malloc(size), size, size};
  memset(bytes->data, with, size);
}

START_TEST(frames_are_the_newest) {
  int port;
  char path[128];
  tdm_view_bytes roster, frame;
  cpl_server *s = open_server(&port, path, sizeof path);
  enter(port, path);
  ck_assert(!cpl_server_watched(s));
  ck_assert_int_eq(http_get(port, "/frame"), 204);
  ck_assert(cpl_server_watched(s));
  fill(&roster, 10, 'r');
  for (int k = 1; k <= 3; k++) {
    fill(&frame, 20, '0' + k);
    cpl_server_frame(s, &roster, &frame);
    ck_assert_ptr_null(frame.data);
  }
  ck_assert_int_eq(http_get(port, "/frame?after=1"), 200);
  ck_assert_uint_eq(http_size, 8 + 10 + 20);
  ck_assert_int_eq(http_body[0], 3);
  ck_assert_int_eq(http_body[4], 10);
  ck_assert_int_eq(http_body[8], 'r');
  ck_assert_int_eq(http_body[18], '3');
  ck_assert_int_eq(http_get(port, "/frame?after=3"), 204);
  cpl_server_close(&s);
}
END_TEST

START_TEST(page_state_and_histories) {
  int port;
  char path[128];
  const char *dir = directory_make();
  tdm_scenery scenery = {0};
  tdm_error err = {0};
  cpl_server *s = open_server(&port, path, sizeof path);
  json_t *meta = json_pack("{s:b, s:s}", "live", 1, "scene", "</script>"), *state = json_pack("{s:i}", "t", 7);
  enter(port, path);
  ck_assert_int_eq(http_get(port, "/channels"), 204); /* there is no run yet */
  write_file(dir, "a.csv", "time [s],x [m]\n0,1\n");
  ck_assert_int_eq(invented_scenery(&scenery, &err), TDM_OK);
  ck_assert_int_eq(cpl_server_run(s, dir, &scenery, meta, &err), TDM_OK);
  cpl_server_state(s, state);
  ck_assert_int_eq(http_get(port, "/"), 200);
  ck_assert_ptr_nonnull(strstr((char *)http_body, "\\u003c/script>"));
  ck_assert_int_eq(http_get(port, "/state"), 200);
  ck_assert_str_eq((char *)http_body, "{\"t\":7}");
  ck_assert_int_eq(http_get(port, "/channels"), 200);
  ck_assert_ptr_nonnull(strstr((char *)http_body + 4, "\"a.csv\""));
  const size_t size = http_size;
  write_file(dir, "a.csv", "time [s],x [m]\n0,1\n1,2\n");
  ck_assert_int_eq(http_get(port, "/channels"), 200);
  ck_assert_uint_eq(http_size, size + 8);
  json_decref(meta);
  json_decref(state);
  tdm_scenery_free(&scenery);
  cpl_server_close(&s);
  directory_remove(dir);
}
END_TEST

/* More connections than the server has threads ask for a large frame and never read: frames are taken all the same, and
 * the server ends. */
START_TEST(readers_that_do_not_read) {
  int port, reader[20];
  char path[128];
  tdm_view_bytes roster, frame;
  cpl_server *s = open_server(&port, path, sizeof path);
  enter(port, path);
  fill(&roster, 10, 'r');
  fill(&frame, 50000000, 'f');
  cpl_server_frame(s, &roster, &frame);
  for (int k = 0; k < 20; k++)
    reader[k] = http_send(port, "GET", "/frame", NULL, "");
  WAIT_FOR(cpl_server_watched(s));
  for (int k = 0; k < 2000; k++) {
    fill(&frame, 100000, 'g');
    cpl_server_frame(s, &roster, &frame);
  }
  cpl_server_close(&s);
  for (int k = 0; k < 20; k++)
    close(reader[k]);
}
END_TEST

TEST_MAIN("server", only_one_gets_in, requests_from_elsewhere, taken_ports_are_an_error, frames_are_the_newest,
          page_state_and_histories, readers_that_do_not_read)

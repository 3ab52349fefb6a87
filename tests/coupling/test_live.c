/* `tandem run --live` as a user and a stranger find it: the same bits with viewers as without, a stop by HTTP, a port
 * that is taken. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/browser/http.h"
#include "tests/command.h"
#include "tests/test_main.h"

/* Start a run with --live; its port, once it has printed the address. */
static pid_t start(const char *dir, const char *out, const char *end, int *port, char *path, size_t size) {
  char to[300], set[64];
  snprintf(to, sizeof to, "%s/%s", dir, out);
  snprintf(set, sizeof set, "time.end=%s", end);
  const char *const words[] = {"run", "torsional", "--out", to, "--set", set, "--live", NULL};
  pid_t pid = background(dir, words);
  WAIT_FOR(background_said(dir, "token=") && strchr(strstr(command_output, "token="), '\n'));
  *port = http_address(command_output, path, size);
  ck_assert_int_eq(http_get(*port, path), 303);
  return pid;
}

static bool has_frame(int port) {
  return http_get(port, "/frame") == 200;
}

/* The run goes on until frames were seen; its time histories until then are those of a run without viewers. */
START_TEST(same_bits) {
  const char *dir = directory_make();
  int port;
  char path[128], live[128];
  snprintf(live, sizeof live, "%s/live", dir);
  ck_assert_int_eq(command("tandem run torsional --out %s/plain --set time.end=0.1", dir), 0);
  pid_t pid = start(dir, "live", "1000", &port, path, sizeof path);
  WAIT_FOR(has_frame(port));
  const int idle = http_send(port, "GET", "/", NULL, ""); /* who asks and does not read */
  uint32_t number = 0, frames = 0;
  while (frames < 3 || lines_of(live, "body_box.csv") < 200) {
    const uint32_t before = number;
    if (has_frame(port))
      memcpy(&number, http_body, sizeof number);
    frames += number != before;
  }
  ck_assert_int_eq(http_ask(port, "POST", "/stop", NULL, "Content-Length: 0\r\n"), 204);
  ck_assert_int_eq(background_end(pid), 130);
  close(idle);
  ck_assert_int_eq(command("sh -c 'cd %s/plain && for f in *.csv; do a=$(wc -c <$f); b=$(wc -c <../live/$f); "
                           "cmp -n $((a < b ? a : b)) $f ../live/$f || exit 1; done'",
                           dir),
                   0);
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

START_TEST(stop_ends_the_run) {
  const char *dir = directory_make();
  int port;
  char path[128], live[128];
  pid_t pid = start(dir, "live", "1000", &port, path, sizeof path);
  WAIT_FOR(has_frame(port));
  ck_assert_int_eq(http_ask(port, "POST", "/stop", NULL, "Content-Length: 0\r\n"), 204);
  ck_assert_int_eq(background_end(pid), 130);
  snprintf(live, sizeof live, "%s/live", dir);
  ck_assert_int_eq(command("grep -c TDM_ERR_INTERRUPTED %s/summary.json", live), 0);
  ck_assert_int_gt(lines_of(live, "body_box.csv"), 1);
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

/* Before anything begins: results of before stay as they are. */
START_TEST(taken_port) {
  const char *dir = directory_make();
  int port;
  char path[128], old[128];
  pid_t pid = start(dir, "live", "1000", &port, path, sizeof path);
  snprintf(old, sizeof old, "%s/old", dir);
  ck_assert_int_eq(command("mkdir %s", old), 0);
  ck_assert_int_eq(command("tandem run torsional --out %s --live %d", old, port), 1);
  expect_output("give another port, or none for a free one");
  ck_assert(!is_there(dir, "old", "scene.json"));
  ck_assert_int_eq(http_ask(port, "POST", "/stop", NULL, "Content-Length: 0\r\n"), 204);
  ck_assert_int_eq(background_end(pid), 130);
  ck_assert_int_eq(command("tandem run torsional --live 70000 --out %s", old), 2);
  ck_assert_int_eq(command("tandem check torsional --live"), 2);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("live", same_bits, stop_ends_the_run, taken_port)

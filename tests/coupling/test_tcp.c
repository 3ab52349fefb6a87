/* tcp: solvers started by hand in any order, strangers, second solvers of a role, ports in use. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/wire/participant.h"
#include "protocol/wire/transport.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

/* A free body of 1 kg; dem is the dummy with one spring. */
static const char scene[] = "{\"time\": {\"end\": 0.2, \"dt\": 1e-4}, \"coupling\": {\"fallback\": \"lommen\", \"n\": "
                            "10, \"transport\": \"tcp\",\n"
                            " \"bodies\": [{\"mbd\": \"mass\", \"dem\": \"mass\"}], \"timeout\": 5},\n"
                            " \"mbd\": {\"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"mass\", \"mass\": 1,\n"
                            "  \"inertia\": [1, 1, 1], \"position\": [0, 0, 0], \"velocity\": [1, 0, 0]}]},\n"
                            " \"dem\": {\"stiffness\": 100}}\n";

static const char *dir;
static int port;
static char endpoint[64], address[96];

/* A port that nobody uses now. */
static void setup(void) {
  struct sockaddr_in any = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  socklen_t size = sizeof any;
  int s = socket(AF_INET, SOCK_STREAM, 0);
  ck_assert_int_eq(bind(s, (struct sockaddr *)&any, sizeof any), 0);
  ck_assert_int_eq(getsockname(s, (struct sockaddr *)&any, &size), 0);
  port = ntohs(any.sin_port);
  close(s);
  dir = directory_make();
  write_file(dir, "scene.json", scene);
  snprintf(endpoint, sizeof endpoint, "tcp://127.0.0.1:%d", port);
  snprintf(address, sizeof address, "coupling.address=%s", endpoint);
}

/* The server's output once it listens and waits for this solver. */
static void wait_for_server(const char *missing) {
  char text[64];
  snprintf(text, sizeof text, "waiting for %s", missing);
  WAIT_FOR(background_said(dir, text));
}

/* The server, waiting for what others start. */
static pid_t start_server(const char *mbd, const char *dem) {
  char file[128], out[128];
  snprintf(file, sizeof file, "%s/scene.json", dir);
  snprintf(out, sizeof out, "%s/out", dir);
  const char *const arguments[] = {"run", file, "--out", out, "--set", address, "--set", mbd, "--set", dem, NULL};
  return background(dir, arguments);
}

static pid_t start_solver(const char *program) {
  pid_t pid = fork();
  if (pid == 0) {
    if (!freopen("/dev/null", "w", stderr))
      _exit(126);
    execl(program, program, "--connect", endpoint, "--timeout", "10", NULL);
    _exit(127);
  }
  return pid;
}

/* A solver that runs, with or without a server. */
static void wait_for_solver(const char *program) {
  char text[512];
  snprintf(text, sizeof text, "%s --connect %s", program, endpoint);
  WAIT_FOR(find_processes(text, NULL) == 1);
}

static const char mbd_program[] = TANDEM_BIN_DIR "/tandem-mbd", dem_program[] = TANDEM_TEST_DIR "/dummy_solver";
static const char mbd_by_hand[] = "coupling.solvers.mbd=null", dem_by_hand[] = "coupling.solvers.dem=null";

START_TEST(any_order) {
  for (int order = 0; order < 3; order++) {
    setup();
    pid_t server = 0, mbd = 0, dem = 0;
    if (order == 0)
      server = start_server(mbd_by_hand, dem_by_hand);
    dem = start_solver(dem_program);
    wait_for_solver(dem_program);
    if (order == 1)
      server = start_server(mbd_by_hand, dem_by_hand);
    mbd = start_solver(mbd_program);
    wait_for_solver(mbd_program);
    if (order == 2)
      server = start_server(mbd_by_hand, dem_by_hand);
    int status = background_end(server);
    background_output(dir);
    ck_assert_msg(status == 0, "order %d: %d: %s", order, status, command_output);
    expect_output("waiting for dem: start it with --connect tcp://127.0.0.1:");
    ck_assert_int_eq(background_end(mbd), 0);
    ck_assert_int_eq(background_end(dem), 0);
    directory_remove(dir);
  }
}
END_TEST

START_TEST(a_solver_that_is_never_started) {
  setup();
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --set %s --set coupling.solvers.dem=null "
                           "--set coupling.join_timeout=1",
                           dir, dir, address),
                   1);
  expect_output("dem: it was not started within 1 s; start it with --connect tcp://127.0.0.1:");
  directory_remove(dir);
}
END_TEST

START_TEST(a_port_in_use) {
  setup();
  pid_t server = start_server(mbd_by_hand, dem_by_hand);
  wait_for_server("dem");
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/second --set %s", dir, dir, address), 1);
  expect_output("coupling.address: cannot listen on tcp://127.0.0.1:");
  expect_output("choose another address or port");
  kill(server, SIGINT);
  ck_assert_int_eq(background_end(server), 130);
  directory_remove(dir);
}
END_TEST

/* Connect to the port and talk nonsense that is not even ZeroMQ. */
static void talk_http(void) {
  struct sockaddr_in to = {
      .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  static const char words[] = "GET / HTTP/1.1\r\nHost: tandem\r\n\r\n";
  int s = socket(AF_INET, SOCK_STREAM, 0);
  ck_assert_int_eq(connect(s, (struct sockaddr *)&to, sizeof to), 0);
  ck_assert_int_eq(send(s, words, sizeof words - 1, MSG_NOSIGNAL), (int)sizeof words - 1);
  shutdown(s, SHUT_WR);
  char answer[256];
  while (recv(s, answer, sizeof answer, 0) > 0) /* until the server has had enough of it */
    ;
  close(s);
}

/* A ZeroMQ peer that sends what is no message, a STEP before HELLO, and a HELLO of no role. */
static void talk_nonsense(void) {
  tdm_transport *t = NULL;
  tdm_error err = {0};
  tdm_frame frame = {0};
  ck_assert_int_eq(tdm_transport_connect(&t, endpoint, NULL, &err), TDM_OK);
  for (int kind = 0; kind < 3; kind++) {
    json_t *json = json_pack("{s:s}", "role", "cook");
    tdm_control_write(&frame, kind == 1 ? TDM_STEP : TDM_HELLO, 0, json, &err);
    json_decref(json);
    if (kind == 0)
      memset(frame.data, 'x', frame.size);
    ck_assert_int_eq(tdm_transport_send(t, NULL, &frame, &err), TDM_OK);
    const void *data;
    size_t size;
    tdm_header header;
    ck_assert_int_eq(tdm_transport_receive(t, 3000, NULL, &data, &size, &err), TDM_OK);
    ck_assert_ptr_nonnull(data); /* each is answered with ERROR */
    ck_assert_int_eq(tdm_header_read(&header, data, size, &err), TDM_OK);
    ck_assert_int_eq(header.type, TDM_ERROR);
  }
  tdm_frame_free(&frame);
  tdm_transport_close(&t);
}

START_TEST(strangers_and_second_solvers) {
  setup();
  pid_t server = start_server(mbd_by_hand, dem_by_hand);
  wait_for_server("dem");
  talk_http();
  talk_nonsense();
  pid_t first = start_solver(mbd_program);
  WAIT_FOR(command("grep -q 'event=hello role=mbd' %s/out/server.log", dir) == 0);
  pid_t second = start_solver(mbd_program);
  ck_assert_int_eq(background_end(second), 1); /* it is told that the role is taken */
  pid_t dem = start_solver(dem_program);
  int status = background_end(server);
  background_output(dir);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
  ck_assert_int_eq(background_end(first), 0);
  ck_assert_int_eq(background_end(dem), 0);
  ck_assert_int_eq(command("cat %s/out/server.log", dir), 0);
  expect_output("it does not begin with TNDM");
  expect_output("STEP came before HELLO");
  expect_output("the role must be");
  expect_output("the role mbd is taken by mbd");
  directory_remove(dir);
}
END_TEST

TEST_MAIN("tcp", any_order, a_solver_that_is_never_started, a_port_in_use, strangers_and_second_solvers)

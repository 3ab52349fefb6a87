/* A small HTTP client for tests of the live view: a request a connection, to a port of this machine. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TESTS_BROWSER_HTTP_H
#define TESTS_BROWSER_HTTP_H

#include <arpa/inet.h>
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

static char http_cookie[128]; /* sent with each request, and set by answers; "": none */
static char http_head[4096];  /* of the last answer */
static unsigned char *http_body;
static size_t http_size;

static inline int http_connect(int port) {
  struct sockaddr_in to = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  int s = socket(AF_INET, SOCK_STREAM, 0);
  ck_assert_int_ge(s, 0);
  ck_assert_int_eq(connect(s, (struct sockaddr *)&to, sizeof to), 0);
  return s;
}

/* Send a request; `more` are further header lines, each ended by CRLF; host NULL: the right one. */
static inline int http_send(int port, const char *method, const char *path, const char *host, const char *more) {
  char text[16384], own[64];
  snprintf(own, sizeof own, "127.0.0.1:%d", port);
  int s = http_connect(port);
  int n =
      snprintf(text, sizeof text, "%s %s HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n%s%s%s%s\r\n", method, path,
               host ? host : own, http_cookie[0] ? "Cookie: " : "", http_cookie, http_cookie[0] ? "\r\n" : "", more);
  ck_assert_int_eq(send(s, text, (size_t)n, MSG_NOSIGNAL), n);
  return s;
}

/* Send, and read all of the answer; its status, 0: the connection was closed without one. */
static inline int http_ask(int port, const char *method, const char *path, const char *host, const char *more) {
  int s = http_send(port, method, path, host, more), status = 0;
  size_t size = 0, capacity = 0;
  char *all = NULL;
  for (ssize_t n = 1; n > 0; size += n > 0 ? (size_t)n : 0) {
    if (capacity - size < 65536)
      all = realloc(all, (capacity += capacity + 131072) + 1);
    n = recv(s, all + size, capacity - size, 0);
  }
  close(s);
  all[size] = 0;
  char *end = strstr(all, "\r\n\r\n"), *set;
  free(http_body);
  http_body = NULL;
  http_size = 0;
  if (end) {
    *end = 0;
    snprintf(http_head, sizeof http_head, "%s", all);
    http_size = size - (size_t)(end + 4 - all);
    http_body = calloc(http_size + 1, 1);
    memcpy(http_body, end + 4, http_size);
    sscanf(http_head, "HTTP/1.1 %d", &status);
    if ((set = strstr(http_head, "Set-Cookie: ")) != NULL)
      snprintf(http_cookie, sizeof http_cookie, "%.*s", (int)strcspn(set + 12, ";"), set + 12);
  }
  free(all);
  return status;
}

static inline int http_get(int port, const char *path) {
  return http_ask(port, "GET", path, NULL, "");
}

/* The port and the path with the token of an address that tandem printed: "... http://127.0.0.1:PORT/?token=T ..." */
static inline int http_address(const char *text, char *path, size_t size) {
  const char *at = strstr(text, "http://127.0.0.1:");
  ck_assert_msg(at != NULL, "no address in: %s", text);
  at += strlen("http://127.0.0.1:");
  const char *slash = strchr(at, '/');
  ck_assert_ptr_nonnull(slash);
  snprintf(path, size, "%.*s", (int)strcspn(slash, " \n"), slash);
  return atoi(at);
}

#endif

/* Messages between an FMU's binary and tandem-serve: see link.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/guest/link.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

typedef struct {
  uint32_t kind, status, ntext, nnumber;
} head;

enum { TEXT_MAX = 1 << 16, NUMBERS_MAX = 1 << 26 };

static bool put(int fd, const void *data, size_t size) {
  const char *at = data;
  while (size > 0) {
    const ssize_t n = send(fd, at, size, MSG_NOSIGNAL);
    if (n < 0 && errno != EINTR)
      return false;
    at += n > 0 ? n : 0;
    size -= n > 0 ? (size_t)n : 0;
  }
  return true;
}

static bool take(int fd, void *data, size_t size) {
  char *at = data;
  while (size > 0) {
    const ssize_t n = read(fd, at, size);
    if (n == 0 || (n < 0 && errno != EINTR))
      return false;
    at += n > 0 ? n : 0;
    size -= n > 0 ? (size_t)n : 0;
  }
  return true;
}

bool guest_send(int fd, guest_kind kind, guest_status status, const char *text, const double *number, size_t nnumber) {
  const size_t length = text ? strlen(text) : 0;
  const head h = {(uint32_t)kind, (uint32_t)status, (uint32_t)(length < TEXT_MAX ? length : TEXT_MAX - 1),
                  (uint32_t)nnumber};
  return put(fd, &h, sizeof h) && put(fd, text, h.ntext) && put(fd, number, nnumber * sizeof *number);
}

bool guest_receive(int fd, guest_message *m) {
  head h;
  if (!take(fd, &h, sizeof h) || h.ntext >= TEXT_MAX || h.nnumber > NUMBERS_MAX)
    return false;
  if (m->text_room < h.ntext + 1) {
    char *text = realloc(m->text, h.ntext + 1);
    if (!text)
      return false;
    m->text = text;
    m->text_room = h.ntext + 1;
  }
  if (m->number_room < h.nnumber) {
    double *number = realloc(m->number, h.nnumber * sizeof *number);
    if (!number)
      return false;
    m->number = number;
    m->number_room = h.nnumber;
  }
  m->kind = (guest_kind)h.kind;
  m->status = (guest_status)h.status;
  m->nnumber = h.nnumber;
  if (!take(fd, m->text, h.ntext) || !take(fd, m->number, h.nnumber * sizeof *m->number))
    return false;
  m->text[h.ntext] = 0;
  return true;
}

void guest_message_free(guest_message *m) {
  free(m->text);
  free(m->number);
  *m = (guest_message){0};
}

/* Pictures of a run: see drawer.h.
 *
 * Orders go to tandem-draw through a socket, a line each. The first is {"pictures": [...], "planned": [...]}: the views
 * as the scene has them, and how many pictures of each are to come; then "VIEW NUMBER": PREFIX_NUMBER.frame is there.
 * The end of the orders is the end of the run.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/drawer.h"

#include "protocol/app/find.h"
#include "protocol/app/plot.h"
#include "protocol/base/interrupt.h"
#include "protocol/base/log.h"
#include "protocol/results/mark.h"
#include "protocol/view/frames.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define LOG_FILE "draw.log" /* what tandem-draw says; removed when it says nothing */

tdm_status tdm_drawer_begin(tdm_drawer *d, const tdm_pictures *pictures, json_t *json, const char *dir,
                            tdm_error *err) {
  *d = (tdm_drawer){.pictures = pictures, .orders = -1};
  if (pictures->count == 0)
    return TDM_OK;
  snprintf(d->dir, sizeof d->dir, "%s", dir);
  d->json = json_is_array(json) ? json_incref(json) : json_pack("[O]", json);
  d->drawn = calloc((size_t)pictures->count, sizeof *d->drawn);
  if (!d->drawn || !d->json)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for pictures");
  return TDM_OK;
}

/* ---- the program ---- */

static void close_orders(tdm_drawer *d) {
  if (d->orders >= 0)
    close(d->orders);
  d->orders = -1;
}

/* Send what the socket takes now. What a dead program does not take is of no use to anybody. */
static void send_orders(tdm_drawer *d) {
  size_t sent = 0;
  while (d->orders >= 0 && sent < d->nwaiting) {
    ssize_t n = send(d->orders, d->waiting + sent, d->nwaiting - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
      break;
    if (n < 0 && errno == EINTR)
      continue;
    if (n < 0) {
      close_orders(d);
    } else
      sent += (size_t)n;
  }
  if (d->orders < 0)
    sent = d->nwaiting;
  d->nwaiting -= sent;
  if (d->nwaiting > 0)
    memmove(d->waiting, d->waiting + sent, d->nwaiting);
}

static void order(tdm_drawer *d, const char *line) {
  size_t n = strlen(line);
  char *more = realloc(d->waiting, d->nwaiting + n + 1);
  if (!more) {
    tdm_fail(&d->notice, TDM_ERR_MEMORY, NULL, "no memory for pictures");
    return;
  }
  memcpy(more + d->nwaiting, line, n + 1);
  d->waiting = more;
  d->nwaiting += n;
  send_orders(d);
}

/* In the child, between fork and exec. It does not outlive the run, and the terminal's Ctrl-C is the run's business. */
static void become_drawer(const char *program, const char *dir, int orders, pid_t parent) {
  int out;
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent || chdir(dir) != 0 || (out = open(LOG_FILE, O_WRONLY | O_CREAT | O_TRUNC, 0666)) < 0)
    _exit(126);
  dup2(orders, 0);
  dup2(out, 1);
  dup2(out, 2);
  execl(program, "tandem-draw", "--orders", (char *)NULL);
  _exit(127);
}

static void send_settings(tdm_drawer *d) {
  json_t *planned = json_array(), *first;
  for (int k = 0; k < d->pictures->count; k++)
    json_array_append_new(planned, json_integer(d->pictures->picture[k].ntime));
  first = json_pack("{s:O, s:o}", "pictures", d->json, "planned", planned);
  char *text = first ? json_dumps(first, JSON_COMPACT) : NULL;
  json_decref(first);
  if (!text)
    tdm_fail(&d->notice, TDM_ERR_MEMORY, NULL, "no memory for pictures");
  else {
    order(d, text);
    order(d, "\n");
  }
  free(text);
}

static void start(tdm_drawer *d) {
  char program[4096];
  int ends[2];
  if (d->child || d->notice.status != TDM_OK)
    return;
  if (!tdm_find_program(program, sizeof program, "tandem-draw")) {
    tdm_fail(
        &d->notice, TDM_ERR_FILE, NULL,
        "no pictures: tandem-draw is neither beside this program nor in PATH; install it, then draw the frames that "
        "are there: tandem draw FILE.frame");
    return;
  }
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    tdm_fail(&d->notice, TDM_ERR_SYSTEM, NULL, "no pictures: no socket: %s", strerror(errno));
    return;
  }
  tdm_mark_add_in(d->dir, LOG_FILE);
  pid_t parent = getpid(), pid = fork();
  if (pid == 0)
    become_drawer(program, d->dir, ends[1], parent);
  close(ends[1]);
  d->orders = ends[0];
  if (pid < 0) {
    tdm_fail(&d->notice, TDM_ERR_SYSTEM, NULL, "no pictures: no process: %s", strerror(errno));
    return;
  }
  d->child = pid;
  send_settings(d);
}

/* ---- frames ---- */

static tdm_status write_frame(tdm_drawer *d, const char *path, const tdm_scenery *scenery, const tdm_snapshot *snapshot,
                              tdm_error *err) {
  d->bytes.size = 0;
  if (tdm_scenery_encode(scenery, false, &d->bytes, err) != TDM_OK ||
      tdm_snapshot_encode(snapshot, false, &d->bytes, err) != TDM_OK)
    return err->status;
  FILE *f = fopen(path, "wb");
  bool bad = !f || fwrite(d->bytes.data, 1, d->bytes.size, f) != d->bytes.size;
  int why = errno;
  if (f && fclose(f) != 0 && !bad) {
    bad = true;
    why = errno;
  }
  return bad ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(why)) : TDM_OK;
}

tdm_status tdm_drawer_submit(tdm_drawer *d, int k, const tdm_scenery *scenery, const tdm_snapshot *snapshot,
                             tdm_error *err) {
  char prefix[96], name[128], path[4352], line[64];
  tdm_picture_prefix(&d->pictures->picture[k], prefix, sizeof prefix);
  snprintf(name, sizeof name, "%s_%03d.png", prefix, d->drawn[k]);
  tdm_mark_add_in(d->dir, name);
  snprintf(name, sizeof name, "%s_%03d.frame", prefix, d->drawn[k]);
  tdm_mark_add_in(d->dir, name);
  snprintf(path, sizeof path, "%s/%s", d->dir, name);
  if (write_frame(d, path, scenery, snapshot, err) != TDM_OK)
    return err->status;
  start(d);
  snprintf(line, sizeof line, "%d %d\n", k, d->drawn[k]++);
  if (d->child)
    order(d, line);
  return TDM_OK;
}

/* ---- end ---- */

/* Its exit status; -1: it could not be waited for or was ended: by a signal to us, or as it took too long. */
static int wait_for_child(tdm_drawer *d, double limit) {
  double deadline = tdm_clock() + limit;
  int signals = tdm_signal_count, status;
  while (true) {
    pid_t got = waitpid(d->child, &status, WNOHANG);
    if (got == d->child)
      break;
    if (got < 0 && errno != EINTR)
      return -1;
    send_orders(d);
    if (d->nwaiting == 0) /* that was the last one */
      close_orders(d);
    if (tdm_signal_count != signals || tdm_clock() > deadline) {
      if (tdm_signal_count != signals)
        tdm_fail(&d->notice, TDM_ERR_INTERRUPTED, NULL,
                 "interrupted while pictures were drawn; those that are missing can be made: tandem draw FILE.frame");
      else
        tdm_fail(&d->notice, TDM_ERR_TIMEOUT, NULL,
                 "tandem-draw took longer than %g s and was ended; TANDEM_PLOT_TIMEOUT in the environment sets another "
                 "limit for a picture [s]",
                 limit);
      kill(d->child, SIGKILL);
      while (waitpid(d->child, &status, 0) < 0 && errno == EINTR)
        ;
      return -1;
    }
    nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* The first line that it said, as the notice; its log goes when it said nothing. */
static void take_log(tdm_drawer *d, int status) {
  char path[4352], line[512] = "";
  snprintf(path, sizeof path, "%s/" LOG_FILE, d->dir);
  FILE *f = fopen(path, "r");
  if (f) {
    if (!fgets(line, sizeof line, f))
      line[0] = 0;
    fclose(f);
  }
  line[strcspn(line, "\n")] = 0;
  tdm_utf8_clean(line);
  if (status == 0 && !*line) {
    unlink(path);
    return;
  }
  if (!*line)
    snprintf(line, sizeof line, status == 127 ? "tandem-draw cannot be started" : "tandem-draw ended with status %d",
             status);
  tdm_fail(&d->notice, TDM_ERR_FILE, NULL, "pictures are missing: %s (%s); draw what is left: tandem draw FILE.frame",
           line, path);
}

static int submitted(const tdm_drawer *d) {
  int n = 0;
  for (int k = 0; d->drawn && k < d->pictures->count; k++)
    n += d->drawn[k];
  return n;
}

static void mark_rows(const tdm_drawer *d) {
  for (int k = 0; k < d->pictures->count; k++) {
    char name[128];
    tdm_picture_row_name(&d->pictures->picture[k], name, sizeof name);
    if (d->drawn[k] > 1)
      tdm_mark_add_in(d->dir, name);
  }
}

void tdm_drawer_finish(tdm_drawer *d, tdm_error *notice) {
  if (d->child) {
    mark_rows(d);
    take_log(d, wait_for_child(d, tdm_plot_patience() * (1 + submitted(d))));
    d->child = 0;
  }
  close_orders(d);
  if (d->notice.status != TDM_OK)
    tdm_fail(notice, d->notice.status, NULL, "%s", d->notice.message);
}

void tdm_drawer_end(tdm_drawer *d) {
  if (d->child) {
    kill(d->child, SIGKILL);
    while (waitpid(d->child, NULL, 0) < 0 && errno == EINTR)
      ;
  }
  if (d->pictures)
    close_orders(d);
  json_decref(d->json);
  free(d->drawn);
  free(d->waiting);
  tdm_view_bytes_free(&d->bytes);
  *d = (tdm_drawer){.orders = -1};
}

/* The mark of a result directory: see mark.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/mark.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char file_name[] = ".tandem";
static const char head[] = "tandem results: a new run may remove the files that are named below\n";
static const char results_line[] = "holds results\n";
static const char file_word[] = "file ";

static void path_of(const char *dir, char *out, size_t size) {
  snprintf(out, size, "%s/%s", dir, file_name);
}

static bool write_text(int fd, const char *text) {
  size_t n = strlen(text);
  return write(fd, text, n) == (ssize_t)n;
}

/* All of the file as text; NULL: none. */
static char *read_text(int fd) {
  struct stat is;
  if (fstat(fd, &is) != 0 || !S_ISREG(is.st_mode))
    return NULL;
  char *text = calloc((size_t)is.st_size + 1, 1);
  ssize_t n = text ? pread(fd, text, (size_t)is.st_size, 0) : -1;
  if (n < 0) {
    free(text);
    return NULL;
  }
  text[n] = 0;
  return text;
}

/* A whole line of the text. */
static bool has_line(const char *text, const char *line) {
  size_t n = strlen(line);
  for (const char *p = text; p && (p = strstr(p, line)) != NULL; p += n)
    if (p == text || p[-1] == '\n')
      return true;
  return false;
}

static bool is_mark(const char *text) {
  return text && strncmp(text, head, strlen(head)) == 0;
}

/* Whether anything but the mark lies in the directory. */
static bool holds_files(const char *dir) {
  DIR *d = opendir(dir);
  bool some = false;
  for (struct dirent *e; d && !some && (e = readdir(d)) != NULL;)
    some = strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0 && strcmp(e->d_name, file_name) != 0;
  if (d)
    closedir(d);
  return some;
}

/* Open and lock, again when the file was removed in between. */
static tdm_status open_locked(tdm_mark *mark, const char *path, const char *dir, tdm_error *err) {
  struct stat is = {0};
  do {
    if (mark->open)
      close(mark->fd);
    mark->fd = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    mark->open = mark->fd >= 0;
    if (!mark->open)
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s; give another directory with --out", path,
                      strerror(errno));
    if (flock(mark->fd, LOCK_EX | LOCK_NB) != 0)
      return errno == EWOULDBLOCK
                 ? tdm_fail(err, TDM_ERR_FILE, NULL,
                            "%s: another run writes into this directory; give another one with --out", dir)
                 : tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be locked: %s; give another directory with --out",
                            path, strerror(errno));
  } while (fstat(mark->fd, &is) == 0 && is.st_nlink == 0);
  return TDM_OK;
}

tdm_status tdm_mark_open(tdm_mark *mark, const char *dir, bool force, tdm_error *err) {
  char path[4352];
  *mark = (tdm_mark){0};
  path_of(dir, path, sizeof path);
  if (open_locked(mark, path, dir, err) != TDM_OK) {
    tdm_mark_close(mark, dir, false);
    return err->status;
  }
  char *text = read_text(mark->fd);
  mark->made = text && !*text;
  mark->results = has_line(text, results_line);
  if (!mark->made && !is_mark(text))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: is no mark of tandem's; give another directory with --out", path);
  else if (mark->made && !force && holds_files(dir))
    tdm_fail(err, TDM_ERR_FILE, NULL,
             "%s: holds files, and none of them says that they are tandem's; give another directory with --out, or "
             "let it write between them with --force",
             dir);
  else if (mark->made && !write_text(mark->fd, head))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s; give another directory with --out", path,
             strerror(errno));
  free(text);
  if (err->status != TDM_OK)
    tdm_mark_close(mark, dir, true);
  return err->status;
}

void tdm_mark_close(tdm_mark *mark, const char *dir, bool undo) {
  char path[4352];
  if (!mark->open)
    return;
  path_of(dir, path, sizeof path);
  if (undo && mark->made && tdm_mark_there(mark, dir))
    unlink(path);
  close(mark->fd);
  *mark = (tdm_mark){0};
}

/* The name is one of a file in the directory itself, whoever wrote the mark. */
static bool plain(const char *name) {
  return *name && !strchr(name, '/') && strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
         strcmp(name, file_name) != 0;
}

void tdm_mark_clear(tdm_mark *mark, const char *dir) {
  char *text = read_text(mark->fd), path[4352], *rest = text;
  for (char *line; rest && (line = strsep(&rest, "\n")) != NULL;) {
    const char *name = line + strlen(file_word);
    if (strncmp(line, file_word, strlen(file_word)) != 0 || !plain(name) ||
        snprintf(path, sizeof path, "%s/%s", dir, name) >= (int)sizeof path)
      continue;
    unlink(path);
  }
  free(text);
  mark->results = false;
  if (ftruncate(mark->fd, 0) == 0)
    write_text(mark->fd, head);
}

void tdm_mark_results(tdm_mark *mark) {
  mark->results = write_text(mark->fd, results_line);
}

static void add_line(int fd, const char *name) {
  char line[512], *text = read_text(fd);
  snprintf(line, sizeof line, "%s%.400s\n", file_word, name);
  if (plain(name) && !strchr(name, '\n') && is_mark(text) && !has_line(text, line))
    write_text(fd, line);
  free(text);
}

void tdm_mark_add(const tdm_mark *mark, const char *name) {
  if (mark->open)
    add_line(mark->fd, name);
}

static int open_in(const char *dir) {
  char path[4352];
  path_of(dir, path, sizeof path);
  return open(path, O_RDWR | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
}

void tdm_mark_add_in(const char *dir, const char *name) {
  int fd = open_in(dir);
  if (fd < 0)
    return;
  add_line(fd, name);
  close(fd);
}

bool tdm_mark_lists(const tdm_mark *mark, const char *name) {
  char line[512], *text = read_text(mark->fd);
  snprintf(line, sizeof line, "%s%.400s\n", file_word, name);
  bool listed = has_line(text, line);
  free(text);
  return listed;
}

bool tdm_mark_there(const tdm_mark *mark, const char *dir) {
  char path[4352];
  struct stat here, there;
  path_of(dir, path, sizeof path);
  return !mark->open || (fstat(mark->fd, &here) == 0 && stat(path, &there) == 0 && here.st_dev == there.st_dev &&
                         here.st_ino == there.st_ino);
}

bool tdm_mark_has(const char *dir) {
  int fd = open_in(dir);
  char *text = fd < 0 ? NULL : read_text(fd);
  bool has = is_mark(text);
  free(text);
  if (fd >= 0)
    close(fd);
  return has;
}

/* A directory of the server's own for as long as it lives: see private.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/run/private.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const char prefix[] = "tandem-", placeholder[] = "XXXXXX"; /* of the directory's name */
static const char lock_name[] = ".tandem-lock", new_lock_name[] = ".tandem-lock.new";

static const char *temporary(void) {
  const char *dir = getenv("TMPDIR");
  return dir && *dir && strlen(dir) < 80 ? dir : "/tmp";
}

/* The files of a directory, and itself. Directories in it are nobody's that we know: then both stay. */
static void remove_all(const char *path) {
  DIR *d = opendir(path);
  for (struct dirent *e; d && (e = readdir(d)) != NULL;)
    if (strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0)
      unlinkat(dirfd(d), e->d_name, 0);
  if (d)
    closedir(d);
  rmdir(path);
}

/* A directory that such a server made: this user's own, closed to others, with a lock that nobody holds. */
static bool is_dead(const char *path) {
  struct stat is;
  if (lstat(path, &is) != 0 || !S_ISDIR(is.st_mode) || is.st_uid != geteuid() || (is.st_mode & 0777) != 0700)
    return false;
  int dir = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  int lock = dir < 0 ? -1 : openat(dir, lock_name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  bool dead = lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0;
  if (lock >= 0)
    close(lock);
  if (dir >= 0)
    close(dir);
  return dead;
}

static void remove_dead(void) {
  DIR *d = opendir(temporary());
  for (struct dirent *e; d && (e = readdir(d)) != NULL;) {
    char path[512];
    if (strncmp(e->d_name, prefix, strlen(prefix)) != 0 || strlen(e->d_name) != strlen(prefix) + strlen(placeholder) ||
        snprintf(path, sizeof path, "%s/%s", temporary(), e->d_name) >= (int)sizeof path)
      continue;
    if (is_dead(path))
      remove_all(path);
  }
  if (d)
    closedir(d);
}

tdm_status cpl_private_make(cpl_private *p, tdm_error *err) {
  char lock[160], new_lock[160];
  remove_dead();
  snprintf(p->dir, sizeof p->dir, "%s/%s%s", temporary(), prefix, placeholder);
  if (!mkdtemp(p->dir)) { /* makes it with mode 0700 */
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be made: %s; set TMPDIR to a directory that can be written", p->dir,
             strerror(errno));
    p->dir[0] = 0;
    return err->status;
  }
  /* under its name only once it is locked: a lock of that name that is free is a dead server's */
  snprintf(lock, sizeof lock, "%s/%s", p->dir, lock_name);
  snprintf(new_lock, sizeof new_lock, "%s/%s", p->dir, new_lock_name);
  p->lock = open(new_lock, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (p->lock >= 0 && flock(p->lock, LOCK_EX | LOCK_NB) == 0 && rename(new_lock, lock) == 0)
    return TDM_OK;
  tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s; set TMPDIR to a directory that can be written", p->dir,
           strerror(errno));
  cpl_private_remove(p);
  return err->status;
}

void cpl_private_remove(cpl_private *p) {
  if (!p->dir[0])
    return;
  remove_all(p->dir);
  if (p->lock >= 0)
    close(p->lock);
  *p = (cpl_private){0};
}

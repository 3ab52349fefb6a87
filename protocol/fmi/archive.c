/* An FMU's files, unpacked: see archive.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/archive.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

static const uint64_t most = UINT64_C(4) << 30; /* bytes of all files together */
enum { ENTRIES_MAX = 100000 };

/* ---- the directory ---- */

static int remove_entry(const char *path, const struct stat *is, int flag, struct FTW *where) {
  (void)is;
  (void)flag;
  (void)where;
  remove(path);
  return 0;
}

static void remove_all(const char *dir) {
  nftw(dir, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* A process that outlives this one by as long as it takes to remove the directory: an FMU may crash, and one that hangs
 * is killed. It waits at a pipe whose other end only this process has. */
static tdm_status remove_at_end(const char *dir, tdm_error *err) {
  int end[2];
  if (pipe(end) != 0)
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "cannot make a pipe: %s", strerror(errno));
  fcntl(end[1], F_SETFD, FD_CLOEXEC);
  const pid_t pid = fork();
  if (pid < 0) {
    close(end[0]);
    close(end[1]);
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "cannot start a process: %s", strerror(errno));
  }
  close(pid == 0 ? end[1] : end[0]);
  if (pid != 0)
    return TDM_OK;
  char byte;
  setsid(); /* signals of the terminal are for others */
  for (int fd = 0; fd < 256; fd++)
    if (fd != end[0])
      close(fd);
  signal(SIGTERM, SIG_IGN);
  while (read(end[0], &byte, 1) < 0 && errno == EINTR)
    continue;
  remove_all(dir);
  _exit(0);
}

static tdm_status make_dir(char *dir, tdm_error *err) {
  char absolute[PATH_MAX];
  const char *temporary = getenv("TMPDIR");
  if (!temporary || !*temporary)
    temporary = "/tmp";
  if (realpath(temporary, absolute)) /* FMUs are told of it as a URI */
    temporary = absolute;
  if (strlen(temporary) > TDM_FMI_DIR_MAX - 32)
    temporary = "/tmp";
  snprintf(dir, TDM_FMI_DIR_MAX, "%s/tandem-fmu-XXXXXX", temporary);
  if (mkdtemp(dir))
    return TDM_OK;
  tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be made: %s; set TMPDIR to a directory that can be written", dir,
           strerror(errno));
  dir[0] = 0;
  return err->status;
}

/* ---- files ---- */

/* A name that stays below the directory. */
static bool is_inside(const char *name) {
  if (name[0] == '/' || strchr(name, '\\'))
    return false;
  for (const char *part = name; part; part = strchr(part, '/')) {
    part += part != name || *part == '/';
    if (strncmp(part, "..", 2) == 0 && (part[2] == 0 || part[2] == '/'))
      return false;
  }
  return true;
}

/* The folders that a path of a file lies in. */
static void make_folders(char *path) {
  for (char *p = strchr(path + 1, '/'); p; p = strchr(p + 1, '/')) {
    *p = 0;
    mkdir(path, 0700);
    *p = '/';
  }
}

static tdm_status too_large(const char *file, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: would need more than 4 GiB when unpacked", file);
}

/* `left`: bytes that may be written still; the sizes that an archive declares may be wrong. */
static tdm_status unpack_entry(zip_t *zip, const zip_stat_t *entry, const char *file, const char *dir, uint64_t *left,
                               tdm_error *err) {
  char path[4096], block[65536];
  if (!is_inside(entry->name) || snprintf(path, sizeof path, "%s/%s", dir, entry->name) >= (int)sizeof path)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: has an entry \"%s\" that would not lie in the FMU's own folder", file,
                    entry->name);
  make_folders(path);
  if (path[strlen(path) - 1] == '/')
    return TDM_OK;
  zip_file_t *in = zip_fopen_index(zip, entry->index, 0);
  FILE *out = in ? fopen(path, "we") : NULL;
  zip_int64_t got = -1;
  while (out && (got = zip_fread(in, block, sizeof block)) > 0) {
    if ((uint64_t)got > *left || fwrite(block, 1, (size_t)got, out) != (size_t)got)
      break;
    *left -= (uint64_t)got;
  }
  const bool full = got > 0 && (uint64_t)got > *left, good = out && got == 0;
  const bool closed = !out || fclose(out) == 0;
  if (full)
    too_large(file, err);
  else if (!good || !closed)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: \"%s\" cannot be unpacked to %s: %s", file, entry->name, dir,
             in && !out ? strerror(errno) : "the archive is damaged, or the disk is full");
  if (in)
    zip_fclose(in);
  return err->status;
}

tdm_status tdm_archive_unpack(const char *file, char *dir, tdm_error *err) {
  int why = 0;
  uint64_t left = most;
  dir[0] = 0;
  zip_t *zip = zip_open(file, ZIP_RDONLY, &why);
  if (!zip) {
    zip_error_t error;
    zip_error_init_with_code(&error, why);
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: is no FMU that can be read: %s", file, zip_error_strerror(&error));
    zip_error_fini(&error);
    return err->status;
  }
  if (make_dir(dir, err) == TDM_OK)
    remove_at_end(dir, err);
  const zip_int64_t n = zip_get_num_entries(zip, 0);
  if (err->status == TDM_OK && n > ENTRIES_MAX)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: has more than %d entries", file, ENTRIES_MAX);
  for (zip_int64_t i = 0; i < n && err->status == TDM_OK; i++) {
    zip_stat_t entry;
    const zip_uint64_t due = ZIP_STAT_NAME | ZIP_STAT_SIZE;
    if (zip_stat_index(zip, (zip_uint64_t)i, 0, &entry) != 0 || (entry.valid & due) != due)
      tdm_fail(err, TDM_ERR_FILE, NULL, "%s: the archive is damaged: %s", file, zip_strerror(zip));
    else if (entry.size > left)
      too_large(file, err);
    else
      unpack_entry(zip, &entry, file, dir, &left, err);
  }
  zip_discard(zip);
  if (err->status != TDM_OK)
    tdm_archive_remove(dir);
  return err->status;
}

void tdm_archive_remove(char *dir) {
  if (dir[0])
    remove_all(dir);
  dir[0] = 0;
}

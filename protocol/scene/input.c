/* Opening the files that a scene or a command names: see input.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/scene/input.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

FILE *tdm_open_input(const char *file, bool stream, const char **why) {
  struct stat is;
  *why = NULL;
  if (stat(file, &is) != 0)
    *why = strerror(errno);
  else if (S_ISDIR(is.st_mode))
    *why = "it is a folder";
  else if (!S_ISREG(is.st_mode) && !(stream && (S_ISFIFO(is.st_mode) || S_ISCHR(is.st_mode))))
    *why = "it is no file but a device or a pipe"; /* opening a pipe would wait for somebody who writes */
  if (*why)
    return NULL;
  FILE *f = fopen(file, "rbe");
  if (!f)
    *why = strerror(errno);
  return f;
}

/* Where scenes and programs are: see find.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/find.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int is_file(const char *path) {
  struct stat s;
  return stat(path, &s) == 0 && S_ISREG(s.st_mode);
}

/* The share folder beside the folder that this program lies in, wherever that was put. */
static void share_dir(char *out, size_t size) {
  char self[2048];
  ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  self[n > 0 ? n : 0] = 0;
  for (int i = 0; i < 2 && strrchr(self, '/'); i++)
    *strrchr(self, '/') = 0;
  snprintf(out, size, "%s/share/tandem/scenarios", self);
}

/* What runs the scenarios of each group. */
static const struct {
  const char *group, *program, *what;
} groups[] = {{.group = "", .program = "tandem", .what = "a co-simulation"},
              {.group = "dem", .program = "tandem-dem", .what = "particles alone"},
              {.group = "mbd", .program = "tandem-mbd", .what = "bodies alone"}};

/* A scenario of that name in another group than the one that was asked for; -1: there is none. */
static int other_group(const char *group, const char *name, const char *const *place, int nplace) {
  char path[4096];
  for (int g = 0; g < 3; g++)
    for (int i = 0; i < nplace && strcmp(groups[g].group, group) != 0; i++) {
      snprintf(path, sizeof path, "%s/%s/%s/scene.json", place[i], groups[g].group, name);
      if (is_file(path))
        return g;
    }
  return -1;
}

tdm_status tdm_find_scene(char *out, size_t size, const char *group, const char *name, const char *dir,
                          tdm_error *err) {
  char share[2200];
  share_dir(share, sizeof share);
  const char *const usual[] = {"scenarios", share};
  const char *const *place = dir ? &dir : usual;
  int nplace = dir ? 1 : 2;
  snprintf(out, size, "%s", name);
  if (is_file(out))
    return TDM_OK;
  if (strchr(name, '/') || strstr(name, ".json")) { /* meant as a file */
    for (int i = 0; i < nplace; i++) {
      snprintf(out, size, "%s/%s", place[i], name);
      if (is_file(out))
        return TDM_OK;
    }
    snprintf(out, size, "%s", name);
    return TDM_OK; /* reading it tells what is wrong */
  }
  char looked[1024] = "";
  for (int i = 0; i < nplace; i++) {
    snprintf(out, size, "%s/%s%s%s/scene.json", place[i], group, *group ? "/" : "", name);
    if (is_file(out))
      return TDM_OK;
    snprintf(looked + strlen(looked), sizeof looked - strlen(looked), "%s%s%s%s", i ? ", " : "", place[i],
             *group ? "/" : "", group);
  }
  int other = other_group(group, name, place, nplace);
  if (other >= 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: this scenario is %s; run it with: %s run %s", name,
                    groups[other].what, groups[other].program, name);
  return tdm_fail(err, TDM_ERR_FILE, NULL,
                  "%s: neither a scene file nor a scenario in %s; name a file, or give --scenarios DIR", name, looked);
}

tdm_status tdm_find_scenario_file(char *out, size_t size, const char *name, const char *dir, tdm_error *err) {
  char share[2200];
  share_dir(share, sizeof share);
  const char *const place[] = {dir ? dir : "scenarios", share};
  for (int i = 0; i < (dir ? 1 : 2); i++) {
    snprintf(out, size, "%s/%s", place[i], name);
    if (is_file(out))
      return TDM_OK;
  }
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: there is no such file in %s; give --scenarios DIR", name, place[0]);
}

/* ---- programs ---- */

static bool is_program(const char *path) {
  return is_file(path) && access(path, X_OK) == 0;
}

bool tdm_find_program(char *out, size_t size, const char *name) {
  if (strchr(name, '/')) {
    snprintf(out, size, "%s", name);
    return is_program(out);
  }
  char self[4096];
  ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n > 0) {
    self[n] = 0;
    char *slash = strrchr(self, '/');
    if (slash && snprintf(out, size, "%.*s/%s", (int)(slash - self), self, name) < (int)size && is_program(out))
      return true;
  }
  for (const char *path = getenv("PATH"); path && *path;) {
    size_t length = strcspn(path, ":");
    if (snprintf(out, size, "%.*s/%s", (int)length, path, name) < (int)size && is_program(out))
      return true;
    path += length + (path[length] == ':');
  }
  return false;
}

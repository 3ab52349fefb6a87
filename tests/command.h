/* Running the tandem executable as a user would, with its output caught. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_COMMAND_H
#define TEST_COMMAND_H

#include "tests/scene_json.h"

#include <check.h>
#include <ctype.h>
#include <dirent.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static char command_output[16384]; /* of the last command, standard output and error together */

/* Run a shell command line ("tandem" stands for the executable just built). Returns its exit status, 128 + n after
 * signal n, 124 when it hangs. */
static inline int command(const char *format, ...) {
  char words[4096], line[8192];
  va_list args;
  va_start(args, format);
  vsnprintf(words, sizeof words, format, args);
  va_end(args);
  snprintf(line, sizeof line, "PATH=" TANDEM_BIN_DIR ":" TANDEM_TEST_DIR ":$PATH; exec 2>&1; timeout 600 %s", words);
  FILE *pipe = popen(line, "r");
  ck_assert_ptr_nonnull(pipe);
  size_t n = fread(command_output, 1, sizeof command_output - 1, pipe);
  command_output[n] = 0;
  char rest[4096];
  while (fread(rest, 1, sizeof rest, pipe) > 0)
    ;
  int status = pclose(pipe);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* A command that refuses its input: an exit status of its own, not a signal. */
static inline bool is_refusal(int status) {
  return status == 1 || status == 2;
}

/* The output of the last command has this text. */
#define expect_output(text) \
  ck_assert_msg(strstr(command_output, text) != NULL, "no \"%s\" in the output:\n%s", text, command_output)

/* A directory that a test may fill; removed by directory_remove. It becomes TMPDIR as well, so that the ipc directories
 * of the runs lie in it and their solvers' command lines have its name. */
static inline const char *directory_make(void) {
  static char name[64];
  strcpy(name, "/tmp/tandem-test-XXXXXX");
  ck_assert_ptr_nonnull(mkdtemp(name));
  setenv("TMPDIR", name, 1);
  return name;
}

static inline void directory_remove(const char *name) {
  char line[256];
  snprintf(line, sizeof line, "rm -rf '%s'", name);
  ck_assert_int_eq(system(line), 0);
}

static inline void write_file(const char *dir, const char *name, const char *text) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", dir, name);
  FILE *f = fopen(path, "w");
  ck_assert_ptr_nonnull(f);
  fputs(text, f);
  fclose(f);
}

/* A new directory (directory_make) with the file scene.json. Single quotes in the text become double ones, so that JSON
 * may be written in C without backslashes. */
static inline const char *directory_with_scene(const char *scene) {
  char text[8192];
  const char *dir = directory_make();
  ck_assert_uint_lt(strlen(scene), sizeof text);
  strcpy(text, scene);
  double_quotes(text);
  write_file(dir, "scene.json", text);
  return dir;
}

/* DIR/OUT/NAME exists. */
static inline bool is_there(const char *dir, const char *out, const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s/%s", dir, out, name);
  return access(path, F_OK) == 0;
}

/* Start `tandem` with these arguments (NULL-terminated, the program's name not among them), its output to DIR/output.
 */
static inline pid_t background(const char *dir, const char *const *arguments) {
  pid_t pid = fork();
  if (pid != 0)
    return pid;
  char path[256];
  const char *argv[32] = {"tandem"};
  for (int i = 0; i < 30 && arguments[i]; i++)
    argv[i + 1] = arguments[i];
  snprintf(path, sizeof path, "%s/output", dir);
  if (!freopen(path, "w", stdout) || dup2(1, 2) < 0)
    _exit(126);
  execv(TANDEM_BIN_DIR "/tandem", (char *const *)argv);
  _exit(127);
}

/* Wait for an event. What never comes ends with the test's own limit (test_main.h), as any hang does. */
#define WAIT_FOR(event) \
  do {                  \
    while (!(event))    \
      usleep(10000);    \
  } while (0)

/* Wait for a background process to end; its exit status, 128 + the signal that ended it. */
static inline int background_end(pid_t pid) {
  int status;
  if (waitpid(pid, &status, 0) != pid)
    return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* It has not ended yet. */
static inline bool background_runs(pid_t pid) {
  return waitpid(pid, NULL, WNOHANG) == 0;
}

/* What a background process has printed so far, into command_output. */
static inline void background_output(const char *dir) {
  char path[256];
  snprintf(path, sizeof path, "%s/output", dir);
  FILE *f = fopen(path, "r");
  size_t n = f ? fread(command_output, 1, sizeof command_output - 1, f) : 0;
  command_output[n] = 0;
  if (f)
    fclose(f);
}

/* It has printed this. */
static inline bool background_said(const char *dir, const char *text) {
  background_output(dir);
  return strstr(command_output, text) != NULL;
}

/* The processes (zombies left out) whose command line has this text: their number, and the last one's id in *pid. */
static inline int find_processes(const char *text, pid_t *pid) {
  DIR *proc = opendir("/proc");
  int found = 0;
  for (struct dirent *entry; proc && (entry = readdir(proc)) != NULL;) {
    char path[300], line[4096] = "";
    if (!isdigit((unsigned char)entry->d_name[0]))
      continue;
    snprintf(path, sizeof path, "/proc/%s/cmdline", entry->d_name);
    FILE *f = fopen(path, "r");
    size_t n = f ? fread(line, 1, sizeof line - 1, f) : 0; /* empty for a zombie */
    if (f)
      fclose(f);
    for (size_t i = 0; i + 1 < n; i++)
      line[i] = line[i] ? line[i] : ' ';
    if (strstr(line, text) == NULL)
      continue;
    found++;
    if (pid)
      *pid = (pid_t)atoi(entry->d_name);
  }
  if (proc)
    closedir(proc);
  return found;
}

/* Processor time that a process has used [s]; 0 when there is none. */
static inline double processor_time(pid_t pid) {
  char path[64], line[1024] = "";
  unsigned long user = 0, system = 0;
  snprintf(path, sizeof path, "/proc/%d/stat", (int)pid);
  FILE *f = fopen(path, "r");
  if (f && fgets(line, sizeof line, f) && strrchr(line, ')'))
    sscanf(strrchr(line, ')') + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user, &system);
  if (f)
    fclose(f);
  return (double)(user + system) / (double)sysconf(_SC_CLK_TCK);
}

/* Lines of a file so far; 0 when there is none. */
static inline int lines_of(const char *dir, const char *name) {
  char path[512];
  int lines = 0;
  snprintf(path, sizeof path, "%s/%s", dir, name);
  FILE *f = fopen(path, "r");
  for (int c; f && (c = fgetc(f)) != EOF;)
    lines += c == '\n';
  if (f)
    fclose(f);
  return lines;
}

/* No process of the runs in this directory is left, and none of their ipc directories. */
static inline void expect_nothing_left(const char *dir) {
  char socket[128], line[256];
  snprintf(socket, sizeof socket, "%s/tandem-", dir);
  ck_assert_int_eq(find_processes(socket, NULL), 0);
  snprintf(line, sizeof line, "ls -d %s* >/dev/null 2>&1", socket);
  ck_assert_msg(system(line) != 0, "an ipc directory is left in %s", dir);
}

#endif

/* A scene from an Adams data set: see import.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/app/import.h"

#include "mbd/adams/model.h"
#include "mbd/scene/scene.h"
#include "protocol/app/command_line.h"
#include "protocol/base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char help[] =
    "tandem-mbd import FILE.adm [--out SCENE] [--end SECONDS] [--force] [--strict]\n\n"
    "Make a scene of an Adams data set. What a scene cannot hold is left out and named with its line.\n"
    "docs/adams.md says what becomes of each statement.\n\n"
    "  --out SCENE       the scene's file (default: FILE.json)\n"
    "  --end SECONDS     how long the scene runs (default: 1; a data set does not say it)\n"
    "  --force           replace SCENE\n"
    "  --strict          refuse a data set of which something that may act is left out\n"
    "  --help\n";

static const char program[] = "tandem-mbd";

enum { COLUMNS = 110 };

typedef struct {
  tdm_arguments given;
  const char *out, *end;
  bool force, strict, help;
  double seconds;
} arguments;

static tdm_status parse(arguments *a, int argc, char **argv, tdm_error *err) {
  const tdm_option options[] = {{.name = "--out", .value = &a->out},
                                {.name = "--end", .value = &a->end},
                                {.name = "--force", .flag = &a->force},
                                {.name = "--strict", .flag = &a->strict},
                                {.name = "--help", .flag = &a->help}};
  *a = (arguments){.seconds = 1};
  if (tdm_arguments_read(&a->given, options, sizeof options / sizeof options[0], "tandem-mbd import", argc, argv,
                         err) != TDM_OK ||
      a->help)
    return err->status;
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "import: name one data set; see tandem-mbd import --help");
  if (a->end) {
    char *rest;
    a->seconds = strtod(a->end, &rest);
    if (*rest || !(a->seconds > 0 && a->seconds < 1e9))
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--end %s: give seconds, a number above 0", a->end);
  }
  return TDM_OK;
}

/* ---- the file ---- */

/* Whether the list at `text`, behind its "[", has neither lists nor objects; *length is that of what is in it. */
static bool flat(const char *text, size_t *length) {
  *length = strcspn(text, "[]{}");
  return text[*length] == ']';
}

/* The words of a list up to `end`, in lines that are full; returns `end`. */
static const char *write_list(FILE *f, const char *p, const char *end, int column) {
  for (p += strspn(p, " \n"); p < end; p += strspn(p, " \n")) {
    const size_t word = strcspn(p, ",\n");
    fwrite(p, 1, word, f);
    column += (int)word + 2;
    p += word;
    if (*p != ',')
      continue;
    p++;
    fputs(column > COLUMNS ? ",\n" : ", ", f);
    column = column > COLUMNS ? 0 : column;
  }
  return end;
}

/* Indented JSON with lists of numbers and words in lines that are full, as a person writes a scene. */
static void write_text(FILE *f, const char *text) {
  int column = 0;
  bool quoted = false;
  size_t n;
  for (const char *p = text; *p;) {
    const char c = *p++;
    fputc(c, f);
    column = c == '\n' ? 0 : column + 1;
    if (c == '\\') /* in a string: what follows belongs to it */
      fputc(*p++, f);
    quoted = quoted != (c == '"');
    if (c == '[' && !quoted && flat(p, &n))
      p = write_list(f, p, p + n, column);
  }
  fputc('\n', f);
}

/* With `force` a file beside it takes the place of an old one when it is whole; a device or link is written to. */
static tdm_status write_scene(const json_t *scene, const char *out, bool force, tdm_error *err) {
  char part[4400];
  struct stat old;
  const bool there = force && lstat(out, &old) == 0, replaces = there && S_ISREG(old.st_mode);
  char *text = json_dumps(scene, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
  if (!text)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the text of %s", out);
  snprintf(part, sizeof part, "%s.part", out);
  const char *path = replaces ? part : out;
  errno = 0;
  FILE *f = fopen(path, force ? "w" : "wx");
  if (f)
    write_text(f, text);
  free(text);
  const bool bad = !f || ferror(f);
  if ((f && fclose(f) != 0) || bad || (replaces && rename(part, out) != 0)) {
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", out, strerror(errno));
    if (f && (replaces || !there))
      unlink(path);
  }
  return err->status;
}

/* ---- the command ---- */

static void print_list(const char *what, const json_t *list) {
  size_t i;
  json_t *line;
  json_array_foreach(list, i, line) printf("%s: %s\n", what, json_string_value(line));
}

/* The solver must be able to read what came out. */
static tdm_status try_scene(const json_t *scene, const char *file, tdm_error *err) {
  tdm_error refused = {0};
  mbd_model *model = NULL;
  json_t *section = json_deep_copy(json_object_get(scene, "mbd"));
  mbd_model_read(&model, section, false, &refused);
  mbd_model_destroy(&model);
  json_decref(section);
  if (refused.status)
    tdm_fail(err, refused.status, NULL, "%s: gives a scene that the solver refuses, at %s: %s", file, refused.path,
             refused.message);
  return err->status;
}

static void print_summary(const adm_model *m, const char *out) {
  print_list("note", m->notes);
  print_list("not needed", m->shown);
  print_list("left out", m->left_out);
  printf("%d bodies, %d joints, %d drivers, %d forces; %d statements read, %d not needed (they move nothing), %d left "
         "out; the scene is %s\n",
         (int)json_array_size(m->bodies), (int)json_array_size(m->joints), (int)json_array_size(m->drivers),
         (int)json_array_size(m->forces), m->nread, m->nshown, (int)json_array_size(m->left_out), out);
}

static tdm_status import(const arguments *a, const char *file, const char *out, tdm_error *err) {
  adm_model m = {0};
  json_t *scene = NULL;
  const unsigned long before = tdm_memory_notes();
  if (!a->force && access(out, F_OK) == 0)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: is there already; give --force to replace it, or another --out",
                    out);
  tdm_memory_watch_json();
  if (adm_import(&m, file, a->seconds, &scene, err) == TDM_OK)
    tdm_memory_since(before, NULL, err);
  const size_t left = json_array_size(m.left_out);
  if (!err->status && a->strict && left > 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %zu statements would be left out, first %s (refused because of --strict)",
             file, left, json_string_value(json_array_get(m.left_out, 0)));
  if (!err->status && try_scene(scene, file, err) == TDM_OK && write_scene(scene, out, a->force, err) == TDM_OK)
    print_summary(&m, out);
  json_decref(scene);
  adm_model_free(&m);
  return err->status;
}

/* the data set's name with .json for .adm; to be freed */
static char *default_out(const char *file) {
  const size_t n = strlen(file), cut = n > 4 && strcmp(file + n - 4, ".adm") == 0 ? n - 4 : n;
  char *name = malloc(cut + sizeof ".json");
  if (name)
    snprintf(name, cut + sizeof ".json", "%.*s.json", (int)cut, file);
  return name;
}

int mbd_import_main(int argc, char **argv) {
  tdm_error err = {0};
  arguments a;
  if (parse(&a, argc, argv, &err) == TDM_OK && a.help) {
    fputs(help, stdout);
  } else if (!err.status) {
    char *out = default_out(a.given.word[0]);
    if (!out)
      tdm_fail(&err, TDM_ERR_MEMORY, NULL, "no memory for the name of a file");
    else
      import(&a, a.given.word[0], a.out ? a.out : out, &err);
    free(out);
  }
  tdm_arguments_free(&a.given);
  return tdm_finish(program, &err);
}

/* A scene from the files of MOLDYN: see import.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/import.h"

#include "dem/moldyn/control.h"
#include "dem/moldyn/particles.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "tandem-dem import BASE.cin [--out SCENE] [--form FORM] [--dimension N] [--force]\n\n"
    "Make a scene of the files of MOLDYN: BASE.cin, and BASE.pin and BASE.win beside it. The scene has the times,\n"
    "materials and contacts of the first; it names the other two, which are read whenever it runs.\n\n"
    "  --out SCENE       the scene's file (default: BASE.json)\n"
    "  --form FORM       what the rows of BASE.win are: normals (default) or end_points\n"
    "  --dimension N     3 (default), or 2: particles in the plane of x and z\n"
    "  --force           replace SCENE\n"
    "  --help\n";

typedef struct {
  const char *control, *out;
  dem_win_form form;
  bool flat, force, help;
} command;

static tdm_status wrong(tdm_error *err, const char *what, const char *cure) {
  return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: %s; see tandem-dem import --help", what, cure);
}

/* the place of a value among two */
static int one_of(const char *option, const char *value, const char *first, const char *second, tdm_error *err) {
  if (value && strcmp(value, first) == 0)
    return 0;
  if (!value || strcmp(value, second) != 0) {
    char cure[128];
    snprintf(cure, sizeof cure, "give %s or %s", first, second);
    wrong(err, option, cure);
  }
  return 1;
}

static tdm_status parse(command *c, int argc, char **argv, tdm_error *err) {
  *c = (command){.form = DEM_WIN_NORMALS};
  for (int i = 0; i < argc && !err->status; i++) {
    const char *option = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
    if (strcmp(option, "--help") == 0) {
      c->help = true;
    } else if (strcmp(option, "--force") == 0) {
      c->force = true;
    } else if (strcmp(option, "--out") == 0) {
      c->out = argv[++i];
      if (!value)
        wrong(err, option, "give the name of a file");
    } else if (strcmp(option, "--form") == 0) {
      c->form = (dem_win_form)one_of(option, value, "normals", "end_points", err);
      i++;
    } else if (strcmp(option, "--dimension") == 0) {
      c->flat = one_of(option, value, "3", "2", err) == 1;
      i++;
    } else if (option[0] == '-') {
      wrong(err, option, "is no option");
    } else if (c->control) {
      wrong(err, option, "one control file is enough");
    } else {
      c->control = option;
    }
  }
  size_t n = c->control ? strlen(c->control) : 0;
  if (!c->help && (n < 5 || strcmp(c->control + n - 4, ".cin") != 0))
    wrong(err, c->control ? c->control : "BASE.cin", "give a control file, whose name ends in .cin");
  return err->status;
}

/* ---- names ---- */

/* the control file's name with another ending; to be freed */
static char *with_ending(const char *control, const char *ending) {
  size_t n = strlen(control) - 4;
  char *name = malloc(n + strlen(ending) + 1);
  if (name) {
    memcpy(name, control, n);
    strcpy(name + n, ending);
  }
  return name;
}

static const char *last_of(const char *path) {
  const char *slash = strrchr(path, '/');
  return slash ? slash + 1 : path;
}

/* do both files lie in the same folder, by their names? */
static bool beside(const char *a, const char *b) {
  size_t n = (size_t)(last_of(a) - a);
  return n == (size_t)(last_of(b) - b) && strncmp(a, b, n) == 0;
}

/* the name by which the scene `out` finds a file, into name */
static void name_in_scene(const char *out, const char *file, char name[PATH_MAX]) {
  if (beside(out, file) || !realpath(file, name))
    snprintf(name, PATH_MAX, "%s", last_of(file));
}

/* ---- the scene ---- */

static tdm_status write_scene(const json_t *scene, const command *c, const char *out, tdm_error *err) {
  if (!c->force && access(out, F_OK) == 0)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: is there already; give --force to replace it, or another --out",
                    out);
  errno = 0;
  if (json_dump_file(scene, out, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", out, errno ? strerror(errno) : "no memory");
  return TDM_OK;
}

/* with the names of the three other files */
static tdm_status import(const command *c, const char *particles, const char *walls, const char *out, tdm_error *err) {
  char particles_name[PATH_MAX], walls_name[PATH_MAX];
  dem_pin pin = {0};
  dem_win win = {0};
  json_t *notes = NULL, *scene = NULL;
  if (dem_pin_read(&pin, particles, NULL, err) == TDM_OK &&
      dem_win_read(&win, walls, c->form, true, NULL, err) == TDM_OK) {
    name_in_scene(out, particles, particles_name);
    name_in_scene(out, walls, walls_name);
    const dem_cin_options options = {particles_name, walls_name, c->form, c->flat};
    scene = dem_cin_read(c->control, &options, &notes, err);
  }
  if (scene && write_scene(scene, c, out, err) == TDM_OK) {
    for (size_t k = 0; k < json_array_size(notes); k++)
      printf("note: %s\n", json_string_value(json_array_get(notes, k)));
    printf("%d particles and %d walls; the scene is %s\n", pin.count, win.count, out);
  }
  dem_pin_free(&pin);
  dem_win_free(&win);
  json_decref(notes);
  json_decref(scene);
  return err->status;
}

int dem_import_main(int argc, char **argv) {
  tdm_error err = {0};
  command c;
  if (parse(&c, argc, argv, &err) == TDM_OK && c.help) {
    fputs(help, stdout);
  } else if (!err.status) {
    char *particles = with_ending(c.control, ".pin"), *walls = with_ending(c.control, ".win"),
         *out = with_ending(c.control, ".json");
    if (!particles || !walls || !out)
      tdm_fail(&err, TDM_ERR_MEMORY, NULL, "no memory for the names of files");
    else
      import(&c, particles, walls, c.out ? c.out : out, &err);
    free(particles);
    free(walls);
    free(out);
  }
  if (err.status)
    fprintf(stderr, "tandem-dem: error: %s\n", err.message);
  return err.status ? 1 : 0;
}

/* Reading a scene: one JSON file with the sections time, coupling, output (the server's) and mbd, dem (the solvers').
 *
 * A reader asks an object for the keys it knows; closing the object refuses every key that was not asked for, with the
 * nearest known name. The first error sticks in the tdm_error, later calls do nothing and return the default, so a
 * loader reads straight down and looks at err->status once:
 *
 *   tdm_object o = tdm_object_open(json, "dem.materials[0]", err);
 *   m->density = tdm_get_number(&o, "density", TDM_REQUIRED, TDM_POSITIVE);
 *   m->poisson = tdm_get_number(&o, "poisson_ratio", 0.25, TDM_ANY);
 *   tdm_object_close(&o);
 *
 * jansson keeps no positions, so errors name the JSON path; tdm_scene_place finds line and column of a path in the
 * text.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_SCENE_SCENE_H
#define TDM_SCENE_SCENE_H

#include "protocol/base/status.h"
#include "protocol/math/pose.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the file ---- */

/* A scene file that was read. */
typedef struct {
  char *file;      /* its name as given */
  char *text;      /* its text, for positions */
  json_t *root;    /* the scene with overrides applied; where tandem reads it, with numbers for expressions */
  json_t *written; /* then: the same with its expressions; else NULL */
  json_t *kept;    /* path of a list as written -> indices of the entries that `root` has; NULL: all lists are whole */
} tdm_scene;

/* Read a scene file. Refuses what is not JSON, duplicate keys, and a root that is not an object; the message starts
 * with file:line:column. Relative names that keys "file" give, of meshes for example, start at the folder of the scene
 * and become absolute. The caller destroys *scene (also after an error). */
tdm_status tdm_scene_read(tdm_scene *scene, const char *file, tdm_error *err);

/* Apply one "path=value" ("coupling.n=25", "dem.materials[0].density=1000"): the value is JSON if it parses, else a
 * string. Missing objects on the way are made; an array index must exist or be the next one, a member of "parameters"
 * must exist. */
tdm_status tdm_scene_set(tdm_scene *scene, const char *assignment, tdm_error *err);

/* What a section names under "solver" as the program that it is for (borrowed): a command, or null for one that
 * somebody else starts. NULL: nothing; an object there is a setting of the solver itself. */
json_t *tdm_section_solver(const json_t *section);

/* Most processes of MPI that tandem's own DEM engine runs on. */
enum { TDM_RANKS_MAX = 4096 };

/* On how many processes of MPI the section "dem" wants tandem's own engine to run ("ranks"); 1 where it does not say,
 * or names no such number, which its reader refuses. */
int tdm_section_ranks(const json_t *section);

/* The section of a solver ("mbd", "dem") as the solver gets it: without that name, and with the scene's own "gravity"
 * where the section has none. A new reference; NULL when there is no such section. */
json_t *tdm_scene_section(const json_t *root, const char *role);

/* The value at `path` (borrowed), NULL when there is none. */
const json_t *tdm_scene_value(const json_t *root, const char *path);

/* Line and column (from 1) of the value at `path` in JSON `text`; of the nearest parent that is there when the path is
 * not. Returns false when nothing of the path is found (line and column are 1 then). */
bool tdm_scene_place(const char *text, const char *path, int *line, int *column);

/* The text of a scene with another value (as JSON) at `path`; all else stays as it is written, and objects that lack
 * keys of the path get them. The caller frees it. NULL: no memory, or the path leads to what cannot get a member. */
char *tdm_scene_text_with(const char *text, const char *path, const char *value);

/* Name places as the scene was written: in the path and the message of an error, indices of lists from which entries
 * were left out. Once for an error; tdm_scene_locate does it too. */
void tdm_scene_as_written(const tdm_scene *scene, tdm_error *err);

/* The value in `root` that was written at `path` (borrowed), NULL when there is none. */
const json_t *tdm_scene_value_written_at(const tdm_scene *scene, const char *path);

/* Put "file:line:column: path: " in front of the message of an error that has a path, and the expression behind it that
 * gave the value there. */
void tdm_scene_locate(const tdm_scene *scene, tdm_error *err);

/* Free what a scene holds; *scene is as new. */
void tdm_scene_destroy(tdm_scene *scene);

/* ---- objects ---- */

enum { TDM_KEYS_MAX = 64 };

/* An object that a reader asks for its keys. */
typedef struct {
  json_t *json;                    /* borrowed; NULL when there is no such object: every key is missing then */
  char path[TDM_PATH_MAX];         /* its JSON path */
  tdm_error *err;                  /* borrowed */
  const char *asked[TDM_KEYS_MAX]; /* keys that the loader knows; string literals */
  int nasked;                      /* how many */
} tdm_object;

/* what a number must be */
typedef enum { TDM_ANY, TDM_POSITIVE, TDM_NOT_NEGATIVE, TDM_UNIT_INTERVAL } tdm_range;

/* default value that means: the key must be there */
#define TDM_REQUIRED ((double)NAN)
/* the same of a whole number */
#define TDM_REQUIRED_INT (-2147483647L)

/* Open `json` (borrowed) as an object at `path`; anything else is an error. NULL opens as an empty object. */
tdm_object tdm_object_open(json_t *json, const char *path, tdm_error *err);

/* Open the member `key` as an object; when it is missing: an error if required, else an empty object. */
tdm_object tdm_get_object(tdm_object *o, const char *key, bool required);

/* Refuse the keys that were not asked for. */
void tdm_object_close(tdm_object *o);

/* true if the key is there (it counts as asked for) */
bool tdm_has(tdm_object *o, const char *key);

/* A finite number in the range; `fallback` when the key is missing (TDM_REQUIRED: an error). */
double tdm_get_number(tdm_object *o, const char *key, double fallback, tdm_range range);

/* A whole number of at least `least`; `fallback` when missing (TDM_REQUIRED_INT: an error). Numbers such as 10.0 count.
 */
long tdm_get_integer(tdm_object *o, const char *key, long fallback, long least);

/* A string that lives as long as the JSON; `fallback` when missing (NULL: an error, and "" is returned). */
const char *tdm_get_string(tdm_object *o, const char *key, const char *fallback);

/* true or false, `fallback` when it is missing. */
bool tdm_get_bool(tdm_object *o, const char *key, bool fallback);

/* The index of a string among `choices`; -1 after an error. `fallback` when missing (-1: an error). */
int tdm_get_choice(tdm_object *o, const char *key, const char *const *choices, int nchoice, int fallback);

enum { TDM_TYPES_MAX = 32 }; /* of one kind */

/* The types that objects of one kind may name under "type". */
typedef struct {
  const void *row[TDM_TYPES_MAX + 1]; /* a type's operations, which begin with its name (a const char *); then NULL */
} tdm_types;

/* The row that "type" names; NULL after an error. */
const void *tdm_get_type(tdm_object *o, const tdm_types *types);

/* The name of row i, NULL behind the last. */
const char *tdm_type_name(const tdm_types *types, int i);

/* Add a type from elsewhere; before any scene is read, and from one thread. The row stays the caller's and must outlive
 * the table. An error (TDM_ERR_ARGUMENT): the table is full, or has the name already. */
tdm_status tdm_type_add(tdm_types *types, const void *row, tdm_error *err);

/* Three finite numbers; *fallback when missing (NULL: an error). */
tdm_vec3 tdm_get_vec3(tdm_object *o, const char *key, const tdm_vec3 *fallback);

/* Exactly n finite numbers into out (unchanged when missing and not required). Returns true if they were there. */
bool tdm_get_numbers(tdm_object *o, const char *key, double *out, int n, bool required);

/* An orientation: [w,x,y,z] (normalised here) or {"euler313": [phi, theta, psi]} [rad]; identity when missing. */
tdm_quat tdm_get_orientation(tdm_object *o, const char *key);

/* Read "gravity" at the root of a scene, which is for every section that has none of its own: a section with another
 * one is refused. */
void tdm_check_gravity(tdm_object *root);

/* What tools and tests hear of the keys that readers ask for: the object's path, the key, and its default (borrowed),
 * once for every question that has a constant one; NULL: required, or the reader computes it. */
typedef void tdm_key_listener(void *arg, const char *path, const char *key, const json_t *fallback);

/* Tell this thread's readers to whom they talk; NULL: nobody, as at the start. */
void tdm_scene_listen(tdm_key_listener *listener, void *arg);

/* The array under `key` (borrowed; NULL when missing, an error if required or not an array). */
json_t *tdm_get_array(tdm_object *o, const char *key, bool required);

/* "path.key[i]" into out (size TDM_PATH_MAX); i < 0 leaves the index away. Returns out. */
const char *tdm_path(char *out, const tdm_object *o, const char *key, int i);

/* An error at this object's key (key NULL: the object itself). */
tdm_status tdm_object_fail(tdm_object *o, const char *key, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#ifdef __cplusplus
}
#endif

#endif

/* The contact laws a scene can choose from.
 *
 * A combination of laws is one row of DEM_LAW_LIST; loop.c compiles one pair loop and one wall loop for each row, so a
 * scene pays only for what it uses: no branch on a law inside a loop, and no history slots without a tangential law.
 *
 * To add a law: write its kernel (normal.h, tangential.h), name it dem_<family>_<name>, and add the rows in which it
 * may appear. Combinations without a row are refused when the scene is loaded.
 */
#ifndef DEM_CONTACT_TABLE_H
#define DEM_CONTACT_TABLE_H

#include <stdbool.h>

/* of every kernel: GCC leaves larger ones as calls otherwise */
#define DEM_KERNEL static inline __attribute__((always_inline))

/* normal, tangential, tail of the normal force, history slots (0 or 1) */
#define DEM_LAW_LIST(X)      \
  X(hertz, none, keep, 0)    \
  X(hertz, none, clip, 0)    \
  X(hertz, mindlin, keep, 1) \
  X(hertz, mindlin, clip, 1)

struct dem_model;
struct dem_data;

/* Add the forces of all contacts to data->force and ->torque (and, for walls, to body_load), advancing the histories
 * by dt [s] (0: only evaluate). `settling` chooses model->settle_pair. */
typedef void dem_loop(const struct dem_model *model, struct dem_data *data, bool settling, double dt);

typedef struct {
  const char *normal, *tangential, *tail;
  bool history; /* contacts have a history slot */
  bool clip;    /* the normal force never attracts */
  dem_loop *pairs, *walls;
} dem_law;

/* The families' names, for reading a scene; NULL-terminated. */
extern const char *const dem_normal_names[];
extern const char *const dem_tangential_names[];
extern const char *const dem_tail_names[];

/* The row of a combination, NULL when there is none. */
const dem_law *dem_law_find(const char *normal, const char *tangential, const char *tail);

#endif

/* The contact laws a scene can choose from.
 *
 * A combination of laws is one row of DEM_LAW_LIST; loop.c compiles one pair loop and one wall loop for each row, so a
 * scene pays only for what it uses: no branch on a law inside a loop, and no history without a law that keeps one.
 *
 * To add a law: write its kernel (normal.h, tangential.h), name it dem_<family>_<name>, and add the rows in which it
 * may appear. Combinations without a row are refused when the scene is loaded.
 */
#ifndef DEM_CONTACT_TABLE_H
#define DEM_CONTACT_TABLE_H

#include <stdbool.h>

/* normal, tangential, columns of history, bits of the columns that are a vector's: these change sign when the two
 * particles of a pair change places */
#define DEM_LAW_LIST(X) \
  X(hertz, none, 0, 0)  \
  X(hertz, mindlin, 4, 7)

enum { DEM_HISTORY_MAX = 4 };

struct dem_model;
struct dem_data;

/* One chunk of particles: what a loop is asked for, and what it returns besides forces. */
typedef struct {
  const struct dem_model *model;
  struct dem_data *data;
  int chunk;
  bool settling; /* chooses model->settle_pair */
  double dt;     /* [s], 0: only evaluate */
  long touching; /* out: contacts */
} dem_loop_task;

/* Add the forces of the chunk's contacts to data->push (and, for walls, to the chunk's body loads), advancing the
 * histories by dt. */
typedef void dem_loop(dem_loop_task *task);

typedef struct {
  const char *normal, *tangential;
  int ncolumn;      /* of history */
  unsigned vectors; /* bit q: column q is one of a vector's */
  dem_loop *pairs, *walls;
} dem_law;

/* The families' names, for reading a scene; NULL-terminated. */
extern const char *const dem_normal_names[];
extern const char *const dem_tangential_names[];
extern const char *const dem_tail_names[];

/* Instruction sets, fastest first, NULL-terminated; the last is plain C. */
extern const char *const dem_simd_names[];

/* The fastest that this machine has. */
const char *dem_simd_best(void);

/* The row of a combination compiled for an instruction set of this machine, NULL when there is none. */
const dem_law *dem_law_find(const char *simd, const char *normal, const char *tangential);

#endif

/* The contact laws a scene can choose from, one table a family.
 *
 * A combination of a normal and a tangential law is one row of DEM_LAW_LIST; loop.c compiles one pair loop and one wall
 * loop for each row, so a scene pays only for what it uses: no branch on a law inside a loop, and no history without a
 * law that keeps one. Rolling, twisting, cohesion, energies, a static friction of its own and a constant viscosity are
 * in a second pair of loops for each normal law, in which the scene's other laws are switches.
 *
 * To add a law: write its kernel (normal.h, tangential.h, rolling.h, cohesion.h), name it dem_<family>_<name>, add the
 * row of its family here and, for a normal or tangential law, the rows of DEM_LAW_LIST in which it may appear; read its
 * coefficients in contact_read.c, and give a normal law its closed forms in theory.c. Combinations without a row are
 * refused when the scene is loaded.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_TABLE_H
#define DEM_CONTACT_TABLE_H

#include "dem/contact/energy.h"
#include "protocol/base/pose.h"

#include <stdbool.h>
#include <stddef.h>

/* Rows of a family: name in C, name in a scene, columns of history, bits of the columns that are a vector's (these
 * change sign when the two particles of a pair change places), the coefficients of a pair that it reads. */
#define DEM_NORMAL_LIST(X)                                                                 \
  X(hooke, "hooke", 0, 0, "stiffness or contact_time, restitution or damping")             \
  X(hertz, "hertz", 0, 0, "restitution or viscosity")                                      \
  X(hunt_crossley, "hunt-crossley", 1, 0, "stiffness (Hertz's), restitution, speed_floor") \
  X(hysteretic, "hysteretic", 1, 0, "stiffness, unloading_stiffness or restitution, adhesion_stiffness")

#define DEM_TANGENTIAL_LIST(X)                                                    \
  X(none, "none", 0, 0, "")                                                       \
  X(coulomb, "coulomb", 0, 0, "friction")                                         \
  X(viscous, "viscous", 0, 0, "tangential_damping")                               \
  X(spring, "spring", 3, 7, "friction, tangential_stiffness, tangential_damping") \
  X(mindlin, "mindlin", 4, 7, "friction")

#define DEM_ROLLING_LIST(X)                                       \
  X(none, "none", 0, 0, "")                                       \
  X(constant_torque, "constant-torque", 0, 0, "rolling_friction") \
  X(spring_dashpot, "spring-dashpot", 3, 7, "rolling_friction, rolling_damping")

#define DEM_TWISTING_LIST(X) \
  X(none, "none", 0, 0, "")  \
  X(constant_torque, "constant-torque", 0, 0, "twisting_friction")

#define DEM_COHESION_LIST(X)                \
  X(none, "none", 0, 0, "")                 \
  X(sjkr, "sjkr", 0, 0, "cohesion_density") \
  X(jkr, "jkr", 1, 0, "adhesion_energy")    \
  X(dmt, "dmt", 0, 0, "adhesion_energy")

/* Normal and tangential laws that go together; mindlin needs a contact circle. */
#define DEM_LAWS_hooke(X) X(hooke, none) X(hooke, coulomb) X(hooke, viscous) X(hooke, spring)
#define DEM_LAWS_hertz(X) X(hertz, none) X(hertz, coulomb) X(hertz, viscous) X(hertz, spring) X(hertz, mindlin)
#define DEM_LAWS_hunt_crossley(X) \
  X(hunt_crossley, none)          \
  X(hunt_crossley, coulomb) X(hunt_crossley, viscous) X(hunt_crossley, spring) X(hunt_crossley, mindlin)
#define DEM_LAWS_hysteretic(X) X(hysteretic, none) X(hysteretic, coulomb) X(hysteretic, viscous) X(hysteretic, spring)
#define DEM_LAW_LIST(X) DEM_LAWS_hooke(X) DEM_LAWS_hertz(X) DEM_LAWS_hunt_crossley(X) DEM_LAWS_hysteretic(X)

#define X(law, name, ncolumn, vectors, keys) DEM_NORMAL_##law,
typedef enum { DEM_NORMAL_LIST(X) DEM_NORMALS } dem_normal;
#undef X
#define X(law, name, ncolumn, vectors, keys) DEM_TANGENTIAL_##law,
typedef enum { DEM_TANGENTIAL_LIST(X) DEM_TANGENTIALS } dem_tangential_law;
#undef X
#define X(law, name, ncolumn, vectors, keys) DEM_ROLLING_##law,
typedef enum { DEM_ROLLING_LIST(X) DEM_ROLLINGS } dem_rolling;
#undef X
#define X(law, name, ncolumn, vectors, keys) DEM_TWISTING_##law,
typedef enum { DEM_TWISTING_LIST(X) DEM_TWISTINGS } dem_twisting;
#undef X
#define X(law, name, ncolumn, vectors, keys) DEM_COHESION_##law,
typedef enum { DEM_COHESION_LIST(X) DEM_COHESIONS } dem_cohesion;
#undef X

/* columns of a normal and of a tangential law */
#define X(law, name, ncolumn, vectors, keys) DEM_NORMAL_COLUMNS_##law = (ncolumn),
enum { DEM_NORMAL_LIST(X) };
#undef X
#define X(law, name, ncolumn, vectors, keys) DEM_TANGENTIAL_COLUMNS_##law = (ncolumn),
enum { DEM_TANGENTIAL_LIST(X) };
#undef X

/* A row of a family, for reading scenes and for people. */
typedef struct {
  const char *name; /* in a scene; NULL ends a table */
  int ncolumn;      /* of history */
  unsigned vectors; /* bit q: column q is one of a vector's */
  const char *keys; /* coefficients that it reads from a pair */
} dem_law_row;

extern const dem_law_row dem_normals[], dem_tangentials[], dem_rollings[], dem_twistings[], dem_cohesions[];

/* The history of a contact: the tangential law's columns first, then the normal law's, then these where the scene has
 * them. */
typedef struct {
  int ncolumn;
  unsigned vectors;                       /* bit q: column q is one of a vector's */
  int normal, rolling, cohesion, sliding; /* the first of each; sliding: 1 while a contact slides, for a static
                                             friction of its own; -1: there is none */
} dem_columns;

enum { DEM_HISTORY_MAX = 10 };

struct dem_model;
struct dem_data;

/* Which contacts a loop is about: all, or those whose effective mass is below or above model->multi_step.mass. */
typedef enum { DEM_ALL, DEM_FAST, DEM_SLOW } dem_share;

/* One chunk of particles: what a loop is asked for, and what it returns besides forces. */
typedef struct {
  const struct dem_model *model;
  struct dem_data *data;
  int chunk;
  bool settling; /* chooses model->settle_pair */
  double dt;     /* [s], 0: only evaluate */
  dem_share share;
  size_t wall_first, wall_end; /* entries of data->walls that are looked at, of this chunk */
  tdm_wrench *load;            /* (nbody) out: what the walls add to the bodies' loads */
  tdm_vec3 *entry_force; /* (data->walls.count) out: force of each entry on its particle, but of planes; or NULL */
  long touching;         /* out: contacts */
  dem_flux flux;         /* out: energies, when the scene asks for them */
} dem_loop_task;

/* Add the forces of the chunk's contacts to data->push (and, for walls, to the task's loads), advancing the histories
 * by dt. */
typedef void dem_loop(dem_loop_task *task);

typedef struct {
  dem_normal normal;
  dem_tangential_law tangential;
  bool all_terms; /* with all other families and with energies */
  dem_loop *pairs, *walls;
} dem_law;

extern const char *const dem_tail_names[];

/* Instruction sets, fastest first, NULL-terminated; the last is plain C. */
extern const char *const dem_simd_names[];

/* The fastest that this machine has, and whether it has one. */
const char *dem_simd_best(void);
bool dem_simd_here(const char *simd);

/* The row of a combination compiled for an instruction set of this machine, NULL when there is none. */
const dem_law *dem_law_find(const char *simd, dem_normal normal, dem_tangential_law tangential, bool all_terms);

/* The columns of a combination. */
dem_columns dem_columns_of(const dem_law *law, dem_rolling rolling, dem_cohesion cohesion, bool sliding);

#endif

/* What a contact law is: a file with its kernel and its row.
 *
 * A scene chooses one law of each family. A row says what readers, limits, energies and reports ask of a law; its
 * kernel, in the same file, is compiled into the loops (loop/). Rows know the model alone.
 *
 * To add a law: a file normal/NAME.c like normal/hooke.c, or tangential/NAME.h like tangential/coulomb.h and so on,
 * and its name in the list of families.h. The build finds the file. It compiles the loops of a normal law, with each
 * tangential law, once for each instruction set.
 * A program of its own adds a law with dem_law_add (table.h). Such a law may be in any file. Its kernel is called, in
 * plain C, unless it is a normal law, whose file makes its loops.
 * What a law reads from a scene is described in scenarios/scene.schema.json.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_LAW_H
#define DEM_CONTACT_LAW_LAW_H

#include "dem/contact/law/task.h"
#include "dem/model/model.h"
#include "dem/numbers/simd_set.h"
#include "protocol/scene/scene.h"

typedef enum {
  DEM_FAMILY_NORMAL,
  DEM_FAMILY_TANGENTIAL,
  DEM_FAMILY_ROLLING,
  DEM_FAMILY_TWISTING,
  DEM_FAMILY_COHESION,
  DEM_FAMILY_MULTI,
  DEM_FAMILIES
} dem_family;

enum { DEM_KEYS_MAX = 8 };

/* A coefficient of a pair that a law reads. */
typedef struct {
  const char *name;
  double example; /* what a benchmark of soft spheres takes; 0: it may be missing */
} dem_law_key;

/* The kernel of a law that a program adds; its argument is in law/contact.h. */
struct dem_call;
typedef void dem_called_kernel(struct dem_call *call);

/* What every row begins with. */
typedef struct {
  const char *name; /* in a scene */
  bool none;        /* stands for no law of the family */
  bool needs_young; /* needs the elastic constants of the materials */
  int ncolumn;      /* of history that a contact keeps for it */
  unsigned vectors; /* bit q: column q is one of a vector's, which changes sign when the two of a pair change places */
  dem_law_key keys[DEM_KEYS_MAX]; /* that it reads, besides restitution and friction; ended by a NULL */
  dem_called_kernel *kernel;      /* of a law that the loops do not hold, in plain C; normal laws, and those of many
                                     contacts, bring loops instead */
} dem_law_head;

/* Two bodies that collide centrally. */
typedef struct {
  double mass, radius; /* effective [kg], [m] */
  double speed;        /* of approach [m/s] */
  double deepest;      /* of a law that keeps it: largest overlap so far, 0: the present one [m] */
} dem_impact;

typedef double dem_of_impact(const dem_model *model, const dem_pair *pair, dem_impact impact);
typedef double dem_of_overlap(const dem_model *model, const dem_pair *pair, dem_impact impact, double overlap);

/* Optional functions may be NULL. */
typedef struct dem_normal_law {
  dem_law_head head;
  bool circle;              /* fills the contact's circle, which tangential laws may need */
  bool hertzian;            /* its elastic force is Hertz's, which laws of cohesion may change */
  bool plastic;             /* dissipates without damping: its energy is another mechanism's */
  bool keeps_deepest;       /* its first column is the largest overlap so far */
  bool settles_as_it_is;    /* keeps its coefficients while settling unless dem.settle names a restitution */
  const char *tangential;   /* name of the tangential law of a scene that names none */
  const char *why_not_clip; /* why "tail": "clip" has no meaning, after "which"; NULL: it has one */
  const char *setting_keys[DEM_KEYS_MAX]; /* of dem.contact that it reads into model.normal_setting */

  /* Optional: its settings. The tangential law is known. */
  void (*read_settings)(dem_model *model, tdm_object *contact);

  /* The coefficients of a pair, whose elastic constants are there. */
  void (*read)(const dem_model *model, tdm_object *pair_of_scene, dem_pair *pair);

  /* Optional: the coefficients that follow from pair.restitution. TDM_ERR_NUMERIC: it is too small for "tail": "clip".
   */
  tdm_status (*damp)(const dem_model *model, dem_pair *pair);

  /* Optional: this pair has terms that only the loops with all terms have. */
  bool (*needs_all_terms)(const dem_pair *pair);

  /* Closed forms; what they mean is in theory.h. step_time is optional. */
  dem_of_impact *time, *step_time, *overlap, *restitution;
  dem_of_overlap *force, *stiffness, *elastic;

  const dem_loop_set *loops[DEM_SIMD_SETS]; /* NULL: the plain ones */
} dem_normal_law;

typedef struct dem_tangential_law {
  dem_law_head head;
  bool friction;     /* reads the friction of a pair */
  bool sticks;       /* a static friction other than the dynamic one has a meaning */
  bool needs_circle; /* goes with normal laws that have a contact circle */

  /* Optional: the coefficients of a pair, when the normal law's are there. */
  void (*read)(const dem_model *model, tdm_object *pair_of_scene, dem_pair *pair);

  /* Optional: those that follow from pair.restitution. */
  void (*damp)(const dem_model *model, dem_pair *pair);

  /* Optional: this pair has terms that only the loops with all terms have. */
  bool (*needs_all_terms)(const dem_pair *pair);

  /* Of its spring, whose force is in its first three columns [N/m]; NULL: it has none. */
  dem_of_overlap *stiffness;
} dem_tangential_law;

typedef struct dem_rolling_law {
  dem_law_head head;
  void (*read)(const dem_model *model, tdm_object *pair_of_scene, dem_pair *pair); /* optional */
  dem_of_overlap *stiffness; /* of its spring, whose couple is in its first three columns [N m]; NULL: it has none */
} dem_rolling_law;

typedef struct dem_twisting_law {
  dem_law_head head;
  void (*read)(const dem_model *model, tdm_object *pair_of_scene, dem_pair *pair); /* optional */
  dem_of_overlap *stiffness; /* of its spring, whose couple about the normal is in its first column [N m]; NULL: it has
                                none */
} dem_twisting_law;

typedef struct dem_cohesion_law {
  dem_law_head head;
  void (*check)(const dem_model *model, tdm_object *contact);                      /* optional: goes with the others? */
  void (*read)(const dem_model *model, tdm_object *pair_of_scene, dem_pair *pair); /* optional */
  double (*reach)(const dem_pair *pair, double radius); /* optional: gap over which a contact holds [m] */
} dem_cohesion_law;

/* A contact among the others of its particles, at the last evaluation. */
typedef struct {
  const dem_pair *pair; /* of the particle's material with the partner's */
  dem_impact at;        /* effective mass and radius */
  double overlap;       /* > 0 [m] */
  int particle, other;  /* other: -1 for a wall */
  size_t place;         /* of its notes */
} dem_among;

/* On several ranks of the other particle only sphere, rotor, material and sums of laws are there. */
typedef double dem_of_among(const struct dem_data *data, const dem_among *contact);

/* How the contacts of a particle act on each other: loops that stand in the place of the normal law's, which is
 * Hertz's (`hertzian`). */
typedef struct dem_multi_law {
  dem_law_head head;
  const char *setting_keys[DEM_KEYS_MAX]; /* of dem.contact that it reads into model.multi_setting */
  void (*read_settings)(dem_model *model, tdm_object *contact); /* optional */

  /* The coefficients of a contact of a particle of material a with material b. */
  void (*read)(const dem_model *model, tdm_object *pair_of_scene, const dem_material *a, const dem_material *b,
               dem_pair *pair);

  /* Optional: the overlap that makes the contact's circle [m]; NULL: that of the spheres. */
  dem_of_among *overlap;
  dem_of_among *stiffness; /* slope of the elastic force when all contacts of the particles grow alike [N/m] */
  dem_of_among *elastic;   /* stored in the normal direction [J] */

  const dem_loop_set *loops[DEM_SIMD_SETS];
} dem_multi_law;

/* The normal law of a pair. */
static inline const dem_normal_law *dem_normal_of(const dem_model *model, const dem_pair *pair) {
  return pair->law ? pair->law : model->normal;
}

/* ---- what readers share ---- */

/* A number that the law needs; the message says so when it is missing. */
double dem_need(tdm_object *pair_of_scene, const char *key, const char *family, const char *law, tdm_range range);

/* Exactly one of two keys, of a normal law. True: the first. */
bool dem_one_of(tdm_object *pair_of_scene, const char *first, const char *second, const char *law);

/* The key "restitution", 0 < e <= 1; 1 after an error. */
double dem_get_restitution(tdm_object *object, double fallback);

/* All that follows from a restitution; path: of its key, for errors. */
void dem_set_restitution(const dem_model *model, dem_pair *pair, double restitution, tdm_error *err, const char *path);

/* Both: the key "restitution" and all that follows from it. */
void dem_read_restitution(const dem_model *model, tdm_object *pair_of_scene, dem_pair *pair);

#endif

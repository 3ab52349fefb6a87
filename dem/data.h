/* The data: everything that a run changes, in one object that can be copied.
 *
 * Particles are a structure of arrays, one packed array of vectors a quantity: a contact gathers whole vectors.
 * The arrays of particles lie in one block, those whose sizes the model fixes in another. The number of particles may
 * change between steps: dem_data_add appends, dem_data_remove closes the gaps, so the order of the particles is always
 * that of their ids, the order of creation. Nothing grows inside a contact loop.
 */
#ifndef DEM_DATA_H
#define DEM_DATA_H

#include "dem/contact/tangential.h"
#include "dem/exact.h"
#include "dem/model.h"

#include <stdint.h>

/* Pairs in CSR form: the partners of particle i are other[first[i]] … other[first[i+1] - 1], ascending. */
typedef struct {
  int *first;     /* (nparticle + 1) */
  int *other;     /* (capacity) */
  dem_slot *slot; /* (capacity), or NULL when the law keeps no history */
  size_t count, capacity;
} dem_list;

/* Scratch of the neighbour search; carries nothing from step to step. */
typedef struct {
  int *cell;     /* (nparticle) cell of a particle */
  int *particle; /* (nparticle) particles by cell */
  int *first;    /* (capacity + 1) first particle of a cell */
  size_t capacity;
} dem_cell_grid;

/* How far a source is. */
typedef struct {
  uint64_t due, made;         /* particles that should be there by now, and those that are */
  double due_mass, made_mass; /* of these [kg], summed in order of creation */
  uint64_t draw;              /* places tried for the next particle */
  uint64_t waits;             /* times that a particle had to wait */
  uint64_t blocked;           /* 1: the next particle waits now */
} dem_source_state;

typedef struct {
  uint64_t removed;
  double mass; /* [kg] */
} dem_sink_state;

/* What went in and out, for the balance. */
typedef struct {
  uint64_t created, removed; /* created: with those of the start */
  dem_exact mass;            /* created less removed, without round-off [kg] */
} dem_ledger;

typedef struct dem_data {
  const dem_model *model; /* borrowed */
  uint64_t nstep;         /* steps since the start of the run */
  dem_ledger ledger;

  /* particles, (nparticle) each, room for (capacity) */
  int nparticle, capacity;
  uint64_t *id;               /* order of creation, ascending; never used twice */
  double *radius;             /* [m] */
  double *mass;               /* [kg] */
  int *kind;                  /* material */
  uint32_t *touched;          /* bit s: sink s waits until the particle has left its body again */
  tdm_vec3 *position;         /* [m] */
  tdm_vec3 *velocity;         /* [m/s]; in a step between the two kicks: at mid-step */
  tdm_vec3 *spin;             /* angular velocity [rad/s]; likewise */
  tdm_vec3 *velocity_ahead;   /* predicted for the end of the step [m/s] */
  tdm_vec3 *spin_ahead;       /* [rad/s] */
  tdm_vec3 *force;            /* of contacts [N] */
  tdm_vec3 *torque;           /* about the centre [N m] */
  tdm_vec3 *position_at_list; /* when the lists were built [m] */

  /* bodies, (nbody) each */
  tdm_pose *pose;         /* now */
  tdm_twist *twist;       /* now */
  tdm_twist *twist_mid;   /* in the middle of the step */
  tdm_wrench *body_load;  /* of the particles, about the centre of mass, world */
  double *body_inverse;   /* 1/mass for the damping [1/kg]; 0: cannot be moved */
  tdm_pose *pose_at_list; /* when the lists were built */
  double *margin;         /* smallest gap - radius of a particle that is not listed with this body's walls [m] */
  double *reach;          /* largest distance of a particle's centre from the centre of mass at the list [m] */
  dem_wall_place *wall;   /* (nwall) where the walls are */
  double *lid;            /* (nwall) by how much a lid is shifted outward [m]; 0 for other walls */
  uint8_t *front;         /* (nparticle x nwall) the particle began in front of this plane */

  dem_source_state *source; /* (nsource) */
  dem_sink_state *sink;     /* (nsink) */

  dem_list pairs;    /* particle i with particles j > i */
  dem_list walls;    /* particle i with walls */
  bool list_valid;   /* the lists are lists of these particles */
  bool list_stale;   /* particles came: rebuild at the next step */
  uint64_t nrebuild; /* of the lists */
  uint64_t ngrow;    /* times that a list had to grow */

  long ncontact; /* touching pairs and walls at the last evaluation */

  /* means over the output interval, (ncoupled) */
  tdm_wrench *sample_sum;
  tdm_wrench *sample_mean; /* the last sample's */
  uint64_t sample_count;   /* steps in sample_sum */

  /* not part of the state */
  dem_list spare_pairs, spare_walls; /* the lists of before, at a rebuild */
  dem_cell_grid grid;
  void *particle_block; /* the arrays of particles */
  void *block;          /* the arrays of fixed size */
  size_t block_size;    /* of the latter [bytes] */
} dem_data;

/* The state at the start of the model: particles and bodies as the scene gives them, forces evaluated with closed
 * histories. NULL when memory runs out. The model must outlive the data. */
dem_data *dem_data_create(const dem_model *model);

/* Make dst the same state as src; both belong to one model. It then goes on bit-identically. False: no memory. */
bool dem_data_copy(dem_data *dst, const dem_data *src);

void dem_data_destroy(dem_data **data);

typedef struct {
  tdm_vec3 position, velocity; /* world [m], [m/s] */
  double radius, mass;         /* [m], [kg] */
  int kind;                    /* material */
} dem_newcomer;

/* Append a particle between two steps: without spin and contacts, with the next id. The lists are rebuilt at the next
 * step. Pointers into the data's particle arrays become invalid. False: no memory. */
bool dem_data_add(dem_data *data, const dem_newcomer *newcomer);

/* Remove the particles with gone[i] >= 0 (nparticle) between two steps. The others keep their order, contacts and
 * histories. Overwrites grid.cell. */
void dem_data_remove(dem_data *data, const int *gone);

/* Room for n particles. False: no memory, nothing changed. */
bool dem_data_reserve(dem_data *data, int n);

/* Mass of coupled body i [kg], inf: cannot be moved. Used from the next force on; ignored when the scene gives
 * contact.wall_mass. */
void dem_set_body_mass(dem_data *data, int i, double mass);

/* Make room for `count` entries, keeping the first list->count. False: no memory. */
bool dem_list_reserve(dem_list *list, size_t count, bool history);

#endif

/* The data: everything that a run changes, in one object that can be copied.
 *
 * Particles are a structure of arrays, one packed array of vectors a quantity: a contact gathers whole vectors.
 * The arrays of particles lie in one block, those whose sizes the model fixes in another. The number of particles may
 * change between steps: dem_data_add appends, dem_data_remove closes the gaps. Their order is that of their ids, the
 * order of creation, as long as they are few (one chunk); more are put in the order of their places every
 * DEM_SORT_STEPS steps (search/pairs.h). Nothing grows inside a contact loop.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STATE_DATA_H
#define DEM_STATE_DATA_H

#include "dem/base/energy.h"
#include "dem/base/mobility.h"
#include "dem/base/near.h"
#include "dem/base/ranks.h"
#include "dem/base/scratch.h"
#include "dem/base/sphere.h"
#include "dem/base/timers.h"
#include "dem/model/model.h"
#include "dem/numbers/exact_sum.h"
#include "dem/state/fields.h"

#include <stdint.h>

/* The pairs of particles that are near, half lists. Particle i has the entries first[i] ... first[i+1] - 1, partners
 * ascending and greater than i. Entries are chunk by chunk, each chunk's filled up to a multiple of DEM_LANES_MAX with
 * entries of the dummy particle (number nparticle). */
typedef struct {
  int *first;         /* (nparticle + 1) */
  int *one;           /* (capacity) i */
  int *other;         /* (capacity) j */
  int *reaction_slot; /* (capacity) place in push for the reaction on j: j, or one of the places between the chunks; on
                       * several ranks of home chunks alone */
  double *history;    /* (columns x capacity) or NULL */
  size_t *chunk;      /* (nchunk + 1) first entry of a chunk */
  size_t count, capacity;
} dem_pairs;

/* A particle near a wall; `part` of the wall: the triangle of a mesh; else 0. */
typedef struct {
  int particle, wall, part;
  float away; /* of a triangle: at least so much was between the two when the list was made; else 0 [m] */
} dem_wall_entry;

enum { DEM_PART_STRIDE = sizeof(dem_wall_entry) / sizeof(int) }; /* from the part of one entry to that of the next */

/* Chunk by chunk, in each ascending by wall, particle and part. */
typedef struct {
  dem_wall_entry *entry; /* (capacity) */
  double *history;       /* (columns x capacity) or NULL */
  size_t *chunk;         /* (nchunk + 1) first entry of a chunk */
  size_t count, capacity;
} dem_wall_contacts;

/* Reactions on particles of later chunks: each has a place of its own in push and is added to its particle when
 * that chunk ends its step, so that chunks do not disturb each other (crossings.h). */
typedef struct {
  int *particle; /* (count) by place */
  int *order;    /* (count) places by the chunk of the particle, ascending in each; of home chunks alone */
  int *chunk;    /* (nchunk + 1) first of a chunk in order */
  int *from;     /* (nchunk + 1) first place of a chunk's own contacts; of home chunks */
  int count, capacity;
  int first, end; /* places of home chunks: first ... end - 1 */
} dem_crossings;

/* How far a source is. */
typedef struct {
  uint64_t due, made;         /* particles that should be there by now, and those that are */
  double due_mass, made_mass; /* of these [kg], summed in order of creation */
  uint64_t tried;             /* places tried for the next particle */
  uint64_t waits;             /* times that a particle had to wait */
  uint64_t blocked;           /* 1: the next particle waits now */
} dem_source_state;

typedef struct {
  uint64_t removed;
  double mass;                               /* [kg] */
  uint64_t class_removed[DEM_EDGES_MAX + 1]; /* the same by size class */
  double class_mass[DEM_EDGES_MAX + 1];
} dem_sink_state;

/* What a deck of a screen has given (flow/screening.h). */
typedef struct {
  uint64_t sorted, undersized;          /* particles */
  double sorted_mass, undersized_mass;  /* [kg] */
  uint64_t blocked, held, blocked_most; /* holes, particles at the last look; most holes at any look */
  double rate, rate_time;               /* smoothed output rate at the last particle [kg/s], and when that was [s] */
} dem_deck_state;

/* Where a particle lies on a screen (flow/blocking.h), for particles that are watched. */
typedef struct {
  double x, y;                   /* where it was when it came to this spot, the screen's axes [m] */
  double spot_since, hole_since; /* from when on it has been there, and over its hole [s] */
  int deck;                      /* 1 + the deck, 0: it lies on none */
  int over;                      /* 1: its centre is over hole (i, j) */
  int i, j;
} dem_spot;

/* Screening as a whole. */
typedef struct {
  uint64_t initial; /* particles of the product at the start of the run */
  uint64_t early;   /* those that left by an outlet before anything counts */
  uint64_t lost;    /* those that left in other ways, as far as the user has been told */
  double time;      /* of the last step boundary [s] */
} dem_screening_state;

/* What went through a container (particles/container.h). */
typedef struct {
  uint64_t number;       /* particles inside */
  double mass;           /* of these [kg] */
  uint64_t entered;      /* particles that have been inside, each once */
  uint64_t left;         /* most of these that were outside at a time */
  double last;           /* when that rose last, or the watch for jams began [s] */
  uint64_t jammed, jams; /* 1: now; how often */
  uint64_t content;      /* particles inside when the first one left */
  uint64_t marks;        /* of the two below that have passed */
  double mark[2];        /* when a tenth and nine tenths of the content had left [s] */
  uint64_t sampled;      /* left at the output before */
  double rate;           /* of those that leave, over the last output interval [1/s] */
} dem_container_state;

/* What went in and out, for the balance. */
typedef struct {
  uint64_t created, removed; /* created: with those of the start */
  uint64_t left;             /* of the removed: those that left dem.domain */
  dem_exact_sum mass;        /* created less removed, without round-off [kg] */
} dem_ledger;

/* Energy that came in from elsewhere than the coupled bodies (energy_balance.h). */
typedef struct {
  double flow, driven; /* since the start of the run [J] */
  double power;        /* of the driven bodies at the last step [W] */
  uint64_t next_look;  /* step from which on the energy may be looked at again */
} dem_energy_balance;

/* What the guard saw last (guard.h). */
typedef enum {
  DEM_GUARD_LEAP,
  DEM_GUARD_OVERLAP,
  DEM_GUARD_LOST,
  DEM_GUARD_STEP,
  DEM_GUARD_ENERGY,
  DEM_GUARD_KINDS
} dem_guard_kind;

typedef struct {
  double start, lowest;           /* energy at the first look, and the lowest since [J] */
  double potential;               /* lowest potential since [J] */
  uint64_t judging;               /* 1: the three are there */
  uint64_t flow;                  /* particles that had come or gone then */
  uint64_t leaper;                /* 1 + id of a particle that moved more than its radius in a step, 0: none */
  double leap;                    /* by how much [m] */
  uint64_t pace_step, pace_next;  /* steps at which speeds were last looked at, and will be next */
  double way;                     /* that a particle and a wall may have gone towards each other since the last look at
                                     overlaps [m] */
  uint64_t lost;                  /* particles behind planes that are known */
  uint64_t told[DEM_GUARD_KINDS]; /* warnings so far */
} dem_guard_state;

/* Forces on the triangles of meshes at the last step or evaluation; all NULL unless model.triangle_forces. */
typedef struct {
  bool wanted;           /* of the evaluations to come */
  tdm_vec3 *force;       /* (model.ntriangle) of the particles on each, world [N] */
  tdm_vec3 *entry_force; /* (capacity) of each entry of the walls' list on its particle [N] */
  size_t capacity;
} dem_traction;

/* Columns of the notes of contacts (notes.h); a contact that is open has width 0. */
enum {
  DEM_NOTE_X,       /* normal, towards the first particle */
  DEM_NOTE_Y,       /* likewise */
  DEM_NOTE_Z,       /* likewise */
  DEM_NOTE_SHARE,   /* distance of the contact from a particle's centre, in its radii */
  DEM_NOTE_WIDTH,   /* square of the radius of the contact's circle [m2] */
  DEM_NOTE_FORCE,   /* elastic normal force, as the others feel it [N] */
  DEM_NOTE_OVERLAP, /* where laws go over their notes again: overlap [m], coefficient of Hertz's force [N/m^1.5] and */
  DEM_NOTE_HERTZ,   /* how much of what the particles' sides give counts */
  DEM_NOTE_WEIGHT,  /* likewise */
  DEM_NOTE_SIDE,    /* what the first particle's contacts give this one */
  DEM_NOTE_OTHER,   /* likewise of the second; 0 of a wall */
  DEM_NOTES
};

enum { DEM_NOTE_ROWS = 9 }; /* of room, a chunk */

typedef struct {
  bool valid;     /* they are of the lists that there are */
  double *column; /* (DEM_NOTES x stride) by place */
  size_t stride;
  size_t others; /* the first place of contacts that other ranks have with home particles */
  size_t *sent;  /* (homes.returning) places of contacts with other ranks' particles */
  int *first;    /* (nparticle + 2) first place of each particle, in place; then the end */
  int *place;    /* 2 x place, and 1 more where the particle is the second one */
  int most;      /* places of a particle at most */
  double *room;  /* (nchunk x DEM_NOTE_ROWS x row) scratch */
  size_t row;    /* 2 most, and what lanes may go beyond */
  size_t first_size, place_size, sent_size, column_size, room_size; /* [bytes] */
} dem_notes;

/* Particles that one thread works on at a time. Fixed, so that sums do not depend on the number of threads. */
enum { DEM_CHUNK = 2048, DEM_LANES_MAX = 8 };

/* Steps after which more than one chunk of particles is put in the order of places again. A fixed number, so that the
 * order of sums depends on no list, skin or search. */
enum { DEM_SORT_STEPS = 1000 };

/* Most sums over chunks at a time (seam/sums.h). */
enum { DEM_CHUNK_SUMS = 10 };

static inline int dem_chunks(int nparticle) {
  return nparticle > 0 ? (nparticle + DEM_CHUNK - 1) / DEM_CHUNK : 1;
}

enum {
  DEM_IN_FRONT = 1, /* the particle began in front of the wall */
  DEM_LET_GO = 2    /* the wall does not act on it until they are clear of each other (dem_shape.lets_go) */
};

/* The state: what a run changes and another run needs to go on from here bit-identically, with the histories in the
 * lists. It is copied, stored and restored by the lists of fields.h, in which every member has its row. */
typedef struct {
  uint64_t nstep; /* steps since the start of the run */
  dem_ledger ledger;
  dem_energy_balance energy_balance;

  /* particles, (nparticle) each, room for (work.capacity) */
  int nparticle;
  int restart;           /* 1: memory is to be made anew */
  uint64_t *id;          /* order of creation, ascending; never used twice */
  int *material;         /* index of model.material */
  uint32_t *held;        /* bit k: the particle has been in container k; none without containers */
  uint32_t *touched;     /* bit s: sink s waits until the particle has left its body again */
  double *mass;          /* [kg] */
  dem_sphere *sphere;    /* position, radius, velocity ahead, 1/mass; one more: the dummy particle */
  dem_rotor *rotor;      /* likewise */
  dem_pace *pace;        /* velocity and spin; in a step between the two kicks: at mid-step */
  dem_push *push;        /* sums of contacts; after those of the particles one of none and the crossings. Lists
                          * are built when they are not needed, and use their memory (pairs.h) */
  dem_push *spare_push;  /* multi-step: of the fast contacts, push then has the slow ones; else NULL */
  dem_pace *drive;       /* model.driven: accelerations besides contacts and gravity; else none */
  dem_pace *memory;      /* what the integrator keeps (integrate.h), if anything */
  tdm_quat *orientation; /* model.oriented; else none */
  dem_spot *spot;        /* model.screening.watched; else none */
  uint8_t *front;        /* (nparticle x nwall) DEM_IN_FRONT, DEM_LET_GO: the particle and this wall */

  /* bodies, (nbody) each */
  tdm_pose *pose;         /* now */
  tdm_twist *twist;       /* now */
  dem_mobility *mobility; /* for the damping */
  tdm_wrench *body_load;  /* (model.nload) of the particles, about the body's centre of mass, world */
  dem_wall_place *wall;   /* (nwall) where the walls are */
  double *lid;            /* (nwall) by how much a lid is shifted outward [m]; 0 for other walls */

  dem_source_state *source; /* (nsource) */
  dem_sink_state *sink;     /* (nsink) */

  dem_container_state *container; /* (ncontainer) */

  uint64_t *traced;               /* (model.ntrace) 1 + id of the particle, of one that a source makes; 0: not yet */
  dem_deck_state *deck;           /* (model.screening.ndeck) */
  dem_screening_state *screening; /* one if there are decks, else none */

  double memory_dt; /* step for which memory was made [s] */

  dem_domain domain;     /* where the box is now; all 0 when the scene has none */
  double domain_rate[3]; /* how fast its lengths grow now [m/s] */
  double strained;       /* how long it has been strained before the steps counted next [s] */
  uint64_t strain_steps; /* steps since, of strain_dt each */
  double strain_dt;      /* [s] */
  dem_guard_state guard;
  uint64_t since_sort; /* steps since the particles were put in the order of their places */

  long ncontact;     /* touching pairs and walls at the last evaluation */
  dem_energy energy; /* of the contacts, if the scene asks for it */

  /* means over the output interval, (model.nload + 1): as body_load, then of the contacts on fixed particles */
  tdm_wrench *sample_sum;
  tdm_wrench *sample_mean; /* the last sample's */
  double sample_steps;     /* steps in sample_sum; parts of one where an output time lies inside a step */
} dem_state;

/* The lists of what is near, with the histories of the contacts beside their entries, and where everything was when
 * they were built. They are made anew when something has moved too far; results do not depend on when, so a stored
 * state has of them only the histories. A copy takes them as they are. */
typedef struct {
  int nchunk; /* of DEM_CHUNK particles each, as of the last list */
  dem_pairs pairs;
  dem_wall_contacts walls;
  dem_crossings crossings;
  bool valid;          /* they are lists of these particles */
  bool stale;          /* particles came: rebuild at the next step */
  double skin;         /* [m] */
  double mean_radius;  /* of the particles, by which the skin is chosen [m] */
  uint64_t nrebuild;   /* times they were built */
  uint64_t since_list; /* steps since the last of them */

  /* when they were built */
  tdm_vec3 *position_at_list; /* (nparticle) [m] */
  tdm_pose *pose_at_list;     /* (nbody) */
  double *margin; /* (nbody) smallest gap - radius of a particle that is not listed with the body's walls [m] */
  double *reach;  /* (nbody) largest distance of a particle's centre from the centre of mass [m] */
  double length_at_list[3]; /* lengths of the box [m] */

  double home[DEM_RANKS_MAX + 1]; /* where the ranks' homes begin (homes.h), as shares of the chunks; then 1 */
} dem_lists;

/* Numbers of particles or of places, rank by rank: those of rank r are item[first[r]] ... item[first[r + 1] - 1]. */
typedef struct {
  int *item;  /* (capacity) */
  int *first; /* (size + 1) */
  int capacity;
} dem_parcels;

/* On several ranks of one thread each: which chunks add to a chunk in a step, so that its step ends as soon as nothing
 * more will (crossings.h). By chunk, of home chunks. */
typedef struct {
  int *to;    /* (capacity) where a chunk adds to: itself and those that its contacts have reactions on */
  int *first; /* (nchunk + 1) first of a chunk in `to` */
  int *all;   /* (nchunk) how many add to it; all other ranks together are one */
  int *left;  /* (nchunk) of these, in this step */
  int *seen;  /* (nchunk) scratch */
  int capacity;
} dem_givers;

/* What this rank and others tell each other (homes.h); all 0 in a process that is alone. */
typedef struct {
  const dem_ranks *ranks; /* borrowed; NULL: alone */
  unsigned united;        /* what is the same on all ranks now (DEM_PLACES ...) */
  bool spread;            /* since the last list this rank got memory for more than its home and what is near to it */
  bool spread_before;     /* likewise before the last list */
  bool holds;             /* it has such memory from then */
  bool planned;           /* the rest, and work.givers, are for the present crossings */
  bool visiting;          /* particles are on their way to those that they visit */
  bool stop, stopped;     /* this rank wants to end; one wanted to at the last step */
  dem_parcels immigrants; /* home particles that visit another rank */
  dem_parcels visitors;   /* particles of another rank that visit this one */
  dem_parcels returning;  /* places of this rank's reactions on visitors */
  dem_parcels returned;   /* places of other ranks' reactions on immigrants */
  int *rank_of;           /* (nchunk) whose home a chunk is */
  bool introduced;        /* visitors' radii and masses are known where they visit */
  int *chunk;             /* (home chunks) in the order in which they are evaluated; NULL: alone */
  int first_outer, end_outer; /* chunk[first_outer ... end_outer - 1] have visitors */
  dem_mail *mail;             /* (size) */
  char *out, *in;             /* (room) what goes and comes [bytes] */
  double *sums;               /* (nsums) of the chunks, as they are gathered */
  size_t room, nsums;
  double spent; /* time in exchanges with other ranks, waiting for them included [s] */

  /* balance */
  double *cost;                 /* (ncost) time of each home chunk since the last look [s] */
  int ncost;                    /* chunks */
  uint64_t looked;              /* step of the last look */
  double busiest, mean;         /* since then, of the ranks: most time and mean [s] */
  double all_busiest, all_mean; /* sums of these over earlier looks [s] */
  int nmove;                    /* times that homes moved */

  long touching;      /* home contacts that touched at the last evaluation */
  dem_rank_work work; /* of this rank, in the steps of the run */
} dem_homes;

/* A thread's chunks in a pass over all: those from `next` to before `end` are left. */
typedef struct {
  int next, end;
  char apart[56]; /* a cache line each */
} dem_section;

/* The workspace: memory, sums by chunk and whatever else means nothing between two steps. Never copied or stored. */
typedef struct {
  int nthread;
  dem_timers *timers; /* borrowed; NULL: not measured */
  dem_homes homes;

  /* an evaluation */
  tdm_wrench *chunk_load; /* (nchunk x model.nload) body_load by chunk */
  dem_flux *chunk_flux;   /* (nchunk) of the contacts' energies */
  double *chunk_sum;      /* (nchunk x DEM_CHUNK_SUMS) dem_sum_chunks */
  double *chunk_supplied; /* (nchunk) by the box, where particles pass its boundary [J] */
  dem_section *section;   /* (nthread) scratch: of a pass over chunks */
  dem_givers givers;      /* who adds to whom */
  tdm_wrench *fast_load;  /* (model.nload) multi-step: body_load of the fast contacts */
  dem_traction traction;  /* forces on the triangles of meshes (bodies/traction.h) */

  /* a rebuild of the lists */
  struct dem_search *search;                    /* owned; NULL until the first list */
  void (*search_destroy)(struct dem_search **); /* of who made it */
  dem_rows rows;                                /* what the search found */
  dem_scratch scratch;                          /* the memory of push */
  dem_wall_contacts spare_walls;                /* the previous list */
  size_t *chunk_spare;                          /* (nchunk + 1) */

  uint64_t *hole;       /* (nparticle) scratch, where holes are watched; else none */
  int *number;          /* (nparticle) scratch, where particles can leave; else none */
  int capacity;         /* room for so many particles */
  dem_notes notes;      /* of contacts, for laws that take them */
  bool among;           /* contact_sum or the notes are those of the last evaluation */
  double *contact_sum;  /* (places of push x model.nsum) over the contacts of a particle, for laws that have them */
  int push_capacity;    /* entries of push */
  void *particle_block; /* the arrays of particles */
  void *block;          /* the arrays of fixed size */
  size_t block_size;    /* of the latter [bytes] */
} dem_workspace;

typedef struct dem_data {
  const dem_model *model; /* borrowed */
  dem_state state;
  dem_lists lists;
  dem_workspace work;
} dem_data;

/* Room for a scene, all zero (create.h makes its start). NULL when memory runs out. The model must outlive the data. */
dem_data *dem_data_allocate(const dem_model *model);

/* Make dst the same state as src; both belong to one model. It then goes on bit-identically. Errors: TDM_ERR_MEMORY. */
tdm_status dem_data_copy(dem_data *dst, const dem_data *src);

void dem_data_destroy(dem_data **data);

/* Put the dummy particle, which touches nothing, behind the last. */
void dem_data_end(dem_data *data);

/* Room for n particles. TDM_ERR_MEMORY: nothing changed. */
tdm_status dem_data_reserve(dem_data *data, int n);

/* The particle after the last one of a chunk. */
static inline int dem_chunk_end(const dem_data *d, int c) {
  return c + 1 < d->lists.nchunk ? (c + 1) * DEM_CHUNK : d->state.nparticle;
}

/* Room for `count` entries. Of the pairs those from `first` to before `end` keep partners and histories, walls may lose
 * all. Errors: TDM_ERR_MEMORY. */
tdm_status dem_pairs_reserve(dem_pairs *list, size_t count, int ncolumn, size_t first, size_t end);
tdm_status dem_walls_reserve(dem_wall_contacts *list, size_t count, int ncolumn);

/* Where crossing k has its place in push and contact_sum: behind the particles and the dummy particle. */
static inline int dem_crossing_slot(const dem_data *d, int k) {
  return d->state.nparticle + 1 + k;
}

/* Room in push for the particles, the dummy particle and `count` crossings. Errors: TDM_ERR_MEMORY. */
tdm_status dem_crossings_reserve(dem_data *data, int count);

#endif

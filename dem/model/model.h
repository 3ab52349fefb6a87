/* The model: what a scene fixes. Immutable after loading, shared as `const dem_model *`.
 *
 * The scene section "dem" is described in docs/scene.md; scene/scene.c reads it, scene/fill.c makes the particles.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_MODEL_H
#define DEM_MODEL_MODEL_H

#include "dem/geometry/wall/wall.h"
#include "dem/model/driven.h"
#include "dem/model/sizes.h"
#include "protocol/wire/participant.h"

#include <stdint.h>

typedef struct {
  char *name;
  double density; /* [kg/m3] */
  bool product;   /* dem.screening counts it */
  double young;   /* [Pa] */
  double poisson;
  double shear; /* young / (2 (1 + poisson)) [Pa] */
} dem_material;

enum { DEM_COEFFICIENTS_MAX = 5 }; /* of one law */

/* What a contact of two materials needs, worked out at load time; 0 where no law of the scene asks for it. All doubles
 * after `given`: contacts gather them by their place. */
typedef struct {
  const struct dem_normal_law *law; /* its own normal law, at walls; NULL: the scene's */
  bool given;                       /* the scene has this pair */
  double restitution;               /* 0: the damping is given otherwise */
  double friction, static_friction;
  double floor;           /* least normal force: -inf, or 0 when the attractive tail is cut [N] */
  double effective_young; /* E*: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2 [Pa] */
  double effective_shear; /* G*: 1/G* = (2-nu1)/G1 + (2-nu2)/G2 [Pa] */

  /* of the normal law, which others may read */
  double stiffness;      /* of a linear law, else 0 [N/m] */
  double beta;           /* damping ratio of the restitution on Hertz's contact, 0 without one */
  double normal_damping; /* of the restitution; its meaning is the law's */
  double viscosity;      /* given instead of a restitution; likewise */

  /* each law's own, named in its file */
  double normal[DEM_COEFFICIENTS_MAX], tangential[DEM_COEFFICIENTS_MAX], rolling[DEM_COEFFICIENTS_MAX],
      twisting[DEM_COEFFICIENTS_MAX], cohesion[DEM_COEFFICIENTS_MAX];
  double multi[DEM_COEFFICIENTS_MAX]; /* of a particle of the first material with one of the second */
} dem_pair;

/* The history of a contact: the tangential law's columns first, then the normal law's, then these where the scene has
 * them. */
typedef struct {
  int ncolumn;
  unsigned vectors;                        /* bit q: column q is one of a vector's */
  int normal, rolling, twisting, cohesion; /* the first of each law; -1: it has none */
  int sliding;                             /* 1 while a contact slides, for a static friction of its own; -1: none */
} dem_columns;

enum { DEM_HISTORY_MAX = 10, DEM_SETTINGS_MAX = 4 };

/* A body: walls that move as one rigid body. */
typedef struct {
  char *name;
  int material;
  int coupled;     /* index among the assignment's coupled bodies, -1: fixed or driven */
  double mass;     /* at the start [kg], inf: cannot be moved */
  tdm_state start; /* world */
  dem_drive drive; /* of a body that is not coupled */
} dem_body;

/* An entry of a body's "shapes". */
typedef struct {
  int body, number;      /* number: in the body's list */
  int first_wall, nwall; /* the walls that it is made of */
} dem_geometry;

/* Makes particles during the run (flow.h). */
typedef struct {
  char *name;
  int material;
  dem_sizes sizes;
  double mass;        /* of one particle [kg], 0: from the density */
  double rate;        /* [1/s], 0: mass_rate decides */
  double mass_rate;   /* [kg/s], 0: rate decides */
  tdm_vec3 low, high; /* box in which the centres appear, world [m]; a point when both are equal */
  tdm_vec3 velocity;  /* world [m/s] */
  int relative;       /* body whose velocity is added, -1: none */
  double factor;      /* of that velocity */
  double start, end;  /* [s]; inf: no end */
  uint64_t count;     /* at most so many particles */
  double total_mass;  /* ends before the particle that would exceed it [kg]; inf: no limit */
  uint64_t seed;
} dem_source;

/* Takes particles away during the run (flow.h). */
typedef enum { DEM_SINK_AFTER_CONTACT, DEM_SINK_BOX, DEM_SINK_PLANE, DEM_SINK_SECTOR } dem_sink_type;

enum {
  DEM_SINKS_MAX = 32, /* one bit each in dem_state.touched */
  DEM_EDGES_MAX = 15  /* of a sink's size classes */
};

typedef struct {
  char *name;
  dem_sink_type type;
  int body;               /* after_contact */
  int frame;              /* body in whose axes, from its centre of mass, the place is given; -1: world */
  tdm_vec3 low, high;     /* box [m] */
  tdm_vec3 point, normal; /* plane: takes what is behind it; sector: middle of the ring, its axis */
  tdm_vec3 across;        /* sector: direction of angle 0, unit, across the axis */
  double radius[2], angle[2], height[2]; /* sector: from and to [m], [rad], [m] along the axis from the point */
  int nedge;                             /* 0: no classes, else nedge + 1 of them */
  double edge[DEM_EDGES_MAX];            /* (nedge) ascending radii [m]: class k has edge[k-1] <= r < edge[k] */
} dem_sink;

/* Size classes that a sink counts by. */
static inline int dem_sink_classes(const dem_sink *sink) {
  return sink->nedge > 0 ? sink->nedge + 1 : 0;
}

/* A deck of a screen by what leaves it (flow/screening.h). */
typedef struct {
  char *name;
  double sorted;        /* radius from which on a particle that leaves it is sorted [m] */
  int screen;           /* the wall of its screen, -1: none is watched */
  long holes;           /* of that */
  double blocking_time; /* after which a particle that stays on a hole blocks it [s] */
} dem_screening_deck;

/* What counts as screening (flow/screening.h). */
typedef struct {
  int ndeck;                  /* 0: the scene has no dem.screening */
  dem_screening_deck *deck;   /* (ndeck) from the highest to the lowest */
  int deck_of[DEM_SINKS_MAX]; /* (nsink) whose outlet a sink is, -1: of none */
  double start;               /* what leaves from then on counts [s] */
  double smoothing;           /* time over which output rates are smoothed [s] */
  bool watched;               /* the screen of some deck is watched for blocked holes (flow/blocking.h) */
  uint64_t every;             /* steps between two looks at them */
} dem_screening_def;

/* A particle whose path is an output (flow/traces.h). */
typedef struct {
  char *name;
  int body;          /* in whose axes, -1: the world's */
  int source;        /* that makes it; -1: any */
  uint64_t particle; /* its number among those of the source, or of all, from 0 in the order of creation */
} dem_trace;

enum { DEM_TRACES_MAX = 16 };

enum { DEM_CONTAINERS_MAX = 32 }; /* one bit each in dem_state.held */

/* A place whose content is counted, and watched for jams (container.h). */
typedef struct {
  char *name;
  int frame;          /* body in whose axes, from its centre of mass, the box is given; -1: world */
  tdm_vec3 low, high; /* box [m] */
  double jam_time;    /* without a particle that leaves [s] */
  double jam_start;   /* from when on it is watched [s]; inf: from the first particle that leaves on */
} dem_container;

/* Lets particles fall into a bed while it settles (pour.h). */
typedef struct {
  int entry;          /* of dem.particles */
  int first, count;   /* its particles in the arrays of the model */
  tdm_pose frame;     /* of the region to world */
  tdm_vec3 low, high; /* region in which they appear, spheres inside [m] */
  double largest;     /* radius [m] */
  uint64_t seed;
} dem_pouring;

/* Particles that one entry of dem.particles made: [first, first + count). */
typedef struct {
  int first, count;
  tdm_vec3 force;        /* on each of them, besides gravity and contacts [N] */
  tdm_vec3 acceleration; /* likewise [m/s2] */
  bool fixed;            /* they never move */
} dem_group;

/* The box in which particles stay, repeat or leave (domain.h). */
typedef struct {
  bool wanted;        /* the scene has dem.domain */
  bool periodic[3];   /* else open */
  double low[3];      /* at the start [m] */
  double length[3];   /* at the start [m] */
  double rate[3];     /* of strain: length (1 + rate t) [1/s]; 0 in open directions */
  bool repeats, open; /* some direction is periodic, some is open */
  bool strained;      /* some rate is not 0 */
} dem_domain_def;

typedef enum { DEM_GUARD_WARN, DEM_GUARD_STOP } dem_guard_action;

/* What is watched while running (guard.h). */
typedef struct {
  long every;     /* steps between two looks, 0: never */
  double overlap; /* largest share of the smaller radius */
  double energy;  /* largest rise, as a share of the energy there is */
  dem_guard_action action;
  bool chosen; /* the scene gives the action */
} dem_guard_def;

/* When the homes of ranks move (seam/homes.h). */
typedef struct {
  long every;       /* steps between two looks, 0: never */
  double tolerance; /* by how much the busiest rank's work may exceed the mean, as a share of it */
} dem_balance_def;

typedef struct {
  bool wanted;     /* the scene has dem.settle */
  double speed;    /* largest particle speed of a bed at rest [m/s] */
  double max_time; /* [s] */
  double dt;       /* [s], 0: chosen from the step limits */
  double drag;     /* rate at which velocities and spins decay while settling [1/s] */
  char *store;     /* file that keeps the settled bed, NULL: none */
} dem_settling;

typedef struct dem_model {
  double dt;  /* DEM step [s] */
  bool proxy; /* windows come with the mechanism that holds the coupled bodies (assignment) */
  double time_start, time_end;
  tdm_interpolation interpolation;
  tdm_vec3 gravity; /* [m/s2] */

  const char *simd;                         /* instruction set, of dem_simd_names */
  const struct dem_normal_law *normal;      /* the contact laws (contact/law/law.h) */
  const struct dem_normal_law *wall_normal; /* of contacts with walls: the same, or the one that pairs name */
  const struct dem_tangential_law *tangential;
  const struct dem_rolling_law *rolling;
  const struct dem_twisting_law *twisting;
  const struct dem_cohesion_law *cohesion;
  double normal_setting[DEM_SETTINGS_MAX]; /* of dem.contact, named in the normal law's file */
  const struct dem_loops *loops;           /* over contacts with these laws */
  const struct dem_loops *wall_loops;      /* those of the law of walls */
  const struct dem_multi_law *multi;       /* how the contacts of a particle act on each other */
  double multi_setting[DEM_SETTINGS_MAX];  /* of dem.contact, named in that law's file */
  const struct dem_loops *sum_loops;       /* before these, the sums over the contacts of a particle; NULL: none */
  const struct dem_noting *noting;         /* likewise the notes of contacts; NULL: none */
  int nsum;                                /* how many, of a law that has them */
  bool all_terms;                          /* of the loops: those with all families and energies */
  struct {
    int tangential, rolling, twisting, cohesion;
  } place;              /* of the laws in their tables */
  bool couples;         /* contacts give couples: rolling or twisting */
  bool energy;          /* energies of the contacts are wanted */
  bool geometry_loads;  /* loads of the geometries of bodies that have several are wanted */
  bool triangle_forces; /* so are forces on the triangles of meshes */
  dem_columns columns;  /* of the contacts' history */
  double reach;         /* gap over which contacts act, for the neighbour lists [m] */
  const struct dem_integrator *integrator;
  bool oriented;                        /* the state keeps how the particles are turned */
  bool unturned;                        /* particles do not turn: moments on them are without effect */
  bool remembers;                       /* the integrator keeps something for each particle (dem_state.memory) */
  const struct dem_integrator *settler; /* velocity Verlet, for settling */
  struct {
    long substeps;
    double mass; /* contacts of a smaller effective mass are the fast ones [kg] */
  } multi_step;
  int threads;        /* that work at the same time; results do not depend on it */
  int ranks;          /* processes that share the run; likewise. 0: the scene does not say */
  const char *search; /* of dem_search_names, NULL: chosen for the spheres */
  int flat;           /* axis along which particles do not move (dem.dimension 2), -1: none */
  double flat_at;     /* their coordinate along it [m] */
  bool driven;        /* flat, unturned, or a group has forces of its own or is fixed */
  dem_domain_def domain;
  dem_guard_def guard;
  int slices; /* 1, 2, 3: particles are in the order of slices across x, y, z; 0: of a curve (search/order.h) */
  dem_balance_def balance;
  char *start;           /* stored state that the run starts from, NULL: none */
  bool clip;             /* the normal force never attracts */
  double wall_mass;      /* [kg] taken for every wall in the damping; 0: the body's own mass */
  double skin;           /* of the neighbour lists [m]; 0: chosen while running (search/pairs.h) */
  double mean_radius;    /* of the particles, every source's counted as one [m] */
  double largest_radius; /* that is there or that a source will make [m]; 0 without any */

  int nmaterial;
  dem_material *material; /* (nmaterial) */
  dem_pair *pair;         /* (nmaterial x nmaterial), symmetric */
  dem_pair *settle_pair;  /* (nmaterial x nmaterial) the same while settling */

  int nbody, ncoupled, ndriven;
  dem_body *body;    /* (nbody) */
  int *coupled_body; /* (ncoupled) body of each coupled body */

  int ngeometry;
  dem_geometry *geometry; /* (ngeometry) of all bodies, body by body */

  int nload; /* loads that a step sums up: those of the bodies, then of the geometries if geometry_loads */

  int nwall;
  dem_wall *wall; /* (nwall) of all bodies, body by body */

  int ntriangle;       /* of all walls with parts, if triangle_forces, else 0 */
  int *first_triangle; /* (nwall) of these; NULL when there are none */

  int ngroup;
  dem_group *group; /* (ngroup) by entry of dem.particles */
  bool fixes;       /* a group or a particle is fixed */

  int npouring;
  dem_pouring *pouring; /* (npouring) one after the other */

  int nbox;
  dem_box *box; /* (nbox) containers */

  int nsource, nsink;
  dem_source *source; /* (nsource) */
  dem_sink *sink;     /* (nsink) */

  int ncontainer;
  dem_container *container; /* (ncontainer) */

  dem_screening_def screening;

  int ntrace;
  dem_trace *trace; /* (ntrace) */

  /* The particles at the start; how many there are now, and which, is in the data. The last npoured of them come while
   * settling and have no position yet. On several ranks places and motion are there of first_here ... end_here - 1
   * only, and all these arrays are NULL when the run begins. */
  int nparticle, npoured;
  int first_here, end_here;
  double *radius;         /* (nparticle) [m] */
  double *mass;           /* (nparticle) [kg] */
  int *particle_material; /* (nparticle) index of material */
  tdm_vec3 *position;     /* (nparticle) at the start [m] */
  tdm_vec3 *velocity;     /* (nparticle) at the start [m/s] */
  tdm_vec3 *spin;         /* (nparticle) angular velocity at the start [rad/s] */
  bool *still;            /* (nparticle) never moves, besides those of fixed groups; NULL: none */
  tdm_quat *orientation;  /* (nparticle) at the start; NULL unless oriented */

  double expected_speed; /* largest relative speed that the user expects [m/s], 0: estimated */

  dem_settling settle;
} dem_model;

/* Index of a name, -1 when there is none. */
int dem_find_material(const dem_model *model, const char *name);
int dem_find_body(const dem_model *model, const char *name);

/* v with `at` for the component along which particles do not move. */
static inline tdm_vec3 dem_flatten(const dem_model *m, tdm_vec3 v, double at) {
  if (m->flat >= 0)
    (&v.x)[m->flat] = at;
  return v;
}

/* Free how particles start: radius, mass, particle_material, position, velocity, spin, orientation. */
void dem_model_forget_start(dem_model *model);

/* Frees and sets *model to NULL; *model may be NULL. */
void dem_model_destroy(dem_model **model);

#endif

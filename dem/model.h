/* The model: what a scene fixes. Immutable after loading, shared as `const dem_model *`.
 *
 * The scene section "dem" is described in README.md; model_read.c reads it, fill.c makes the particles.
 */
#ifndef DEM_MODEL_H
#define DEM_MODEL_H

#include "dem/contact/table.h"
#include "dem/geometry/shape.h"
#include "dem/sizes.h"
#include "protocol/participant.h"

#include <stdint.h>

typedef struct {
  char *name;
  double density; /* [kg/m3] */
  double young;   /* [Pa] */
  double poisson;
  double shear; /* young / (2 (1 + poisson)) [Pa] */
} dem_material;

/* What a contact of two materials needs, worked out at load time. */
typedef struct {
  bool given; /* the scene has this pair */
  double restitution, friction;
  double floor;              /* least normal force: -inf, or 0 when the attractive tail is cut [N] */
  double young;              /* E*: 1/E* = (1-nu1^2)/E1 + (1-nu2^2)/E2 [Pa] */
  double shear;              /* G*: 1/G* = (2-nu1)/G1 + (2-nu2)/G2 [Pa] */
  double normal_damping;     /* 2 sqrt(5/6) beta: c_n = this * sqrt(m* S_n) */
  double tangential_damping; /* 2 sqrt(5/6) beta sqrt(8 G* / 2 E*): c_t = this * sqrt(m* S_n) */
} dem_pair;

/* A geometry: walls that move as one rigid body. */
typedef struct {
  char *name;
  int material;
  int coupled;     /* index among the assignment's coupled bodies, -1: fixed in space */
  double mass;     /* at the start [kg], inf: cannot be moved */
  tdm_state start; /* world */
} dem_body;

/* Makes particles during the run (flow.h). */
typedef struct {
  char *name;
  int kind; /* material */
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
typedef enum { DEM_SINK_AFTER_CONTACT, DEM_SINK_BOX, DEM_SINK_PLANE } dem_sink_type;

enum {
  DEM_SINKS_MAX = 32, /* one bit each in dem_data.touched */
  DEM_EDGES_MAX = 15  /* of a sink's size classes */
};

typedef struct {
  char *name;
  dem_sink_type type;
  int body;                   /* after_contact */
  tdm_vec3 low, high;         /* box: world [m] */
  tdm_vec3 point, normal;     /* plane: takes what is behind it; world */
  int nedge;                  /* 0: no classes, else nedge + 1 of them */
  double edge[DEM_EDGES_MAX]; /* (nedge) ascending radii [m]: class k has edge[k-1] <= r < edge[k] */
} dem_sink;

/* Size classes that a sink counts by. */
static inline int dem_sink_classes(const dem_sink *sink) {
  return sink->nedge > 0 ? sink->nedge + 1 : 0;
}

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
} dem_group;

typedef struct {
  bool wanted;     /* the scene has dem.settle */
  double speed;    /* largest particle speed of a bed at rest [m/s] */
  double max_time; /* [s] */
  double dt;       /* [s], 0: chosen from the step limits */
  double drag;     /* rate at which velocities and spins decay while settling [1/s] */
  char *store;     /* file that keeps the settled bed, NULL: none */
} dem_settling;

typedef struct dem_model {
  double dt; /* DEM step [s] */
  double time_start;
  tdm_interpolation interpolation;
  tdm_vec3 gravity; /* [m/s2] */

  const char *simd;   /* instruction set, of dem_simd_names */
  const dem_law *law; /* the combination of contact laws */
  const struct dem_integrator *integrator;
  bool clip;        /* the normal force never attracts */
  double wall_mass; /* [kg] taken for every wall in the damping; 0: the body's own mass */
  double skin;      /* of the neighbour list [m] */

  int nmaterial;
  dem_material *material; /* (nmaterial) */
  dem_pair *pair;         /* (nmaterial x nmaterial), symmetric */
  dem_pair *settle_pair;  /* (nmaterial x nmaterial) the same while settling */

  int nbody, ncoupled;
  dem_body *body;    /* (nbody) */
  int *coupled_body; /* (ncoupled) body of each coupled body */

  int nwall;
  dem_wall *wall; /* (nwall) half-spaces and solid boxes of all bodies, body by body */

  int ngroup;
  dem_group *group; /* (ngroup) by entry of dem.particles */

  int npouring;
  dem_pouring *pouring; /* (npouring) one after the other */

  int nbox;
  dem_box *box; /* (nbox) containers */

  int nsource, nsink;
  dem_source *source; /* (nsource) */
  dem_sink *sink;     /* (nsink) */

  /* the particles at the start; how many there are now, and which, is in the data. The last npoured of them come while
   * settling and have no position yet. */
  int nparticle, npoured;
  double *radius;     /* (nparticle) [m] */
  double *mass;       /* (nparticle) [kg] */
  int *kind;          /* (nparticle) material */
  tdm_vec3 *position; /* (nparticle) at the start [m] */
  tdm_vec3 *velocity; /* (nparticle) at the start [m/s] */
  tdm_vec3 *spin;     /* (nparticle) angular velocity at the start [rad/s] */

  double expected_speed; /* largest relative speed that the user expects [m/s], 0: estimated */

  dem_settling settle;
} dem_model;

/* Index of a name, -1 when there is none. */
int dem_find_material(const dem_model *model, const char *name);
int dem_find_body(const dem_model *model, const char *name);

/* Read the assignment's section "dem". *model is set also after an error (the caller destroys it). */
tdm_status dem_model_load(dem_model **model, const tdm_assignment *assignment, tdm_error *err);

/* Frees and sets *model to NULL; *model may be NULL. */
void dem_model_destroy(dem_model **model);

#endif

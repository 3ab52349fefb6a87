/* The model: what a scene fixes. Immutable after loading, shared as `const dem_model *`.
 *
 * The scene section "dem" is described in README.md; model_read.c reads it, fill.c makes the particles.
 */
#ifndef DEM_MODEL_H
#define DEM_MODEL_H

#include "dem/contact/table.h"
#include "dem/geometry/shape.h"
#include "protocol/participant.h"

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
} dem_settling;

typedef struct dem_model {
  double dt; /* DEM step [s] */
  double time_start;
  tdm_interpolation interpolation;
  tdm_vec3 gravity; /* [m/s2] */

  const dem_law *law; /* the combination of contact laws */
  double wall_mass;   /* [kg] taken for every wall in the damping; 0: the body's own mass */
  double skin;        /* of the neighbour list [m] */

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
  dem_group *group; /* (ngroup) */

  int nparticle;
  double *radius;     /* (nparticle) [m] */
  double *mass;       /* (nparticle) [kg] */
  int *kind;          /* (nparticle) material */
  tdm_vec3 *position; /* (nparticle) at the start [m] */
  tdm_vec3 *velocity; /* (nparticle) at the start [m/s] */
  tdm_vec3 *spin;     /* (nparticle) angular velocity at the start [rad/s] */

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

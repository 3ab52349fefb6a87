/* The multibody model: what a scene fixes. Immutable after mbd_model_read (scene/scene.h) and mbd_model_couple; the
 * run's own state is an mbd_data.
 *
 * Bodies are numbered from 0, the fixed world ("ground") is body -1. World axes unless a comment says body axes.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_MODEL_H
#define MBD_MODEL_MODEL_H

#include "mbd/model/driver.h"
#include "mbd/model/force.h"
#include "mbd/shape/outline.h"
#include "protocol/wire/participant.h"

enum { MBD_GROUND = -1, MBD_NAME_MAX = 40 };

/* a point with axes that is fixed to a body */
typedef struct {
  char name[MBD_NAME_MAX];
  tdm_pose pose;                  /* body axes, from the centre of mass */
  bool output;                    /* it has channels */
  char channel[2 * MBD_NAME_MAX]; /* "body.marker", their name */
} mbd_marker;

typedef struct {
  char name[MBD_NAME_MAX];
  double mass;      /* [kg] */
  tdm_mat3 inertia; /* about the centre of mass, body axes [kg m2] */
  tdm_mat3 inverse_inertia;
  bool slim;           /* it has none about its own axis (slim.h): a ball's inverse stands above */
  bool spins;          /* slim, and no joint holds it about the axis: it has the inertia of a ball */
  tdm_vec3 axis;       /* slim: body axes */
  tdm_state start;     /* as given in the scene, orientation normalised */
  tdm_vec3 origin;     /* of the file that its shape is a mesh of, from the centre of mass, body axes [m] */
  char *mesh;          /* that file, NULL: none */
  double scale;        /* metres a unit of it */
  mbd_outline outline; /* of a shape that is no mesh; draw NULL: it has none */
  int nmarker;
  mbd_marker *marker; /* (nmarker) */
} mbd_body;

typedef enum {
  MBD_GGL,      /* stabilised index 2: positions and velocities on the constraints */
  MBD_INDEX3,   /* positions alone */
  MBD_ONE_STEP, /* generalised-alpha */
  MBD_FORMULATIONS
} mbd_formulation_id;

typedef enum { MBD_GUARD_STOP, MBD_GUARD_WARN, MBD_GUARD_OFF } mbd_guard_action;

/* scene key "guard", see guard.h */
typedef struct {
  double energy; /* share of the energy by which the balance may be off */
  mbd_guard_action action;
} mbd_guard_settings;

/* settings of the integrator, scene keys "formulation" ... and "solver" */
typedef struct {
  mbd_formulation_id formulation;
  bool modified;             /* corrector: velocities are out of the error test and weigh little in Newton's */
  bool restart_each_window;  /* forget the history at the start of each window */
  double relative_tolerance; /* of positions, Euler parameters and velocities */
  double absolute_tolerance; /* of the same [m, 1, m/s, rad/s] */
  int max_order;             /* of the BDF, 1 to 5 */
  double max_step;           /* [s], 0: no limit */
  double spectral_radius;    /* one_step: at infinite frequency, 0 to 1 */
  mbd_guard_settings guard;
} mbd_settings;

/* A pair of bodies tied by a constraint. A joint or driver has one; a joint that couples others has one for each of
 * them, which add up in the same rows. */
typedef struct {
  const mbd_joint *joint;    /* the joint, or the one whose coordinate the driver drives or friction holds */
  const mbd_driver *driver;  /* NULL: the joint's own rows */
  const mbd_force *friction; /* whose row it is, which holds the joint's coordinate while it sticks; NULL: none's */
  int index;                 /* from 0 among the pairs of a joint that couples others */
  int turn;                  /* the joint whose angle is counted over turns for it, -1: none */
  int body[2], row;
} mbd_part;

struct mbd_model {
  const json_t *section;        /* borrowed while it is read, NULL afterwards */
  const tdm_types *joint_types; /* that a scene may name, rows mbd_joint_ops; as the section */
  tdm_vec3 gravity;             /* [m/s2] */
  int nbody;
  mbd_body *body; /* (nbody) */
  int njoint;
  mbd_joint *joint; /* (njoint) */
  int ndriver;
  mbd_driver *driver; /* (ndriver) */
  int nforce;
  mbd_force *force; /* (nforce) */
  int npart;
  mbd_part *part; /* (npart) those of the joints first, then drivers, then frictions */
  int njointpart; /* parts of all joints */
  int njointrow;  /* constraint rows of all joints */
  int nrow;       /* of all joints, then drivers, then frictions */
  int nfriction;
  int *friction; /* (nfriction) forces that may stick, each with one row; nreacting of them rub by a joint's reaction */
  int nreacting;
  int ncoupled;
  int *coupled; /* (ncoupled) body index of each coupled body, in the order of the assignment */
  mbd_settings solver;
};

/* Name the bodies that take a load from outside; errors are at "coupling.bodies[i].mbd". */
tdm_status mbd_model_couple(mbd_model *model, const tdm_assigned_body *body, int nbody, tdm_error *err);

/* Refuse a motion law that has no value at some time of [t0, t1] [s]. */
tdm_status mbd_model_check_times(const mbd_model *model, double t0, double t1, tdm_error *err);

void mbd_model_destroy(mbd_model **model);

/* The index of a body (MBD_GROUND for "ground"), -2 when there is none of that name. */
int mbd_model_find_body(const mbd_model *model, const char *name);

/* The body name nearest to `name`, or NULL; the ground counts if asked. */
const char *mbd_model_nearest_body(const mbd_model *model, const char *name, bool ground);

/* Start pose of a body or of the ground, and a world point or direction in that body's axes. */
tdm_pose mbd_model_pose(const mbd_model *model, int body);
tdm_vec3 mbd_model_arm(const mbd_model *model, int body, tdm_vec3 world_point);
tdm_vec3 mbd_model_direction(const mbd_model *model, int body, tdm_vec3 world_direction);

/* The size of the mechanism at the start [m]: the diagonal of the box around the bodies' centres and their joint
 * points, that of the one around the joint points of the ground, or a radius of gyration, whichever is largest. */
double mbd_model_extent(const mbd_model *model);

/* The absolute tolerance below which rounding of positions counts [m]: 3e-14 of the largest coordinate of a body at the
 * start, or of the mechanism's size, or of 1 m. */
double mbd_model_finest(const mbd_model *model);

#endif

/* Small models that the tests make FMUs of; fmi2.c and fmi3.c give them the two interfaces. Which one it is, and what
 * is to go wrong with it, the token (GUID) says: "spring", "arm hang" ...
 *
 *   spring    a mass on a spring and damper, x downwards:
 *             m x'' = m g + F - preload - k x - c x'
 *
 *   arm       a body on an arm with a torsional spring and damper:
 *             I phi'' = M + mz + (r x f)_z + m g r_x - k phi - c phi'
 *
 *   cylinder  a piston that a valve feeds:
 *             m x'' = F + A p - c x',   p' = (E/(V + A x)) (q sqrt(ps - p) - A x')
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_FMU_MODEL_H
#define TEST_FMU_MODEL_H

/* Variables by their value reference; what a model does not have stays 0. */
enum {
  V_MASS,
  V_STIFFNESS,
  V_DAMPING,
  V_PRELOAD,
  V_GRAVITY,
  V_INERTIA, /* about the pivot */
  V_ARM,     /* length */
  V_AREA,
  V_SUPPLY, /* ps */
  V_VALVE,  /* q */
  V_MODULUS,
  V_VOLUME, /* V */
  V_F = 20,
  V_M,
  V_FX,
  V_FY,
  V_MZ,
  V_X = 30, /* spring, cylinder: way; arm: place of the body */
  V_Y,
  V_VX,
  V_VY,
  V_AX,
  V_AY,
  V_PHI,
  V_W,
  V_ALPHA,
  V_PRESSURE,
  V_DEGREES,
  NVALUE,
  /* FMI 3: arrays of three */
  V_FORCE3 = 50, /* (fx, fy, nothing) */
  V_PLACE3,      /* (x, y, 0) */
  V_VELOCITY3,
  /* of other types */
  V_COUNT = 60,
  V_SWITCH,
  V_TEXT
};

typedef enum { SPRING, ARM, CYLINDER } model_kind;

typedef struct {
  model_kind kind;
  char fault[32]; /* "": none */
  double t;
  double state[3]; /* x, v, p; phi, w */
  double value[NVALUE];
  int count, on;
  char text[32];
} model;

/* A model by its token; 0: there is none of that name, or it is "single" and the process has had one. */
int model_make(model *m, const char *token);

/* Integrate from m->t by h; the outputs follow. */
void model_step(model *m, double h);

/* Outputs by states and inputs. */
void model_look(model *m);

/* How an output changes with an input. */
double model_derivative(const model *m, unsigned output, unsigned input);

/* 1 if this is to go wrong now: "hang", "crash", "overflow" (of the stack) and "exit" do so by themselves. */
int model_fails(const model *m, const char *fault);

#endif

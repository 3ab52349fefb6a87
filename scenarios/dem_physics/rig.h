/* A small scene of particles in memory, stepped by hand: what the cases of this folder run on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_RIG_H
#define SCN_RIG_H

#include "coupler/verify/verify.h"
#include "dem/state/data.h"

typedef struct {
  cpl_verify *verify; /* borrowed: told what the run cost */
  json_t *scene;      /* the section dem */
  dem_model *model;
  dem_data *data;
  double dt;    /* of the next steps [s] */
  double time;  /* stepped so far [s] */
  double begin; /* wall clock [s] */
} scn_rig;

/* Load the section dem given as JSON with ' for " (printf format), and let it settle if it says so. Zeroed by this;
 * scn_rig_close also after an error. */
tdm_status scn_rig_open(scn_rig *rig, cpl_verify *v, double dt, tdm_error *err, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* n steps; sources and sinks act. */
tdm_status scn_rig_steps(scn_rig *rig, long n, tdm_error *err);

/* Frees; the measures that follow show this run's times. */
void scn_rig_close(scn_rig *rig);

/* Kinetic energy with rotation [J]. */
double scn_rig_kinetic(const scn_rig *rig);

/* ---- impacts ---- */

/* What came out of an impact of particle 0 with particle 1, or with the plane z = 0 when there is no other. */
typedef struct {
  double overlap, force;         /* largest [m], [N] */
  double time;                   /* until the overlap is 0 again [s] */
  double push_time;              /* until the force is 0 [s] */
  tdm_vec3 velocity[2], spin[2]; /* afterwards [m/s], [rad/s] */
} scn_impact;

/* Called after each step of the contact: time, overlap, normal force. */
typedef void scn_impact_watch(void *context, double time, double overlap, double force);

/* Step from first touch (overlap 0) until the bodies part. TDM_ERR_NUMERIC: they do not in `most` steps. */
tdm_status scn_rig_impact(scn_rig *rig, long most, scn_impact *impact, scn_impact_watch *watch, void *context,
                          tdm_error *err);

/* Keep the largest size in *most (0 at first); NaN stays. */
void scn_worst(double *most, double difference);

/* dir/name of the scenario's results, for writing; NULL and an error. */
FILE *scn_curve(cpl_verify *v, const char *name, tdm_error *err);

#endif

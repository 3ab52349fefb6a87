/* LIGGGHTS' own example of mc-strain (examples/LIGGGHTS/Tutorials_public/hydrogel_multicontact): the bed of
 * hydrogel.json in a box of stiff walls, with gravity, under a plate that moves evenly by 18 %. Its largest force on
 * the plate against those that LIGGGHTS 3.8 gets with and without the law. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"
#include "scenarios/table.h"

#include "protocol/parameters/load.h"

#include <math.h>
#include <stdio.h>

enum { SAMPLES = 200 };

static const double start = 0.1676430125, end = 0.1375165625, /* of the plate [m] */
    duration = 0.3, dt = 5e-5;                                /* [s] */

/* the section but for its particles; keys of the contact, of a pair, and how fast the plate moves */
#define BED                                                                                                           \
  "{'gravity':[0,0,-9.81],'guard':{'overlap':0.5},"                                                                   \
  "'materials':[{'name':'gel','density':11.5,'young_modulus':23300,'poisson_ratio':0.5},"                             \
  "{'name':'wall','density':11.5,'young_modulus':5e7,'poisson_ratio':0.5}],"                                          \
  "'pairs':[{'materials':['gel','gel'],'restitution':0.95,'friction':0.03%s},"                                        \
  "{'materials':['gel','wall'],'restitution':0.95,'friction':0.03%s}],'contact':{'tangential':'mindlin'%s},"          \
  "'bodies':[{'name':'plate','material':'wall','position':[0,0,%.17g],'shapes':[{'type':'plane','normal':[0,0,-1]}]," \
  "'motion':{'velocity':[0,0,%.17g]}},{'name':'box','material':'wall','shapes':["                                     \
  "{'type':'plane','normal':[0,0,1]},{'type':'plane','normal':[1,0,0]},{'type':'plane','normal':[0,1,0]},"            \
  "{'type':'plane','normal':[-1,0,0],'point':[0.165190844117647,0,0]},"                                               \
  "{'type':'plane','normal':[0,-1,0],'point':[0,0.165833589215686,0]}]}],'particles':%s}"

/* "particles" of hydrogel.json as text, which the caller frees; NULL and an error */
static char *balls(cpl_verify *v, tdm_error *err) {
  char file[4096];
  tdm_scene scene = {0};
  if (cpl_verify_find_file(v, "multicontact/hydrogel.json", file, sizeof file, err) ||
      tdm_scene_load(&scene, file, NULL, err))
    return NULL;
  char *text = json_dumps(tdm_scene_value(scene.root, "dem.particles"), JSON_REAL_PRECISION(17));
  tdm_scene_destroy(&scene);
  if (!text)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a scene");
  return text;
}

/* the largest force on the plate [N] */
static double press(cpl_verify *v, const char *particles, int law, double factor, FILE *f, tdm_error *err) {
  char pair[64];
  snprintf(pair, sizeof pair, "%s", scn_multi_pair(law, factor));
  const long steps = lround(duration / dt);
  double most = 0;
  scn_rig rig;
  if (scn_rig_open(&rig, v, dt, err, BED, pair, pair, scn_multi_contact(law), start, (end - start) / duration,
                   particles) == TDM_OK)
    for (long k = 1; k <= steps && scn_rig_steps(&rig, 1, err) == TDM_OK; k++) {
      const double force = rig.data->state.body_load[0].force.z;
      most = fmax(most, force);
      if (k % (steps / SAMPLES) == 0)
        fprintf(f, "%.9g,%.9g,%d\n", 1 - rig.data->state.pose[0].position.z / start, force, law);
    }
  fputs("\n\n", f);
  scn_rig_close(&rig);
  return most;
}

static void plot(cpl_verify *v) {
  static const tdm_curve curves[] = {{"liggghts.csv", "1:($3==0?$2:1/0)", "classical", "lines lw 2"},
                                     {"liggghts.csv", "1:($3==1?$2:1/0)", "mc-strain 1.125", "lines lw 2"}};
  const tdm_plot plot = {.title = "LIGGGHTS' hydrogel example",
                         .xlabel = "strain",
                         .ylabel = "force on the plate [N]",
                         .ncurve = 2,
                         .curve = curves};
  cpl_verify_plot(v, "liggghts", 1, &plot);
}

tdm_status scn_multi_liggghts(cpl_verify *v, tdm_error *err) {
  static const struct {
    const char *name;
    int law;
    double factor, force, allowed; /* LIGGGHTS 3.8's [N] */
  } runs[] = {{"classical", SCN_CLASSICAL, 0, 6.69, 0.02}, {"mc-strain 1.125", SCN_STRAIN, 1.125, 15.49, 0.05}};
  char *particles = balls(v, err);
  FILE *f = particles ? scn_curve(v, "liggghts.csv", err) : NULL;
  if (f)
    fputs("strain,force [N],run\n", f);
  for (int k = 0; k < 2 && f && err->status == TDM_OK; k++) {
    const double force = press(v, particles, runs[k].law, runs[k].factor, f, err);
    cpl_verify_measure(v, "peak_force [N]", runs[k].name, force, CPL_NO_LIMIT, 0);
    cpl_verify_measure(v, "off_liggghts", runs[k].name, fabs(force / runs[k].force - 1), CPL_AT_MOST, runs[k].allowed);
  }
  if (f)
    fclose(f);
  free(particles);
  if (err->status == TDM_OK)
    plot(v);
  return err->status;
}

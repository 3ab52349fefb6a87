/* Box of particles on a spring and damper, [L18] Section 3.3: position and velocity of the box against the oscillator
 * that carries box and fill as one mass. */
#include "coupler/table.h"
#include "scenarios/spring_damper/reference.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* as in scene.json */
static const scn_spring_damper_parameters parameters = {
    .mass = 100 + 261.8, .damping = 500, .stiffness = 5000, .preload = 100, .gravity = 9.81};
static const double least_nse = 0.999;

typedef struct {
  int n;
  double *x, *v;             /* (n) simulation, downward from the start */
  double *exact_x, *exact_v; /* (n) */
} histories;

static void histories_free(histories *h) {
  free(h->x);
  free(h->v);
  free(h->exact_x);
  free(h->exact_v);
}

static tdm_status compare(const cpl_table *body, histories *h, tdm_error *err) {
  const double *time = cpl_table_column(body, "time", err), *z = cpl_table_column(body, "z", err),
               *vz = cpl_table_column(body, "vz", err);
  if (err->status != TDM_OK)
    return err->status;
  size_t size = (size_t)body->nrow * sizeof(double);
  h->n = body->nrow;
  h->x = malloc(size);
  h->v = malloc(size);
  h->exact_x = malloc(size);
  h->exact_v = malloc(size);
  if (!h->x || !h->v || !h->exact_x || !h->exact_v)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < h->n; i++) {
    h->x[i] = z[0] - z[i];
    h->v[i] = -vz[i];
    scn_spring_damper_exact(&parameters, time[i], &h->exact_x[i], &h->exact_v[i]);
  }
  return TDM_OK;
}

static tdm_status write_comparison(const char *dir, const cpl_table *body, const histories *h, tdm_error *err) {
  char file[4096];
  snprintf(file, sizeof file, "%s/comparison.csv", dir);
  FILE *f = fopen(file, "w");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written", file);
  fputs("time [s],x [m],x theory [m],v [m/s],v theory [m/s]\n", f);
  const double *time = cpl_table_column(body, "time", err);
  for (int i = 0; i < h->n; i++)
    fprintf(f, "%.12g,%.9g,%.9g,%.9g,%.9g\n", time[i], h->x[i], h->exact_x[i], h->v[i], h->exact_v[i]);
  fclose(f);
  return TDM_OK;
}

static void plot(cpl_verify *v) {
  static const cpl_curve position[] = {{"comparison.csv", "1:2", "co-simulation", "lines lw 3"},
                                       {"comparison.csv", "1:3", "theory", "lines dt 2 lw 1.5 lc rgb 'black'"}};
  static const cpl_curve velocity[] = {{"comparison.csv", "1:4", "co-simulation", "lines lw 3"},
                                       {"comparison.csv", "1:5", "theory", "lines dt 2 lw 1.5 lc rgb 'black'"}};
  static const cpl_curve load[] = {{"body_box.csv", "1:17", "load of the particles", "lines"}};
  static const cpl_plot plots[] = {
      {"Position of the box, downward from the start", "time [s]", "x [m]", "set key bottom right\n", 2, position},
      {"Velocity of the box", "time [s]", "v [m/s]", "set key top right\n", 2, velocity},
      {"Vertical load on the box, means over the output interval", "time [s]", "F_z [N]", NULL, 1, load},
  };
  cpl_verify_plot(v, "spring_damper", 3, plots);
}

tdm_status scn_spring_damper(cpl_verify *v, tdm_error *err) {
  char dir[4096], file[4200];
  cpl_table body = {0};
  histories h = {0};
  if (cpl_verify_run(v, "", NULL, dir, sizeof dir, err) != TDM_OK)
    return err->status;
  snprintf(file, sizeof file, "%s/body_box.csv", dir);
  if (cpl_table_read(&body, file, err) == TDM_OK && compare(&body, &h, err) == TDM_OK &&
      write_comparison(dir, &body, &h, err) == TDM_OK) {
    cpl_verify_measure(v, "nse_x", "", cpl_nse(h.x, h.exact_x, h.n), CPL_AT_LEAST, least_nse);
    cpl_verify_measure(v, "r2_x", "", cpl_r2(h.x, h.exact_x, h.n), CPL_NO_LIMIT, 0);
    cpl_verify_measure(v, "nse_v", "", cpl_nse(h.v, h.exact_v, h.n), CPL_AT_LEAST, least_nse);
    cpl_verify_measure(v, "r2_v", "", cpl_r2(h.v, h.exact_v, h.n), CPL_NO_LIMIT, 0);
    plot(v);
  }
  histories_free(&h);
  cpl_table_free(&body);
  return err->status;
}

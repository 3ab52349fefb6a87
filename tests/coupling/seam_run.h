/* Runs through the library, solvers as threads: what the tests of its seams share. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_SEAM_RUN_H
#define TEST_SEAM_RUN_H

#include "coupler/run/run.h"
#include "dem/adapter/solver.h"
#include "mbd/adapter/solver.h"
#include "protocol/math/gsl_errors.h"
#include "tests/command.h"

/* A box on a spring, around a sphere that both of its faces press on; ' stands for ". */
static const char seam_scene[] =
    "{'time': {'end': 0.1, 'dt': 1e-5},\n"
    " 'coupling': {'n': 100, 'transport': 'inproc', 'scheme': 'hold', 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
    " 'output': {'interval': 1e-3},\n"
    " 'mbd': {'gravity': [0, 0, 0],\n"
    "  'bodies': [{'name': 'box', 'mass': 2, 'inertia': [1, 1, 1], 'position': [0, 0, 0], 'velocity': [0.1, 0, 0]}],\n"
    "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'box'], 'point': [0, 0, 0],\n"
    "   'axis': [1, 0, 0]}],\n"
    "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'box'],\n"
    "   'points': [[-1, 0, 0], [0, 0, 0]], 'stiffness': 3000, 'damping': 10}]},\n"
    " 'dem': {'gravity': [0, 0, 0], 'contact': {'normal': 'hooke', 'tangential': 'none'},\n"
    "  'materials': [{'name': 'm', 'density': 1000}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'stiffness': 2500, 'restitution': 1}],\n"
    "  'bodies': [{'name': 'box', 'material': 'm',\n"
    "   'shapes': [{'type': 'box', 'size': [0.092, 0.4, 0.4], 'side': 'inside'}]}],\n"
    "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.05, 'positions': [[0, 0, 0]]}]}}\n";

/* Run dir/scene.json into dir/out with overrides (NULL-terminated), schemes and observers as cpl_run_options has them.
 */
static inline tdm_status seam_run(const char *dir, const char *out, const char *const *set,
                                  const cpl_scheme *const *schemes, const cpl_observer *const *observers,
                                  cpl_run_result *result, tdm_error *err) {
  char scene[256], results[256];
  tdm_gsl_return_errors();
  snprintf(scene, sizeof scene, "%s/scene.json", dir);
  snprintf(results, sizeof results, "%s/%s", dir, out);
  const cpl_run_options options = {
      .scene = scene,
      .set = set,
      .out = results,
      .quiet = true,
      .solver = {[CPL_MBD] = {.ops = &mbd_solver_ops}, [CPL_DEM] = {.ops = &dem_solver_ops}},
      .schemes = schemes,
      .observers = observers};
  return cpl_run(&options, result, err);
}

/* The file dir/out/summary.json (new reference). */
static inline json_t *seam_summary(const char *dir, const char *out) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s/summary.json", dir, out);
  json_t *summary = json_load_file(path, 0, NULL);
  ck_assert_ptr_nonnull(summary);
  return summary;
}

#endif

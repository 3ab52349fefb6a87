/* Assembly: see assemble.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/assembly/assemble.h"

#include "mbd/assembly/rank.h"
#include "mbd/consistent/rubbing.h"
#include "mbd/consistent/stick.h"
#include "mbd/joint/frame.h"
#include "mbd/linear/largest.h"
#include "mbd/mechanics/energy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

mbd_origin mbd_origin_of(const mbd_model *model, int row) {
  mbd_origin o;
  if (row >= model->nrow - model->nfriction) {
    int force = model->friction[row - (model->nrow - model->nfriction)];
    snprintf(o.path, sizeof o.path, "mbd.forces[%d]", force);
    o.kind = "friction", o.name = model->force[force].name, o.equation = "sticking";
    return o;
  }
  if (row >= model->njointrow) {
    const mbd_driver *d = &model->driver[row - model->njointrow]; /* one row each */
    snprintf(o.path, sizeof o.path, "mbd.drivers[%d]", (int)(d - model->driver));
    o.kind = "driver", o.name = d->name, o.equation = mbd_coordinate_table[d->ops->coordinate].name;
    return o;
  }
  const mbd_joint *j = model->joint;
  while (row >= j->row + j->ops->nrow)
    j++;
  snprintf(o.path, sizeof o.path, "mbd.joints[%d]", (int)(j - model->joint));
  o.kind = "joint", o.name = j->name, o.equation = j->ops->equation[row - j->row];
  return o;
}

/* The row to blame next for the violations g: of those that others imply (`dependent`), which contradict these, the
 * first that is open; then the one with the largest |g|. Those of the origins `named` (n) are done. -1: none is left.
 */
static int next_open(const mbd_model *model, const double *g, const bool *dependent, const char *const *named, int n) {
  double most = mbd_largest(g, model->nrow);
  int worst = -1;
  for (int i = 0; i < model->nrow; i++) {
    bool done = false;
    for (int k = 0; k < n; k++)
      done = done || mbd_origin_of(model, i).name == named[k];
    if (done)
      continue;
    if (dependent[i] && fabs(g[i]) > 1e-3 * most)
      return i;
    if (fabs(g[i]) > 0.1 * most && (worst < 0 || fabs(g[i]) > fabs(g[worst])))
      worst = i;
  }
  return worst;
}

/* The joints and drivers to blame for the violations g, at most three: "a", "b" ... Returns the first one's row. */
static int name_open(const mbd_model *model, const double *g, const bool *dependent, char *out, size_t size) {
  enum { NAMES_MAX = 3 };
  const char *named[NAMES_MAX];
  int first = 0, row;
  size_t used = 0;
  out[0] = 0;
  for (int n = 0; used < size && (row = next_open(model, g, dependent, named, n)) >= 0; n++) {
    if (n == NAMES_MAX) {
      snprintf(out + used, size - used, " ...");
      break;
    }
    mbd_origin o = mbd_origin_of(model, row);
    first = n == 0 ? row : first;
    named[n] = o.name;
    used += (size_t)snprintf(out + used, size - used, "%s%s \"%s\" (\"%s\", %.3g)", n > 0 ? ", " : "", o.kind, o.name,
                             o.equation, fabs(g[row]));
  }
  return first;
}

/* How far body b is in y from its start in the scene [m, rad]. */
static void moved_by(const mbd_model *model, const double *y, int b, double *moved, double *turned) {
  tdm_pose now = mbd_body_state(y, b).pose, start = model->body[b].start.pose;
  *moved = tdm_norm(tdm_sub(now.position, start.position));
  *turned = tdm_norm(tdm_quat_turn(start.orientation, now.orientation));
}

/* Refuse a start that lies farther from an assembled position than the mechanism is large, or a radian: which of
 * several positions was meant is a guess then. Laws of drivers that do not start at zero ask for such moves. */
static tdm_status refuse_far(const mbd_model *model, const mbd_data *data, tdm_error *err) {
  double size = mbd_model_extent(model), most = 1, moved, turned;
  int far = -1;
  bool asked;
  mbd_prescribed_way(model, data->t, &asked);
  for (int b = 0; b < model->nbody && !asked; b++) {
    moved_by(model, data->y, b, &moved, &turned);
    double share = fmax(turned, moved / fmax(size, 1e-9));
    if (share > most)
      most = share, far = b;
  }
  if (far < 0)
    return TDM_OK;
  char path[TDM_PATH_MAX];
  snprintf(path, sizeof path, "mbd.bodies[%d].position", far);
  moved_by(model, data->y, far, &moved, &turned);
  return tdm_fail(
      err, TDM_ERR_SCENE, path,
      "the start is too far from a position that the joints allow: body \"%s\" would have to move by %.3g m "
      "and turn by %.3g rad, where at most the mechanism's size (%.3g m) and 1 rad are corrected; give "
      "positions and orientations nearer to it, or check the points and axes of its joints",
      model->body[far].name, moved, turned, size);
}

static tdm_status positions(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, tdm_error *err) {
  int number, near;
  bool *dependent = calloc((size_t)model->nrow + 1, sizeof *dependent);
  mbd_kinematics(model, data, data->t, data->y);
  if (!dependent || !mbd_rank(model, data, dependent, &number, &near))
    tdm_fail(err, TDM_ERR_MEMORY, "mbd.joints", "no memory for %d constraint rows", model->nrow);
  else if (mbd_project_positions(model, data, kkt, data->t, data->y) < 1e-9)
    refuse_far(model, data, err);
  else {
    char open[400];
    int first = name_open(model, mbd_kkt_b(kkt), dependent, open, sizeof open);
    tdm_fail(err, TDM_ERR_SCENE, mbd_origin_of(model, first).path,
             "the mechanism cannot be assembled: its joints and drivers contradict each other, these stay open: %s; "
             "check their points and axes, the drivers' motions and the bodies' positions",
             open);
  }
  free(dependent);
  return err->status;
}

/* ---- dependent rows ---- */

/* A small motion that the independent rows allow, at the position y; false: none. */
static bool wiggle(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double *y) {
  unsigned seed = 1;
  double extent = 0, translation = 0, rotation = 0;
  for (int b = 0; b < model->nbody; b++)
    for (int k = 0; k < 6; k++) {
      seed = seed * 1664525u + 1013904223u; /* not of random.h: last bits of reactions follow from these numbers */
      y[MBD_BODY_UNKNOWNS * b + MBD_V + k] = (double)(seed >> 8) / (1 << 24) - 0.5;
    }
  mbd_kinematics(model, data, data->t, y);
  if (!mbd_kkt_fill(kkt, model, data, MBD_VELOCITY))
    return false;
  for (int i = 0; i < model->npart; i++) /* drivers stand still */
    if (model->part[i].driver)
      mbd_kkt_b(kkt)[model->part[i].row] += mbd_part_at(model, data, i, false)->g_t[0];
  const double *x = mbd_kkt_solve(kkt, NULL);
  if (!x)
    return false;
  for (int b = 0; b < model->nbody; b++) {
    double *v = y + MBD_BODY_UNKNOWNS * b + MBD_V;
    for (int k = 0; k < 6; k++)
      v[k] += x[6 * b + k];
    translation = fmax(translation, tdm_norm(mbd_get3(v)));
    rotation = fmax(rotation, tdm_norm(mbd_get3(v + 3)));
  }
  for (int i = 0; i < model->njoint; i++)
    extent = fmax(extent, fmax(tdm_norm(model->joint[i].arm[0]), tdm_norm(model->joint[i].arm[1])));
  double step = 0.01 / fmax(rotation, extent > 0 ? translation / extent : 0);
  if (!isfinite(step))
    return false;
  for (int b = 0; b < model->nbody; b++) {
    double twist[6];
    memcpy(twist, y + MBD_BODY_UNKNOWNS * b + MBD_V, sizeof twist);
    mbd_move_body(y, b, twist, step);
  }
  return true;
}

/* The first row that is dependent at the start but not beside it: the start is a singular position. -1: none; -2: out
 * of memory. */
static int singular_row(const mbd_model *model, mbd_data *data, mbd_kkt *kkt) {
  size_t n = (size_t)mbd_nunknown(model);
  double *y = malloc(n * sizeof *y);
  bool *beside = calloc((size_t)model->nrow + 1, sizeof *beside);
  int number = data->ndependent, row = y && beside ? -1 : -2, near;
  if (row == -1) {
    memcpy(y, data->y, n * sizeof *y);
    if (wiggle(model, data, kkt, y) && mbd_project_positions(model, data, kkt, data->t, y) < 1e-9) {
      mbd_kinematics(model, data, data->t, y);
      if (!mbd_rank(model, data, beside, &number, &near))
        number = data->ndependent;
    }
    for (int i = 0; i < model->nrow && number < data->ndependent && row < 0; i++)
      if (data->dependent[i] && !beside[i])
        row = i;
  }
  free(y);
  free(beside);
  return row;
}

/* An earlier driver without which the driver of row `row` would not be redundant; NULL: there is none. */
static const mbd_driver *opponent(const mbd_model *model, mbd_data *data, int row) {
  bool *dependent = calloc((size_t)model->nrow + 1, sizeof *dependent);
  const mbd_driver *found = NULL;
  for (int i = model->njointrow, n, near; i < row && dependent && !found; i++)
    if (mbd_rank_without(model, data, i, dependent, &n, &near) && !dependent[row])
      found = &model->driver[i - model->njointrow];
  free(dependent);
  return found;
}

/* Find the dependent rows, and the most nearly dependent one. Refuses a dependent driver, and a start that is a
 * singular position. */
static tdm_status find_dependent(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, int *near, tdm_error *err) {
  mbd_kinematics(model, data, data->t, data->y);
  if (!mbd_rank(model, data, data->dependent, &data->ndependent, near))
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd.joints", "no memory for %d constraint rows", model->nrow);
  int singular = data->ndependent > 0 ? singular_row(model, data, kkt) : -1;
  if (singular == -2)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd.joints", "no memory for %d constraint rows", model->nrow);
  if (singular >= 0) {
    mbd_origin o = mbd_origin_of(model, singular);
    return tdm_fail(err, TDM_ERR_SCENE, o.path,
                    "the start is a singular position: there the equation \"%s\" of %s \"%s\" fixes nothing that the "
                    "joints before it leave free, elsewhere it does, so the motion is not determined; start elsewhere",
                    o.equation, o.kind, o.name);
  }
  for (int i = model->njointrow; i < model->njointrow + model->ndriver; i++)
    if (data->dependent[i]) {
      mbd_origin o = mbd_origin_of(model, i);
      const mbd_driver *other = opponent(model, data, i);
      return tdm_fail(err, TDM_ERR_SCENE, o.path,
                      "the driver \"%s\" is redundant: the joints %s%s%s fix its coordinate (%s) already; remove the "
                      "driver, or what fixes it",
                      o.name, other ? "and the driver \"" : "before it", other ? other->name : "", other ? "\"" : "",
                      o.equation);
    }
  return TDM_OK;
}

/* ---- start ---- */

/* Note the largest differences between the scene's start and y. */
static void compare(const mbd_model *model, const double *y, mbd_assembly *a) {
  for (int b = 0; b < model->nbody; b++) {
    tdm_state now = mbd_body_state(y, b), start = model->body[b].start;
    double moved, turned;
    moved_by(model, y, b, &moved, &turned);
    double dv = tdm_norm(tdm_sub(now.twist.velocity, start.twist.velocity));
    double dw = tdm_norm(tdm_sub(now.twist.angular, start.twist.angular));
    if (fmax(moved, turned) > fmax(a->translation, a->rotation))
      a->body = b;
    if (fmax(dv, dw) > fmax(a->velocity, a->angular))
      a->body_velocity = b;
    a->translation = fmax(a->translation, moved);
    a->rotation = fmax(a->rotation, turned);
    a->velocity = fmax(a->velocity, dv);
    a->angular = fmax(a->angular, dw);
  }
}

/* Note the driver whose coordinate has a rate in the velocities y that is not the prescribed one. A coordinate at rest
 * contradicts nothing: that is what a scene without velocities gives. */
static void compare_drivers(const mbd_model *model, mbd_data *data, const double *y, mbd_assembly *a) {
  mbd_kinematics(model, data, data->t, y);
  for (int i = 0; i < model->ndriver; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, model->njointpart + i, false);
    double twist[MBD_PAIR], given = 0, prescribed = -rows->g_t[0];
    mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
    for (int k = 0; k < MBD_PAIR; k++)
      given += rows->G[0][k] * twist[k];
    double apart = fabs(given - prescribed);
    if (fabs(given) > 1e-6 && apart > 1e-6 && apart > fabs(a->given - a->prescribed)) {
      a->driver = i;
      a->given = given;
      a->prescribed = prescribed;
    }
  }
}

/* Dependent rows whose rates contradict the independent ones, which hold in y. */
static bool rates_contradict(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, const double *y) {
  mbd_kinematics(model, data, data->t, y);
  if (!mbd_kkt_fill_all(kkt, model, data, MBD_VELOCITY))
    return true;
  return mbd_largest(mbd_kkt_b(kkt), model->nrow) > 1e-8 * (1 + mbd_largest(y, mbd_nunknown(model)));
}

static tdm_status velocities(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_assembly *assembly,
                             tdm_error *err) {
  bool good = mbd_project_velocities(model, data, kkt, data->t, data->y, false);
  compare(model, data->y, assembly);
  if (model->ndriver > 0) {
    compare_drivers(model, data, data->y, assembly);
    good = good && mbd_project_velocities(model, data, kkt, data->t, data->y, true);
  }
  if (!good)
    return tdm_fail(err, TDM_ERR_SCENE, "mbd.joints",
                    "no velocities satisfy the joints at the start: it is a singular position; start elsewhere");
  if (data->ndependent > 0 && rates_contradict(model, data, kkt, data->y)) {
    char open[400];
    name_open(model, mbd_kkt_b(kkt), data->dependent, open, sizeof open);
    return tdm_fail(err, TDM_ERR_SCENE, "mbd.joints",
                    "joints and drivers contradict each other in their velocities at the start: %s; remove one of them",
                    open);
  }
  return TDM_OK;
}

/* Slim bodies (slim.h) that joints hold about their axis each, but all of them together leave free, have no equation
 * for that turn: the system of all rows has a pivot of zero. */
static tdm_status refuse_slim(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, tdm_error *err) {
  int slim = -1;
  for (int b = 0; b < model->nbody; b++)
    slim = model->body[b].slim && !model->body[b].spins ? b : slim;
  if (slim < 0)
    return TDM_OK;
  mbd_kinematics(model, data, data->t, data->y);
  if (mbd_kkt_fill_all(kkt, model, data, MBD_POSITION) && mbd_kkt_spread(kkt) > 1e-15)
    return TDM_OK;
  char path[TDM_PATH_MAX];
  snprintf(path, sizeof path, "mbd.bodies[%d].inertia", slim);
  return tdm_fail(err, TDM_ERR_SCENE, path,
                  "body \"%s\" has no inertia about its own axis, and the joints that hold it there leave it free "
                  "together with others that have none either; give one of them an inertia about it",
                  model->body[slim].name);
}

tdm_status mbd_assemble(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_assembly *assembly, tdm_error *err) {
  *assembly = (mbd_assembly){.body = -1, .body_velocity = -1, .driver = -1, .near_row = -1};
  if (refuse_slim(model, data, kkt, err) || positions(model, data, kkt, err) ||
      find_dependent(model, data, kkt, &assembly->near_row, err) || velocities(model, data, kkt, assembly, err))
    return err->status;
  assembly->freedom = 6 * model->nbody - (model->nrow - model->nfriction) + data->ndependent;
  if (mbd_rubbing_check(model, data, kkt, err))
    return err->status;
  mbd_accept(model, data, data->t, data->y);
  mbd_energies e = mbd_energies_at(model, data);
  data->energy_start = e.kinetic + e.potential + e.springs;
  if (!mbd_stick_settle(model, data, kkt, data->t, data->y, NULL))
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no consistent accelerations at the start; check joints, masses and coefficients of friction");
  return TDM_OK;
}

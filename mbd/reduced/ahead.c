/* The path ahead: see ahead.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/reduced/ahead.h"

#include "mbd/consistent/kkt.h"
#include "protocol/base/memory.h"
#include "protocol/math/hermite.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double parabola_is_enough = 1e-3, cubics_are_enough = 1e-5; /* shares of a law's range in the window */
static const double still = 1e-3,
                    force_is_followed = 1e-3;           /* of a force: its change by its size; as cubics_are_enough */
static const double little_turn = 0.1, node_turn = 0.3; /* [rad] */
enum { LEAST_NODES = 4, FREE_STEPS = 4 };               /* steps from node to node where the load has a say */

/* Places in an interval at which laws are looked at: irrational, so that no oscillation hides between them. */
static const double looks[] = {0.3183098861837907, 0.6180339887498949};
enum { NLOOK = sizeof looks / sizeof looks[0] };

struct mbd_ahead {
  const mbd_model *model; /* borrowed */
  mbd_data *data;
  mbd_kkt *kkt;
  void *integration; /* one_step's */
  bool free;         /* joints and drivers leave some freedom */
  int substeps;      /* from node to node */
  bool *prescribed;  /* (ncoupled) */
  bool *carries;     /* (nbody) it is coupled, or hangs on a coupled one by joints or forces */
  double *time;      /* (TDM_NODES_MAX x substeps) */
  double *node_time; /* (TDM_NODES_MAX) */
  tdm_state *state;  /* (TDM_NODES_MAX x ncoupled) */
};

/* ---- life ---- */

void mbd_ahead_destroy(mbd_ahead **ahead) {
  mbd_ahead *a = ahead ? *ahead : NULL;
  if (!a)
    return;
  mbd_one_step.destroy(a->integration);
  mbd_kkt_destroy(&a->kkt);
  mbd_data_destroy(&a->data);
  free(a->prescribed);
  free(a->carries);
  free(a->time);
  free(a->node_time);
  free(a->state);
  free(a);
  *ahead = NULL;
}

/* A unit load on a coupled body accelerates it by 1/mass or 1/inertia where nothing holds it, and not at all where
 * joints and drivers do. */
static bool find_prescribed(mbd_ahead *a) {
  const mbd_model *m = a->model;
  double *load = calloc(6 * (size_t)m->nbody + 1, sizeof *load);
  if (!load)
    tdm_memory_note();
  bool good = load && mbd_accelerations(m, a->data, a->kkt, a->data->t, a->data->y);
  for (int c = 0; c < m->ncoupled && good; c++) {
    const int body = m->coupled[c];
    const tdm_mat3 *inverse = &m->body[body].inverse_inertia;
    const double free_turn = fabs(inverse->m[0][0]) + fabs(inverse->m[1][1]) + fabs(inverse->m[2][2]);
    a->prescribed[c] = true;
    for (int i = 0; i < 6 && good; i++) {
      memset(mbd_kkt_b(a->kkt), 0, (size_t)m->nrow * sizeof(double));
      load[6 * body + i] = 1;
      const double *x = mbd_kkt_solve(a->kkt, load);
      load[6 * body + i] = 0;
      good = x;
      if (good && fabs(x[6 * body + i]) > 1e-9 * (i < 3 ? 1 / m->body[body].mass : free_turn))
        a->prescribed[c] = false;
    }
  }
  free(load);
  return good;
}

/* If one of the two carries, so does the other; the ground and bodies that do not move with it carry nothing. Returns
 * whether that is new. */
static bool carry(mbd_ahead *a, const int body[2]) {
  if (body[0] < 0 || body[1] < 0 || a->carries[body[0]] == a->carries[body[1]])
    return false;
  return a->carries[body[0]] = a->carries[body[1]] = true;
}

/* Which bodies may bend the path of a coupled one by their turning: not those that a gear alone ties to it, such as a
 * motor's rotor, whose angle goes as the law does. */
static void find_carriers(mbd_ahead *a) {
  const mbd_model *m = a->model;
  for (int c = 0; c < m->ncoupled; c++)
    a->carries[m->coupled[c]] = true;
  for (bool more = true; more;) {
    more = false;
    for (int i = 0; i < m->njoint; i++)
      more = (!m->joint[i].ops->couples && carry(a, m->joint[i].body)) || more;
    for (int i = 0; i < m->nforce; i++)
      more = carry(a, m->force[i].body) || more;
  }
}

tdm_status mbd_ahead_create(mbd_ahead **out, const mbd_model *model, const mbd_data *data, int freedom,
                            mbd_stop_fn stop, void *context, tdm_error *err) {
  mbd_ahead *a = *out = calloc(1, sizeof *a);
  if (!a)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the path ahead");
  a->model = model;
  a->free = freedom > 0;
  a->substeps = a->free ? FREE_STEPS : 1;
  a->data = mbd_data_create(model);
  a->kkt = mbd_kkt_create(model);
  a->prescribed = calloc((size_t)model->ncoupled + 1, sizeof *a->prescribed);
  a->carries = calloc((size_t)model->nbody + 1, sizeof *a->carries);
  a->time = calloc((size_t)TDM_NODES_MAX * (size_t)a->substeps, sizeof *a->time);
  a->node_time = calloc(TDM_NODES_MAX, sizeof *a->node_time);
  a->state = calloc((size_t)TDM_NODES_MAX * (size_t)model->ncoupled + 1, sizeof *a->state);
  if (!a->data || !a->kkt || !a->prescribed || !a->carries || !a->time || !a->node_time || !a->state)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the path ahead");
  find_carriers(a);
  mbd_data_copy(model, a->data, data);
  if (!find_prescribed(a))
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd", "no accelerations at the start; check joints and masses");
  return mbd_one_step.create(&a->integration, model, a->data, a->kkt, stop, context, err);
}

const bool *mbd_ahead_prescribed(const mbd_ahead *ahead) {
  return ahead->prescribed;
}

/* ---- how many nodes ---- */

/* Of a law from t1 to t2 in n intervals: the range of its values, and how far it is from the parabola of its start and
 * from Hermite's cubics. */
typedef struct {
  double range, size, parabola, cubics; /* size: largest value */
} bend;

static bend bend_of(const tdm_motion *law, double t1, double t2, int n) {
  const tdm_motion_value first = tdm_motion_at(law, t1);
  const double h = (t2 - t1) / n;
  double least = first.value, most = first.value;
  bend b = {0};
  tdm_motion_value from = first;
  for (int k = 0; k < n; k++) {
    const tdm_motion_value to = tdm_motion_at(law, t1 + (k + 1) * h);
    for (int i = 0; i <= NLOOK; i++) {
      const double s = i < NLOOK ? looks[i] : 1, tau = (k + s) * h;
      const double x = i < NLOOK ? tdm_motion_at(law, t1 + tau).value : to.value;
      const double cubic = tdm_hermite(s, h, from.value, from.rate, to.value, to.rate);
      b.parabola = fmax(b.parabola, fabs(x - first.value - tau * (first.rate + 0.5 * tau * first.acceleration)));
      b.cubics = fmax(b.cubics, fabs(x - cubic));
      least = fmin(least, x);
      most = fmax(most, x);
    }
    from = to;
  }
  b.range = most - least;
  b.size = fmax(fabs(least), fabs(most));
  /* what rounding of the value leaves is no bend */
  const double rounding = 1e-14 * fmax(b.size, fmax(tdm_motion_magnitude(law, t1), tdm_motion_magnitude(law, t2)));
  b.parabola = fmax(0, b.parabola - rounding);
  b.cubics = fmax(0, b.cubics - rounding);
  return b;
}

static double fastest_turn(const mbd_ahead *a, const double *y) {
  double most = 0;
  for (int b = 0; b < a->model->nbody; b++)
    if (a->carries[b])
      most = fmax(most, tdm_norm(mbd_get3(y + MBD_BODY_UNKNOWNS * b + MBD_W)));
  return most;
}

/* Nodes, `least` or more, that follow the law from t1 to t2 within the share `enough` of its range; b: with `least`. */
static int follow(const tdm_motion *law, double t1, double t2, int least, bend b, double enough) {
  int n = least;
  while (n <= TDM_NODES_MAX && b.cubics > enough * b.range) {
    n *= 2;
    b = bend_of(law, t1, t2, n);
  }
  return n;
}

/* The number of nodes from t1 to t2; 0: the parabola is enough; more than TDM_NODES_MAX: that many are too few. */
static int nodes_for(const mbd_ahead *a, const double *y, double t1, double t2) {
  const mbd_model *m = a->model;
  const double turn = fastest_turn(a, y) * (t2 - t1);
  bool bends = m->ndriver > 0 && turn > little_turn;
  int n = LEAST_NODES;
  while (n <= TDM_NODES_MAX && turn > node_turn * n)
    n *= 2;
  for (int i = 0; i < m->ndriver; i++) {
    const tdm_motion *law = &m->driver[i].motion;
    bend b = bend_of(law, t1, t2, n);
    if (b.parabola <= parabola_is_enough * b.range)
      continue;
    bends = true;
    n = follow(law, t1, t2, n, b, cubics_are_enough);
  }
  for (int i = 0; a->free && i < m->nforce; i++) {
    const mbd_force *f = &m->force[i];
    const tdm_motion *law = f->ops->law && a->carries[f->body[1]] ? f->ops->law(f) : NULL;
    if (!law)
      continue;
    const bend b = bend_of(law, t1, t2, n);
    if (b.range <= still * b.size)
      continue;
    bends = true;
    n = follow(law, t1, t2, n, b, force_is_followed);
  }
  return bends ? n : 0;
}

/* ---- the path ---- */

static tdm_status keep_node(void *context, int i, double t, const double *y, tdm_error *err) {
  mbd_ahead *a = context;
  (void)err;
  if ((i + 1) % a->substeps != 0)
    return TDM_OK;
  const int node = (i + 1) / a->substeps - 1;
  a->node_time[node] = t;
  for (int c = 0; c < a->model->ncoupled; c++)
    a->state[node * a->model->ncoupled + c] = mbd_body_state(y, a->model->coupled[c]);
  return TDM_OK;
}

tdm_status mbd_ahead_path(mbd_ahead *a, const mbd_data *data, double t1, double t2, tdm_nodes *path, tdm_error *err) {
  const mbd_model *m = a->model;
  int nnode = nodes_for(a, data->y, t1, t2);
  *path = (tdm_nodes){.nbody = m->ncoupled};
  while (nnode > TDM_NODES_MAX) { /* what is left of it has nodes, be it a parabola: its end is told by the last */
    t2 = t1 + 0.75 * (t2 - t1);
    nnode = nodes_for(a, data->y, t1, t2);
    nnode = nnode > LEAST_NODES ? nnode : LEAST_NODES;
  }
  const int n = nnode * a->substeps;
  if (n == 0 || m->ncoupled == 0)
    return TDM_OK;
  mbd_data_copy(m, a->data, data);
  for (int c = 0; c < m->ncoupled; c++)
    a->data->load[c] = mbd_load_at(data, c, t1);
  a->data->nload = data->nload > 0;
  a->data->load_t0 = t1;
  a->data->load_t1 = t2;
  for (int i = 0; i < n; i++)
    a->time[i] = i + 1 < n ? t1 + (t2 - t1) * (i + 1) / n : t2;
  tdm_error own = {0};
  if (mbd_one_step.start(a->integration, t1, &own) != TDM_OK ||
      mbd_one_step.advance(a->integration, t2, n, a->time, keep_node, a, &own) != TDM_OK) {
    if (own.status == TDM_ERR_INTERRUPTED)
      return tdm_fail(err, own.status, NULL, "%s", own.message);
    return tdm_fail(err, TDM_ERR_NUMERIC, "coupling.n",
                    "the path of the bodies from %.9g s to %.9g s cannot be told ahead: %.600s; or take a smaller "
                    "coupling.n",
                    t1, t2, own.message);
  }
  *path = (tdm_nodes){nnode, m->ncoupled, a->node_time, a->state};
  return TDM_OK;
}

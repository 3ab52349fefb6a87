/* LIGGGHTS as the DEM side of a co-simulation: see solver.h.
 *
 * Each coupled body is a fix mesh/surface/stress of its name, whose reference point is the centre of mass: LIGGGHTS
 * sums force and moment about it, and carries it along, so that it tells where the mesh is. Movers take velocities from
 * equal-style variables (motion.h), in the order in which these were made: LIGGGHTS puts a variable that is given anew
 * behind all others, and movers know theirs by number. A fix ave/time with a running mean sums the loads from step to
 * step, so the mean over any steps is a difference of two sums. Names of all that begin with "tandem_".
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/foreign/liggghts/solver.h"

#include "dem/foreign/liggghts/host.h"
#include "dem/foreign/liggghts/motion.h"
#include "dem/foreign/liggghts/section.h"
#include "protocol/base/log.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VALUE = 160 };

static int ranks; /* of this process' program */

/* An equal-style variable: one component of a body's velocity, or of its rate of turn. */
typedef struct {
  int body, component; /* 0 to 2: velocity along x, y, z; 3 to 5: rate */
  char value[VALUE];
} mover_value;

/* What is known of a coupled body. */
typedef struct {
  tdm_pose place; /* of its mesh now */
  bool turns;     /* it has movers that turn it */
  bool touches;   /* the script has a wall/gran for it */
  tdm_wrench sum; /* of its loads since the start; and up to the window, and to the last sample */
  tdm_wrench sum_window, sum_sampled;
  tdm_wrench mean; /* of the last sample */
} body_state;

typedef struct {
  lig_section section;
  tdm_interpolation way;
  double dt;    /* of LIGGGHTS now [s] */
  double first; /* LIGGGHTS' number of the step at the start */
  long nstep;   /* since then */
  long sampled; /* up to the last sample */
  bool fresh;   /* LIGGGHTS is to set itself up before the next step */
  body_state *body;
  int nvalue;
  mover_value *value; /* (nvalue) in LIGGGHTS' order; room for 6 nbody */
  lig_motion *motion; /* (nbody) through the window */
  tdm_wrench *load;   /* (nbody) at the start */
  tdm_channel *channel;
  double *initial;
  json_t *report;
  bool other_units, takes_gravity; /* of the script */
  int nwarning;
  tdm_warning *warning;    /* (nwarning) room for nbody + 1 */
  double working, running; /* time in windows, and in their commands "run" [s] */
  unsigned long nwindow;
} solver;

/* ---- LIGGGHTS' numbers ---- */

/* Six numbers of a fix, from `at` on. */
static tdm_wrench fix_wrench(const char *fix, int at) {
  tdm_wrench w = {0};
  double *number = (double *)(void *)&w;
  for (int k = 0; k < TDM_WRENCH_DOUBLES; k++)
    lig_host_fix_value(fix, at + k, &number[k]);
  return w;
}

static tdm_wrench minus(const tdm_wrench *a, const tdm_wrench *b) {
  return (tdm_wrench){tdm_sub(a->force, b->force), tdm_sub(a->moment, b->moment)};
}

static tdm_wrench times(double s, const tdm_wrench *a) {
  return (tdm_wrench){tdm_scale(s, a->force), tdm_scale(s, a->moment)};
}

/* Where the mesh is: LIGGGHTS carries its reference point along. Its turn is known from what was ordered. */
static void look_at_mesh(solver *s, int i) {
  tdm_vec3 *x = &s->body[i].place.position;
  const char *fix = s->section.body[i].name;
  lig_host_fix_value(fix, 6, &x->x);
  lig_host_fix_value(fix, 7, &x->y);
  lig_host_fix_value(fix, 8, &x->z);
}

/* The sums of loads after `nstep` steps, from the running means, whose first value is that at the start. */
static void look_at_loads(solver *s) {
  for (int i = 0; i < s->section.nbody; i++) {
    char fix[32];
    snprintf(fix, sizeof fix, "tandem_%d_load", i);
    const tdm_wrench mean = fix_wrench(fix, 0);
    s->body[i].sum = times((double)s->nstep + 1, &mean);
  }
}

/* ---- start ---- */

/* The variable NAME_mesh: what fix mesh/surface/stress needs for a body, in the order in which LIGGGHTS takes it. */
static void give_mesh(const lig_body *b, const tdm_assigned_body *assigned) {
  static const double pi_of_liggghts = 3.14159265; /* which it takes degrees with */
  const tdm_pose at = assigned->state.pose;
  const tdm_vec3 turn = tdm_quat_to_rotvec(at.orientation), x = tdm_pose_point(at, b->origin), c = at.position;
  const double angle = tdm_norm(turn);
  char rotate[256] = "";
  if (angle > 0)
    snprintf(rotate, sizeof rotate, " rotate axis %.17g %.17g %.17g angle %.17g", turn.x / angle, turn.y / angle,
             turn.z / angle, angle * 180 / pi_of_liggghts);
  lig_host_command("variable %s_mesh index \"file %s type %ld scale %.17g%s move %.17g %.17g %.17g reference_point "
                   "%.17g %.17g %.17g\"",
                   b->name, b->mesh, b->type, b->scale, rotate, x.x, x.y, x.z, c.x, c.y, c.z);
}

/* What the script can use: its own variables in the scene, the meshes, the step, gravity. */
static void give_variables(const solver *s, const tdm_assignment *a) {
  const char *key;
  json_t *value;
  for (int i = 0; i < s->section.nbody; i++)
    if (s->section.body[i].mesh)
      give_mesh(&s->section.body[i], &a->body[i]);
  lig_host_command("variable dt index %.17g", a->dt);
  const tdm_vec3 g = s->section.gravity, down = tdm_norm(g) > 0 ? tdm_unit(g) : tdm_v3(0, 0, -1);
  if (s->section.has_gravity)
    lig_host_command("variable gravity index \"%.17g vector %.17g %.17g %.17g\"", tdm_norm(g), down.x, down.y, down.z);
  json_object_foreach(s->section.variables, key, value) {
    if (json_is_string(value))
      lig_host_command("variable %s index \"%s\"", key, json_string_value(value));
    else
      lig_host_command("variable %s index %.17g", key,
                       json_is_number(value) ? json_number_value(value) : (double)json_is_true(value));
  }
}

static bool has_word(const char *line, const char *word) {
  const size_t n = strlen(word);
  for (const char *at = line; (at = strstr(at, word)) != NULL; at += n)
    if ((at == line || at[-1] == ' ') && strchr(" \t", at[n]))
      return true; /* also at the end of the line: strchr finds its 0 */
  return false;
}

/* A line of the script, as LIGGGHTS reads it, and again with its variables put in. */
static void hear_script(void *self, const char *line) {
  solver *s = self;
  char units[32];
  s->takes_gravity |= strstr(line, "${gravity}") != NULL;
  if (sscanf(line, " units %31s", units) == 1)
    s->other_units = strcmp(units, "si") != 0;
  if (strstr(line, "wall/gran"))
    for (int i = 0; i < s->section.nbody; i++)
      s->body[i].touches |= has_word(line, s->section.body[i].name);
}

/* What LIGGGHTS would not say: other units, a body that no particle feels, a gravity that nobody takes. */
static tdm_status look_through(solver *s, tdm_error *err) {
  if (s->other_units)
    return tdm_fail(err, TDM_ERR_SCENE, "dem.script", "%s takes other units than si, and tandem only those",
                    s->section.script);
  for (int i = 0; i < s->section.nbody; i++)
    if (!s->body[i].touches)
      tdm_warning_set(&s->warning[s->nwarning++], "dem.script",
                      "no fix wall/gran of %s names the mesh \"%s\": particles pass through it", s->section.script,
                      s->section.body[i].name);
  const double size = s->section.has_gravity ? tdm_norm(s->section.gravity) : 0;
  if (size > 0 && !s->takes_gravity)
    tdm_warning_set(&s->warning[s->nwarning++], "dem.script",
                    "%s does not take the scene's gravity of %g m/s2; the line for it: fix gravity all gravity "
                    "${gravity}",
                    s->section.script, size);
  return TDM_OK;
}

/* Each coupled body has its mesh, and it stands where it should. */
static tdm_status check_meshes(solver *s, const tdm_assignment *a, tdm_error *err) {
  for (int i = 0; i < s->section.nbody; i++) {
    const lig_body *b = &s->section.body[i];
    const tdm_vec3 c = a->body[i].state.pose.position;
    double z;
    if (!lig_host_fix_value(b->name, 8, &z))
      return tdm_fail(err, TDM_ERR_SCENE, "dem.script",
                      "%s makes no mesh \"%s\" with loads; it needs the line: fix %s all mesh/surface/stress "
                      "${%s_mesh}",
                      s->section.script, b->name, b->name, b->name);
    look_at_mesh(s, i);
    s->body[i].place.orientation = a->body[i].state.pose.orientation;
    const tdm_vec3 x = s->body[i].place.position;
    if (tdm_norm(tdm_sub(x, c)) > 1e-9 * fmax(1, tdm_norm(c)))
      return tdm_fail(err, TDM_ERR_SCENE, "dem.script",
                      "%s gives the mesh \"%s\" the reference_point %.9g %.9g %.9g, but its centre of mass is at %.9g "
                      "%.9g %.9g, about which moments are taken",
                      s->section.script, b->name, x.x, x.y, x.z, c.x, c.y, c.z);
  }
  return TDM_OK;
}

/* Time histories: thermodynamic output of LIGGGHTS, which keeps what their variables need up to date. */
static tdm_status give_channels(solver *s, tdm_error *err) {
  char words[1800] = "";
  int used = 0;
  for (int k = 0; k < s->section.nchannel; k++) {
    const lig_channel *c = &s->section.channel[k];
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.channels[%d].variable", k);
    used += snprintf(words + used, sizeof words - (size_t)used, " v_%s", c->variable);
    if (used >= (int)sizeof words)
      return tdm_fail(err, TDM_ERR_SCENE, "dem.channels", "too many for a command of LIGGGHTS; take fewer");
    s->channel[k] = c->channel;
  }
  lig_host_at("dem.channels", true);
  lig_host_command("thermo_style custom step%s", words);
  lig_host_at("dem.script", true);
  lig_host_command("thermo_modify lost %s norm no", s->section.may_lose ? "ignore" : "error");
  lig_host_command("thermo 1000000000");
  return TDM_OK;
}

/* Give LIGGGHTS a variable, or its new value. */
static void give_variable(const mover_value *v) {
  static const char *const name[] = {"vx", "vy", "vz", "wx", "wy", "wz"};
  lig_host_command("variable tandem_%d_%s equal %s", v->body, name[v->component], v->value);
}

/* Three more, from component `first` on. */
static void add_variables(solver *s, int body, int first) {
  for (int k = first; k < first + 3; k++) {
    s->value[s->nvalue] = (mover_value){.body = body, .component = k, .value = "0.0"};
    give_variable(&s->value[s->nvalue++]);
  }
}

/* What moves a body; what turns it is made when it turns. */
static void give_mover(solver *s, int i) {
  add_variables(s, i, 0);
  lig_host_command("fix tandem_%d_move all move/mesh mesh %s linear/variable v_tandem_%d_vx v_tandem_%d_vy "
                   "v_tandem_%d_vz",
                   i, s->section.body[i].name, i, i, i);
}

static void give_turning(solver *s, int i) {
  static const char *const axis[] = {"1 0 0", "0 1 0", "0 0 1"}, *const name[] = {"wx", "wy", "wz"};
  const tdm_vec3 c = s->body[i].place.position;
  add_variables(s, i, 3);
  for (int k = 0; k < 3; k++)
    lig_host_command("fix tandem_%d_%s all move/mesh mesh %s rotate/variable origin %.17g %.17g %.17g axis %s omega "
                     "v_tandem_%d_%s",
                     i, name[k], s->section.body[i].name, c.x, c.y, c.z, axis[k], i, name[k]);
  s->body[i].turns = true;
  s->fresh = true;
}

static void give_sum(const solver *s, int i) {
  char words[1024] = "";
  int used = 0;
  for (int k = 1; k <= TDM_WRENCH_DOUBLES; k++)
    used += snprintf(words + used, sizeof words - (size_t)used, " f_%s[%d]", s->section.body[i].name, k);
  lig_host_command("fix tandem_%d_load all ave/time 1 1 1%s ave running start %.0f", i, words, s->first);
}

/* After the script: the loads at the start come from a step in which nothing moves, since LIGGGHTS sums them at the end
 * of steps alone. */
static tdm_status take_over(solver *s, const tdm_assignment *a, tdm_error *err) {
  if (check_meshes(s, a, err) != TDM_OK || give_channels(s, err) != TDM_OK)
    return err->status;
  lig_host_command("variable tandem_step equal step");
  lig_host_command("variable tandem_mass equal mass(all)");
  for (int i = 0; i < s->section.nbody; i++)
    give_mover(s, i);
  lig_host_command("timestep 1e-20");
  lig_host_command("run 1 post no");
  for (int i = 0; i < s->section.nbody; i++)
    s->load[i] = s->body[i].mean = fix_wrench(s->section.body[i].name, 0);
  lig_host_command("timestep %.17g", s->dt);
  lig_host_variable("tandem_step", &s->first);
  for (int i = 0; i < s->section.nbody; i++)
    give_sum(s, i);
  lig_host_command("run 0 post no");
  look_at_loads(s);
  for (int i = 0; i < s->section.nbody; i++)
    s->body[i].sum_sampled = s->body[i].sum;
  for (int k = 0; k < s->section.nchannel; k++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.channels[%d].variable", k);
    if (!lig_host_variable(s->section.channel[k].variable, &s->initial[k]))
      return tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" is no equal-style variable with a number",
                      s->section.channel[k].variable);
  }
  return TDM_OK;
}

static json_t *report_of(void) {
  double mass = 0;
  lig_host_variable("tandem_mass", &mass);
  return json_pack("{s:i, s:f, s:{s:f}, s:s}", "ranks", ranks, "particles", lig_host_particles(), "fill", "mass", mass,
                   "wall_mass", "infinite: contacts take the particle's mass alone");
}

static bool make_room(solver *s) {
  s->body = calloc((size_t)s->section.nbody + 1, sizeof *s->body);
  s->value = calloc(6 * (size_t)s->section.nbody + 1, sizeof *s->value);
  s->motion = calloc((size_t)s->section.nbody + 1, sizeof *s->motion);
  s->warning = calloc((size_t)s->section.nbody + 1, sizeof *s->warning);
  s->load = calloc((size_t)s->section.nbody + 1, sizeof *s->load);
  s->channel = calloc((size_t)s->section.nchannel + 1, sizeof *s->channel);
  s->initial = calloc((size_t)s->section.nchannel + 1, sizeof *s->initial);
  return s->body && s->warning && s->value && s->motion && s->load && s->channel && s->initial;
}

static tdm_status create(void **self, const tdm_assignment *a, tdm_ready *ready, tdm_participant *p, tdm_error *err) {
  solver *s = calloc(1, sizeof *s);
  *self = s;
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  s->way = a->interpolation;
  s->dt = a->dt;
  if (lig_section_read(&s->section, a, err) != TDM_OK)
    return err->status;
  if (!make_room(s))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  lig_host_at("dem.script", true);
  if (lig_host_open(p, err) != TDM_OK)
    return err->status;
  give_variables(s, a);
  lig_host_command("units si"); /* where the script says nothing */
  lig_host_command("echo screen");
  lig_host_listen(hear_script, s);
  lig_host_script(s->section.script);
  lig_host_listen(NULL, NULL);
  lig_host_command("echo none");
  if (look_through(s, err) != TDM_OK || take_over(s, a, err) != TDM_OK)
    return err->status;
  s->report = report_of();
  lig_host_at("", false);
  tdm_remark(TDM_NOTICE, "wall_mass", "coupling.bodies", a->time_start,
             "LIGGGHTS takes coupled bodies for walls of infinite mass: their contacts are damped by the particle's "
             "mass, not by the effective mass of both");
  *ready = (tdm_ready){.load = s->load,
                       .nchannel = s->section.nchannel,
                       .channel = s->channel,
                       .initial = s->initial,
                       .nwarning = s->nwarning,
                       .warning = s->warning,
                       .gravity = s->takes_gravity ? &s->section.gravity : NULL,
                       .report = s->report};
  return TDM_OK;
}

static void destroy(void *self) {
  solver *s = self;
  if (!s)
    return;
  if (s->nwindow > 0)
    tdm_log(TDM_LOG_INFO, "cost", "windows=%lu beside_run_us=%.3g", s->nwindow,
            1e6 * (s->working - s->running) / (double)s->nwindow);
  lig_section_free(&s->section);
  free(s->body);
  free(s->value);
  free(s->motion);
  free(s->warning);
  free(s->load);
  free(s->channel);
  free(s->initial);
  json_decref(s->report);
  free(s);
}

/* ---- windows ---- */

/* The value of a variable in this window; whether it is another than before. */
static bool set_variable(mover_value *v, const lig_motion *m, double before) {
  const int k = v->component % 3;
  const double c0 = (&m->c[0].x)[k], c1 = (&m->c[1].x)[k], c2 = (&m->c[2].x)[k];
  char value[VALUE];
  if (v->component >= 3)
    snprintf(value, sizeof value, "%.17g", (&m->rate.x)[k]);
  else if (c1 == 0 && c2 == 0)
    snprintf(value, sizeof value, "%.17g", c0);
  else
    snprintf(value, sizeof value, "(%.17g)+(step-%.0f)*((%.17g)+(step-%.0f)*(%.17g))", c0, before, c1, before, c2);
  const bool changes = strcmp(value, v->value) != 0;
  strcpy(v->value, value);
  return changes;
}

/* Steps of this length, and the bodies on their ways. */
static void begin_window(solver *s, const tdm_step *in) {
  const double dt = (in->t1 - in->t0) / (double)in->nstep;
  if (fabs(dt - s->dt) > 1e-6 * s->dt) {
    lig_host_command("timestep %.17g", dt);
    s->dt = dt;
    s->fresh = true;
  }
  for (int i = 0; i < s->section.nbody; i++) {
    s->motion[i] = lig_motion_make(s->body[i].place, &in->start[i], &in->end[i], s->way, (double)in->nstep, s->dt);
    if (s->motion[i].turns && !s->body[i].turns)
      give_turning(s, i);
  }
  const double before = s->first + (double)s->nstep; /* LIGGGHTS' number of the step before the window's first */
  bool changes = false;
  for (int k = 0; k < s->nvalue; k++)
    changes |= set_variable(&s->value[k], &s->motion[s->value[k].body], before);
  for (int k = 0; k < s->nvalue && changes; k++)
    give_variable(&s->value[k]);
}

static void run(solver *s, long n) {
  if (n <= 0)
    return;
  lig_host_command("run %ld pre %s post no", n, s->fresh ? "yes" : "no");
  s->fresh = false;
  s->nstep += n;
}

/* An output time: means since the one before, channels. */
static tdm_status take_sample(solver *s, const tdm_step *in, int j, tdm_result *out, tdm_error *err) {
  look_at_loads(s);
  for (int i = 0; i < s->section.nbody; i++) {
    body_state *b = &s->body[i];
    if (s->nstep > s->sampled) {
      const tdm_wrench since = minus(&b->sum, &b->sum_sampled);
      b->mean = times(1 / (double)(s->nstep - s->sampled), &since);
    }
    b->sum_sampled = b->sum;
    out->sample_load[j * s->section.nbody + i] = b->mean;
  }
  s->sampled = s->nstep;
  for (int k = 0; k < s->section.nchannel; k++)
    if (!lig_host_variable(s->section.channel[k].variable, &out->channel[j * s->section.nchannel + k]))
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "the variable \"%s\" has no number at %.9g s",
                      s->section.channel[k].variable, in->sample_time[j]);
  return TDM_OK;
}

static tdm_status step(void *self, const tdm_step *in, tdm_result *out, tdm_error *err) {
  solver *s = self;
  if (in->nstate != s->section.nbody)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "STEP has states of %d bodies, ASSIGN had %d", in->nstate,
                    s->section.nbody);
  const double begin = tdm_clock(), run_before = lig_host_running();
  const long start = s->nstep, end = start + (long)in->nstep;
  begin_window(s, in);
  for (int i = 0; i < s->section.nbody; i++)
    s->body[i].sum_window = s->body[i].sum;
  for (int j = 0; j < in->nsample; j++) { /* at the end of the step that is nearest to the time, or later */
    const long to = start + lround((in->sample_time[j] - in->t0) / s->dt);
    run(s, (to < end ? to : end) - s->nstep);
    if (take_sample(s, in, j, out, err) != TDM_OK)
      return err->status;
  }
  run(s, end - s->nstep);
  look_at_loads(s);
  for (int i = 0; i < s->section.nbody; i++) {
    const tdm_wrench all = minus(&s->body[i].sum, &s->body[i].sum_window);
    out->load[i] = times(1 / (double)in->nstep, &all);
    look_at_mesh(s, i);
    s->body[i].place.orientation = in->end[i].pose.orientation;
  }
  s->nwindow++;
  s->working += tdm_clock() - begin;
  s->running += lig_host_running() - run_before;
  return TDM_OK;
}

tdm_solver_ops lig_solver_ops(int nrank) {
  ranks = nrank;
  return (tdm_solver_ops){
      .role = "dem", .software = "tandem-liggghts " TDM_VERSION, .create = create, .step = step, .destroy = destroy};
}

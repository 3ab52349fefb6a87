/* tandem-serve RESOURCES: the process behind an instance of an exported FMU. It starts the FMU's solvers, plays the
 * server to them, and answers the FMU's binary (guest/link.h) until that hangs up. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* close_range, POLLRDHUP, asprintf */
#include "coupler/export/serve/perform.h"
#include "protocol/base/interrupt.h"
#include "protocol/base/log.h"
#include "protocol/math/gsl_errors.h"
#include "protocol/scene/remark.h"
#include "protocol/scene/scene.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LINE = 3, BEAT_MS = 250 };

/* What resources/fmu.json says. */
typedef struct {
  json_t *json;
  const char *token;
  cpl_export_side side;
  int ninput, noutput;
  int stride;   /* outputs of a body */
  bool follows; /* accelerations follow the loads */
  const char **set;
} fmu_facts;

typedef struct {
  const char *dir; /* the FMU's resources */
  fmu_facts facts;
  cpl_stage stage;
  cpl_performance performance;
  double end; /* of the scene [s] */
  bool started;
  tdm_remarks remarks; /* this process's own */
  json_t *told;        /* events of remarks that were told */
} server;

/* ---- what the FMU is ---- */

/* Files that were packed, as overrides of the scene: "dem.bodies[0].shapes[0].file=DIR/files/0.stl". */
static tdm_status read_files(server *s, tdm_error *err) {
  json_t *files = json_object_get(s->facts.json, "files"), *name;
  const char *path;
  size_t n = 0;
  s->facts.set = calloc(json_object_size(files) + 1, sizeof *s->facts.set);
  if (!s->facts.set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  json_object_foreach(files, path, name) {
    char *set = NULL;
    if (asprintf(&set, "%s=%s/%s", path, s->dir, json_string_value(name)) < 0)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    s->facts.set[n++] = set;
  }
  return TDM_OK;
}

static tdm_status read_facts(server *s, tdm_error *err) {
  char file[4200];
  json_error_t why;
  snprintf(file, sizeof file, "%s/fmu.json", s->dir);
  s->facts.json = json_load_file(file, 0, &why);
  if (!s->facts.json)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read: %s; export the FMU again", file, why.text);
  tdm_object o = tdm_object_open(s->facts.json, "fmu.json", err);
  s->facts.token = tdm_get_string(&o, "token", NULL);
  const int side = tdm_get_choice(&o, "side", cpl_export_sides, CPL_NEXPORT, -1);
  s->facts.side = side < 0 ? CPL_EXPORT_DEM : (cpl_export_side)side;
  s->facts.ninput = (int)tdm_get_integer(&o, "inputs", TDM_REQUIRED_INT, 0);
  s->facts.noutput = (int)tdm_get_integer(&o, "outputs", TDM_REQUIRED_INT, 0);
  s->facts.stride = (int)tdm_get_integer(&o, "outputs_of_a_body", TDM_REQUIRED_INT, 0);
  s->facts.follows = tdm_get_bool(&o, "mobility", false);
  if (err->status == TDM_OK && json_array_size(json_object_get(s->facts.json, "starts")) != (size_t)s->facts.ninput)
    tdm_object_fail(&o, "starts", "has not a number for each input");
  return err->status == TDM_OK ? read_files(s, err) : err->status;
}

/* The solvers that are part of it, flags 1 << role. */
static unsigned roles_of(const server *s) {
  unsigned roles = 0;
  for (int r = 0; r < CPL_NROLE; r++)
    roles |= cpl_export_has(s->facts.side, (cpl_role)r) ? 1u << r : 0;
  return roles;
}

static tdm_status load(server *s, tdm_error *err) {
  char scene[4200];
  cpl_settings *set = &s->stage.settings;
  snprintf(scene, sizeof scene, "%s/scene.json", s->dir);
  if (cpl_stage_load(&s->stage, s->facts.side, roles_of(s), scene, s->facts.set, err) == TDM_OK)
    set->output_interval = set->dt; /* samples are taken at any step's end */
  if (s->facts.side != CPL_EXPORT_BOTH) {
    set->interpolates = false; /* docs/fmu.md has the path, whatever the scene says */
    set->adapt.on = true;      /* windows are the tool's steps, of any length */
    set->adapt.n_min = 1;
  }
  s->end = set->time_end;
  return err->status;
}

/* tandem's solvers beside this program can be executed; archives need not keep that. */
static void make_executable(void) {
  static const char *const names[] = {"tandem-dem", "tandem-mbd"};
  char self[4000], path[4096];
  const ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  self[n > 0 ? n : 0] = 0;
  char *slash = strrchr(self, '/');
  for (int i = 0; i < 2 && slash; i++) {
    struct stat is;
    *slash = 0;
    snprintf(path, sizeof path, "%s/%s", self, names[i]);
    if (access(path, X_OK) != 0 && stat(path, &is) == 0)
      chmod(path, is.st_mode | S_IXUSR); /* starting it tells what is wrong */
  }
}

/* ---- answers ---- */

static bool greet(const server *s) {
  const json_t *starts = json_object_get(s->facts.json, "starts");
  const int ninput = s->facts.ninput, nbody = s->stage.settings.nbody;
  double *number = calloc((size_t)(GUEST_HELLO_NUMBERS + ninput), sizeof *number);
  if (!number)
    return false;
  number[GUEST_NINPUT] = ninput;
  number[GUEST_NOUTPUT] = s->facts.noutput;
  number[GUEST_ACCELERATION] = TDM_STATE_DOUBLES;
  number[GUEST_STRIDE] = s->facts.stride;
  number[GUEST_NBODY] = s->facts.follows ? nbody : 0;
  number[GUEST_STARTS_ANEW] = s->facts.side == CPL_EXPORT_DEM;
  for (int i = 0; i < ninput; i++)
    number[GUEST_HELLO_NUMBERS + i] = json_number_value(json_array_get(starts, (size_t)i));
  const bool good =
      guest_send(LINE, GUEST_HELLO, GUEST_OK, s->facts.token, number, (size_t)(GUEST_HELLO_NUMBERS + ninput));
  free(number);
  return good;
}

static bool answer_error(guest_kind kind, guest_status status, const tdm_error *err) {
  char text[TDM_PATH_MAX + TDM_MESSAGE_MAX + 80];
  snprintf(text, sizeof text, "%s%s%s%s", err->path, err->path[0] ? ": " : "", err->message,
           status == GUEST_DISCARD ? "; nothing was done, and the step may be tried again otherwise" : "");
  return guest_send(LINE, kind, status, text, NULL, 0);
}

/* A remark, or a doubt, into the text; once an event. */
static void tell(server *s, FILE *out, const json_t *remark, const char *key, guest_status *status) {
  const char *event = json_string_value(json_object_get(remark, key));
  const char *level = json_string_value(json_object_get(remark, "level"));
  const char *path = json_string_value(json_object_get(remark, "path"));
  const char *message = json_string_value(json_object_get(remark, "message"));
  if (!event || json_object_get(s->told, event))
    return;
  json_object_set_new(s->told, event, json_true());
  if (!level || strcmp(level, "warning") == 0)
    *status = GUEST_WARNING;
  fprintf(out, "%s%s%s%s", ftell(out) > 0 ? "\n" : "", path ? path : "", path && *path ? ": " : "",
          message ? message : "");
}

/* What solvers and server have said since the last time; the caller frees the text. */
static char *news(server *s, guest_status *status) {
  char *text = NULL;
  size_t size = 0, i;
  json_t *remark;
  FILE *out = open_memstream(&text, &size);
  if (!out)
    return NULL;
  json_array_foreach(s->stage.session.warnings, i, remark) tell(s, out, remark, "message", status);
  for (int r = 0; r < CPL_NROLE; r++)
    json_array_foreach(s->stage.session.partner[r].remarks, i, remark) tell(s, out, remark, "event", status);
  json_t *own = s->remarks.count > 0 ? tdm_remarks_to_json(&s->remarks, NULL) : NULL;
  json_array_foreach(own, i, remark) tell(s, out, remark, "event", status);
  json_decref(own);
  if (fclose(out) == 0)
    return text;
  free(text);
  return NULL;
}

/* Outputs and, where there is one, the mobility. */
static bool answer_outputs(server *s, guest_kind kind) {
  const cpl_performance *p = &s->performance;
  const size_t n = (size_t)s->facts.noutput, k = s->facts.follows ? 6 * (size_t)p->layout.nbody : 0;
  guest_status status = GUEST_OK;
  char *text = news(s, &status);
  double *number = calloc(n + k * k + 1, sizeof *number);
  if (number) {
    memcpy(number, p->output, n * sizeof *number);
    if (k > 0)
      memcpy(number + n, p->mobility, k * k * sizeof *number);
  }
  const bool good = number && guest_send(LINE, kind, status, text, number, n + k * k);
  free(number);
  free(text);
  return good;
}

/* ---- questions ---- */

static void stop(server *s, const tdm_error *err) {
  if (s->started)
    cpl_perform_free(&s->performance);
  s->started = false;
  cpl_stage_stop(&s->stage, err);
}

/* In place of a multibody solver: the bodies as they were when the FMU was made, where the inputs have them now. */
static tdm_status place_bodies(server *s, const double *input, tdm_error *err) {
  json_t *bodies = json_object_get(s->facts.json, "bodies"), *body;
  size_t i;
  tdm_state *state = calloc((size_t)s->stage.settings.nbody + 1, sizeof *state);
  if (!state)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  json_array_foreach(bodies, i, body) {
    const char *mesh = json_string_value(json_object_get(body, "mesh"));
    if (mesh && mesh[0] != '/')
      json_object_set_new(body, "mesh", json_sprintf("%s/%s", s->dir, mesh));
  }
  if (cpl_stage_open(&s->stage, err) == TDM_OK && cpl_stage_bodies(&s->stage, bodies, err) == TDM_OK &&
      cpl_perform_states(&s->stage.settings, input, state, err) == TDM_OK)
    for (int k = 0; k < s->stage.settings.nbody; k++)
      s->stage.session.body[k].state = state[k];
  free(state);
  return err->status;
}

static tdm_status check_same(const server *s, tdm_error *err) {
  const cpl_export_layout l = cpl_export_layout_of(s->facts.side, &s->stage.session);
  const bool follows = s->facts.side != CPL_EXPORT_DEM && s->stage.session.mobility.Y;
  if (cpl_export_ninput(&l) == s->facts.ninput && cpl_export_noutput(&l) == s->facts.noutput &&
      l.output == s->facts.stride && follows == s->facts.follows)
    return TDM_OK;
  return tdm_fail(err, TDM_ERR_VERSION, NULL,
                  "the solvers tell %d outputs of %d inputs, the FMU has %d of %d: they are others than those that it "
                  "was exported with; export it again",
                  cpl_export_noutput(&l), cpl_export_ninput(&l), s->facts.noutput, s->facts.ninput);
}

static tdm_status start(server *s, const double *number, tdm_error *err) {
  static const char *const programs[CPL_NROLE] = {[CPL_MBD] = "tandem-mbd", [CPL_DEM] = "tandem-dem"};
  const double *input = number + 2;
  cpl_settings *set = &s->stage.settings;
  const double longest = 9e14 * set->dt; /* steps are counted exactly; who says 1e20 s means no end */
  set->time_end = isfinite(number[0]) ? fmin(number[0], longest) : s->end;
  if (s->facts.side != CPL_EXPORT_BOTH)
    set->n = (long)cpl_total_steps(set);
  json_object_clear(s->told);
  s->remarks = (tdm_remarks){0};
  if (s->facts.side == CPL_EXPORT_DEM && place_bodies(s, input, err) != TDM_OK)
    return err->status;
  if (cpl_stage_start(&s->stage, roles_of(s), programs, err) != TDM_OK) {
    const size_t n = strlen(err->message);
    if (strstr(err->message, "dem.settle.store") || strcmp(err->path, "dem.settle.store") == 0)
      snprintf(err->message + n, sizeof err->message - n,
               "; the bed that is packed belongs to bodies that start where the FMU's start values have them");
    return err->status;
  }
  if (check_same(s, err) != TDM_OK)
    return err->status;
  s->started = true;
  return cpl_perform_start(&s->performance, &s->stage, number[1] != 0, input, err);
}

/* One question; false: the line is dead, or was misused. */
static bool answer(server *s, const guest_message *m) {
  tdm_error err = {0};
  bool refused = false;
  const size_t ninput = (size_t)s->facts.ninput;
  const int slot = m->nnumber == 1 ? (int)m->number[0] : -1;
  const bool has_inputs = m->kind == GUEST_START || m->kind == GUEST_STEP;
  const bool keeps = m->kind == GUEST_KEEP || m->kind == GUEST_RESTORE;
  if ((has_inputs && m->nnumber != ninput + 2) || (keeps && !(slot >= 0 && slot < GUEST_SLOTS_MAX)) ||
      (m->kind != GUEST_START && m->kind != GUEST_STOP && !s->started))
    return false;
  if (m->kind == GUEST_START)
    start(s, m->number, &err);
  else if (m->kind == GUEST_STEP)
    cpl_perform_step(&s->performance, m->number[0], m->number[1], m->number + 2, &refused, &err);
  else if (m->kind == GUEST_KEEP)
    cpl_perform_keep(&s->performance, slot, &err);
  else if (m->kind == GUEST_RESTORE)
    cpl_perform_restore(&s->performance, slot, &err);
  else
    stop(s, NULL);
  if (err.status != TDM_OK && !refused)
    stop(s, &err);
  if (err.status != TDM_OK)
    return answer_error(m->kind, refused ? GUEST_DISCARD : GUEST_ERROR, &err);
  return has_inputs ? answer_outputs(s, m->kind) : guest_send(LINE, m->kind, GUEST_OK, NULL, NULL, 0);
}

/* The tool may hang up, or die, while a step is under way: then that is given up. */
static void *watch_line(void *nothing) {
  struct pollfd line = {.fd = LINE, .events = POLLRDHUP};
  while (poll(&line, 1, -1) < 0 && errno == EINTR)
    continue;
  tdm_interrupted = 1;
  return nothing;
}

static void serve(server *s) {
  guest_message m = {0};
  struct pollfd line = {.fd = LINE, .events = POLLIN};
  bool good = greet(s);
  while (good) {
    const int n = poll(&line, 1, BEAT_MS);
    if (n < 0 && errno != EINTR)
      break;
    if (n > 0)
      good = guest_receive(LINE, &m) && answer(s, &m);
    else if (s->started)
      cpl_session_beat(&s->stage.session); /* the tool is at something else; the solvers are to wait */
  }
  guest_message_free(&m);
}

int main(int argc, char **argv) {
  tdm_error err = {0};
  struct stat is;
  if (argc != 2 || argv[1][0] == '-' || fstat(LINE, &is) != 0 || !S_ISSOCK(is.st_mode)) {
    const bool help = argc == 2 && strcmp(argv[1], "--help") == 0;
    fputs("tandem-serve is started by FMUs that tandem export has made; it is no command for users (docs/fmu.md)\n",
          help ? stdout : stderr);
    return help ? 0 : 2;
  }
  close_range(LINE + 1, ~0U, 0);    /* files of the tool that it did not mean to hand on */
  fcntl(LINE, F_SETFD, FD_CLOEXEC); /* solvers must not hold the line */
  tdm_log_open(NULL, "serve");
  tdm_gsl_return_errors();
  signal(SIGPIPE, SIG_IGN);
  make_executable();
  server s = {.dir = argv[1], .told = json_object()};
  tdm_remarks_open(&s.remarks);
  pthread_t watch;
  if (pthread_create(&watch, NULL, watch_line, NULL) == 0)
    pthread_detach(watch);
  if (read_facts(&s, &err) == TDM_OK && load(&s, &err) == TDM_OK)
    serve(&s);
  else
    answer_error(GUEST_HELLO, GUEST_ERROR, &err);
  stop(&s, NULL);
  cpl_stage_free(&s.stage);
  for (size_t i = 0; s.facts.set && s.facts.set[i]; i++)
    free((void *)s.facts.set[i]);
  free(s.facts.set);
  json_decref(s.facts.json);
  json_decref(s.told);
  return err.status == TDM_OK ? 0 : 1;
}

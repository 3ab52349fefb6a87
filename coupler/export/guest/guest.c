/* An instance of an exported FMU: see guest.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/guest/guest.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

guest_status guest_fail(guest *g, guest_status status, const char *format, ...) {
  char text[2048];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  g->say(g, status, text);
  return status;
}

guest_status guest_lacks(guest *g, const char *function) {
  return guest_fail(g, GUEST_ERROR, "%s: this FMU has no such variables, and does not claim that capability", function);
}

static unsigned hex_digit(char c) {
  return (unsigned)(isdigit((unsigned char)c) ? c - '0' : tolower((unsigned char)c) - 'a' + 10);
}

bool guest_path_of(guest *g, const char *uri, char *out, size_t size) {
  size_t n = 0;
  const char *at = uri;
  const bool is_uri = strncmp(at, "file:", 5) == 0;
  if (is_uri) {
    at += 5;
    if (strncmp(at, "//", 2) == 0) { /* an authority, empty or this machine */
      at += 2;
      const char *slash = strchr(at, '/');
      at = slash ? slash : at;
    }
  }
  for (; *at && n + 1 < size; n++) {
    const bool is_coded = is_uri && *at == '%' && isxdigit((unsigned char)at[1]) && isxdigit((unsigned char)at[2]);
    out[n] = is_coded ? (char)(hex_digit(at[1]) << 4 | hex_digit(at[2])) : *at;
    at += is_coded ? 3 : 1;
  }
  if (*at) {
    guest_fail(g, GUEST_ERROR,
               "the path of the FMU's resources has %zu characters or more, of %zu that it may have: "
               "unpack it elsewhere; it is %.200s...",
               size, size - 1, uri);
    return false;
  }
  while (n > 1 && out[n - 1] == '/')
    n--;
  out[n] = 0;
  return true;
}

/* ---- questions ---- */

/* The other end is gone. */
static guest_status lose(guest *g) {
  char words[1024];
  guest_host_last_words(&g->host, words, sizeof words);
  guest_host_end(&g->host);
  g->lost = true;
  return guest_fail(g, GUEST_ERROR, "%s", words);
}

/* Wait for an answer, and say what comes with it. */
static guest_status listen_to(guest *g, guest_kind kind) {
  guest_message *a = &g->answer;
  if (!guest_receive(g->host.fd, a) || a->kind != kind)
    return lose(g);
  if (a->text[0] && kind != GUEST_HELLO)
    g->say(g, a->status, a->text);
  g->lost = g->lost || a->status >= GUEST_ERROR;
  return a->status;
}

static guest_status ask(guest *g, guest_kind kind, const double *number, size_t nnumber) {
  if (g->host.fd < 0)
    return guest_fail(g, GUEST_ERROR, "the solver of this instance has ended; reset the instance, or free it");
  if (!guest_send(g->host.fd, kind, GUEST_OK, NULL, number, nnumber))
    return lose(g);
  return listen_to(g, kind);
}

/* Take outputs and mobility from the last answer, which belong to the inputs that were sent. */
static guest_status take_outputs(guest *g) {
  const size_t k = 36 * g->nbody * g->nbody;
  if (g->answer.nnumber != g->noutput + k) {
    g->lost = true;
    return guest_fail(g, GUEST_FATAL, "tandem-serve answered with %zu numbers, not with %zu: it is not this FMU's own",
                      g->answer.nnumber, g->noutput + k);
  }
  memcpy(g->output, g->answer.number, g->noutput * sizeof *g->output);
  memcpy(g->mobility, g->answer.number + g->noutput, k * sizeof *g->mobility);
  memcpy(g->known, g->input, g->ninput * sizeof *g->known);
  return g->answer.status;
}

/* Back to before the solvers were started; what they have kept is gone. */
static guest_status stop_solvers(guest *g) {
  const guest_status status = ask(g, GUEST_STOP, NULL, 0);
  memset(g->slot, 0, sizeof g->slot);
  g->started = false;
  g->run++;
  return status;
}

/* ---- life ---- */

static bool make_room(guest *g) {
  const double *n = g->answer.number;
  g->ninput = (size_t)n[GUEST_NINPUT];
  g->noutput = (size_t)n[GUEST_NOUTPUT];
  g->acceleration = (size_t)n[GUEST_ACCELERATION];
  g->stride = (size_t)n[GUEST_STRIDE];
  g->nbody = (size_t)n[GUEST_NBODY];
  g->starts_anew = n[GUEST_STARTS_ANEW] != 0;
  g->first = calloc(g->ninput + 1, sizeof *g->first);
  g->input = calloc(g->ninput + 1, sizeof *g->input);
  g->known = calloc(g->ninput + 1, sizeof *g->known);
  g->output = calloc(g->noutput + 1, sizeof *g->output);
  g->mobility = calloc(36 * g->nbody * g->nbody + 1, sizeof *g->mobility);
  if (!g->first || !g->input || !g->known || !g->output || !g->mobility ||
      g->answer.nnumber != GUEST_HELLO_NUMBERS + g->ninput)
    return false;
  memcpy(g->first, n + GUEST_HELLO_NUMBERS, g->ninput * sizeof *g->first);
  return true;
}

/* As an instance is right after it was made. */
static void begin(guest *g) {
  memcpy(g->input, g->first, g->ninput * sizeof *g->input);
  memcpy(g->known, g->first, g->ninput * sizeof *g->known);
  memset(g->output, 0, g->noutput * sizeof *g->output);
  g->phase = GUEST_INSTANTIATED;
  g->started = g->stale = g->at_end = g->lost = false;
  g->start = g->t = 0;
  g->stop = NAN;
}

guest *guest_make(guest_say *say, void *owner, const char *token, const char *resources) {
  char why[4608] = "out of memory";
  guest *g = calloc(1, sizeof *g);
  if (!g)
    return NULL;
  *g = (guest){.say = say, .owner = owner, .host = {.fd = -1, .errors = -1}};
  if (!guest_host_start(&g->host, resources, why, sizeof why)) {
    guest_fail(g, GUEST_ERROR, "%s", why);
  } else if (listen_to(g, GUEST_HELLO) != GUEST_OK) {
    if (!g->lost || g->host.fd >= 0)
      guest_fail(g, GUEST_ERROR, "%s", g->answer.text);
  } else if (!token || strcmp(token, g->answer.text) != 0) {
    guest_fail(g, GUEST_ERROR, "the token \"%s\" is not that of this FMU, \"%s\"", token ? token : "", g->answer.text);
  } else if (!make_room(g)) {
    guest_fail(g, GUEST_ERROR, "out of memory, or tandem-serve is not this FMU's own");
  } else {
    begin(g);
    return g;
  }
  guest_free(&g);
  return NULL;
}

void guest_free(guest **instance) {
  guest *g = *instance;
  *instance = NULL;
  if (!g)
    return;
  guest_host_end(&g->host);
  guest_message_free(&g->answer);
  free(g->first);
  free(g->input);
  free(g->known);
  free(g->output);
  free(g->mobility);
  free(g);
}

guest_status guest_enter(guest *g, double start, bool has_stop, double stop) {
  if (g->phase != GUEST_INSTANTIATED)
    return guest_fail(g, GUEST_ERROR, "initialization begins once, after the instance was made or reset");
  if (!isfinite(start) || (has_stop && !(stop > start)))
    return guest_fail(g, GUEST_ERROR, "the experiment goes from %g s to %g s; it must end after its start", start,
                      stop);
  g->start = g->t = start;
  g->stop = has_stop ? stop : NAN;
  g->phase = GUEST_INITIALIZING;
  return GUEST_OK;
}

/* While initializing: the solvers are READY for the inputs that are set now. */
static guest_status be_started(guest *g) {
  if (g->started && !(g->stale && g->starts_anew))
    return GUEST_OK;
  if (g->started && stop_solvers(g) != GUEST_OK)
    return GUEST_ERROR;
  double *number = calloc(g->ninput + 2, sizeof *number);
  if (!number)
    return guest_fail(g, GUEST_ERROR, "out of memory");
  number[0] = g->stop - g->start;
  number[1] = g->at_end;
  memcpy(number + 2, g->input, g->ninput * sizeof *number);
  const guest_status status = ask(g, GUEST_START, number, g->ninput + 2);
  free(number);
  if (status > GUEST_WARNING)
    return status;
  g->started = true;
  g->stale = false;
  return take_outputs(g);
}

guest_status guest_leave(guest *g) {
  if (g->phase != GUEST_INITIALIZING)
    return guest_fail(g, GUEST_ERROR, "initialization has not begun");
  const guest_status status = be_started(g);
  if (status <= GUEST_WARNING)
    g->phase = GUEST_STEPPING;
  return status;
}

guest_status guest_terminate(guest *g) {
  g->phase = GUEST_ENDED;
  return g->host.fd >= 0 && g->started && !g->lost ? stop_solvers(g) : GUEST_OK;
}

guest_status guest_reset(guest *g) {
  if (g->host.fd < 0)
    return guest_fail(g, GUEST_ERROR, "tandem-serve has ended; free this instance and make another one");
  const guest_status status = g->started ? stop_solvers(g) : GUEST_OK;
  if (status == GUEST_OK)
    begin(g);
  return status;
}

/* ---- variables ---- */

/* Accelerations follow the loads that are set now, by the mobility. */
static double output_of(const guest *g, size_t k) {
  const size_t body = g->stride ? k / g->stride : 0, at = g->stride ? k % g->stride : 0;
  double value = g->output[k];
  if (body >= g->nbody || at < g->acceleration || at >= g->acceleration + 6)
    return value;
  const double *row = g->mobility + (6 * body + at - g->acceleration) * g->ninput;
  for (size_t j = 0; j < g->ninput; j++)
    value += row[j] * (g->input[j] - g->known[j]);
  return value;
}

guest_status guest_get(guest *g, const uint32_t *reference, size_t n, double *value) {
  for (size_t i = 0; i < n; i++) {
    const size_t r = reference[i];
    if (r == 0)
      value[i] = g->t;
    else if (r <= g->ninput)
      value[i] = g->input[r - 1];
    else if (r > g->ninput + g->noutput)
      return guest_fail(g, GUEST_ERROR, "there is no real variable with the value reference %zu", r);
    else if (g->phase == GUEST_INSTANTIATED)
      return guest_fail(g, GUEST_ERROR, "outputs are known from initialization on");
    else if (g->phase == GUEST_INITIALIZING && be_started(g) > GUEST_WARNING)
      return GUEST_ERROR;
    else
      value[i] = output_of(g, r - 1 - g->ninput);
  }
  return GUEST_OK;
}

guest_status guest_set(guest *g, const uint32_t *reference, size_t n, const double *value) {
  for (size_t i = 0; i < n; i++) {
    const size_t r = reference[i];
    if (r == 0 || r > g->ninput)
      return guest_fail(g, GUEST_ERROR, "the real variable with the value reference %zu is no input", r);
    if (!isfinite(value[i]))
      return guest_fail(g, GUEST_ERROR, "the input with the value reference %zu was set to %g", r, value[i]);
    g->stale = g->stale || g->input[r - 1] != value[i];
    g->input[r - 1] = value[i];
  }
  return GUEST_OK;
}

/* The boolean parameter is there where motions are inputs. */
static bool is_flag(const guest *g, uint32_t reference) {
  return g->starts_anew && reference == g->ninput + g->noutput + 1;
}

guest_status guest_get_flag(guest *g, const uint32_t *reference, size_t n, bool *value) {
  for (size_t i = 0; i < n; i++) {
    if (!is_flag(g, reference[i]))
      return guest_fail(g, GUEST_ERROR, "there is no boolean variable with the value reference %u", reference[i]);
    value[i] = g->at_end;
  }
  return GUEST_OK;
}

guest_status guest_set_flag(guest *g, const uint32_t *reference, size_t n, const bool *value) {
  for (size_t i = 0; i < n; i++) {
    if (!is_flag(g, reference[i]))
      return guest_fail(g, GUEST_ERROR, "there is no boolean variable with the value reference %u", reference[i]);
    if (g->phase > GUEST_INITIALIZING)
      return guest_fail(g, GUEST_ERROR, "inputs_at_end is fixed after initialization");
    g->stale = g->stale || g->at_end != value[i];
    g->at_end = value[i];
  }
  return GUEST_OK;
}

guest_status guest_derivative(guest *g, const uint32_t *unknown, size_t nunknown, const uint32_t *known, size_t nknown,
                              const double *seed, double *derivative) {
  if (g->nbody == 0)
    return guest_lacks(g, "GetDirectionalDerivative");
  if (g->phase == GUEST_INSTANTIATED || (g->phase == GUEST_INITIALIZING && be_started(g) > GUEST_WARNING))
    return guest_fail(g, GUEST_ERROR, "derivatives are known from initialization on");
  for (size_t i = 0; i < nunknown; i++) {
    derivative[i] = 0;
    if (unknown[i] <= g->ninput || unknown[i] > g->ninput + g->noutput)
      return guest_fail(g, GUEST_ERROR, "the value reference %u is no output's", unknown[i]);
    const size_t k = unknown[i] - 1 - g->ninput, body = k / g->stride, at = k % g->stride;
    const bool follows = body < g->nbody && at >= g->acceleration && at < g->acceleration + 6;
    for (size_t j = 0; j < nknown; j++) {
      if (known[j] == 0 || known[j] > g->ninput)
        return guest_fail(g, GUEST_ERROR, "the value reference %u is no input's", known[j]);
      if (follows)
        derivative[i] += seed[j] * g->mobility[(6 * body + at - g->acceleration) * g->ninput + known[j] - 1];
    }
  }
  return GUEST_OK;
}

/* ---- steps ---- */

guest_status guest_step(guest *g, double t, double h) {
  if (g->lost)
    return guest_fail(g, GUEST_ERROR, "this instance has failed; reset it, or free it");
  if (g->phase != GUEST_STEPPING)
    return guest_fail(g, GUEST_ERROR, "steps come after initialization and before the end");
  if (t + h > g->stop + 1e-6 * h + 1e-9 * fabs(g->stop)) /* never where there is none: NaN */
    return guest_fail(g, GUEST_ERROR,
                      "a communication step from %.9g s to %.9g s leads beyond the stop time of the experiment, %.9g s",
                      t, t + h, g->stop);
  double *number = calloc(g->ninput + 2, sizeof *number);
  if (!number)
    return guest_fail(g, GUEST_ERROR, "out of memory");
  number[0] = t - g->start;
  number[1] = h;
  memcpy(number + 2, g->input, g->ninput * sizeof *number);
  guest_status status = ask(g, GUEST_STEP, number, g->ninput + 2);
  free(number);
  if (status > GUEST_WARNING)
    return status;
  status = take_outputs(g);
  if (status <= GUEST_WARNING)
    g->t = t + h;
  return status;
}

/* ---- states ---- */

static size_t count_kept(const guest *g) {
  return 2 * g->ninput + g->noutput + 36 * g->nbody * g->nbody;
}

/* All numbers of the state, to or from a block. */
static void copy_kept(guest *g, double *block, bool back) {
  double *const part[] = {g->input, g->known, g->output, g->mobility};
  const size_t n[] = {g->ninput, g->ninput, g->noutput, 36 * g->nbody * g->nbody};
  for (size_t i = 0; i < sizeof n / sizeof n[0]; block += n[i++])
    memcpy(back ? part[i] : block, back ? block : part[i], n[i] * sizeof *block);
}

static guest_kept *make_kept(const guest *g) {
  guest_kept *k = calloc(1, sizeof *k);
  double *number = calloc(count_kept(g) + 1, sizeof *number);
  if (k && number) {
    *k = (guest_kept){.slot = -1, .number = number};
    return k;
  }
  free(k);
  free(number);
  return NULL;
}

static void free_kept(guest_kept *k) {
  free(k->number);
  free(k);
}

/* The slot that a state has in the solvers as they run now; -1: none. */
static int slot_of(const guest *g, const guest_kept *k) {
  return k && k->run == g->run ? k->slot : -1;
}

static int free_slot(const guest *g) {
  int slot = 0;
  while (slot < GUEST_SLOTS_MAX && g->slot[slot])
    slot++;
  return slot;
}

guest_status guest_keep(guest *g, guest_kept **kept) {
  if (g->phase == GUEST_ENDED || g->lost)
    return guest_fail(g, GUEST_ERROR, "the state of an instance that has ended, or has failed, cannot be kept");
  const bool steps = g->phase == GUEST_STEPPING;
  const int old = slot_of(g, *kept), slot = !steps ? -1 : old >= 0 ? old : free_slot(g);
  if (slot == GUEST_SLOTS_MAX)
    return guest_fail(g, GUEST_ERROR, "%d states are kept already; free some of them", GUEST_SLOTS_MAX);
  guest_kept *k = *kept ? *kept : make_kept(g);
  if (!k)
    return guest_fail(g, GUEST_ERROR, "out of memory");
  const guest_status status = steps ? ask(g, GUEST_KEEP, &(double){slot}, 1) : GUEST_OK;
  if (status > GUEST_WARNING) {
    if (!*kept)
      free_kept(k);
    return status;
  }
  if (old >= 0)
    g->slot[old] = false;
  if (slot >= 0)
    g->slot[slot] = true;
  *k = (guest_kept){.phase = g->phase,
                    .slot = slot,
                    .run = g->run,
                    .at_end = g->at_end,
                    .start = g->start,
                    .stop = g->stop,
                    .t = g->t,
                    .number = k->number};
  copy_kept(g, k->number, false);
  *kept = k;
  return GUEST_OK;
}

guest_status guest_go_back(guest *g, const guest_kept *k) {
  guest_status status = GUEST_OK;
  if (!k)
    return guest_fail(g, GUEST_ERROR, "there is no state to go back to");
  if (k->slot >= 0 && (k->run != g->run || g->phase != GUEST_STEPPING || g->lost))
    return guest_fail(g, GUEST_ERROR,
                      "the state at %g s belongs to a run of the solvers that has ended (by a reset, an "
                      "error, the end, or a state from before the first step); it can only be freed",
                      k->t);
  if (g->host.fd < 0)
    return guest_fail(g, GUEST_ERROR, "tandem-serve has ended; free this instance and make another one");
  if (k->slot >= 0)
    status = ask(g, GUEST_RESTORE, &(double){k->slot}, 1);
  else if (g->started)
    status = stop_solvers(g);
  if (status > GUEST_WARNING)
    return status;
  g->phase = k->phase;
  g->at_end = k->at_end;
  g->start = k->start;
  g->stop = k->stop;
  g->t = k->t;
  g->lost = false;
  copy_kept(g, k->number, true);
  return GUEST_OK;
}

void guest_forget(guest *g, guest_kept **kept) {
  if (!*kept)
    return;
  const int slot = slot_of(g, *kept);
  if (slot >= 0)
    g->slot[slot] = false;
  free_kept(*kept);
  *kept = NULL;
}

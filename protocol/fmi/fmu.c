/* A co-simulation FMU: see fmu.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmu.h"

#include "protocol/base/log.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char *volatile tdm_fmu_calling;
volatile double tdm_fmu_called_at;

static const char *last_call = ""; /* for messages */

void tdm_fmu_enter(const char *call) {
  last_call = call;
  tdm_fmu_called_at = tdm_clock();
  tdm_fmu_calling = call;
}

int tdm_fmu_leave(int status) {
  tdm_fmu_calling = NULL;
  return status;
}

void tdm_fmu_says(tdm_fmu *f, int status, const char *category, const char *message) {
  char quoted[1024];
  if (status >= 2)
    snprintf(f->said, sizeof f->said, "%s", message ? message : "");
  tdm_utf8_clean(f->said);
  tdm_log(status == 0   ? TDM_LOG_INFO
          : status == 1 ? TDM_LOG_WARNING
                        : TDM_LOG_ERROR,
          "fmu", "category=%s message=%s", category && *category ? category : "-",
          tdm_log_quote(quoted, sizeof quoted, message ? message : ""));
}

/* ---- opening ---- */

/* The standard's functions from the binary into the table. */
static tdm_status find_functions(tdm_fmu *f, tdm_error *err) {
  const tdm_fmi_description *d = &f->description;
  for (const tdm_fmu_function *function = f->version->function; function->name; function++) {
    void *address = dlsym(f->library, function->name);
    const bool due = function->need == 1 || (function->need == 2 && d->keeps_states) ||
                     (function->need == 3 && d->gives_derivatives);
    if (!address && due)
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: its binary has no function %s, which FMI %d.0 asks of it", f->file,
                      function->name, d->version);
    memcpy((char *)f->table + function->at, &address, sizeof address);
  }
  return TDM_OK;
}

static tdm_status load_binary(tdm_fmu *f, tdm_error *err) {
  char path[2 * TDM_FMI_DIR_MAX + 512], platforms[TDM_FMI_DIR_MAX + 16];
  snprintf(path, sizeof path, "%s/binaries/%s/%s.so", f->dir, f->version->platform, f->description.identifier);
  snprintf(platforms, sizeof platforms, "%s/binaries", f->dir);
  if (access(path, R_OK) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL,
                    "%s: has no binary for this platform (binaries/%s/%s.so)%s; export it for 64-bit Linux", f->file,
                    f->version->platform, f->description.identifier,
                    access(platforms, R_OK) == 0 ? ", only for others" : "");
  f->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!f->library)
    return tdm_fail(err, TDM_ERR_FILE, NULL,
                    "%s: its binary cannot be loaded: %s; TMPDIR must be on a file system that allows programs",
                    f->file, dlerror());
  f->table = calloc(1, f->version->table_size);
  if (!f->table)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return find_functions(f, err);
}

tdm_status tdm_fmu_open(tdm_fmu **fmu, const char *file, tdm_error *err) {
  char path[TDM_FMI_DIR_MAX + 32];
  tdm_fmu *f = *fmu = calloc(1, sizeof *f);
  if (!f)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  f->file = file;
  if (tdm_archive_unpack(file, f->dir, err) != TDM_OK)
    return err->status;
  snprintf(path, sizeof path, "%s/modelDescription.xml", f->dir);
  if (tdm_description_read(&f->description, path, file, err) != TDM_OK)
    return err->status;
  f->version = f->description.version == 3 ? &tdm_fmu_version3 : &tdm_fmu_version2;
  return load_binary(f, err);
}

void tdm_fmu_close(tdm_fmu **fmu) {
  tdm_fmu *f = *fmu;
  *fmu = NULL;
  if (!f)
    return;
  tdm_fmu_end(f);
  if (f->library && f->worst < 4)
    dlclose(f->library);
  tdm_archive_remove(f->dir);
  tdm_description_free(&f->description);
  free(f->table);
  free(f);
}

/* ---- calls ---- */

/* What the FMU's last call has returned. */
static tdm_status judge(tdm_fmu *f, int status, const char *path, tdm_error *err) {
  static const struct {
    const char *word, *cure;
  } statuses[] = {[2] = {"discard", "; it cannot do that: where it is a step, a smaller mbd.step may help"},
                  [3] = {"error", "; it cannot go on"},
                  [4] = {"fatal", "; all of it is beyond repair"},
                  [5] = {"pending", "; it steps asynchronously, which tandem-fmu does not take"},
                  [6] = {"a status that the standard does not know", ""}};
  if (status == 0 || status == 1)
    return TDM_OK;
  const int known = status >= 2 && status <= 5 ? status : 6;
  const int bad = known <= 4 ? known : 3; /* what else may come is as an error */
  if (bad > f->worst)
    f->worst = bad;
  return tdm_fail(err, TDM_ERR_NUMERIC, path, "%s: %s at t = %.9g s returned %s%s%s%s", f->file, last_call, f->t,
                  statuses[known].word, f->said[0] ? ": " : "", f->said, statuses[known].cure);
}

tdm_status tdm_fmu_instantiate(tdm_fmu *f, tdm_error *err) {
  f->said[0] = 0;
  f->worst = 0;
  f->running = false;
  f->instance = f->version->instantiate(f);
  if (f->instance)
    return TDM_OK;
  return tdm_fail(err, TDM_ERR_FILE, NULL,
                  "%s: %s gave no instance%s%s; often its %s \"%s\" is not that of its binary, or a licence or a file "
                  "is missing: export it again",
                  f->file, f->version->make, f->said[0] ? ": " : "", f->said,
                  f->description.version == 3 ? "instantiationToken" : "GUID", f->description.token);
}

tdm_status tdm_fmu_initialize(tdm_fmu *f, const tdm_fmu_experiment *experiment, tdm_error *err) {
  f->t = experiment->start;
  if (judge(f, f->version->enter(f, experiment), NULL, err) != TDM_OK)
    return err->status;
  f->running = judge(f, f->version->leave(f), NULL, err) == TDM_OK;
  return err->status;
}

tdm_status tdm_fmu_get(tdm_fmu *f, const uint32_t *reference, int n, double *value, int nvalue, tdm_error *err) {
  if (n == 0)
    return TDM_OK;
  if (judge(f, f->version->get(f, reference, n, value, nvalue), NULL, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < nvalue; i++)
    if (!isfinite(value[i]))
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "%s: at t = %.9g s an output is not a finite number", f->file, f->t);
  return TDM_OK;
}

tdm_status tdm_fmu_set(tdm_fmu *f, const uint32_t *reference, int n, const double *value, int nvalue, tdm_error *err) {
  return n == 0 ? TDM_OK : judge(f, f->version->set(f, reference, n, value, nvalue), NULL, err);
}

tdm_status tdm_fmu_step(tdm_fmu *f, double t, double h, bool never_back, tdm_error *err) {
  f->t = t;
  if (judge(f, f->version->step(f, t, h, never_back), NULL, err) == TDM_OK)
    f->t = t + h;
  return err->status;
}

tdm_status tdm_fmu_keep(tdm_fmu *f, void **state, tdm_error *err) {
  return judge(f, f->version->keep(f, state), NULL, err);
}

tdm_status tdm_fmu_go_back(tdm_fmu *f, void *state, tdm_error *err) {
  return judge(f, f->version->go_back(f, state), NULL, err);
}

void tdm_fmu_forget(tdm_fmu *f, void **state) {
  if (*state && f->instance && f->worst < 3)
    f->version->forget(f, state);
  *state = NULL;
}

tdm_status tdm_fmu_derivative(tdm_fmu *f, const uint32_t *unknown, int nunknown, const uint32_t *known, int nknown,
                              const double *seed, int nseed, double *derivative, int nderivative, tdm_error *err) {
  return judge(f, f->version->derivative(f, unknown, nunknown, known, nknown, seed, nseed, derivative, nderivative),
               NULL, err);
}

void tdm_fmu_end(tdm_fmu *f) {
  if (f->instance && f->running && f->worst < 3)
    f->version->terminate(f);
  if (f->instance && f->worst < 4)
    f->version->release(f);
  f->instance = NULL;
}

/* ---- parameters and start values ---- */

enum { ELEMENTS_MAX = 4096 };

/* The numbers of a value for an array or a scalar of v->size elements; false: it has others. */
static bool read_elements(const tdm_fmi_variable *v, json_t *value, double *out, int *n) {
  const size_t count = json_is_array(value) ? json_array_size(value) : 1;
  if (count == 0 || count > ELEMENTS_MAX || (v->size > 0 && count != (size_t)v->size))
    return false;
  for (size_t i = 0; i < count; i++) {
    json_t *element = json_is_array(value) ? json_array_get(value, i) : value;
    if (v->type == TDM_FMI_BOOLEAN ? !json_is_boolean(element) : !json_is_number(element))
      return false;
    out[i] = json_is_boolean(element) ? json_is_true(element) : json_number_value(element);
    const bool whole = floor(out[i]) == out[i] && fabs(out[i]) < 2147483648.0;
    if (v->type != TDM_FMI_REAL && !whole)
      return false;
  }
  *n = (int)count;
  return true;
}

tdm_status tdm_fmu_set_start(tdm_fmu *f, const tdm_fmi_variable *v, json_t *value, const char *path, tdm_error *err) {
  static const char *const wanted[] = {"a number", "a whole number", "true or false", "text", "a whole number"};
  double real[ELEMENTS_MAX];
  long whole[ELEMENTS_MAX];
  int n = 0;
  if (v->type == TDM_FMI_OTHER)
    return tdm_fail(err, TDM_ERR_SCENE, path, "the variable \"%s\" of %s is of type %s, which tandem-fmu cannot set",
                    v->name, f->file, v->type_name ? v->type_name : "?");
  if (v->type == TDM_FMI_STRING && json_is_string(value))
    return judge(f, f->version->set_text(f, v->reference, json_string_value(value)), path, err);
  if (v->type == TDM_FMI_STRING || !read_elements(v, value, real, &n))
    return tdm_fail(err, TDM_ERR_SCENE, path, "the variable \"%s\" of %s is of type %s: give %s%s", v->name, f->file,
                    v->type_name, wanted[v->type], v->size == 1 ? "" : " for each of its elements, as a list");
  if (v->type == TDM_FMI_REAL)
    return judge(f, f->version->set(f, &v->reference, 1, real, n), path, err);
  for (int i = 0; i < n; i++)
    whole[i] = (long)real[i];
  return judge(f, f->version->set_integers(f, v->type, v->reference, whole, n), path, err);
}

#include "coupler/check.h"

#include "coupler/scheme/scheme.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* One line of a report: its path without the solver, and a value; objects go down, arrays of numbers stay on a line. */
static void print_value(const char *path, const json_t *value) {
  char deeper[TDM_PATH_MAX];
  const char *key;
  size_t i;
  json_t *child;
  if (json_is_object(value)) {
    json_object_foreach((json_t *)value, key, child) {
      snprintf(deeper, sizeof deeper, "%s%s%s", path, *path ? "." : "", key);
      print_value(deeper, child);
    }
    return;
  }
  if (json_is_array(value) && json_array_size(value) > 0 && !json_is_number(json_array_get(value, 0))) {
    json_array_foreach(value, i, child) {
      snprintf(deeper, sizeof deeper, "%s[%zu]", path, i);
      print_value(deeper, child);
    }
    return;
  }
  printf("  %-28s ", path);
  if (json_is_string(value))
    printf("%s", json_string_value(value));
  else if (json_is_integer(value))
    printf("%lld", (long long)json_integer_value(value));
  else if (json_is_real(value))
    printf("%.6g", json_real_value(value));
  else if (json_is_boolean(value))
    printf("%s", json_is_true(value) ? "yes" : "no");
  else if (json_is_array(value))
    json_array_foreach(value, i, child) printf("%s%.6g", i ? " " : "", json_number_value(child));
  else
    printf("-");
  printf("\n");
}

static void print_coupling(const cpl_settings *s, const cpl_session *session) {
  printf("run\n");
  printf("  %-28s %g s in %llu DEM steps of %g s\n", "time", s->time_end, (unsigned long long)cpl_total_steps(s),
         s->dt);
  printf("  %-28s n = %ld: %llu windows of %g s\n", "windows", s->n, (unsigned long long)cpl_total_windows(s),
         (double)s->n * s->dt);
  printf("  %-28s %s: %s\n", "scheme", s->scheme->name, s->scheme->summary);
  printf("  %-28s every %g s: %.0f rows\n", "time histories", s->output_interval,
         floor((double)cpl_total_steps(s) * s->dt / s->output_interval + 1e-6) + 1);
  for (int i = 0; i < s->nbody; i++)
    printf("  %-28s \"%s\" (mbd) is \"%s\" (dem), %g kg, load at the start %.6g N\n", i ? "" : "coupled bodies",
           s->body[i].name[CPL_MBD], s->body[i].name[CPL_DEM], session->body[i].mass, tdm_norm(session->load[i].force));
}

void cpl_check_print(const cpl_settings *settings, const cpl_session *session) {
  print_coupling(settings, session);
  for (int r = 0; r < CPL_NROLE; r++) {
    const cpl_partner *p = &session->partner[r];
    printf("%s: %s\n", cpl_role_names[r], p->software);
    print_value("", p->report);
  }
  printf("%zu warning%s\n", json_array_size(session->warnings), json_array_size(session->warnings) == 1 ? "" : "s");
}

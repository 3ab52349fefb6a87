/* What channels are called where people read them: see words.h. To name a channel: a row. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/contents/words.h"

#include <stdio.h>
#include <string.h>

/* what stands before the component of a vector */
static const struct {
  const char *name, *words;
} vectors[] = {
    {"", "position"},
    {"q", "orientation (quaternion)"},
    {"v", "velocity"},
    {"w", "angular velocity"},
    {"a", "acceleration"},
    {"alpha", "angular acceleration"},
    {"f", "force"},
    {"m", "moment"},
    {"u", "displacement"},
    {"phi", "rotation"},
    {"com.", "centre of mass"},
    {"velocity.", "mean velocity"},
    {"impulse.", "impulse"},
    {"angular_impulse.", "angular impulse"},
};

/* channels with one number */
static const struct {
  const char *name, *unit, *words; /* unit NULL: any */
  const char *curve;               /* what the curve is called, where curves of one quantity share a panel; else NULL */
} scalars[] = {
    {"rate", "rad/s", "angular velocity", NULL},
    {"value", "N", "force", NULL},
    {"value", "N m", "torque", NULL},
    {"f", "N", "size of the force", NULL},
    {"m", "N m", "size of the moment", NULL},
    {"sliding", NULL, "direction of sliding", NULL},
    {"drift", "m", "drift of the states", NULL},
    {"drift_angle", NULL, "drift of the states", NULL},
    {"count", NULL, "number of particles", NULL},
    {"impact_speed", NULL, "highest speed of impacts", NULL},
    {"lost", NULL, "particles lost", NULL},
    {"left", NULL, "particles that left the domain", NULL},
    {"mass", "kg", "mass", NULL},
    {"created", NULL, "particles created", NULL},
    {"waiting", NULL, "particles that wait", NULL},
    {"removed", NULL, "particles removed", NULL},
    {"number", NULL, "particles unaccounted for", NULL},
    {"rate", "1/s", "outflow", "now"},
    {"mean_rate", "1/s", "outflow", "mean of the discharge"},
    {"sorted", "1", "particles that left", "sorted"},
    {"undersized", "1", "particles that left", "undersized"},
    {"sorted_mass", "kg", "mass that left", "sorted"},
    {"undersized_mass", "kg", "mass that left", "undersized"},
    {"efficiency", "%", "efficiency", "by number"},
    {"efficiency_mass", "%", "efficiency", "by mass"},
    {"rate", "kg/s", "output rate", "mean"},
    {"rate_now", "kg/s", "output rate", "of late"},
    {"share", "%", "share of undersized by mass", NULL},
    {"fed", "1", "particles of the product", "fed"},
    {"inside", "1", "particles of the product", "inside"},
    {"blocked", "1", "blocked holes", "now"},
    {"blocked_most", "1", "blocked holes", "most so far"},
    {"blocked_share", "%", "share of holes that are blocked", NULL},
    {"held", "1", "particles held on one spot", NULL},
    {"out", "1", "particles of the product", "left by outlets"},
};

/* The length of a vector's name before its component; -1: it is none. */
static int vector_stem(const char *name) {
  const size_t n = strlen(name);
  if (n == 0 || !strchr("xyzw", name[n - 1]))
    return -1;
  for (size_t k = 0; k < sizeof vectors / sizeof vectors[0]; k++)
    if (strlen(vectors[k].name) == n - 1 && strncmp(vectors[k].name, name, n - 1) == 0)
      return name[n - 1] != 'w' || strcmp(name, "qw") == 0 ? (int)k : -1;
  return -1;
}

/* "kinetic_energy" as "kinetic energy" */
static void plain(char *out, size_t size, const char *name) {
  snprintf(out, size, "%s", name);
  for (char *c = out; *c; c++)
    if (*c == '_' || *c == '.')
      *c = ' ';
}

cpl_words cpl_words_of(const char *name, const char *unit) {
  cpl_words w = {0};
  const size_t n = strlen(name);
  const int k = vector_stem(name);
  if (k >= 0) {
    w.vector = true;
    snprintf(w.quantity, sizeof w.quantity, "%s", vectors[k].words);
    snprintf(w.component, sizeof w.component, "%s", name + n - 1);
    return w;
  }
  if (n > 2 && name[n - 2] == '.' && strchr("xyz", name[n - 1])) { /* another solver's vector */
    w.vector = true;
    plain(w.quantity, sizeof w.quantity, name);
    w.quantity[strlen(w.quantity) > 2 ? strlen(w.quantity) - 2 : 0] = 0;
    snprintf(w.component, sizeof w.component, "%s", name + n - 1);
    return w;
  }
  plain(w.component, sizeof w.component, name);
  w.shared = strcmp(unit, "J") == 0;
  snprintf(w.quantity, sizeof w.quantity, "%s", w.shared ? "energy" : w.component);
  for (size_t i = 0; i < sizeof scalars / sizeof scalars[0]; i++)
    if (strcmp(name, scalars[i].name) == 0 && (!scalars[i].unit || strcmp(unit, scalars[i].unit) == 0)) {
      snprintf(w.quantity, sizeof w.quantity, "%s", scalars[i].words);
      w.shared = scalars[i].curve != NULL;
      if (w.shared)
        snprintf(w.component, sizeof w.component, "%s", scalars[i].curve);
    }
  return w;
}

const char *cpl_words_unit(const char *unit, char *out, unsigned size) {
  const size_t n = strlen(unit);
  if (strcmp(unit, "1") == 0 || n == 0)
    snprintf(out, size, "-");
  else if (n > 2 && unit[n - 1] == '2' && unit[n - 2] == 's')
    snprintf(out, size, "%.*s\u00b2", (int)(n - 1), unit);
  else
    snprintf(out, size, "%s", unit);
  return out;
}

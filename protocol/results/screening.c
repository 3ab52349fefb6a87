/* What a run that measures screening comes to: see screening.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/screening.h"

#include <math.h>
#include <string.h>

static const char all[] = "screening", decks[] = "decks";

/* the member of an object that is an object itself, made if it is not there */
static json_t *member(json_t *of, const char *key) {
  if (!json_object_get(of, key))
    json_object_set_new(of, key, json_object());
  return json_object_get(of, key);
}

void tdm_screening_enter(json_t *summary, const char *channel, const char *unit, double value) {
  const size_t n = strlen(all);
  if (strncmp(channel, all, n) != 0 || channel[n] != '.')
    return;
  json_t *to = member(summary, all);
  const char *name = channel + n + 1, *dot = strchr(name, '.');
  if (dot) {
    char deck[64];
    snprintf(deck, sizeof deck, "%.*s", (int)(dot - name), name);
    to = member(member(to, decks), deck);
    name = dot + 1;
  }
  json_t *number = !isfinite(value)         ? json_null()
                   : strcmp(unit, "1") == 0 ? json_integer((json_int_t)value)
                                            : json_real(value);
  json_object_set_new(to, name, number);
}

/* Member `key` as a number of so many decimals, or - where it is not defined; into out. Returns out. */
static const char *text_of(const json_t *of, const char *key, int decimals, char out[48]) {
  const json_t *value = json_object_get(of, key);
  if (json_is_number(value))
    snprintf(out, 48, "%.*f", decimals, json_number_value(value));
  else
    snprintf(out, 48, "-");
  return out;
}

void tdm_screening_print(FILE *f, const json_t *summary) {
  const json_t *screening = json_object_get(summary, all);
  const char *name;
  json_t *deck;
  char text[5][48];
  if (!screening)
    return;
  fprintf(f, "screening: %s particles fed, %s inside, %s lost; efficiency %s %% by number, %s %% by mass\n",
          text_of(screening, "fed", 0, text[0]), text_of(screening, "inside", 0, text[1]),
          text_of(screening, "lost", 0, text[2]), text_of(screening, "efficiency", 2, text[3]),
          text_of(screening, "efficiency_mass", 2, text[4]));
  fprintf(f, "  %-16s %10s %10s %12s %12s\n", "deck", "sorted", "undersized", "number [%]", "mass [%]");
  json_object_foreach(json_object_get(screening, decks), name, deck)
      fprintf(f, "  %-16s %10s %10s %12s %12s\n", name, text_of(deck, "sorted", 0, text[0]),
              text_of(deck, "undersized", 0, text[1]), text_of(deck, "efficiency", 2, text[2]),
              text_of(deck, "efficiency_mass", 2, text[3]));
}

/* The statements of an Adams data set: see statement.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/statement.h"

#include "protocol/scene/input.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Bytes of a file at most: a hundred times what the largest rigid machines have. Attributes of a statement. */
enum { MOST_BYTES = 1 << 28, MOST_ATTRIBUTES = 1000 };

/* Larger numbers are refused. */
static const double most_number = 1e60;

static const char blanks[] = " \t\r\n\f\v";

/* What is not here may move something. */
static const struct {
  const char *keyword;
  adm_meaning meaning;
} keywords[] = {
    {"UNITS", ADM_READ},       {"PART", ADM_READ},         {"MARKER", ADM_READ},    {"JOINT", ADM_READ},
    {"JPRIM", ADM_READ},       {"GCON", ADM_READ},         {"COUPLER", ADM_READ},   {"MOTION", ADM_READ},
    {"SFORCE", ADM_READ},      {"SPRINGDAMPER", ADM_READ}, {"BUSHING", ADM_READ},   {"SPLINE", ADM_READ},
    {"ACCGRAV", ADM_READ},     {"END", ADM_READ},          {"GRAPHICS", ADM_SHOWN}, {"REQUEST", ADM_SHOWN},
    {"MREQUEST", ADM_SHOWN},   {"OUTPUT", ADM_SHOWN},      {"RESULTS", ADM_SHOWN},  {"VARIABLE", ADM_SHOWN},
    {"STRING", ADM_SHOWN},     {"ARRAY", ADM_SHOWN},       {"MATRIX", ADM_SHOWN},   {"INTEGRATOR", ADM_SHOWN},
    {"DEBUG", ADM_SHOWN},      {"LSOLVER", ADM_SHOWN},     {"IC", ADM_SHOWN},       {"EQUILIBRIUM", ADM_SHOWN},
    {"KINEMATICS", ADM_SHOWN}, {"PREFERENCES", ADM_SHOWN}, {"PINPUT", ADM_SHOWN},   {"POUTPUT", ADM_SHOWN},
    {"GFORCE", ADM_ACTS},      {"VFORCE", ADM_ACTS},       {"VTORQUE", ADM_ACTS},   {"NFORCE", ADM_ACTS},
    {"CONTACT", ADM_ACTS},     {"FRICTION", ADM_ACTS},     {"BEAM", ADM_ACTS},      {"FIELD", ADM_ACTS},
    {"GEAR", ADM_ACTS},        {"SENSOR", ADM_ACTS},       {"POINT_MASS", ADM_ACTS}};
enum { NKEYWORD = sizeof keywords / sizeof keywords[0] };

tdm_status adm_fail(const adm_dataset *d, int line, tdm_error *err, const char *format, ...) {
  char message[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  tdm_utf8_clean(message);
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s:%d: %s", d->file, line, message);
}

/* ---- words ---- */

static bool is_word(char c) {
  return isalnum((unsigned char)c) || c == '_';
}

/* The word at p in capitals, cut to what fits; returns what is behind it. */
static const char *take_word(const char *p, char word[ADM_WORD_MAX + 1]) {
  int n = 0;
  for (; is_word(*p); p++)
    if (n < ADM_WORD_MAX)
      word[n++] = (char)toupper((unsigned char)*p);
  word[n] = 0;
  return p;
}

/* Whether `word` is `full` or the beginning of it. */
static bool begins(const char *full, const char *word) {
  return *word && strncmp(full, word, strlen(word)) == 0;
}

/* The full name that `word` stands for: itself, or the only one that begins so. NULL: none, or more than one. */
static const char *in_full(const char *word, const char *const *names) {
  const char *found = NULL;
  bool several = false;
  for (int i = 0; names[i]; i++) {
    if (strcmp(names[i], word) == 0)
      return names[i];
    if (begins(names[i], word)) {
      several = found != NULL;
      found = names[i];
    }
  }
  return several ? NULL : found;
}

/* ---- lines ---- */

typedef struct {
  adm_dataset *d;
  FILE *stream;
  char *line;
  size_t size, used, room; /* of line; of the last statement's text */
  int number, seen;        /* line; line of the text's end */
  long room_statements;
  bool goes_on, ended; /* the last line ended in &; END was there */
  char view_name[ADM_VIEW_NAME_MAX + 1];
} source;

/* The name that Adams View leaves in the comment before a statement. */
static void note_view_name(source *s, const char *comment) {
  static const char key[] = "adams_view_name='";
  const char *at = strstr(comment, key);
  if (!at)
    return;
  at += strlen(key);
  snprintf(s->view_name, sizeof s->view_name, "%.*s", (int)strcspn(at, "'"), at);
}

static tdm_status append(source *s, const char *text, tdm_error *err) {
  adm_statement *last = &s->d->statement[s->d->n - 1];
  const size_t gap = (size_t)(s->number - s->seen), n = strlen(text);
  if (s->used + gap + n + 1 > s->room) {
    const size_t room = 2 * (s->used + gap + n + 1);
    char *more = realloc(last->text, room);
    if (!more)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %s", s->d->file);
    last->text = more;
    s->room = room;
  }
  memset(last->text + s->used, '\n', gap);
  memcpy(last->text + s->used + gap, text, n + 1);
  s->used += gap + n;
  s->seen = s->number;
  return TDM_OK;
}

static void name_keyword(adm_statement *of, const char *word) {
  const char *names[NKEYWORD + 1] = {NULL};
  for (int i = 0; i < NKEYWORD; i++)
    names[i] = keywords[i].keyword;
  const char *full = strlen(word) >= 3 || strcmp(word, "IC") == 0 ? in_full(word, names) : NULL;
  snprintf(of->keyword, sizeof of->keyword, "%s", full ? full : word);
  of->meaning = ADM_ACTS;
  for (int i = 0; i < NKEYWORD && full; i++)
    if (keywords[i].keyword == full)
      of->meaning = keywords[i].meaning;
}

static tdm_status begin_statement(source *s, const char *text, tdm_error *err) {
  adm_dataset *d = s->d;
  char word[ADM_WORD_MAX + 1];
  if (!isalpha((unsigned char)text[0]))
    return adm_fail(d, s->number, err,
                    "\"%.40s\" is no statement (KEYWORD/id, ...), no continuation (, ...) and no comment (! ...)",
                    text);
  const char *p = take_word(text, word);
  p += strspn(p, blanks);
  if (d->n == s->room_statements) {
    const long room = s->room_statements ? 2 * s->room_statements : 64;
    adm_statement *more = realloc(d->statement, (size_t)room * sizeof *more);
    if (!more)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %s", d->file);
    d->statement = more;
    s->room_statements = room;
  }
  adm_statement *of = &d->statement[d->n++];
  *of = (adm_statement){.line = s->number};
  name_keyword(of, word);
  memcpy(of->view_name, s->view_name, sizeof of->view_name);
  s->view_name[0] = 0;
  s->used = s->room = 0;
  s->seen = s->number;
  if (*p == '/') {
    p += 1 + strspn(p + 1, blanks);
    char *end = NULL;
    errno = 0;
    if (isdigit((unsigned char)*p)) {
      of->id = strtol(p, &end, 10);
      if (errno || of->id > INT_MAX || is_word(*end) || *end == '.')
        return adm_fail(d, s->number, err, "%s/%.20s: the identifier must be a whole number up to %d", of->keyword, p,
                        INT_MAX);
      p = end;
    }
  } else if (*p && *p != ',')
    return adm_fail(d, s->number, err, "\"%.40s\" is no statement: a / must follow the keyword, as in MARKER/12", text);
  if (strcmp(of->keyword, "END") == 0) {
    s->ended = true;
    d->n--;
    return TDM_OK;
  }
  return append(s, p, err);
}

/* One line without its comment, in place; "" where nothing is left. */
static char *strip(source *s) {
  char *comment = strchr(s->line, '!');
  if (comment) {
    note_view_name(s, comment);
    *comment = 0;
  }
  char *text = s->line + strspn(s->line, blanks);
  size_t n = strlen(text);
  while (n > 0 && strchr(blanks, text[n - 1]))
    text[--n] = 0;
  return text;
}

static tdm_status take_line(source *s, tdm_error *err) {
  char *text = strip(s);
  if (!*text)
    return TDM_OK;
  const bool comma = *text == ',', continues = comma || s->goes_on;
  size_t n = strlen(text);
  s->goes_on = text[n - 1] == '&';
  if (s->goes_on)
    text[n - 1] = ' ';
  if (!continues)
    return begin_statement(s, text, err);
  if (s->d->n == 0)
    return adm_fail(s->d, s->number, err, "goes on with a statement, but none stands before it");
  return append(s, comma ? text + 1 : text, err);
}

static tdm_status read_lines(source *s, tdm_error *err) {
  ssize_t length;
  while (!s->ended && (length = getline(&s->line, &s->size, s->stream)) >= 0) {
    s->number++;
    if (strlen(s->line) != (size_t)length)
      return adm_fail(s->d, s->number, err, "has a byte 0, so this is no text; give the data set that Adams reads");
    if (s->number == 1) {
      const char *title = strip(s);
      static const char view[] = "ADAMS/View model name:";
      title += strncmp(title, view, sizeof view - 1) == 0 ? sizeof view - 1 : 0;
      snprintf(s->d->title, sizeof s->d->title, "%s", title + strspn(title, blanks));
      tdm_utf8_clean(s->d->title);
    } else if (take_line(s, err) != TDM_OK)
      return err->status;
  }
  if (ferror(s->stream))
    return adm_fail(s->d, s->number, err, "cannot be read on: %s", strerror(errno));
  if (!s->ended)
    return adm_fail(s->d, s->number, err, "the file ends without END: it was cut off, or its last line END is missing");
  return TDM_OK;
}

tdm_status adm_dataset_read(adm_dataset *d, const char *file, tdm_error *err) {
  const char *why;
  source s = {.d = d};
  struct stat is;
  d->file = file;
  s.stream = tdm_open_input(file, false, &why);
  if (!s.stream)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be opened: %s; check the name and the folder", file, why);
  if (fstat(fileno(s.stream), &is) == 0 && is.st_size > MOST_BYTES)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: the file has more than %d MB; is it a data set?", file, MOST_BYTES >> 20);
  else
    read_lines(&s, err);
  free(s.line);
  fclose(s.stream);
  return err->status;
}

void adm_dataset_free(adm_dataset *d) {
  for (int i = 0; i < d->n; i++)
    free(d->statement[i].text);
  free(d->statement);
  *d = (adm_dataset){0};
}

/* ---- numbers ---- */

bool adm_scan_number(const char **at, double *x) {
  char digits[64];
  const char *p = *at, *end;
  p += *p == '+' || *p == '-';
  const char *mantissa = p;
  p += strspn(p, "0123456789");
  p += *p == '.';
  p += strspn(p, "0123456789");
  if (p == mantissa || (p == mantissa + 1 && *mantissa == '.') || p - *at > 40)
    return false;
  end = p;
  int n = snprintf(digits, sizeof digits, "%.*s", (int)(p - *at), *at);
  const bool d = *p == 'd' || *p == 'D', e = *p == 'e' || *p == 'E';
  if (d || e) { /* 1.0E-3, 1.0D-3; a D alone: degrees */
    const char *power = p + 1 + (p[1] == '+' || p[1] == '-');
    const size_t length = strspn(power, "0123456789");
    if (length > 0 && length < 6) {
      snprintf(digits + n, sizeof digits - (size_t)n, "e%.*s", (int)(power + length - p - 1), p + 1);
      end = p = power + length;
    }
  }
  *x = strtod(digits, NULL);
  if ((*p == 'd' || *p == 'D') && !is_word(p[1])) {
    *x *= M_PI / 180;
    end = p + 1;
  }
  *at = end;
  return fabs(*x) <= most_number;
}

/* ---- attributes ---- */

/* A value goes on until a word follows that is no part of it: numbers may, the first word always does. */
static const char *value_end(const char *p) {
  const char *end = p;
  for (int token = 0; *p; token++) {
    p += strspn(p, ", \t\n");
    if (!*p || (token > 0 && (isalpha((unsigned char)*p) || *p == '_')))
      break;
    p += strcspn(p, ", \t\n=");
    if (*p == '=')
      break;
    end = p;
  }
  return end;
}

static int lines_between(const char *from, const char *to) {
  int n = 0;
  for (; from < to; from++)
    n += *from == '\n';
  return n;
}

static tdm_status read_attribute(adm_reader *r, const char **at, int line, const char *const *names) {
  adm_attribute *a = &r->attribute[r->n];
  *a = (adm_attribute){.line = line};
  const char *p = *at;
  if (!isalpha((unsigned char)*p))
    return adm_fail(r->dataset, a->line, r->err, "%s/%ld cannot be read at \"%.30s\"; NAME = value must stand there",
                    r->of->keyword, r->of->id, p);
  p = take_word(p, a->name);
  a->known = in_full(a->name, names);
  r->n++;
  const char *equals = p + strspn(p, blanks);
  if (*equals == '=') {
    const bool raw = a->known && strcmp(a->known, "FUNCTION") == 0;
    p = equals + 1 + strspn(equals + 1, blanks);
    const char *end = raw ? p + strcspn(p, "\\") : value_end(p);
    a->value = strndup(p, (size_t)(end - p));
    if (!a->value)
      return tdm_fail(r->err, TDM_ERR_MEMORY, NULL, "no memory for %s", r->dataset->file);
    p = end;
  }
  *at = p;
  return TDM_OK;
}

tdm_status adm_open(adm_reader *r, const adm_dataset *d, const adm_statement *of, const char *const *names,
                    tdm_error *err) {
  *r = (adm_reader){.dataset = d, .of = of, .err = err};
  const char *p = of->text, *counted = p; /* up to where `line` counts */
  int line = of->line;
  size_t room = 0;
  while (err->status == TDM_OK) {
    p += strspn(p, ", \t\n\\");
    if (!*p)
      break;
    line += lines_between(counted, p);
    counted = p;
    if (r->n == MOST_ATTRIBUTES)
      return adm_fail(d, line, err, "%s/%ld has more than %d attributes; is a line missing?", of->keyword, of->id,
                      MOST_ATTRIBUTES);
    if ((size_t)r->n == room) {
      room = room ? 2 * room : 16;
      adm_attribute *more = realloc(r->attribute, room * sizeof *more);
      if (!more)
        return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %s", d->file);
      r->attribute = more;
    }
    read_attribute(r, &p, line, names);
  }
  for (int i = 0; i < r->n && !err->status; i++)
    if (r->attribute[i].known && adm_find(r, r->attribute[i].known) != &r->attribute[i])
      return adm_fail(d, r->attribute[i].line, err, "%s/%ld has %s twice; keep one", of->keyword, of->id,
                      r->attribute[i].known);
  return err->status;
}

void adm_close(adm_reader *r) {
  for (int i = 0; i < r->n; i++)
    free(r->attribute[i].value);
  free(r->attribute);
  *r = (adm_reader){0};
}

const adm_attribute *adm_find(const adm_reader *r, const char *name) {
  for (int i = 0; i < r->n; i++)
    if (r->attribute[i].known && strcmp(r->attribute[i].known, name) == 0)
      return &r->attribute[i];
  return NULL;
}

int adm_choose(const adm_reader *r, const char *value, int line, const char *const *words) {
  char word[ADM_WORD_MAX + 1] = "";
  take_word(value ? value : "", word);
  const char *full = in_full(word, words);
  for (int i = 0; words[i] && full; i++)
    if (words[i] == full)
      return i;
  adm_fail(r->dataset, line, r->err, "%s/%ld: \"%.30s\" is none of the words that may stand there", r->of->keyword,
           r->of->id, value ? value : "");
  return -1;
}

double *adm_all_numbers(const adm_reader *r, const char *name, int *n) {
  const adm_attribute *a = adm_find(r, name);
  *n = 0;
  if (!a || r->err->status)
    return NULL;
  const char *p = a->value ? a->value : "";
  double *x = malloc((strlen(p) / 2 + 2) * sizeof *x);
  if (!x) {
    tdm_fail(r->err, TDM_ERR_MEMORY, NULL, "no memory for %s", r->dataset->file);
    return NULL;
  }
  while (*(p += strspn(p, ", \t\n"))) {
    const char *start = p;
    if (!adm_scan_number(&p, &x[*n]) || (*p && !strchr(", \t\n", *p))) {
      adm_fail(r->dataset, a->line + lines_between(a->value, start), r->err,
               "%s/%ld: \"%.*s\" in %s is no number up to %g; write it as 12.5, 1.25E1 or, an angle in degrees, 30D",
               r->of->keyword, r->of->id, (int)strcspn(start, ", \t\n"), start, name, most_number);
      break;
    }
    (*n)++;
  }
  if (*n == 0)
    adm_fail(r->dataset, a->line, r->err, "%s/%ld: %s has no number", r->of->keyword, r->of->id, name);
  if (r->err->status) {
    free(x);
    return NULL;
  }
  return x;
}

int adm_numbers(const adm_reader *r, const char *name, int least, int most, double *x) {
  int n;
  double *all = adm_all_numbers(r, name, &n);
  if (!all)
    return 0;
  if (n < least || n > most)
    adm_fail(r->dataset, adm_find(r, name)->line, r->err, "%s/%ld: %s has %d numbers; give %d%s", r->of->keyword,
             r->of->id, name, n, n < least ? least : most,
             least == most ? ""
             : n < least   ? " or more"
                           : " or fewer");
  else
    memcpy(x, all, (size_t)n * sizeof *x);
  free(all);
  return r->err->status ? 0 : n;
}

double adm_number(const adm_reader *r, const char *name, double otherwise) {
  double x;
  return adm_numbers(r, name, 1, 1, &x) == 1 ? x : otherwise;
}

int adm_ids(const adm_reader *r, const char *name, int least, int most, long *id) {
  double x[ADM_IDS_MAX];
  const int n = adm_numbers(r, name, least, most, x);
  for (int i = 0; i < n && !r->err->status; i++)
    if (x[i] >= 1 && x[i] <= INT_MAX && x[i] == floor(x[i]))
      id[i] = (long)x[i];
    else
      adm_fail(r->dataset, adm_find(r, name)->line, r->err,
               "%s/%ld: %g in %s is no identifier of a statement, a whole number from 1", r->of->keyword, r->of->id,
               x[i], name);
  return r->err->status ? 0 : n;
}

long adm_id(const adm_reader *r, const char *name, bool required) {
  long id = 0;
  adm_ids(r, name, 1, 1, &id);
  if (!adm_find(r, name) && required)
    adm_fail(r->dataset, r->of->line, r->err, "%s/%ld has no %s; add it", r->of->keyword, r->of->id, name);
  return r->err->status ? 0 : id;
}

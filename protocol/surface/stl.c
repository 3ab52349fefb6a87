/* STL files: see stl.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/surface/stl.h"

#include "protocol/scene/input.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

enum { HEADER = 84, RECORD = 50 };                    /* bytes of a binary file's head and of a triangle */
enum { TRIANGLES_MAX = INT_MAX / 8, TEXT_AT = 1024 }; /* TEXT_AT: bytes that are looked at to tell text */

typedef struct {
  const char *file, *path;
  tdm_error *err;
  char *bytes; /* the whole file, a zero byte behind it */
  size_t size;
  double scale;
  const char *at; /* text: the next byte */
  long line;
  tdm_stl *stl;
  int capacity;
} reader;

static tdm_status fail(reader *r, tdm_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

static tdm_status fail(reader *r, tdm_status status, const char *format, ...) {
  char message[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  tdm_utf8_clean(message);
  return tdm_fail(r->err, status, r->path, "%s", message);
}

static tdm_status load(reader *r) {
  struct stat info;
  const char *why;
  FILE *f = tdm_open_input(r->file, false, &why);
  if (!f || fstat(fileno(f), &info) != 0) {
    if (f)
      fclose(f);
    return fail(r, TDM_ERR_FILE, "\"%s\" cannot be opened: %s; check the name and the folder", r->file,
                f ? strerror(errno) : why);
  }
  r->size = (size_t)info.st_size;
  r->bytes = malloc(r->size + 1);
  size_t n = r->bytes ? fread(r->bytes, 1, r->size, f) : 0;
  fclose(f);
  if (!r->bytes)
    return fail(r, TDM_ERR_MEMORY, "no memory for the %zu bytes of \"%s\"", r->size, r->file);
  if (n != r->size)
    return fail(r, TDM_ERR_FILE, "\"%s\" could be read to byte %zu of %zu only", r->file, n, r->size);
  r->bytes[r->size] = 0;
  return TDM_OK;
}

/* finite, and small enough for the products of coordinates */
static bool usable(tdm_vec3 x) {
  return fabs(x.x) < 1e15 && fabs(x.y) < 1e15 && fabs(x.z) < 1e15;
}

/* a corner in metres; false: out of what can be computed with, told. `place` is where it stands in the file. */
static bool place_corner(reader *r, tdm_vec3 x, const char *place, tdm_vec3 *out) {
  *out = tdm_scale(r->scale, x);
  if (usable(*out))
    return true;
  if (usable(x))
    fail(r, TDM_ERR_SCENE, "\"scale\" = %g takes a corner of \"%s\" from [%g, %g, %g] to [%g, %g, %g] m; correct it",
         r->scale, r->file, x.x, x.y, x.z, out->x, out->y, out->z);
  else
    fail(r, TDM_ERR_FILE, "\"%s\" %s at [%g, %g, %g] is no number or too large; export it again", r->file, place, x.x,
         x.y, x.z);
  return false;
}

static bool append(reader *r, const tdm_vec3 corner[3]) {
  tdm_stl *s = r->stl;
  if (s->count == r->capacity) {
    int capacity = r->capacity ? 2 * r->capacity : 64;
    tdm_vec3 *grown = s->count < TRIANGLES_MAX ? realloc(s->corner, 3 * (size_t)capacity * sizeof *grown) : NULL;
    if (!grown) {
      fail(r, TDM_ERR_MEMORY, "no memory for the %d triangles of \"%s\"", capacity, r->file);
      return false;
    }
    s->corner = grown;
    r->capacity = capacity;
  }
  memcpy(&s->corner[3 * (size_t)s->count++], corner, 3 * sizeof *corner);
  return true;
}

/* ---- binary ---- */

static uint32_t word(const char *bytes) {
  const unsigned char *b = (const unsigned char *)bytes;
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static double number(const char *bytes) {
  uint32_t w = word(bytes);
  float x;
  memcpy(&x, &w, sizeof x);
  return x;
}

static void read_binary(reader *r) {
  uint32_t n = word(r->bytes + HEADER - 4);
  for (uint32_t t = 0; t < n; t++) {
    size_t at = HEADER + (size_t)RECORD * t + 12; /* behind the normal */
    tdm_vec3 corner[3];
    for (int k = 0; k < 3; k++, at += 12) {
      tdm_vec3 x = tdm_v3(number(r->bytes + at), number(r->bytes + at + 4), number(r->bytes + at + 8));
      char place[64];
      snprintf(place, sizeof place, "byte %zu: triangle %u, a corner", at, t);
      if (!place_corner(r, x, place, &corner[k]))
        return;
    }
    if (!append(r, corner))
      return;
  }
}

/* ---- text ---- */

/* bytes of a byte order mark in front */
static size_t mark_of(const reader *r) {
  return strncmp(r->bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
}

/* Go to the next word and return its length, 0 at the end. */
static size_t next_word(reader *r) {
  for (; isspace((unsigned char)*r->at); r->at++)
    r->line += *r->at == '\n';
  size_t n = 0;
  while (r->at[n] && !isspace((unsigned char)r->at[n]))
    n++;
  return n;
}

static bool is(const reader *r, size_t n, const char *want) {
  return n == strlen(want) && strncasecmp(r->at, want, n) == 0;
}

static bool unexpected(reader *r, size_t n, const char *want) {
  if (n)
    fail(r, TDM_ERR_FILE, "\"%s\" line %ld: \"%.*s\" where \"%s\" must be; export it again", r->file, r->line,
         n > 40 ? 40 : (int)n, r->at, want);
  else
    fail(r, TDM_ERR_FILE, "\"%s\" line %ld: the file ends where \"%s\" must be; it was cut, export it again", r->file,
         r->line, want);
  return false;
}

static bool expect(reader *r, const char *want) {
  size_t n = next_word(r);
  if (!is(r, n, want))
    return unexpected(r, n, want);
  r->at += n;
  return true;
}

static bool read_number(reader *r, double *x) {
  size_t n = next_word(r);
  char *end;
  *x = n ? strtod(r->at, &end) : 0;
  if (!n || end != r->at + n)
    return unexpected(r, n, "a number");
  r->at += n;
  return true;
}

static bool read_corner(reader *r, tdm_vec3 *x) {
  if (!expect(r, "vertex") || !read_number(r, &x->x) || !read_number(r, &x->y) || !read_number(r, &x->z))
    return false;
  char place[64];
  snprintf(place, sizeof place, "line %ld: the vertex", r->line);
  return place_corner(r, *x, place, x);
}

/* behind the word "facet" */
static bool read_facet(reader *r) {
  double unused;
  tdm_vec3 corner[3];
  if (!expect(r, "normal"))
    return false;
  for (int k = 0; k < 3; k++)
    if (!read_number(r, &unused))
      return false;
  if (!expect(r, "outer") || !expect(r, "loop"))
    return false;
  for (int k = 0; k < 3; k++)
    if (!read_corner(r, &corner[k]))
      return false;
  return expect(r, "endloop") && expect(r, "endfacet") && append(r, corner);
}

/* is this word "facet" and the next one "normal"? */
static bool at_facet(const reader *r, size_t n) {
  const char *next = r->at + n + strspn(r->at + n, " \t\r\n");
  return is(r, n, "facet") && strncasecmp(next, "normal", 6) == 0;
}

/* The name of a solid: whatever is left of the line, or of a file in one line until it goes on with a facet or its
 * end. */
static void skip_name(reader *r) {
  const char *end = r->at + strcspn(r->at, "\n");
  for (size_t n; n = next_word(r), n > 0 && r->at < end && !at_facet(r, n) && !is(r, n, "endsolid");)
    r->at += n;
}

/* the name behind "endsolid", to the end of the line; false: there are more facets in it */
static bool skip_end(reader *r) {
  const char *end = r->at + strcspn(r->at, "\n");
  for (size_t n; n = next_word(r), n > 0 && r->at < end; r->at += n)
    if (at_facet(r, n)) {
      fail(r, TDM_ERR_FILE, "\"%s\" line %ld: another solid in the same line; export each into its own lines", r->file,
           r->line);
      return false;
    }
  return true;
}

static void read_text(reader *r) {
  r->at = r->bytes + mark_of(r);
  r->line = 1;
  while (next_word(r) > 0) {
    if (!expect(r, "solid"))
      return;
    skip_name(r);
    size_t n;
    while (n = next_word(r), is(r, n, "facet")) {
      r->at += n;
      if (!read_facet(r))
        return;
    }
    if (!is(r, n, "endsolid")) {
      unexpected(r, n, "facet or endsolid");
      return;
    }
    r->at += n;
    if (!skip_end(r))
      return;
  }
  if (r->at != r->bytes + r->size)
    fail(r, TDM_ERR_FILE, "\"%s\" line %ld: a zero byte in text; export it again", r->file, r->line);
}

/* ---- the file ---- */

/* A text has no zero byte; the head of a binary file may begin with "solid", too, but a count follows it. */
static bool looks_like_text(const reader *r) {
  size_t n = r->size < TEXT_AT ? r->size : TEXT_AT, blank = mark_of(r);
  while (blank < n && isspace((unsigned char)r->bytes[blank]))
    blank++;
  return strncasecmp(r->bytes + blank, "solid", 5) == 0 && !memchr(r->bytes, 0, n);
}

/* so small that the squares of lengths would vanish */
static bool vanishes(const tdm_stl *s) {
  double most = 0;
  for (int k = 1; k < 3 * s->count; k++) {
    tdm_vec3 d = tdm_sub(s->corner[k], s->corner[0]);
    most = fmax(most, fmax(fabs(d.x), fmax(fabs(d.y), fabs(d.z))));
  }
  return most < 1e-15;
}

static void read_bytes(reader *r) {
  uint32_t n = r->size >= HEADER ? word(r->bytes + HEADER - 4) : 0;
  uint64_t need = HEADER + (uint64_t)RECORD * n;
  if (r->size >= HEADER && r->size == need)
    read_binary(r);
  else if (looks_like_text(r))
    read_text(r);
  else if (r->size < HEADER)
    fail(r, TDM_ERR_FILE,
         "\"%s\" is no STL file: it does not begin with \"solid\" and has %zu of the %d bytes of a "
         "binary file's head",
         r->file, r->size, HEADER);
  else
    fail(r, TDM_ERR_FILE,
         "\"%s\" is no whole STL file: its head (byte 80) counts %u triangles, which take %llu bytes, but it has %zu; "
         "export it again",
         r->file, n, (unsigned long long)need, r->size);
  if (!r->err->status && r->stl->count == 0)
    fail(r, TDM_ERR_FILE, "\"%s\" has no triangles; export the part again", r->file);
  if (!r->err->status && vanishes(r->stl))
    fail(r, TDM_ERR_SCENE, "\"scale\" = %g leaves nothing of \"%s\": it is smaller than 1e-15 m; correct it", r->scale,
         r->file);
}

tdm_status tdm_stl_read(tdm_stl *stl, const char *file, double scale, const char *path, tdm_error *err) {
  *stl = (tdm_stl){0};
  reader r = {.file = file, .path = path, .err = err, .scale = scale, .stl = stl};
  if (load(&r) == TDM_OK)
    read_bytes(&r);
  free(r.bytes);
  return err->status;
}

static void put_word(unsigned char *b, uint32_t w) {
  for (int k = 0; k < 4; k++)
    b[k] = (unsigned char)(w >> 8 * k);
}

static void put_vector(unsigned char *b, tdm_vec3 v) {
  const double x[3] = {v.x, v.y, v.z};
  for (int k = 0; k < 3; k++) {
    float f = (float)x[k];
    uint32_t w;
    memcpy(&w, &f, sizeof w);
    put_word(b + 4 * k, w);
  }
}

tdm_status tdm_stl_write(const tdm_stl *stl, const char *file, tdm_error *err) {
  FILE *f = fopen(file, "wb");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" cannot be written: %s", file, strerror(errno));
  unsigned char head[HEADER] = "binary STL of tandem";
  put_word(head + HEADER - 4, (uint32_t)stl->count);
  bool good = fwrite(head, 1, HEADER, f) == HEADER;
  for (int t = 0; t < stl->count && good; t++) {
    const tdm_vec3 *c = &stl->corner[3 * (size_t)t];
    unsigned char record[RECORD] = {0};
    put_vector(record, tdm_unit(tdm_cross(tdm_sub(c[1], c[0]), tdm_sub(c[2], c[0]))));
    for (int k = 0; k < 3; k++)
      put_vector(record + 12 * (k + 1), c[k]);
    good = fwrite(record, 1, RECORD, f) == RECORD;
  }
  good = fclose(f) == 0 && good;
  return good ? TDM_OK : tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" could not be written: %s", file, strerror(errno));
}

void tdm_stl_destroy(tdm_stl *stl) {
  free(stl->corner);
  *stl = (tdm_stl){0};
}

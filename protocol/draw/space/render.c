/* Triangles, balls and thin lines as an image: see render.h.
 *
 * All is drawn into textures of twice the width and height, from which the image is made. Balls are squares whose
 * pixels find out where they meet the ball. Translucent triangles come last, the farthest first.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define GL_GLEXT_PROTOTYPES
#include "protocol/draw/space/render.h"

#include "protocol/draw/space/shaders.h"

#include <GL/osmesa.h>
#include <stdlib.h>
#include <string.h>

enum { OVER = 2 }; /* samples a pixel in each direction; the image shaders take as many */

#ifdef __SANITIZE_ADDRESS__
/* What these libraries keep until the program ends is no leak of ours. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
  return "leak:libOSMesa.so\nleak:libfontconfig.so\n";
}
const char *__lsan_default_options(void);
const char *__lsan_default_options(void) {
  return "print_suppressions=0"; /* what tandem-draw says is taken for an error */
}
#endif

/* ---- lists ---- */

static tdm_status make_room(void **array, size_t *capacity, size_t n, size_t size, tdm_error *err) {
  if (n <= *capacity)
    return TDM_OK;
  size_t room = n + n / 2 + 256;
  void *more = realloc(*array, room * size);
  if (!more)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture");
  *array = more;
  *capacity = room;
  return TDM_OK;
}

tdm_status tdm_vertices_add(tdm_vertices *list, const tdm_vertex *vertex, int count, tdm_error *err) {
  void *array = list->vertex;
  size_t n = (size_t)count;
  if (make_room(&array, &list->capacity, list->count + n, sizeof *vertex, err) != TDM_OK)
    return TDM_ERR_MEMORY;
  list->vertex = array;
  memcpy(list->vertex + list->count, vertex, n * sizeof *vertex);
  list->count += n;
  return TDM_OK;
}

tdm_status tdm_balls_add(tdm_balls *list, const tdm_ball *ball, tdm_error *err) {
  void *array = list->ball;
  if (make_room(&array, &list->capacity, list->count + 1, sizeof *ball, err) != TDM_OK)
    return TDM_ERR_MEMORY;
  list->ball = array;
  list->ball[list->count++] = *ball;
  return TDM_OK;
}

void tdm_drawing_clear(tdm_drawing *d) {
  d->solid.count = d->edges.count = d->glass.count = d->glass_edges.count = d->lines.count = 0;
  d->balls.count = d->dots.count = 0;
}

void tdm_drawing_free(tdm_drawing *d) {
  free(d->solid.vertex);
  free(d->edges.vertex);
  free(d->glass.vertex);
  free(d->glass_edges.vertex);
  free(d->lines.vertex);
  free(d->balls.ball);
  free(d->dots.ball);
  *d = (tdm_drawing){0};
}

/* ---- OpenGL ---- */

struct tdm_renderer {
  OSMesaContext context;
  uint32_t *pixel; /* (width x height) */
  int width, height;
  GLuint mesh, ball, image, flat; /* programs */
  GLuint target, color, depth;
  GLuint vertices, balls, nothing; /* arrays of attributes */
  GLuint buffer;
};

static GLuint compile(GLenum kind, const char *text, tdm_error *err) {
  GLuint shader = glCreateShader(kind);
  GLint good = 0;
  glShaderSource(shader, 1, &text, NULL);
  glCompileShader(shader);
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    char log[512] = "";
    glGetShaderInfoLog(shader, sizeof log, NULL, log);
    tdm_fail(err, TDM_ERR_SYSTEM, NULL, "OpenGL of this machine (OSMesa) cannot draw: %s", log);
  }
  return shader;
}

static GLuint program(const char *vertex, const char *fragment, tdm_error *err) {
  GLuint p = glCreateProgram(), v = compile(GL_VERTEX_SHADER, vertex, err),
         f = compile(GL_FRAGMENT_SHADER, fragment, err);
  GLint good = 0;
  glAttachShader(p, v);
  glAttachShader(p, f);
  glLinkProgram(p);
  glGetProgramiv(p, GL_LINK_STATUS, &good);
  if (!good)
    tdm_fail(err, TDM_ERR_SYSTEM, NULL, "OpenGL of this machine (OSMesa) cannot draw: a shader does not link");
  glDeleteShader(v);
  glDeleteShader(f);
  return p;
}

static void attribute(GLuint index, GLint size, GLenum type, size_t stride, size_t offset) {
  glEnableVertexAttribArray(index);
  glVertexAttribPointer(index, size, type, type == GL_UNSIGNED_BYTE, (GLsizei)stride, (const void *)offset);
}

static void make_arrays(tdm_renderer *r) {
  GLuint names[3];
  glGenBuffers(1, &r->buffer);
  glGenVertexArrays(3, names);
  r->vertices = names[0];
  r->balls = names[1];
  r->nothing = names[2];
  glBindBuffer(GL_ARRAY_BUFFER, r->buffer);
  glBindVertexArray(r->vertices);
  attribute(0, 3, GL_FLOAT, sizeof(tdm_vertex), offsetof(tdm_vertex, position));
  attribute(1, 3, GL_FLOAT, sizeof(tdm_vertex), offsetof(tdm_vertex, normal));
  attribute(2, 4, GL_UNSIGNED_BYTE, sizeof(tdm_vertex), offsetof(tdm_vertex, color));
  glBindVertexArray(r->balls);
  attribute(0, 4, GL_FLOAT, sizeof(tdm_ball), 0);
  attribute(1, 4, GL_UNSIGNED_BYTE, sizeof(tdm_ball), offsetof(tdm_ball, color));
  glVertexAttribDivisor(0, 1);
  glVertexAttribDivisor(1, 1);
}

/* Our image and the textures that it is made from, of this size. */
static tdm_status resize(tdm_renderer *r, int width, int height, tdm_error *err) {
  if (r->pixel && r->width == width && r->height == height)
    return TDM_OK;
  uint32_t *pixel = realloc(r->pixel, (size_t)width * (size_t)height * sizeof *pixel);
  if (!pixel)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture of %d x %d pixels", width, height);
  r->pixel = pixel;
  r->width = width;
  r->height = height;
  if (!OSMesaMakeCurrent(r->context, pixel, GL_UNSIGNED_BYTE, width, height))
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "OpenGL of this machine (OSMesa) makes no pictures of %d x %d pixels",
                    width, height);
  OSMesaPixelStore(OSMESA_Y_UP, 0);
  if (!r->target) {
    make_arrays(r);
    r->mesh = program(shader_mesh_vertex, shader_mesh_fragment, err);
    r->ball = program(shader_ball_vertex, shader_ball_fragment, err);
    r->image = program(shader_image_vertex, shader_image_fragment, err);
    r->flat = program(shader_image_vertex, shader_flat_fragment, err);
    glGenFramebuffers(1, &r->target);
    glGenTextures(1, &r->color);
    glGenTextures(1, &r->depth);
  }
  const struct {
    GLuint texture;
    GLint inside;
    GLenum format, type, place;
  } parts[] = {{r->color, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_COLOR_ATTACHMENT0},
               {r->depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_ATTACHMENT}};
  glBindFramebuffer(GL_FRAMEBUFFER, r->target);
  for (int i = 0; i < 2; i++) {
    glActiveTexture(GL_TEXTURE0 + (GLenum)i);
    glBindTexture(GL_TEXTURE_2D, parts[i].texture);
    glTexImage2D(GL_TEXTURE_2D, 0, parts[i].inside, OVER * width, OVER * height, 0, parts[i].format, parts[i].type,
                 NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glFramebufferTexture2D(GL_FRAMEBUFFER, parts[i].place, GL_TEXTURE_2D, parts[i].texture, 0);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "OpenGL of this machine (OSMesa) makes no pictures of %d x %d pixels",
                    width, height);
  return err->status;
}

tdm_renderer *tdm_renderer_new(tdm_error *err) {
  static const int wanted[] = {OSMESA_FORMAT,
                               OSMESA_BGRA,
                               OSMESA_DEPTH_BITS,
                               0,
                               OSMESA_PROFILE,
                               OSMESA_CORE_PROFILE,
                               OSMESA_CONTEXT_MAJOR_VERSION,
                               3,
                               OSMESA_CONTEXT_MINOR_VERSION,
                               3,
                               0};
  tdm_renderer *r = calloc(1, sizeof *r);
  if (!r) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return NULL;
  }
  r->context = OSMesaCreateContextAttribs(wanted, NULL);
  if (!r->context)
    tdm_fail(err, TDM_ERR_SYSTEM, NULL, "OSMesa makes no OpenGL 3.3; install Debian's libosmesa6");
  else
    resize(r, 64, 64, err);
  if (err->status != TDM_OK) {
    tdm_renderer_free(r);
    return NULL;
  }
  return r;
}

void tdm_renderer_free(tdm_renderer *r) {
  if (!r)
    return;
  if (r->context)
    OSMesaDestroyContext(r->context);
  free(r->pixel);
  free(r);
}

/* ---- a picture ---- */

typedef struct {
  float projection[16]; /* columns one after the other */
  float light[3], up[3];
  bool perspective;
  float reach, pixels, crevice;
} look;

static void set_uniforms(GLuint p, const look *l) {
  glUseProgram(p);
  glUniformMatrix4fv(glGetUniformLocation(p, "projection"), 1, GL_FALSE, l->projection);
  glUniform1i(glGetUniformLocation(p, "perspective"), l->perspective);
  glUniform3fv(glGetUniformLocation(p, "light"), 1, l->light);
  glUniform3fv(glGetUniformLocation(p, "up"), 1, l->up);
  glUniform1f(glGetUniformLocation(p, "opacity"), 1);
  glUniform1f(glGetUniformLocation(p, "nearer"), 0);
  glUniform1f(glGetUniformLocation(p, "reach"), l->reach);
  glUniform1f(glGetUniformLocation(p, "pixels"), l->pixels);
  glUniform1f(glGetUniformLocation(p, "crevice"), l->crevice);
  glUniform1i(glGetUniformLocation(p, "image"), 0);
  glUniform1i(glGetUniformLocation(p, "depth"), 1);
}

static void draw_vertices(const tdm_renderer *r, GLenum kind, const tdm_vertices *list) {
  if (list->count == 0)
    return;
  glUseProgram(r->mesh);
  glBindVertexArray(r->vertices);
  glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(list->count * sizeof *list->vertex), list->vertex, GL_STREAM_DRAW);
  glDrawArrays(kind, 0, (GLsizei)list->count);
}

static void draw_edges(const tdm_renderer *r, const tdm_vertices *list, float width) {
  glUseProgram(r->mesh);
  glUniform1f(glGetUniformLocation(r->mesh, "nearer"), 1e-3f);
  glLineWidth(width);
  draw_vertices(r, GL_LINES, list);
  glUniform1f(glGetUniformLocation(r->mesh, "nearer"), 0);
}

static void draw_balls(const tdm_renderer *r, const tdm_balls *list) {
  if (list->count == 0)
    return;
  glUseProgram(r->ball);
  glBindVertexArray(r->balls);
  glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(list->count * sizeof *list->ball), list->ball, GL_STREAM_DRAW);
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)list->count);
}

static void draw_lines(const tdm_renderer *r, const tdm_drawing *d, float opacity) {
  const GLuint programs[] = {r->mesh, r->ball};
  for (int i = 0; i < 2; i++) {
    glUseProgram(programs[i]);
    glUniform1f(glGetUniformLocation(programs[i], "opacity"), opacity);
  }
  draw_vertices(r, GL_TRIANGLES, &d->lines);
  draw_balls(r, &d->dots);
}

static void draw_all(const tdm_renderer *r, const tdm_drawing *d) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDepthMask(GL_TRUE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  draw_vertices(r, GL_TRIANGLES, &d->solid);
  draw_edges(r, &d->edges, 2);
  if (d->behind)
    glClear(GL_DEPTH_BUFFER_BIT);
  draw_balls(r, &d->balls);
  if (d->behind) {
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_lines(r, d, 1);
    return;
  }
  draw_lines(r, d, 1);
  glDepthMask(GL_FALSE);
  draw_vertices(r, GL_TRIANGLES, &d->glass);
  draw_edges(r, &d->glass_edges, 2);
  glDepthFunc(GL_GREATER);
  draw_lines(r, d, 0.22f);
}

/* ---- order ---- */

static int nearest_first(const void *a, const void *b) {
  const tdm_ball *x = a, *y = b;
  return (x->center[2] < y->center[2]) - (x->center[2] > y->center[2]);
}

static float depth_of(const tdm_vertex *triangle) {
  return triangle[0].position[2] + triangle[1].position[2] + triangle[2].position[2];
}

static int farthest_first(const void *a, const void *b) {
  float x = depth_of(a), y = depth_of(b);
  return (x > y) - (x < y);
}

/* ---- what is hidden ---- */

/* a row of samples that a disc of radius r about (x, y) takes, cut to the image: its columns, none when c0 > c1 */
typedef struct {
  int c0, c1;
} span;

static span span_of(double x, double y, double r, int row, int width) {
  const double dy = row + 0.5 - y, h2 = r * r - dy * dy;
  if (!(h2 > 0))
    return (span){0, -1};
  const double half = sqrt(h2);
  return (span){(int)fmin(fmax(0, ceil(x - half - 0.5)), width), (int)fmin(fmax(-1, floor(x + half - 0.5)), width - 1)};
}

/* Where a ball may be seen, and where it surely hides what is behind: a ten-thousandth of its radius more and less, so
 * that rounding decides nothing. */
static const double seen = 1 + 1e-4, hides = 1 - 1e-4;

/* Without perspective, balls that others hide wholly are taken out: in a heap most are. `nearest` (width x height) has
 * for each sample of the image the depth of what is drawn there. Balls are in order, the nearest first. */
static void cull(tdm_balls *list, const look *l, int width, int height, float *nearest) {
  const double sx = 0.5 * width * l->projection[0], sy = 0.5 * height * l->projection[5];
  size_t left = 0;
  for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
    nearest[i] = -INFINITY;
  for (size_t i = 0; i < list->count; i++) {
    const tdm_ball b = list->ball[i];
    const double x = 0.5 * width + sx * b.center[0], y = 0.5 * height + sy * b.center[1], r = sy * b.radius;
    const float front = b.center[2] + b.radius;
    const int row0 = (int)fmin(fmax(0, floor(y - r - 1)), height), row1 = (int)fmin(fmax(-1, ceil(y + r)), height - 1);
    bool hidden = true;
    for (int row = row0; row <= row1 && hidden; row++) {
      const span s = span_of(x, y, seen * r, row, width);
      const float *at = nearest + (size_t)row * (size_t)width;
      int open = 0;
      for (int column = s.c0; column <= s.c1; column++)
        open |= at[column] < front;
      hidden = !open;
    }
    if (hidden)
      continue;
    list->ball[left++] = b;
    for (int row = row0; row <= row1; row++) {
      const span s = span_of(x, y, hides * r, row, width);
      float *at = nearest + (size_t)row * (size_t)width;
      for (int column = s.c0; column <= s.c1; column++) {
        const double dx = column + 0.5 - x, dy = row + 0.5 - y, h2 = r * r - dx * dx - dy * dy;
        at[column] = fmaxf(at[column], (float)(b.center[2] + sqrt(fmax(0, h2)) / sy));
      }
    }
  }
  list->count = left;
}

/* ---- what is seen ---- */

/* the least and the greatest distance in front of the eye, of all there is */
static void depths(const tdm_drawing *d, double *nearest, double *farthest) {
  const tdm_vertices *lists[] = {&d->solid, &d->edges, &d->glass, &d->glass_edges, &d->lines};
  const tdm_balls *balls[] = {&d->balls, &d->dots};
  *nearest = INFINITY;
  *farthest = -INFINITY;
  for (int l = 0; l < 5; l++)
    for (size_t i = 0; i < lists[l]->count; i++) {
      double z = -lists[l]->vertex[i].position[2];
      *nearest = fmin(*nearest, z);
      *farthest = fmax(*farthest, z);
    }
  for (int l = 0; l < 2; l++)
    for (size_t i = 0; i < balls[l]->count; i++) {
      double z = -balls[l]->ball[i].center[2], r = balls[l]->ball[i].radius;
      *nearest = fmin(*nearest, z - 3 * r); /* the ball's square is turned towards the eye */
      *farthest = fmax(*farthest, z + r);
    }
}

static void project(look *l, const tdm_drawing *d, const tdm_camera *c) {
  double n, f, distance = c->distance / d->unit, half[2] = {c->half[0] / d->unit, c->half[1] / d->unit};
  depths(d, &n, &f);
  if (!(n <= f))
    n = f = distance;
  double more = 1e-3 * (f - n) + 2e-3 * fmax(f, distance); /* edges lie in front of their surfaces */
  n -= more;
  f += more;
  if (c->perspective) {
    f = fmax(f, 1e-3 * distance);
    n = fmax(n, 1e-4 * f);
  }
  float *p = l->projection; /* column-major */
  memset(p, 0, sizeof l->projection);
  l->perspective = c->perspective;
  for (int k = 0; k < 2; k++)
    p[5 * k] = (float)(c->perspective ? distance / half[k] : 1 / half[k]);
  p[10] = (float)(c->perspective ? -(f + n) / (f - n) : -2 / (f - n));
  p[14] = (float)(c->perspective ? -2 * f * n / (f - n) : -(f + n) / (f - n));
  p[11] = c->perspective ? -1 : 0;
  p[15] = c->perspective ? 0 : 1;
}

/* how far crevices are looked for: a few radii of the balls */
static double reach_of(const tdm_drawing *d, double half) {
  double sum = 0;
  for (size_t i = 0; i < d->balls.count; i++)
    sum += d->balls.ball[i].radius;
  double mean = d->balls.count ? sum / (double)d->balls.count : 0.03 * half;
  return fmin(fmax(2.5 * mean, 0.02 * half), 0.12 * half);
}

static look make_look(const tdm_drawing *d, const tdm_camera *c, tdm_vec3 up, int height) {
  look l = {.crevice = c->flat ? 0 : 0.75f};
  double half = c->half[1] / d->unit;
  project(&l, d, c);
  l.reach = (float)reach_of(d, half);
  l.pixels = (float)(l.reach * 0.5 * OVER * height / half * (c->perspective ? c->distance / d->unit : 1));
  const float space[3] = {0.46f, 0.76f, 0.42f}, flat[3] = {0.62f, 0.78f, 0.28f};
  memcpy(l.light, c->flat ? flat : space, sizeof l.light);
  up = tdm_unit(up);
  l.up[0] = (float)tdm_dot(up, c->right);
  l.up[1] = (float)tdm_dot(up, c->up);
  l.up[2] = (float)tdm_dot(up, c->back);
  return l;
}

/* Paper for flat views; in space a light that grows towards the lower edge, against which silhouettes stand out. */
static void background(const tdm_renderer *r, const tdm_camera *c) {
  static const float none[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  static const tdm_vertex sky[4] = {{{-1, 1, 0}, {0, 0, 0}, {255, 255, 255, 255}},
                                    {{1, 1, 0}, {0, 0, 0}, {255, 255, 255, 255}},
                                    {{-1, -1, 0}, {0, 0, 0}, {228, 233, 239, 255}},
                                    {{1, -1, 0}, {0, 0, 0}, {228, 233, 239, 255}}};
  tdm_vertices list = {.vertex = (tdm_vertex *)sky, .count = 4};
  glDepthMask(GL_TRUE);
  glClearColor(1, 1, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  if (c->flat)
    return;
  glDisable(GL_DEPTH_TEST);
  look plain = {0};
  memcpy(plain.projection, none, sizeof none);
  set_uniforms(r->mesh, &plain);
  draw_vertices(r, GL_TRIANGLE_STRIP, &list);
}

tdm_status tdm_render(tdm_renderer *r, tdm_drawing *d, const tdm_camera *camera, tdm_vec3 up, int width, int height,
                      const uint32_t **pixel, tdm_error *err) {
  if (resize(r, width, height, err) != TDM_OK)
    return err->status;
  const look l = make_look(d, camera, up, height);
  if (d->balls.count > 1)
    qsort(d->balls.ball, d->balls.count, sizeof *d->balls.ball, nearest_first);
  float *nearest =
      camera->perspective ? NULL : malloc((size_t)OVER * OVER * (size_t)width * (size_t)height * sizeof *nearest);
  if (nearest)
    cull(&d->balls, &l, OVER * width, OVER * height, nearest);
  free(nearest);
  if (d->glass.count > 3)
    qsort(d->glass.vertex, d->glass.count / 3, 3 * sizeof *d->glass.vertex, farthest_first);
  glBindFramebuffer(GL_FRAMEBUFFER, r->target);
  glViewport(0, 0, OVER * width, OVER * height);
  background(r, camera);
  set_uniforms(r->mesh, &l);
  set_uniforms(r->ball, &l);
  draw_all(r, d);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  set_uniforms(l.crevice > 0 ? r->image : r->flat, &l);
  glBindVertexArray(r->nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glFinish();
  if (glGetError() != GL_NO_ERROR)
    return tdm_fail(err, TDM_ERR_SYSTEM, NULL, "OpenGL of this machine (OSMesa) failed on a picture of %d x %d pixels",
                    width, height);
  *pixel = r->pixel;
  return TDM_OK;
}

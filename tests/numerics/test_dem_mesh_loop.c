/* The contact loops look at DEM_W triangles at a time and ask the mesh where that is not enough: the same bits as
 * always asking it, with each instruction set. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/shape/rows.h"
#include "dem/geometry/shape/shape.h"
#include "dem/numbers/simd_set.h"
#include "test_mesh_support.h"
#include "tests/test_main.h"

#include <unistd.h>

/* ---- a mesh that is always asked ---- */

static dem_shape asked;

static void read_asked(tdm_object *o, int body, dem_wall_list *list) {
  dem_shape_mesh.read(o, body, list);
  if (!o->err->status)
    list->wall[list->count - 1].shape = &asked;
}

static void add_asked(void) {
  if (asked.type)
    return;
  ck_assert_ptr_nonnull(dem_shape_mesh.triangles);
  asked = dem_shape_mesh;
  asked.type = "asked";
  asked.number = 1001;
  asked.read = read_asked;
  asked.triangles = NULL;
  ck_assert_int_eq(dem_shape_add(&asked, NULL), TDM_OK);
}

/* ---- surfaces, about 0.1 m wide ---- */

typedef struct {
  double square, rough; /* side of a square [m]; by how much corners are off their places [m] */
  unsigned hole;        /* one square of so many is missing; 0: none */
  bool cracked;         /* corners of one half are off by round-off */
} surface;

enum { SIDE = 20 };

static tdm_vec3 place_of(const surface *of, int i, int j, bool second) {
  random_state = (uint64_t)(1000 * i + j + 1);
  tdm_vec3 x = tdm_v3(of->square * (i - SIDE / 2), of->square * (j - SIDE / 2), 0);
  x = tdm_axpy(of->rough, tdm_v3(between(-0.5, 0.5), between(-0.5, 0.5), between(-1, 1)), x);
  return of->cracked && second ? tdm_axpy(1e-8, tdm_v3(between(-1, 1), between(-1, 1), between(-1, 1)), x) : x;
}

static void add_surface(tdm_stl *s, const surface *of) {
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j < SIDE; j++) {
      const bool second = i >= SIDE / 2;
      tdm_vec3 a = place_of(of, i, j, second), b = place_of(of, i + 1, j, second);
      tdm_vec3 c = place_of(of, i + 1, j + 1, second), d = place_of(of, i, j + 1, second);
      if (of->hole && (unsigned)(i * 31 + j * 17) % of->hole == 0)
        continue;
      if ((i * 7 + j * 3) % 5 < 2)
        add_quad(s, b, c, d, a);
      else if ((i + j) % 7 == 0) /* turned over */
        add_quad(s, d, c, b, a);
      else
        add_quad(s, a, b, c, d);
    }
}

static void add_soup(tdm_stl *s) {
  random_state = 7;
  for (int t = 0; t < 400; t++) {
    tdm_vec3 a = tdm_v3(between(-0.05, 0.05), between(-0.05, 0.05), between(-0.03, 0.005));
    double size = 0.03 * pow(10, between(-1.5, 0));
    add(s, a, tdm_v3(a.x + size * uniform(), a.y + size * uniform(), a.z - size * uniform()),
        tdm_v3(a.x - size * uniform(), a.y + size * uniform(), a.z + size * uniform()));
  }
}

static const surface surfaces[] = {
    {.square = 0.005},                                  /* flat: corners on a lattice */
    {.square = 0.005, .rough = 2e-4, .hole = 13},       /* facets of a curved wall, and rims */
    {.square = 0.005, .rough = 2e-3},                   /* hills smaller than the balls */
    {.square = 0.0015, .rough = 1e-4, .cracked = true}, /* many triangles a ball; an open seam */
    {.square = 0.02, .rough = 3e-3, .hole = 7},         /* triangles larger than the balls */
};
enum { SURFACES = sizeof surfaces / sizeof *surfaces, MESHES = SURFACES + 2 };

static const char *mesh_file(int kind) {
  static char path[256];
  snprintf(path, sizeof path, "%s/mesh_loop_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  tdm_stl s = {0};
  tdm_error err = {0};
  if (kind < SURFACES)
    add_surface(&s, &surfaces[kind]);
  else if (kind == SURFACES)
    add_soup(&s);
  else
    add_cube(&s, tdm_v3(0, 0, 0.5), 63); /* to be scaled: concave corners, seen from inside */
  ck_assert_msg(!tdm_stl_write(&s, path, &err), "%s", err.message);
  tdm_stl_destroy(&s);
  return path;
}

/* ---- scenes ---- */

#define BALLS "'radius':[0.003,0.006],'count':60"

static rig *scene(const char *type, int kind, const char *balls_of, const char *simd, const char *more) {
  char shape[512], balls[512];
  snprintf(shape, sizeof shape, "{'type':'%s','file':'%s','scale':%g}", type, mesh_file(kind),
           kind == SURFACES + 1 ? 0.06 : 1.0);
  snprintf(balls, sizeof balls,
           "{'type':'random','material':'a',%s,'seed':3,'velocity':[0.3,-0.2,-1],"
           "'region':{'min':[-0.025,-0.025,0.002],'max':[0.025,0.025,0.055]}}",
           balls_of);
  rig *r = rig_make(scene_json("{'gravity':[0,0,-9.81],'simd':'%s','materials':[{'name':'a','density':2500,"
                               "'young_modulus':2e6,'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],"
                               "'restitution':0.5,'friction':0.5}],'bodies':[{'name':'m','material':'a','shapes':[%s],"
                               "'motion':{'angular_velocity':[0.3,0.2,2],'velocity':[0,0.05,0]}}],'particles':[%s]%s}",
                               simd, shape, balls, more),
                    2e-5, 0, NULL);
  unlink(mesh_file(kind));
  return r;
}

static const char *const more[] = {"", ",'energy':true", ",'skin':0.004",
                                   ",'integrator':'multi-step','multi_step':"
                                   "{'substeps':3,'mass':2e-4}"};
enum { WAYS = sizeof more / sizeof *more };

#ifdef __SANITIZE_ADDRESS__
enum { LOOKS = 20 }; /* slow there */
#else
enum { LOOKS = 60 };
#endif

START_TEST(test_same_bits) {
  const int kind = _i / WAYS;
  add_asked();
  for (int s = 0; dem_simd_names[s]; s++) {
    if (!dem_simd_here(dem_simd_names[s]))
      continue;
    rig *a = scene("mesh", kind, BALLS, dem_simd_names[s], more[_i % WAYS]);
    rig *b = scene("asked", kind, BALLS, "plain", more[_i % WAYS]);
    const dem_state *x = &a->data->state, *y = &b->data->state;
    const size_t n = (size_t)x->nparticle;
    long touching = 0;
    for (int k = 0; k < LOOKS; k++) {
      rig_steps(a, 40);
      rig_steps(b, 40);
      touching += x->ncontact;
      ck_assert_int_eq(x->ncontact, y->ncontact);
      ck_assert_msg(
          !memcmp(x->sphere, y->sphere, n * sizeof *x->sphere) && !memcmp(x->rotor, y->rotor, n * sizeof *x->rotor) &&
              !memcmp(x->body_load, y->body_load, sizeof *x->body_load),
          "mesh %d on %s%s: not the same after %d steps", kind, dem_simd_names[s], more[_i % WAYS], 40 * (k + 1));
    }
    ck_assert_msg(touching > 5 * LOOKS, "mesh %d: only %ld contacts", kind, touching);
    rig_free(a);
    rig_free(b);
  }
}
END_TEST

/* several chunks of balls on a mesh: the same bits for any number of threads, lists and all */
START_TEST(test_threads) {
  static const char *const threads[] = {"", ",'threads':2", ",'threads':3"};
  rig *r[3];
  for (int k = 0; k < 3; k++)
    r[k] = scene("mesh", 1, "'radius':[0.0007,0.0011],'count':5000", dem_simd_best(), threads[k]);
  const dem_state *one = &r[0]->data->state;
  const size_t n = (size_t)one->nparticle;
  ck_assert_int_gt(r[0]->data->lists.nchunk, 2);
  for (int k = 0; k < 10; k++)
    for (int t = 0; t < 3; t++) {
      const dem_state *other = &r[t]->data->state;
      rig_steps(r[t], 20);
      ck_assert_msg(!memcmp(one->sphere, other->sphere, n * sizeof *one->sphere) &&
                        !memcmp(one->rotor, other->rotor, n * sizeof *one->rotor) &&
                        !memcmp(one->body_load, other->body_load, sizeof *one->body_load),
                    "%d threads: not the same after %d steps", t + 1, 20 * (k + 1));
      ck_assert_int_eq(one->ncontact, other->ncontact);
    }
  ck_assert_uint_gt(r[0]->data->lists.nrebuild, 3);
  ck_assert_int_gt(r[0]->data->lists.walls.count, 100);
  for (int k = 0; k < 3; k++)
    rig_free(r[k]);
}
END_TEST

TEST_MAIN_ROWS("dem_mesh_loop", {test_same_bits, MESHES *WAYS}, {test_threads, 1})

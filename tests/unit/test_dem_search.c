/* Every search makes the rows that looking at every pair makes; the linked linear list of [A07] with its exchange rules
 * and the example of Table 2.2. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/sweep.h"
#include "dem/search/search.h"
#include "protocol/math/random.h"
#include "tests/test_main.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

enum { MOST = 4000, SEARCHES = 4 };

static const char *const fast[SEARCHES] = {"cells", "sweep", "grid", "linked-linear"};

static uint64_t random_state;

/* [0, 1) */
static double unit(void) {
  return tdm_random_next(&random_state);
}

typedef struct {
  const char *what;
  int n;
  double small, large; /* radii [m] */
  double side[3];      /* of the box [m] */
  bool periodic[3];
  double skin; /* [m] */
} cloud;

static const cloud clouds[] = {
    {"nothing", 0, 1, 1, {10, 10, 10}, {false}, 0.1},
    {"one", 1, 1, 1, {10, 10, 10}, {false}, 0.1},
    {"two", 2, 1, 1, {2, 2, 2}, {false}, 0.1},
    {"dense, equal", 1100, 1, 1, {22, 22, 22}, {false}, 0.1},
    {"dilute, equal", 1000, 1, 1, {300, 300, 300}, {false}, 0.1},
    {"no skin", 800, 1, 1, {20, 20, 20}, {false}, 0},
    {"1:3", 1000, 1, 3, {40, 40, 40}, {false}, 0.1},
    {"1:100", 1300, 0.05, 5, {40, 40, 40}, {false}, 0.02},
    {"all in a cell", 120, 5, 5, {1, 1, 1}, {false}, 0.1},
    {"a layer", 1000, 1, 1.5, {80, 80, 0}, {false}, 0.1},
    {"a row", 600, 1, 1, {1000, 0, 0}, {false}, 0.1},
    {"periodic in x", 1000, 1, 1, {22, 22, 22}, {true, false, false}, 0.1},
    {"periodic in y and z", 1200, 1, 2, {30, 30, 30}, {false, true, true}, 0.1},
    {"periodic in all, dense", 1100, 1, 1, {21, 22, 23}, {true, true, true}, 0.1},
    {"periodic in all, 1:100", 800, 0.05, 5, {40, 40, 40}, {true, true, true}, 0.02},
    {"periodic, two cells wide", 60, 1, 1, {4.2, 4.2, 4.2}, {true, true, true}, 0.1},
    {"periodic, two by three by ten cells", 150, 1, 1, {4.25, 6.4, 21.5}, {true, true, true}, 0.1},
    {"periodic and dilute", 300, 1, 1, {200, 250, 300}, {true, true, true}, 0.1},
};
enum { CLOUDS = sizeof clouds / sizeof *clouds };

static dem_sphere sphere[MOST];

static double *axis_of(dem_sphere *s, int a) {
  return a == 0 ? &s->position.x : a == 1 ? &s->position.y : &s->position.z;
}

/* sizes of a cloud are spread so that all decades hold some */
static void place(const cloud *c, dem_sphere *s) {
  for (int a = 0; a < 3; a++)
    *axis_of(s, a) = c->side[a] * unit();
  s->radius = c->small * pow(c->large / c->small, unit());
}

/* back into the box where it repeats */
static void wrap(const cloud *c, dem_sphere *s) {
  for (int a = 0; a < 3; a++)
    if (c->periodic[a]) {
      double *x = axis_of(s, a);
      *x -= c->side[a] * floor(*x / c->side[a]);
      if (*x >= c->side[a])
        *x = 0;
    }
}

static void shake(const cloud *c, int n, double size) {
  for (int i = 0; i < n; i++) {
    for (int a = 0; a < 3; a++)
      *axis_of(&sphere[i], a) += size * (2 * unit() - 1) * (c->side[a] > 0);
    wrap(c, &sphere[i]);
  }
}

static void shuffle(int n) {
  for (int i = n - 1; i > 0; i--) {
    int j = (int)(unit() * (i + 1));
    dem_sphere t = sphere[i];
    sphere[i] = sphere[j];
    sphere[j] = t;
  }
}

static void compare(const char *what, const char *name, int n, const dem_rows *rows, const dem_rows *wanted) {
  ck_assert_msg(rows->count == wanted->count, "%s, %s: %zu pairs, wanted %zu", what, name, rows->count, wanted->count);
  ck_assert_msg(!memcmp(rows->first, wanted->first, ((size_t)n + 1) * sizeof(int)), "%s, %s: rows", what, name);
  ck_assert_msg(!rows->count || !memcmp(rows->other, wanted->other, rows->count * sizeof(int)), "%s, %s: partners",
                what, name);
}

typedef struct {
  dem_search *search[SEARCHES], *all;
  dem_rows rows, wanted;
} bench;

static void start(bench *b) {
  memset(b, 0, sizeof *b);
  b->all = dem_search_create("all");
  ck_assert_ptr_nonnull(b->all);
  for (int k = 0; k < SEARCHES; k++) {
    b->search[k] = dem_search_create(fast[k]);
    ck_assert_ptr_nonnull(b->search[k]);
  }
}

static void finish(bench *b) {
  for (int k = 0; k < SEARCHES; k++)
    dem_search_destroy(&b->search[k]);
  dem_search_destroy(&b->all);
  ck_assert_ptr_null(b->all);
}

/* the rows of a part, as a rank asks for them, are those of all */
static void check_part(bench *b, const char *what, dem_search_input in, int begin, int end) {
  dem_rows rows;
  in.some = true;
  in.begin = begin;
  in.end = end;
  for (int k = 0; k < SEARCHES; k++) {
    ck_assert_int_eq(dem_search_run(b->search[k], &in, &rows), TDM_OK);
    ck_assert(rows.begin == begin && rows.end == end);
    for (int i = begin; i < end; i++) {
      const int at = dem_row(&rows, i), from = dem_row(&b->wanted, i), length = dem_row(&b->wanted, i + 1) - from;
      ck_assert_msg(dem_row(&rows, i + 1) - at == length, "%s, %s: row %d", what, fast[k], i);
      ck_assert_msg(length == 0 || memcmp(&rows.other[at], &b->wanted.other[from], (size_t)length * sizeof(int)) == 0,
                    "%s, %s: partners of %d", what, fast[k], i);
    }
    ck_assert_uint_eq(rows.count, (size_t)dem_row(&rows, end));
  }
}

static void check_all(bench *b, const char *what, const dem_search_input *input) {
  ck_assert_int_eq(dem_search_run(b->all, input, &b->wanted), TDM_OK);
  for (int k = 0; k < SEARCHES; k++) {
    ck_assert_int_eq(dem_search_run(b->search[k], input, &b->rows), TDM_OK);
    compare(what, fast[k], input->n, &b->rows, &b->wanted);
  }
}

static dem_search_input input_of(const cloud *c, int nthread) {
  dem_search_input in = {.sphere = sphere, .n = c->n, .skin = c->skin, .nthread = nthread};
  for (int a = 0; a < 3; a++) {
    in.domain.periodic[a] = c->periodic[a];
    in.domain.length[a] = c->side[a];
  }
  return in;
}

/* moved a little and far, some removed, many added, renumbered: with 1, 2 and 4 threads */
START_TEST(test_agree) {
  const cloud *c = &clouds[_i];
  for (int nthread = 1; nthread <= 4; nthread *= 2) {
    bench b;
    start(&b);
    random_state = 7;
    dem_search_input in = input_of(c, nthread);
    for (int i = 0; i < in.n; i++)
      place(c, &sphere[i]);
    check_all(&b, c->what, &in);
    for (int k = 0; k < 4; k++) {
      shake(c, in.n, 0.02 * c->small * (k + 1));
      check_all(&b, c->what, &in);
    }
    shake(c, in.n, c->large);
    check_all(&b, c->what, &in);
    shuffle(in.n);
    check_all(&b, c->what, &in);
    in.n -= in.n / 5;
    check_all(&b, c->what, &in);
    int more = c->n + c->n / 3;
    for (int i = in.n; i < more; i++)
      place(c, &sphere[i]);
    in.n = more;
    check_all(&b, c->what, &in);
    check_part(&b, c->what, in, 0, in.n / 2);
    check_part(&b, c->what, in, in.n / 3, in.n / 2);
    check_part(&b, c->what, in, in.n, in.n);
    shake(c, in.n, 0.02 * c->small);
    check_all(&b, c->what, &in);
    finish(&b);
  }
}
END_TEST

/* one numbering and one set of boxes for sweep, then another domain, then none */
START_TEST(test_domain_changes) {
  bench b;
  start(&b);
  random_state = 3;
  cloud c = {"domain", 400, 1, 1, {15, 15, 15}, {false}, 0.1};
  for (int i = 0; i < c.n; i++)
    place(&c, &sphere[i]);
  static const double side[] = {15, 16, 17};
  for (int mask = 0; mask < 8; mask++) {
    for (int a = 0; a < 3; a++) {
      c.periodic[a] = mask >> a & 1;
      c.side[a] = side[mask % 3];
    }
    dem_search_input in = input_of(&c, 1);
    check_all(&b, c.what, &in);
    check_part(&b, c.what, in, in.n / 3, in.n / 2);
  }
  finish(&b);
}
END_TEST

/* the box that repeats need not begin at zero */
START_TEST(test_low_corner) {
  bench b;
  start(&b);
  random_state = 5;
  cloud c = {"corner", 700, 1, 1, {15, 15, 15}, {true, true, true}, 0.1};
  dem_search_input in = input_of(&c, 1);
  static const double low[3] = {-1000.3, 7.77, -7.5};
  for (int i = 0; i < c.n; i++) {
    place(&c, &sphere[i]);
    for (int a = 0; a < 3; a++)
      *axis_of(&sphere[i], a) += low[a];
  }
  memcpy(in.domain.low, low, sizeof low);
  check_all(&b, c.what, &in);
  check_part(&b, c.what, in, in.n / 3, in.n / 2);
  finish(&b);
}
END_TEST

/* n^3 spheres on a lattice, nearly touching: each has six neighbours where the box repeats, n^2 (n - 1) pairs a
 * direction where it does not */
START_TEST(test_lattice) {
  enum { SIDE = 8, N = SIDE * SIDE * SIDE };
  for (int i = 0; i < N; i++)
    sphere[i] = (dem_sphere){.position = {i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE}, .radius = 0.4999};
  for (int periodic = 0; periodic < 2; periodic++)
    for (const char *const *name = dem_search_names; *name; name++) {
      dem_search_input in = {.sphere = sphere, .n = N, .skin = 0.01, .nthread = 2};
      for (int a = 0; a < 3; a++) {
        in.domain.periodic[a] = periodic;
        in.domain.length[a] = SIDE;
      }
      dem_search *search = dem_search_create(*name);
      dem_rows rows = {0};
      ck_assert_int_eq(dem_search_run(search, &in, &rows), TDM_OK);
      ck_assert_uint_eq(rows.count, periodic ? 3 * N : 3 * SIDE * SIDE * (SIDE - 1));
      ck_assert_int_eq(rows.first[0], 0);
      ck_assert_int_eq(rows.other[0], 1);
      ck_assert_int_eq(rows.other[1], periodic ? SIDE - 1 : SIDE);
      in.skin = 0; /* no longer near */
      ck_assert_int_eq(dem_search_run(search, &in, &rows), TDM_OK);
      ck_assert_uint_eq(rows.count, 0);
      dem_search_destroy(&search);
    }
}
END_TEST

START_TEST(test_coincident) {
  bench b;
  start(&b);
  enum { N = 150 };
  for (int i = 0; i < N; i++)
    sphere[i] = (dem_sphere){.position = {1, 2, 3}, .radius = 1};
  dem_search_input in = {.sphere = sphere, .n = N, .nthread = 1};
  check_all(&b, "coincident", &in);
  ck_assert_uint_eq(b.rows.count, N * (N - 1) / 2);
  finish(&b);
}
END_TEST

/* A bed with spheres that flew off: absurdly far, beyond all numbers, not a number; some of these near each other. */
START_TEST(test_far) {
  static const double odd[] = {1e4, 1e9, -1e9, 1e15, -1e17, 1e300, -1e308, INFINITY, -INFINITY, NAN};
  enum { ODD = sizeof odd / sizeof *odd };
  cloud c = {"far", 1200, 1, 1, {20, 20, 20}, {false}, 0.1};
  bench b;
  start(&b);
  random_state = 11;
  for (int i = 0; i < c.n; i++)
    place(&c, &sphere[i]);
  dem_search_input in = input_of(&c, 2);
  for (int round = 0; round < 3; round++) {
    for (int k = 0; k < ODD; k++)
      for (int pair = 0; pair < 2; pair++)
        *axis_of(&sphere[100 * k + pair], (k + round) % 3) = odd[k] + pair;
    check_all(&b, c.what, &in);
  }
  for (int i = 0; i < c.n; i++)
    sphere[i].position = tdm_v3(NAN, 0, i);
  check_all(&b, "nothing is a number", &in);
  ck_assert_uint_eq(b.rows.count, 0);
  finish(&b);
}
END_TEST

/* far spheres in a large flat bed cost neither time nor memory: it takes minutes if all share a few cells */
START_TEST(test_far_in_large_bed) {
  enum { N = 200000, SIDE = 632 };
  dem_sphere *s = calloc(N, sizeof *s);
  dem_rows rows = {0};
  dem_search *search = dem_search_create("cells");
  for (int i = 0; i < N; i++)
    s[i] = (dem_sphere){.position = {i % SIDE, (double)(i / SIDE), 0}, .radius = 0.5};
  s[3].position.x = 1e12;
  s[4].position.y = -1e200;
  s[5].position.z = INFINITY;
  s[7].position.z = 1e7;
  for (int k = 0; k < 20; k++)
    ck_assert_int_eq(
        dem_search_run(search, &(dem_search_input){.sphere = s, .n = N, .skin = 0.01, .nthread = 1}, &rows), TDM_OK);
  ck_assert_uint_gt(rows.count, 2 * N - 3 * SIDE);
  dem_search_destroy(&search);
  free(s);
}
END_TEST

/* The rows do not depend on where they lie: in a block that is large enough, too small, or not there at all. What does
 * not fit is taken elsewhere, and nothing is written behind the block. */
START_TEST(test_scratch) {
  enum { N = 1500, LARGE = 1 << 20, SMALL = 20000, GUARD = 64 };
  cloud c = {"scratch", N, 0.8, 1, {15, 15, 15}, {false}, 0.1};
  random_state = 5;
  for (int i = 0; i < N; i++)
    place(&c, &sphere[i]);
  dem_search_input in = input_of(&c, 2);
  bench b;
  start(&b);
  check_all(&b, c.what, &in);
  char *block = aligned_alloc(64, LARGE + GUARD);
  for (size_t size = SMALL; size <= LARGE; size += LARGE - SMALL) {
    memset(block, 7, LARGE + GUARD);
    dem_scratch scratch = {.block = block, .size = size};
    in.scratch = &scratch;
    dem_rows rows;
    for (int call = 0; call < 2; call++) {
      dem_scratch_done(&scratch);
      ck_assert_int_eq(dem_search_run(b.search[0], &in, &rows), TDM_OK);
      compare(c.what, fast[0], N, &rows, &b.wanted);
    }
    ck_assert_int_eq(size == LARGE, scratch.heap == NULL);
    ck_assert_uint_le(scratch.most, size);
    for (int k = 0; k < GUARD; k++)
      ck_assert_int_eq(block[size + (size_t)k], 7);
    dem_scratch_done(&scratch);
    ck_assert_ptr_null(scratch.heap);
    ck_assert_uint_eq(scratch.used, 0);
    dem_scratch_free(&scratch);
    ck_assert_ptr_null(scratch.kept);
  }
  free(block);
  finish(&b);
}
END_TEST

START_TEST(test_table) {
  ck_assert_ptr_null(dem_search_create("auto"));
  ck_assert_ptr_null(dem_search_create("cels"));
  for (const char *const *name = dem_search_names; *name; name++) {
    dem_search *search = dem_search_create(*name);
    ck_assert_ptr_nonnull(search);
    ck_assert_str_eq(dem_search_name(search), *name);
    bool verlet = !strcmp(*name, "verlet-1967"), linked = !strcmp(*name, "linked-linear");
    ck_assert_double_eq(dem_search_skin(search, 0.2, 2), verlet ? 6 : linked ? 2e-9 : 0.2); /* r_v = 2 r_max + skin */
    ck_assert_int_eq(dem_search_interval(search), verlet ? 20 : linked ? 1 : 0);
    dem_search_destroy(&search);
  }
}
END_TEST

/* [A07] Eq. 2.64: exactly the pairs nearer than 5 r_max, whatever their radii */
START_TEST(test_verlet_circles) {
  enum { N = 300 };
  random_state = 7;
  for (int i = 0; i < N; i++)
    sphere[i] = (dem_sphere){.position = {30 * unit(), 30 * unit(), 30 * unit()}, .radius = i == 17 ? 2 : 0.5 + unit()};
  dem_search *search = dem_search_create("verlet-1967");
  dem_search_input in = {.sphere = sphere, .n = N, .skin = dem_search_skin(search, 0.1, 2), .nthread = 1};
  dem_rows rows = {0};
  ck_assert(dem_search_run(search, &in, &rows) == TDM_OK);
  for (int i = 0; i < N; i++) {
    int at = rows.first[i];
    for (int j = i + 1; j < N; j++)
      if (tdm_norm(tdm_sub(sphere[i].position, sphere[j].position)) < 5 * 2.0)
        ck_assert_int_eq(rows.other[at++], j);
    ck_assert_int_eq(at, rows.first[i + 1]);
  }
  /* as a rank asks: some rows, of which the largest sphere is one; what is before them may be anything */
  enum { BEGIN = 10, END = 200 };
  for (int i = 0; i < BEGIN; i++)
    sphere[i] = (dem_sphere){0};
  in.some = true;
  in.begin = BEGIN;
  in.end = END;
  ck_assert(dem_search_run(search, &in, &rows) == TDM_OK);
  size_t count = 0;
  for (int i = BEGIN; i < END; i++)
    for (int j = i + 1; j < N; j++) {
      const bool listed = count < rows.count && dem_row(&rows, i) <= (int)count && (int)count < dem_row(&rows, i + 1) &&
                          rows.other[count] == j;
      count += listed;
      const double gap =
          tdm_norm(tdm_sub(sphere[i].position, sphere[j].position)) - sphere[i].radius - sphere[j].radius;
      ck_assert_msg(listed || gap >= in.skin, "%d and %d", i, j);
    }
  ck_assert_uint_eq(count, rows.count);
  dem_search_destroy(&search);
}
END_TEST

START_TEST(test_choose) {
  for (int i = 0; i < 1000; i++)
    sphere[i] = (dem_sphere){.position = {i, 0, 0}, .radius = 1 + 0.001 * i};
  dem_search_input in = {.sphere = sphere, .n = 1000, .skin = 0.1, .nthread = 1};
  ck_assert_str_eq(dem_search_choose(&in), "cells");
  sphere[500].radius = 30;
  ck_assert_str_eq(dem_search_choose(&in), "grid");
  for (int i = 0; i < 1000; i++) /* equal ones and one of volume v: 1000 v / (999 + v) */
    sphere[i].radius = 1;
  in.skin = 0;
  sphere[7].radius = cbrt(30.5);
  ck_assert_str_eq(dem_search_choose(&in), "cells");
  sphere[7].radius = cbrt(31.5);
  ck_assert_str_eq(dem_search_choose(&in), "grid");
  in.n = 0;
  ck_assert_str_eq(dem_search_choose(&in), "cells");
}
END_TEST

/* the marks of an axis as [A07] writes them: -i begins, +i ends, particles from 1 */
static void check_marks(const dem_sweep *s, int axis, const int *wanted) {
  for (int k = 0; k < 2 * s->n; k++) {
    const dem_mark *m = &s->mark[axis][k];
    ck_assert_int_eq(m->end ? m->particle + 1 : -(m->particle + 1), wanted[k]);
  }
}

/* exactly these boxes, of particles from 1, are stored */
static void check_stored(const dem_sweep *s, const int (*pair)[2], int count) {
  int stored = 0;
  for (int i = 0; i < s->n; i++)
    for (int j = i + 1; j < s->n; j++)
      stored += dem_sweep_stored(s, i, j);
  ck_assert_int_eq(stored, count);
  for (int k = 0; k < count; k++)
    ck_assert(dem_sweep_stored(s, pair[k][0] - 1, pair[k][1] - 1));
}

/* [A07] Fig. 2.12, 2.13 and Table 2.2: the order of the marks at t is the text's; at t + dt particle 4 has moved so
 * that its box leaves that of 1 and enters that of 5 */
START_TEST(test_table_2_2) {
  dem_sphere s[5] = {{.position = {7, 2, 0}, .radius = 2},
                     {.position = {7, 9, 0}, .radius = 3},
                     {.position = {9, 9, 0}, .radius = 2},
                     {.position = {4.5, 3.5, 0}, .radius = 1.5},
                     {.position = {1, 2, 0}, .radius = 1}};
  dem_search_input in = {.sphere = s, .n = 5, .nthread = 1};
  dem_sweep sweep = {0};
  ck_assert_int_eq(dem_sweep_update(&sweep, &in), TDM_OK);
  check_marks(&sweep, 0, (int[]){-5, 5, -4, -2, -1, 4, -3, 1, 2, 3});
  check_marks(&sweep, 1, (int[]){-1, -5, -4, 5, 1, 4, -2, -3, 3, 2});
  check_stored(&sweep, (const int[][2]){{1, 4}, {2, 3}}, 2);

  s[3].position.x -= 1.5;
  ck_assert_int_eq(dem_sweep_update(&sweep, &in), TDM_OK);
  check_marks(&sweep, 0, (int[]){-5, -4, 5, -2, 4, -1, -3, 1, 2, 3});
  check_marks(&sweep, 1, (int[]){-1, -5, -4, 5, 1, 4, -2, -3, 3, 2});
  check_stored(&sweep, (const int[][2]){{2, 3}, {4, 5}}, 2);
  dem_sweep_free(&sweep);
}
END_TEST

/* [A07] Table 2.1 and Fig. 2.14: boxes of i = 1 and j = 2 on the x axis before and after the exchange */
static const struct {
  dem_rule rule;
  double low[2][2], high[2][2]; /* [time][particle] */
  int marks[2][4];
  bool stored[2];
} rules[] = {
    {DEM_RULE_BEGINS, {{0, 1}, {2, 1}}, {{4, 5}, {4, 5}}, {{-1, -2, 1, 2}, {-2, -1, 1, 2}}, {true, true}},
    {DEM_RULE_ENDS, {{1, 0}, {1, 0}}, {{4, 5}, {4, 3}}, {{-2, -1, 1, 2}, {-2, -1, 2, 1}}, {true, true}},
    {DEM_RULE_REMOVE, {{2, 0}, {4, 0}}, {{6, 3}, {6, 3}}, {{-2, -1, 2, 1}, {-2, 2, -1, 1}}, {true, false}},
    {DEM_RULE_ADD, {{0, 3}, {0, 1}}, {{2, 5}, {2, 5}}, {{-1, 1, -2, 2}, {-1, -2, 1, 2}}, {false, true}},
};

START_TEST(test_exchange_rules) {
  dem_sphere s[2] = {0};
  dem_search_input in = {.sphere = s, .n = 2, .nthread = 1};
  dem_sweep sweep = {0};
  for (int time = 0; time < 2; time++) {
    for (int i = 0; i < 2; i++) {
      double low = rules[_i].low[time][i], high = rules[_i].high[time][i];
      s[i] = (dem_sphere){.position = {(low + high) / 2, 0, 0}, .radius = (high - low) / 2};
    }
    ck_assert_int_eq(dem_sweep_update(&sweep, &in), TDM_OK);
    check_marks(&sweep, 0, rules[_i].marks[time]);
    ck_assert_int_eq(dem_sweep_stored(&sweep, 0, 1), rules[_i].stored[time]);
  }
  for (int k = 0; k < 4; k++) {
    const int *now = rules[_i].marks[1], *was = rules[_i].marks[0];
    if (now[k] == was[k])
      continue;
    dem_mark left = {.particle = abs(was[k]) - 1, .end = was[k] > 0};
    dem_mark right = {.particle = abs(was[k + 1]) - 1, .end = was[k + 1] > 0};
    ck_assert_int_eq(dem_sweep_rule(&left, &right), rules[_i].rule);
    break;
  }
  dem_sweep_free(&sweep);
}
END_TEST

TEST_MAIN_ROWS("dem_search", {test_agree, CLOUDS}, {test_domain_changes, 1}, {test_low_corner, 1}, {test_lattice, 1},
               {test_coincident, 1}, {test_far, 1}, {test_far_in_large_bed, 1}, {test_scratch, 1}, {test_table, 1},
               {test_verlet_circles, 1}, {test_choose, 1}, {test_table_2_2, 1},
               {test_exchange_rules, (int)(sizeof rules / sizeof *rules)})

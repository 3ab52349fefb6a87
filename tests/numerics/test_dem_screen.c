/* Screens: distances against bars one by one, bounces, who passes a reduced hole, decks that move, materials. */
/* SPDX-License-Identifier: GPL-3.0-or-later */

#include "dem/geometry/screen/screen.h"
#include "dem/output/view.h"
#include "dem/search/pairs.h"
#include "dem/state/wall_gap.h"
#include "dem/store/fingerprint.h"
#include "dem/watch/energy_balance.h"
#include "test_dem_support.h"
#include "test_random.h"
#include "tests/test_main.h"

/* ---- scenes ---- */

#define DECK "'type':'screen','deck':"
#define HOLES "'hole':0.022,'bar':0.006,"

/* Particles of radius r and a deck of friction 0 and restitution e, whose contacts store nothing tangential. */
static rig *rig_of(const char *gravity, double e, const char *body, const char *deck, const char *particles,
                   double dt) {
  return rig_make(scene_json("{'gravity':%s,'contact':{'normal':'hooke','tangential':'none'},"
                             "'materials':[{'name':'m','density':2500}],"
                             "'pairs':[{'materials':['m','m'],'restitution':%g,'stiffness':1e6}],"
                             "'bodies':[{'name':'b','material':'m',%s'shapes':[{" DECK "%s}]}],'particles':[%s]}",
                             gravity, e, body, deck, particles),
                  dt, 0, NULL);
}

#define ONE(x) "{'type':'list','material':'m','radius':0.01,'positions':[" x "]}"

static void place(rig *r, int i, tdm_vec3 x, tdm_vec3 v) {
  dem_data *d = r->data;
  d->state.sphere[i].position = x;
  d->state.sphere[i].velocity = v;
  d->state.pace[i].velocity = v;
  d->lists.stale = true;
}

static double kinetic(dem_data *d) {
  return dem_stored_energy_now(d).kinetic;
}

static const dem_screen *screen_of(const rig *r) {
  return r->model->wall[0].data;
}

static const dem_screen reduced = {.deck = DEM_DECK_REDUCED,
                                   .aisles = 5,
                                   .pieces = 1,
                                   .half = 0.011,
                                   .bar = 0.006,
                                   .radius = 0.14,
                                   .zeta = 0.6,
                                   .clearance = -1};

/* ---- the layout ---- */

/* [A07] Eq. 4.22, 4.23: n = R/(2w + g) + 1 rounded, gaps between x_a = w + j (2w + g) and x_a + g. */
START_TEST(the_layout_is_that_of_the_paper) {
  rig *r = rig_of("[0,0,0]", 1, "", "'plate'," HOLES "'radius':0.15", ONE("[9,9,9]"), 1e-6);
  const dem_screen *s = screen_of(r);
  const int n = (int)lround(0.15 / 0.028 + 1);
  ck_assert_int_eq(2 * s->aisles + 1, 2 * n - 1);
  ck_assert_int_eq(dem_screen_parts(s), 2 * (2 * n - 2));
  for (int part = 0; part < dem_screen_parts(s); part++) {
    double ends[2], across, x_a = 0.011 + (part % (2 * n - 2) - (n - 1)) * 0.028;
    ck_assert(dem_screen_bar(s, part, ends, &across));
    ck_near(across, x_a + 0.003, 1e-15);
    ck_near(hypot(ends[1], across), 0.15, 1e-15);
  }
  rig_free(r);
}
END_TEST

/* ---- the reduced hole ---- */

/* [A07] Eq. 4.20, 4.21, 4.24: centres pass in |x| < w - b (model 2), |x| < w - b - r (model 1). */
START_TEST(passages_are_those_of_the_models) {
  dem_screen s = reduced;
  ck_near(dem_screen_passage(&s, 0.010), 0.011 - 0.6 * 0.011, 1e-16);
  ck_assert_double_le(dem_screen_passage(&s, 0.011), 0);
  s.by_radius = 1;
  ck_near(dem_screen_passage(&s, 0.010), 0.011 - 0.010 - 0.6 * 0.001, 1e-16);
  s.clearance = 0.0004;
  ck_near(dem_screen_passage(&s, 0.010), 0.0006, 1e-16);
  s.by_radius = 0;
  ck_near(dem_screen_passage(&s, 0.010), 0.0106, 1e-16);
}
END_TEST

/* depth in the obstacle for centres, hole by hole; negative outside of it */
static double depth_of(const dem_screen *s, tdm_vec3 x, double radius) {
  double rho = hypot(x.x, x.y), beside = fmax(0, fmax(rho - s->radius, s->inner - rho));
  double depth = radius - hypot(beside, x.z), a = dem_screen_passage(s, radius), p = dem_screen_pitch(s);
  for (int i = -s->aisles; i <= s->aisles && a > 0; i++)
    for (int j = -s->aisles; j <= s->aisles; j++) {
      double du = fabs(x.x - i * p) - a, dv = fabs(x.y - j * p) - a;
      bool in = du <= 0 && dv <= 0;
      depth = fmin(depth, in ? fmax(du, dv) : hypot(fmax(du, 0), fmax(dv, 0)));
    }
  return depth;
}

/* The overlap is the depth in the obstacle, the normal its gradient; the gap changes by no more than the place. */
START_TEST(the_reduced_gap_is_a_distance) {
  random_state = 1;
  for (int k = 0; k < 20000; k++) {
    dem_screen s = reduced;
    s.by_radius = k % 2;
    s.zeta = between(0, 1);
    s.inner = k % 3 ? 0 : 0.04;
    double radius = between(0.002, 0.013);
    tdm_vec3 x = {between(-0.2, 0.2), between(-0.2, 0.2), between(-1.5, 1.5) * radius}, n, other;
    double gap = dem_screen_reduced_gap(&s, x, radius, &n);
    ck_near(radius - gap, depth_of(&s, x, radius), 1e-15);
    ck_near(tdm_norm(n), 1, 1e-14);
    tdm_vec3 y = tdm_add(x, tdm_v3(between(-0.01, 0.01), between(-0.01, 0.01), between(-0.01, 0.01)));
    ck_assert_double_le(fabs(dem_screen_reduced_gap(&s, y, radius, &other) - gap),
                        tdm_norm(tdm_sub(y, x)) * (1 + 1e-9));
    double further = dem_screen_reduced_gap(&s, tdm_axpy(1e-9, n, x), radius, &other);
    if (tdm_dot(n, other) > 1 - 1e-6)
      ck_near(further - gap, 1e-9, 1e-13);
    /* the same from below, and for the other aisles */
    ck_near(dem_screen_reduced_gap(&s, tdm_v3(-x.y, x.x, -x.z), radius, &other), gap, 1e-15);
  }
}
END_TEST

/* The share of vertical rain that passes: ((2w - 2b)/(2w + g))² with b = zeta w, or (2(w - r) - 2b)²/(2w + g)² with
 * b = zeta (w - r). From above and from below; what does not pass is reflected with its speed. */
START_TEST(rain_passes_in_its_share) {
  enum { SIDE = 60, N = SIDE * SIDE };
  static const struct {
    const char *model;
    double zeta, share, from;
  } rain[] = {{"center", 0.2, 0.8 * 0.022 / 0.028, 1},
              {"center", 0.6, 0.4 * 0.022 / 0.028, -1},
              {"radius", 0.25, 0.75 * (0.022 - 0.01) / 0.028, 1}};
  for (int k = 0; k < 3; k++) {
    char deck[200], fill[200];
    snprintf(deck, sizeof deck, "'reduced'," HOLES "'radius':3,'model':'%s','zeta':%g", rain[k].model, rain[k].zeta);
    snprintf(fill, sizeof fill,
             "{'type':'block','material':'m','radius':0.005,'spacing':0.056,'corner':[9,9,9],'count':[%d,%d,1]}", SIDE,
             SIDE);
    rig *r = rig_of("[0,0,0]", 1, "", deck, fill, 4e-6);
    dem_data *d = r->data;
    random_state = 3 + (uint64_t)k;
    int over = 0, passed = 0;
    const double start = rain[k].from * 0.00501;
    for (int i = 0; i < N; i++) {
      int column = i % SIDE - SIDE / 2, line = i / SIDE - SIDE / 2;
      double u = between(-0.014, 0.014), v = between(-0.014, 0.014);
      over += fmax(fabs(u), fabs(v)) < 0.014 * rain[k].share;
      place(r, i, tdm_v3(0.056 * column + u, 0.056 * line + v, start), tdm_v3(0, 0, -0.05 * rain[k].from));
    }
    rig_steps(r, 200); /* to the plane in 50, a contact of 30 */
    for (int i = 0; i < N; i++) {
      double speed = rain[k].from * d->state.pace[i].velocity.z;
      passed += speed < 0;
      if (speed > 0.04)
        ck_relative(speed, 0.05, 3e-3);
    }
    ck_assert_int_le(abs(passed - over), N / 500); /* some land on the very edge of a hole */
    const double p = rain[k].share * rain[k].share;
    ck_near(passed, N * p, 4 * sqrt(N * p * (1 - p)));
    rig_free(r);
  }
}
END_TEST

/* Nothing acts on a particle on its way through; one that drifts over a bar meanwhile is turned back by the side of the
 * hole, passes, and keeps its energy. One that is too large stays above. */
START_TEST(one_on_its_way_is_not_hit) {
  rig *r = rig_of("[0,0,0]", 1, "", "'reduced'," HOLES "'radius':0.14,'zeta':0.2", ONE("[0,0,0.02],[9,9,9]"), 1e-6);
  dem_data *d = r->data;
  place(r, 0, tdm_v3(0, 0.001, 0.011), tdm_v3(0, 0, -1));
  rig_steps(r, 25000);
  ck_vector(d->state.sphere[0].position, tdm_v3(0, 0.001, 0.011 - 0.025), 1e-12);
  place(r, 0, tdm_v3(0, 0.001, 0.011), tdm_v3(2, 0, -0.5));
  double before = kinetic(d), far = 0;
  for (int k = 0; k < 50000; k++) {
    rig_steps(r, 1);
    if (d->state.sphere[0].position.z > -0.0099)
      far = fmax(far, fabs(d->state.sphere[0].position.x));
  }
  ck_assert_double_lt(d->state.sphere[0].position.z, -0.01);
  ck_assert(far > 0.0088 && far < 0.0092);
  ck_relative(kinetic(d), before, 1e-4);
  rig_free(r);
  r = rig_of("[0,0,-9.81]", 0.3, "", "'reduced'," HOLES "'radius':0.14",
             "{'type':'list','material':'m','radius':0.0111,'positions':[[0.001,0,0.02]]}", 1e-5);
  rig_steps(r, 60000);
  ck_near(r->data->state.sphere[0].position.z, 0.0111, 1e-5);
  rig_free(r);
}
END_TEST

/* Who touches the deck over a hole is through at once: nothing acts on it until it is clear of the deck, also over
 * bars. Then the deck is there again, from below. One over a bar is thrown back. */
START_TEST(at_once_means_at_once) {
  rig *r = rig_of("[0,0,0]", 1, "", "'reduced'," HOLES "'radius':0.14,'zeta':0.2,'passing':'at_once'",
                  ONE("[0,0,0.02],[9,9,9]"), 1e-6);
  dem_data *d = r->data;
  place(r, 0, tdm_v3(0.0087, 0.001, 0.010001), tdm_v3(2, 0.3, -0.5));
  rig_steps(r, 30000); /* 60 mm along, over two bars */
  ck_vector(d->state.sphere[0].position, tdm_v3(0.0687, 0.01, -0.004999), 1e-12);
  ck_assert_int_eq(d->state.front[0] & DEM_LET_GO, DEM_LET_GO);
  ck_assert(dem_gap(d, 0, 0, NULL) == d->state.sphere[0].radius); /* no overlap for guards and limits */
  rig_steps(r, 20000);
  ck_assert_int_eq(d->state.front[0] & DEM_LET_GO, 0);
  place(r, 0, tdm_v3(0.014, 0.001, -0.0102), tdm_v3(0, 0, 0.5)); /* under a bar */
  rig_steps(r, 3000);
  ck_relative(d->state.pace[0].velocity.z, -0.5, 1e-3);
  place(r, 0, tdm_v3(0.0089, 0.001, 0.0102), tdm_v3(0, 0, -0.5)); /* just beside the reduced hole */
  rig_steps(r, 3000);
  ck_relative(d->state.pace[0].velocity.z, 0.5, 1e-3);
  rig_free(r);
}
END_TEST

/* Nothing acts over a hole; a particle that leaves it before it is through is thrown up by what it has sunk. */
START_TEST(nothing_acts_over_a_hole) {
  rig *r = rig_of("[0,0,0]", 1, "", "'reduced'," HOLES "'radius':0.14,'zeta':0.2,'passing':'over_hole'",
                  ONE("[0,0,0.02],[9,9,9]"), 1e-6);
  dem_data *d = r->data;
  place(r, 0, tdm_v3(0, 0.001, 0.010001), tdm_v3(0.1, 0, -0.5));
  rig_steps(r, 42000); /* 4.2 mm along, 21 mm down */
  ck_vector(d->state.sphere[0].position, tdm_v3(0.0042, 0.001, -0.010999), 1e-12);
  place(r, 0, tdm_v3(0, 0.001, 0.0101), tdm_v3(2, 0, -0.5));
  rig_steps(r, 4300); /* 8.6 mm along, 2.15 mm down; the hole ends at 8.8 */
  ck_relative(d->state.sphere[0].position.z, 0.00795, 1e-9);
  ck_assert_int_eq(d->state.front[0] & DEM_LET_GO, 0);
  ck_assert(dem_gap(d, 0, 0, NULL) == d->state.sphere[0].radius);
  rig_steps(r, 200);
  ck_assert_double_gt(d->state.pace[0].velocity.z, 1);
  rig_free(r);
}
END_TEST

/* A particle that slides over the deck keeps its speed on the way through. One that is too large stays above. */
START_TEST(who_slides_passes_at_once) {
  static const struct {
    double radius;
    bool through;
  } slides[] = {{0.01, true}, {0.0111, false}};
  for (int k = 0; k < 2; k++) {
    char fill[200];
    snprintf(fill, sizeof fill,
             "{'type':'list','material':'m','radius':%g,'positions':[[-0.1,0.001,%g]],'velocity':[2,0,0]}",
             slides[k].radius, slides[k].radius);
    rig *r =
        rig_of("[0,0,-9.81]", 0.3, "", "'reduced'," HOLES "'radius':0.14,'zeta':0.5,'passing':'at_once'", fill, 1e-5);
    rig_steps(r, 8000);
    ck_relative(r->data->state.pace[0].velocity.x, 2.0, 1e-12);
    ck_assert((r->data->state.sphere[0].position.z < 0) == slides[k].through);
    rig_free(r);
  }
}
END_TEST

/* [A07] Eq. (4.29): on particles that do not turn friction is that of sliding: v = v0 - mu g t, until they rest. Those
 * that turn end rolling, at 5/7 of the speed. */
START_TEST(who_does_not_turn_slides) {
  for (int turning = 0; turning < 2; turning++) {
    rig *r =
        rig_make(scene_json("{'gravity':[0,0,-10],'rotation':%s,'contact':{'normal':'hooke','tangential':'spring'},"
                            "'materials':[{'name':'m','density':2500}],"
                            "'pairs':[{'materials':['m','m'],'restitution':0.3,'stiffness':1e6,'friction':0.25}],"
                            "'bodies':[{'name':'b','material':'m','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                            "'particles':[{'type':'list','material':'m','radius':0.01,'positions':[[0,0,0.0099999]],"
                            "'velocity':[1,0,0]}]}",
                            turning ? "true" : "false"),
                 1e-5, 0, NULL);
    rig_steps(r, 20000);
    const dem_pace *now = &r->data->state.pace[0];
    ck_relative(now->velocity.x, turning ? 5.0 / 7 : 0.5, 1e-3);
    ck_assert(turning || tdm_norm(now->spin) == 0);
    rig_steps(r, 30000);
    ck_near(now->velocity.x, turning ? 5.0 / 7 : 0.0, 1e-3);
    rig_free(r);
  }
}
END_TEST

/* ---- bars ---- */

/* A bar as the test sees it: the nearest point of its axis, or of the box around it. */
static double distance_to(const dem_screen *s, int family, int k, int piece, tdm_vec3 x, tdm_vec3 *away) {
  double c = (k + 0.5 - s->aisles) * (2 * s->half + s->bar), along = family ? x.y : x.x,
         side = (family ? x.x : x.y) - c;
  double out = sqrt(fmax(0, s->radius * s->radius - c * c)), in = sqrt(fmax(0, s->inner * s->inner - c * c));
  double low = in > 0 && piece ? in : -out, high = in > 0 && !piece ? -in : out;
  double beyond = along < low    ? along - low
                  : along > high ? along - high
                                 : 0,
         z = x.z + (family ? s->layer : -s->layer);
  if (s->deck == DEM_DECK_PLATE) {
    side = copysign(fmax(0, fabs(side) - s->bar / 2), side);
    z = copysign(fmax(0, fabs(z) - s->thickness / 2), z);
  }
  *away = family ? tdm_v3(side, beyond, z) : tdm_v3(beyond, side, z);
  double from = tdm_norm(*away);
  *away = tdm_scale(1 / from, *away);
  return s->deck == DEM_DECK_PLATE ? from : from - s->thickness / 2;
}

/* over a bar of the family, as the test counts */
static bool stands_over(const dem_screen *s, int family, tdm_vec3 x) {
  for (int k = 0; k < 2 * s->aisles; k++)
    for (int piece = 0; piece < s->pieces; piece++) {
      tdm_vec3 away;
      if ((piece == 0 || fabs((k + 0.5 - s->aisles) * (2 * s->half + s->bar)) < s->inner) &&
          distance_to(s, family, k, piece, x, &away) < fabs(x.z) - s->thickness / 2 + 1e-12)
        return true;
    }
  return false;
}

/* Touches, their gaps and normals, and what is listed, are those of all bars looked at one by one. */
START_TEST(touches_are_those_of_all_bars) {
  random_state = 7;
  for (int k = 0; k < 20000; k++) {
    dem_screen s = {.deck = k % 2 ? DEM_DECK_PLATE : DEM_DECK_WIRES,
                    .aisles = 5,
                    .half = 0.011,
                    .bar = 0.006,
                    .radius = 0.14,
                    .inner = k % 3 ? 0 : 0.04,
                    .pieces = k % 3 ? 1 : 2,
                    .thickness = between(0.002, 0.007)};
    s.layer = k % 4 ? 0 : s.thickness / 2;
    s.layer = s.deck == DEM_DECK_WIRES ? s.layer : 0;
    const double radius = between(0.002, 0.04), reach = radius * between(1, 1.5);
    const tdm_vec3 x = {between(-0.15, 0.15), between(-0.15, 0.15), between(0.0036, 0.04) * (uniform() < 0.5 ? 1 : -1)};
    const bool plate = s.deck == DEM_DECK_PLATE, over[2] = {stands_over(&s, 0, x), stands_over(&s, 1, x)};
    int list[200], n = dem_screen_near(&s, x, reach, list, 200), at = 0, touch = 0;
    ck_assert(n <= 200);
    dem_touch found[DEM_TOUCHES_MAX];
    int count = dem_screen_touches(&s, list, 1, n, x, radius, found);
    double nearest = INFINITY;
    for (int part = 0; part < dem_screen_parts(&s); part++) {
      const int family = part / (2 * s.aisles * s.pieces), bar = part / s.pieces % (2 * s.aisles),
                piece = part % s.pieces;
      if (piece == 1 && !(fabs((bar + 0.5 - s.aisles) * 0.028) < s.inner))
        continue;
      tdm_vec3 away;
      const double gap = distance_to(&s, family, bar, piece, x, &away);
      nearest = fmin(nearest, gap);
      if (gap < reach)
        ck_assert_int_eq(list[at++], part);
      const bool hidden = plate && (family == 0 ? over[1] : over[0] && !over[1]);
      if (!(gap < radius) || hidden)
        continue;
      ck_assert_int_lt(touch, count);
      ck_assert_int_eq(found[touch].part, part);
      ck_near(found[touch].gap, gap, 1e-15);
      ck_vector(found[touch++].normal, away, 1e-12);
    }
    ck_assert_int_eq(at, n);
    ck_assert_int_eq(touch, count);
    tdm_vec3 normal;
    if (hypot(x.x, x.y) < s.radius && hypot(x.x, x.y) > s.inner + 0.02)
      ck_near(dem_screen_gap(&s, x, &normal), nearest, 1e-15);
  }
}
END_TEST

/* Over a bar and over a crossing a plate is a plane: one touch, straight up. Over a hole it has four edges. */
START_TEST(a_plate_is_flat) {
  const dem_screen s = {.deck = DEM_DECK_PLATE,
                        .aisles = 5,
                        .pieces = 1,
                        .half = 0.011,
                        .bar = 0.006,
                        .radius = 0.14,
                        .thickness = 0.004};
  static const double at[][3] = {{0.014, 0.014, 1}, {0.013, 0.016, 1}, {0.014, 0, 1}, {0.003, 0.015, 1}, {0, 0, 4}};
  for (int k = 0; k < 5; k++) {
    int list[50], n = dem_screen_near(&s, tdm_v3(at[k][0], at[k][1], 0.008), 0.02, list, 50);
    dem_touch t[DEM_TOUCHES_MAX];
    int count = dem_screen_touches(&s, list, 1, n, tdm_v3(at[k][0], at[k][1], 0.008), k < 4 ? 0.0061 : 0.0126, t);
    ck_assert_int_eq(count, (int)at[k][2]);
    for (int c = 0; c < count; c++)
      ck_near(t[c].normal.z, k < 4 ? 1 : 0.006 / hypot(0.006, 0.011), 1e-12);
  }
}
END_TEST

/* A deck of wires and the same wires as cylinders give the same forces. */
START_TEST(wires_are_cylinders) {
  char shapes[4000] = "";
  for (int k = 0; k < 8; k++) {
    double c = (k % 4 - 1.5) * 0.028, half = sqrt(0.0036 - c * c);
    size_t at = strlen(shapes);
    snprintf(shapes + at, sizeof shapes - at,
             "%s{'type':'cylinder','side':'outside','radius':0.003,'length':%.17g,'point':[%.17g,%.17g,%g],'axis':%s}",
             k ? "," : "", 2 * half, k < 4 ? -half : c, k < 4 ? c : -half, k < 4 ? 0.003 : -0.003,
             k < 4 ? "[1,0,0]" : "[0,1,0]");
  }
  json_t *json = scene_json("{'gravity':[0,0,0],'contact':{'normal':'hooke','tangential':'none'},"
                            "'materials':[{'name':'m','density':2500}],"
                            "'pairs':[{'materials':['m','m'],'restitution':0.5,'stiffness':1e6}],"
                            "'bodies':[{'name':'b','material':'m','shapes':[%s]}],'particles':[%s]}",
                            shapes, ONE("[9,9,9]"));
  rig *b = rig_make(json, 1e-6, 0, NULL);
  rig *a = rig_of("[0,0,0]", 0.5, "", "'wires'," HOLES "'radius':0.06", ONE("[9,9,9]"), 1e-6);
  random_state = 11;
  for (int k = 0; k < 2000; k++) {
    tdm_vec3 x = {between(-0.035, 0.035), between(-0.035, 0.035), between(-0.016, 0.016)};
    for (int side = 0; side < 2; side++) {
      place(side ? b : a, 0, x, tdm_v3(1, -2, 3));
      ck_assert(dem_lists_build((side ? b : a)->data) == TDM_OK);
      forces_now((side ? b : a)->data, false);
    }
    const tdm_wrench *p = &a->data->state.body_load[0], *q = &b->data->state.body_load[0];
    ck_vector(p->force, q->force, 1e-9 * (1 + tdm_norm(q->force)));
    ck_vector(p->moment, q->moment, 1e-9 * (1 + tdm_norm(q->force)));
  }
  rig_free(a);
  rig_free(b);
}
END_TEST

/* Elastic bounces from every deck keep the energy, wherever a particle hits, and leave none inside. */
START_TEST(elastic_bounces_keep_the_energy) {
  enum { SIDE = 9, N = SIDE * SIDE };
  static const char *const decks[] = {"'reduced',", "'reduced','zeta':0.7,'model':'radius',", "'wires',",
                                      "'wires','layers':1,'thickness':0.004,"};
  for (int k = 0; k < 4; k++) {
    char deck[200], fill[200];
    snprintf(deck, sizeof deck, "%s" HOLES "'radius':1.6", decks[k]);
    snprintf(fill, sizeof fill,
             "{'type':'block','material':'m','radius':0.008,'spacing':0.28,'corner':[9,9,9],"
             "'count':[%d,%d,1]}",
             SIDE, SIDE);
    rig *r = rig_of("[0,0,0]", 1, "", deck, fill, 1e-6);
    dem_data *d = r->data;
    random_state = 5;
    double speed[N];
    for (int i = 0; i < N; i++) {
      double up = uniform() < 0.5 ? 1 : -1;
      tdm_vec3 v = {between(-0.2, 0.2), between(-0.2, 0.2), -up * between(0.5, 1)};
      place(r, i,
            tdm_v3(0.28 * (i % SIDE - 4) + between(-0.01, 0.01), 0.28 * (i / SIDE - 4) + between(-0.01, 0.01),
                   0.015 * up),
            v);
      speed[i] = tdm_norm(v);
    }
    const double before = kinetic(d);
    rig_steps(r, 100000);
    ck_relative(kinetic(d), before, 1e-3);
    ck_assert(dem_stored_energy_now(d).elastic == 0);
    for (int i = 0; i < N; i++) {
      ck_relative(tdm_norm(d->state.pace[i].velocity), speed[i], 5e-3);
      ck_assert(fabs(d->state.sphere[i].position.z) > 0.0085);
    }
    rig_free(r);
  }
}
END_TEST

/* ---- decks that move ---- */

/* A deck that flies with the particle above it, turned, does what one at rest does. */
START_TEST(a_moving_deck_is_the_same_deck) {
  static const char *const decks[] = {"'reduced','zeta':0.3,", "'wires',", "'plate',"};
  for (int k = 0; k < 3; k++) {
    char deck[2][200];
    snprintf(deck[0], sizeof deck[0], "%s" HOLES "'radius':0.14", decks[k]);
    snprintf(deck[1], sizeof deck[1], "%s" HOLES "'radius':0.14,'center':[0,0,0.1],'orientation':[0.8,0,0.6,0]",
             decks[k]);
    rig *rest = rig_of("[0,0,0]", 0.7, "", deck[0], ONE("[9,9,9]"), 1e-6);
    rig *fly = rig_of("[0,0,0]", 0.7, "'motion':{'velocity':[3,-2,1]},", deck[1], ONE("[9,9,9]"), 1e-6);
    const tdm_quat turn = {0.8, 0, 0.6, 0};
    const tdm_vec3 x = {0.00451337, 0.00601153, 0.01550371}, v = {0.2, -0.3, -1}, drift = {3, -2, 1};
    place(rest, 0, x, v);
    place(fly, 0, tdm_add(tdm_v3(0, 0, 0.1), tdm_quat_rotate(turn, x)), tdm_add(drift, tdm_quat_rotate(turn, v)));
    const double dt = 1e-6;
    for (int step = 0; step < 20000; step++) {
      one_step(rest->data, NULL, dt);
      one_step(fly->data, NULL, dt);
    }
    tdm_vec3 end = rest->data->state.sphere[0].position, own = fly->data->state.sphere[0].position;
    own = tdm_sub(own, tdm_axpy(20000 * dt, drift, tdm_v3(0, 0, 0.1)));
    ck_vector(tdm_quat_rotate(tdm_quat_conj(turn), own), end, 1e-6);
    ck_assert(tdm_norm(tdm_sub(end, tdm_axpy(20000 * dt, v, x))) > 1e-3); /* it was hit */
    rig_free(rest);
    rig_free(fly);
  }
}
END_TEST

/* Small ones fall through a deck that swings sideways, large ones stay on it; nobody is lost or stays in a hole. */
START_TEST(a_swinging_deck_sorts) {
  static const char *const decks[] = {"'reduced','zeta':0.2,", "'wires','thickness':0.006,",
                                      "'plate','thickness':0.003,"};
  for (int k = 0; k < 3; k++) {
    rig *r =
        rig_make(scene_json("{'gravity':[0,0,-9.81],'contact':{'normal':'hooke','tangential':'coulomb'},"
                            "'materials':[{'name':'m','density':2500}],"
                            "'pairs':[{'materials':['m','m'],'restitution':0.5,'friction':0.2,'stiffness':2e4}],"
                            "'bodies':[{'name':'b','material':'m','motion':{'oscillation':{'amplitude':[0.01,0.007,0],"
                            "'frequency':7}},'shapes':[{" DECK "%s" HOLES "'radius':0.16}]},"
                            "{'name':'w','material':'m','shapes':[{'type':'cylinder','side':'inside','radius':0.14,"
                            "'point':[0,0,-0.1],'length':0.4},{'type':'plane','point':[0,0,-0.1],'normal':[0,0,1]}]}],"
                            "'particles':[{'type':'block','material':'m','radius':0.007,'spacing':0.03,"
                            "'corner':[-0.075,-0.075,0.02],'count':[6,6,1]},{'type':'block','material':'m',"
                            "'radius':0.0125,'spacing':0.03,'corner':[-0.075,-0.075,0.045],'count':[6,6,1]}]}",
                            decks[k]),
                 5e-5, 0, NULL);
    dem_data *d = r->data;
    for (int step = 0; step < 40000; step++) {
      one_step(d, NULL, 5e-5);
    }
    int below = 0;
    for (int i = 0; i < 72; i++) {
      const dem_sphere *s = &d->state.sphere[i];
      ck_assert(hypot(s->position.x, s->position.y) < 0.14 && s->position.z > -0.095 && s->position.z < 0.2);
      below += s->position.z < -0.02;
      ck_assert_msg((d->state.sphere[i].radius > 0.012) == (s->position.z > -0.02),
                    "deck %d: particle %d is at %g %g %g", k, i, s->position.x, s->position.y, s->position.z);
    }
    ck_assert_int_eq(below, 36);
    rig_free(r);
  }
}
END_TEST

/* ---- materials, cost, pictures, errors ---- */

/* The friction on a deck is that of its own material, that on a wall of the same body the body's. */
START_TEST(a_deck_has_its_own_material) {
  rig *r = rig_make(scene_json("{'gravity':[0,0,-10],'contact':{'normal':'hooke','tangential':'coulomb'},"
                               "'materials':[{'name':'m','density':2500},{'name':'steel','density':1},"
                               "{'name':'net','density':1}],"
                               "'pairs':[{'materials':['m','m'],'restitution':0.3,'friction':0.5,'stiffness':1e6},"
                               "{'materials':['m','steel'],'restitution':0.3,'friction':0.3,'stiffness':1e6},"
                               "{'materials':['m','net'],'restitution':0.3,'friction':0.06,'stiffness':1e6}],"
                               "'bodies':[{'name':'b','material':'steel','shapes':[{" DECK "'plate'," HOLES
                               "'radius':0.14,'material':'net'},"
                               "{'type':'plane','point':[0,0,-1],'normal':[0,0,1]}]}],'particles':[" ONE(
                                   "[0,0.014,0.01299],[0.3,0,-0.99001]") "]}"),
                    1e-6, 0, NULL);
  dem_data *d = r->data;
  ck_assert_int_eq(r->model->wall[0].material, 2);
  ck_assert_int_eq(r->model->wall[1].material, 1);
  place(r, 0, d->state.sphere[0].position, tdm_v3(1, 0, 0));
  place(r, 1, d->state.sphere[1].position, tdm_v3(1, 0, 0));
  forces_now(d, false);
  rig_steps(r, 1);
  ck_relative(d->state.push[0].force.x, -0.06 * d->state.push[0].force.z, 1e-6);
  ck_relative(d->state.push[1].force.x, -0.3 * d->state.push[1].force.z, 1e-6);
  rig_free(r);
  tdm_error err =
      rig_refused(scene_json("{'contact':{'normal':'hooke'},'materials':[{'name':'m','density':1},"
                             "{'name':'net','density':1}],'pairs':[{'materials':['m','m'],'restitution':1,"
                             "'friction':0,'stiffness':1}],'bodies':[{'name':'b','material':'m','shapes':[{" DECK
                             "'plate'," HOLES "'radius':0.14,'material':'net'}]}],'particles':[" ONE("[0,0,1]") "]}"),
                  NULL);
  ck_assert_msg(strstr(err.message, "net"), "%s", err.message);
}
END_TEST

/* What is looked at near a particle is as much with 25 000 holes as with 100. */
START_TEST(the_number_of_holes_costs_nothing) {
  random_state = 13;
  for (int k = 0; k < 1000; k++) {
    dem_screen few = {.deck = k % 2 ? DEM_DECK_PLATE : DEM_DECK_WIRES,
                      .aisles = 5,
                      .pieces = 1,
                      .half = 0.011,
                      .bar = 0.006,
                      .radius = 0.15,
                      .thickness = 0.006},
               many = few;
    many.aisles = 90; /* 181 x 181 x pi/4 */
    many.radius = 90 * 0.028;
    tdm_vec3 x = {between(-0.05, 0.05), between(-0.05, 0.05), between(-0.03, 0.03)};
    int list[2][64];
    ck_assert_int_eq(dem_screen_near(&few, x, 0.02, list[0], 64), dem_screen_near(&many, x, 0.02, list[1], 64));
  }
}
END_TEST

static int polygons_of(const char *deck, double *area, double level) {
  rig *r = rig_of("[0,0,0]", 1, "", deck, ONE("[0,0,1]"), 1e-6);
  dem_bounds bounds = dem_scene_bounds(r->data);
  ck_near(bounds.low.x, -2.5, 1e-12);
  dem_polygons all = {0};
  tdm_error err = {0};
  ck_assert(dem_polygons_make(&all, r->data, &bounds, &err) == TDM_OK);
  *area = 0;
  for (int k = 0; k < all.count; k++) {
    const tdm_vec3 *c = all.polygon[k].corner;
    ck_assert(fabs(c[0].z) <= level && fabs(c[2].z) <= level);
    *area += 0.5 * tdm_norm(tdm_cross(tdm_sub(c[2], c[0]), tdm_sub(c[3], c[1])));
  }
  int count = all.count;
  dem_polygons_free(&all);
  rig_free(r);
  return count;
}

START_TEST(they_are_drawn) {
  double area;
  ck_assert_int_eq(polygons_of("'reduced'," HOLES "'radius':2.5", &area, 0), 356 + 72);
  ck_relative(area, M_PI * 2.5 * 2.5 * 2 * 0.006 / 0.028 + 2 * M_PI * 2.497 * 0.006, 0.01); /* and its rim */
  ck_assert_int_eq(polygons_of("'wires'," HOLES "'radius':2.5", &area, 0.006), (4 + 2) * 356);
  ck_assert_int_eq(polygons_of("'wires','hole':0.05,'bar':0.01,'radius':2.5", &area, 0.01), (12 + 2) * 168);
  ck_assert_int_lt(polygons_of("'plate','hole':0.0002,'bar':0.0001,'radius':2.5", &area, 0.0001), 20000);
  ck_relative(area, M_PI * 2.5 * 2.5, 0.01);
}
END_TEST

START_TEST(its_sizes_are_in_the_fingerprint) {
  static const char *const decks[] = {"'reduced'," HOLES "'radius':0.14",
                                      "'reduced'," HOLES "'radius':0.15",
                                      "'reduced'," HOLES "'radius':0.14,'zeta':0.1",
                                      "'wires'," HOLES "'radius':0.14",
                                      "'wires'," HOLES "'radius':0.14,'layers':1",
                                      "'plate'," HOLES "'radius':0.14"};
  uint64_t print[6];
  for (int k = 0; k < 6; k++) {
    rig *r = rig_of("[0,0,0]", 1, "", decks[k], ONE("[0,0,1]"), 1e-6);
    print[k] = dem_fingerprint_bed(r->model);
    for (int other = 0; other < k; other++)
      ck_assert(print[other] != print[k]);
    rig_free(r);
  }
}
END_TEST

START_TEST(what_is_wrong_is_told) {
  static const char *const wrong[][3] = {
      {HOLES "'radius':0.14", "deck", "missing"},
      {"'deck':'reduced','bar':0.006,'radius':0.14", "hole", "missing"},
      {"'deck':'reduced'," HOLES "'radius':0.01", "radius", "no bar"},
      {"'deck':'reduced','hole':1e-9,'bar':1e-9,'radius':0.14", "radius", "in metres"},
      {"'deck':'reduced'," HOLES "'radius':0.14,'inner_radius':0.14", "inner_radius", "less than"},
      {"'deck':'reduced'," HOLES "'radius':0.14,'zeta':1.1", "zeta", "1"},
      {"'deck':'reduced'," HOLES "'radius':0.14,'zeta':0.1,'clearance':0.001", "clearance", "remove one"},
      {"'deck':'reduced'," HOLES "'radius':0.14,'layers':2", "layers", "unknown"},
      {"'deck':'reduced'," HOLES "'radius':0.14,'passing':'fast'", "passing", "at_once"},
      {"'deck':'wires'," HOLES "'radius':0.14,'zeta':0.5", "zeta", "unknown"},
      {"'deck':'wires'," HOLES "'radius':0.14,'layers':3", "layers", "1"},
      {"'deck':'wires'," HOLES "'radius':0.14,'thickness':0.03", "thickness", "no holes"},
      {"'deck':'plate'," HOLES "'radius':0.14,'material':'n'", "material", "m"}};
  for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
    tdm_error err = rig_refused(scene_json("{'materials':[{'name':'m','density':1,'young_modulus':1e7,"
                                           "'poisson_ratio':0.3}],'bodies':[{'name':'b','material':'m','shapes':["
                                           "{'type':'screen',%s}]}]}",
                                           wrong[k][0]),
                                NULL);
    ck_assert_msg(strstr(err.path, wrong[k][1]) && strstr(err.message, wrong[k][2]), "%s: %s", err.path, err.message);
  }
}
END_TEST

TEST_MAIN("dem_screen", the_layout_is_that_of_the_paper, passages_are_those_of_the_models,
          the_reduced_gap_is_a_distance, rain_passes_in_its_share, one_on_its_way_is_not_hit, at_once_means_at_once,
          nothing_acts_over_a_hole, who_slides_passes_at_once, who_does_not_turn_slides, touches_are_those_of_all_bars,
          a_plate_is_flat, wires_are_cylinders, elastic_bounces_keep_the_energy, a_moving_deck_is_the_same_deck,
          a_swinging_deck_sorts, a_deck_has_its_own_material, the_number_of_holes_costs_nothing, they_are_drawn,
          its_sizes_are_in_the_fingerprint, what_is_wrong_is_told)

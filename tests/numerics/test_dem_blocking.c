/* Blocked holes: who blocks, on every kind of deck, on one that moves; how many there are; what is refused. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/flow/blocking.h"
#include "dem/geometry/screen/screen.h"
#include "dem/store/state_file.h"
#include "tests/test_main.h"

/* holes of 20 mm, bars of 10 mm, a blocking time of 0.2 s; grains slide without friction along x */
#define SCENE                                                                                                        \
  "{'materials':[{'name':'a','density':1000,'young_modulus':1e5,'poisson_ratio':0.25},{'name':'rubber',"             \
  "'density':1000,'young_modulus':1e5,'poisson_ratio':0.25}],'pairs':[{'materials':['a','a'],'restitution':0.1,'"    \
  "friction':0},"                                                                                                    \
  "{'materials':['a','rubber'],'restitution':0.1,'friction':0},{'materials':['rubber','rubber'],'restitution':0.1,'" \
  "friction':0}],"                                                                                                   \
  "'bodies':[{'name':'barrel','material':'a','shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-1]},"          \
  "{'type':'screen','deck':%s,'hole':0.02,'bar':0.01,'radius':0.2}]%s}],"                                            \
  "'sinks':[{'name':'out','type':'plane','point':[0,0,-0.5],'normal':[0,0,1]}],"                                     \
  "'screening':{'materials':['a'],'decks':[{'name':'top','outlets':['out'],'blocking_time':0.2,"                     \
  "'screen':{'body':'barrel','shape':1}}]},'particles':[%s]}"
#define GRAIN(material, radius, x, y, z, v)                                                             \
  "{'type':'list','material':'" material "','radius':" #radius ",'positions':[[" #x "," #y "," #z "]]," \
  "'velocity':[" #v ",0,0]}"

static const double dt = 1e-4;

static rig *deck(const char *kind, const char *motion, const char *particles) {
  rig *r = rig_make(scene_json(SCENE, kind, motion, particles), dt, 0, NULL);
  ck_assert_uint_eq(r->model->screening.every, 100);
  flow_now(r->data, 0, dt);
  return r;
}

/* to a time [s] */
static void go(rig *r, double t) {
  while ((double)r->data->state.nstep * dt < t - 1e-9) {
    one_step(r->data, NULL, dt);
    flow_now(r->data, (double)r->data->state.nstep * dt, dt);
  }
}

/* ---- who blocks ---- */

/* the height at which a ball of 15 mm lies in a hole: on the edges of a plate of 2 mm, on wires of 10 mm in one plane
 */
static const char *const kinds[] = {"'reduced','zeta':1", "'plate','thickness':0.002", "'wires','layers':1",
                                    "'reduced','zeta':1,'passing':'at_once'"};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

START_TEST(test_stays) {
  /* one stays in its hole, one slides on over others, one of rubber stays */
  static const char *const height[] = {"0.0149", "0.0121", "0.0132", "0.0149"};
  char grains[512];
  for (int k = 0; k < KINDS; k++) {
    snprintf(grains, sizeof grains,
             "{'type':'list','material':'a','radius':0.015,'positions':[[0.06,0,%s]]},{'type':'list','material':"
             "'rubber','radius':0.015,'positions':[[0.06,0.09,%s]]}",
             height[k], height[k]);
    rig *r = deck(kinds[k], "", grains);
    const dem_deck_state *top = &r->data->state.deck[0];
    go(r, 0.19);
    ck_assert(top->blocked == 0 && top->held == 0);
    go(r, 0.25);
    ck_assert_msg(top->blocked == 1 && top->held == 1 && top->blocked_most == 1, "%s: %d", kinds[k], (int)top->blocked);
    ck_assert(r->data->state.spot[0].i == 2 && r->data->state.spot[0].j == 0);
    /* it is freed */
    r->data->state.sphere[0].position.z += 0.1;
    go(r, 0.27);
    ck_assert(top->blocked == 0 && top->held == 0 && top->blocked_most == 1);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_slides) {
  /* over each hole for 0.1 s: it blocks none of them, and is never held; slower it blocks each in turn, unheld */
  rig *r = deck(kinds[0], "", GRAIN("a", 0.015, -0.1, 0, 0.0149, 0.2));
  for (int k = 1; k <= 8; k++) {
    go(r, 0.1 * k);
    ck_assert(r->data->state.spot[0].deck == 1);
    ck_assert(r->data->state.deck[0].blocked == 0 && r->data->state.deck[0].held == 0);
  }
  rig_free(r);
  r = deck(kinds[0], "", GRAIN("a", 0.015, -0.0101, 0, 0.0149, 0.06)); /* over the hole (0, 0) until 0.335 s */
  go(r, 0.32);
  ck_assert(r->data->state.deck[0].blocked == 1 && r->data->state.deck[0].held == 0);
  go(r, 0.4); /* over a bar */
  ck_assert(r->data->state.deck[0].blocked == 0 && r->data->state.spot[0].over == 0);
  rig_free(r);
}
END_TEST

START_TEST(test_lies_on_a_bar) {
  /* held, but no hole is blocked; beside the deck neither */
  rig *r = deck(kinds[1], "", GRAIN("a", 0.004, 0.045, 0.045, 0.005, 0) "," GRAIN("a", 0.004, 0.25, 0, 0.005, 0));
  r->data->state.sphere[1].velocity.z = r->data->state.pace[1].velocity.z = 3; /* it flies */
  go(r, 0.3);
  ck_assert(r->data->state.deck[0].blocked == 0 && r->data->state.deck[0].held == 1);
  ck_assert(r->data->state.spot[1].deck == 0);
  rig_free(r);
}
END_TEST

START_TEST(test_two_in_a_hole) {
  rig *r = deck(kinds[0], "", GRAIN("a", 0.002, 0.005, 0, 0.00199, 0) "," GRAIN("a", 0.002, -0.005, 0, 0.00199, 0));
  go(r, 0.3);
  ck_assert(r->data->state.deck[0].blocked == 1 && r->data->state.deck[0].held == 2);
  rig_free(r);
}
END_TEST

START_TEST(test_deck_moves) {
  /* the deck and its grain go along x at 0.3 m/s: on the same hole all the time */
  rig *r = deck(kinds[1], ",'motion':{'velocity':[0.3,0,0]}", GRAIN("a", 0.015, 0, 0.03, 0.0121, 0.3));
  go(r, 0.3);
  ck_near(r->data->state.sphere[0].position.x, 0.09, 1e-4);
  ck_assert(r->data->state.deck[0].blocked == 1 && r->data->state.deck[0].held == 1);
  ck_assert(r->data->state.spot[0].i == 0 && r->data->state.spot[0].j == 1);
  rig_free(r);
}
END_TEST

/* ---- states ---- */

START_TEST(test_states) {
  /* a copy and a stored state know since when; one that begins with the particles does not */
  rig *r = deck(kinds[1], "", GRAIN("a", 0.015, 0, 0, 0.0121, 0)), *other = deck(kinds[1], "", "");
  void *bytes;
  size_t size;
  tdm_error err = {0};
  go(r, 0.15);
  ck_assert_int_eq(dem_state_save(r->data, &bytes, &size), TDM_OK);
  dem_data *copy = dem_data_create(r->model), *first = r->data;
  ck_assert_int_eq(dem_data_copy(copy, first), TDM_OK);
  go(r, 0.25);
  r->data = copy;
  go(r, 0.25);
  ck_assert_mem_eq(copy->state.spot, first->state.spot, sizeof *copy->state.spot);
  ck_assert_mem_eq(copy->state.deck, first->state.deck, sizeof *copy->state.deck);
  ck_assert(copy->state.deck[0].blocked == 1);
  rig *again = deck(kinds[1], "", GRAIN("a", 0.015, 0, 0, 0.0121, 0));
  ck_assert_msg(dem_state_load(again->data, bytes, size, &err) == TDM_OK, "%s", err.message);
  go(again, 0.25);
  ck_assert_mem_eq(again->data->state.spot, first->state.spot, sizeof *first->state.spot);
  ck_assert_int_eq(dem_state_write(r->data, "blocking.state", "x", NULL, 0, &err), TDM_OK);
  ck_assert_msg(dem_state_read(other->data, DEM_STATE_START, "blocking.state", "x", NULL, 0, &err) == TDM_OK, "%s",
                err.message);
  ck_assert(other->data->state.spot[0].deck == 0 && other->data->state.nparticle == 1);
  remove("blocking.state");
  free(bytes);
  dem_data_destroy(&first);
  rig_free(r), rig_free(other), rig_free(again);
}
END_TEST

/* ---- holes ---- */

START_TEST(test_number_of_holes) {
  /* against counting one by one, and [A07]'s five-deck machine: about 25 000 holes in the finest deck */
  static const double sizes[][4] = {
      {0.01, 0.005, 0.2, 0}, {0.01, 0.005, 0.2, 0.05}, {0.01, 0.01, 0.03, 0.03 - 1e-9}, {0.5, 0.5, 1.5, 0}};
  for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
    dem_screen s = {.half = sizes[k][0], .bar = sizes[k][1], .radius = sizes[k][2], .inner = sizes[k][3]};
    s.aisles = (int)nearbyint(s.radius / dem_screen_pitch(&s));
    long n = 0, over = 0;
    const double p = dem_screen_pitch(&s);
    for (int i = -s.aisles; i <= s.aisles; i++)
      for (int j = -s.aisles; j <= s.aisles; j++) {
        const double rho2 = p * p * (i * i + j * j);
        const bool there = rho2 <= s.radius * s.radius * (1 + 1e-12) && rho2 >= s.inner * s.inner * (1 - 1e-12);
        int a, b;
        n += there;
        over += dem_screen_hole(&s, tdm_v3(i * p + 0.99 * s.half, j * p - 0.99 * s.half, 0), &a, &b);
        ck_assert(a == i && b == j);
        ck_assert(!dem_screen_hole(&s, tdm_v3(i * p + 1.01 * s.half, j * p, 0), &a, &b));
      }
    ck_assert_int_eq(dem_screen_holes(&s), n);
    ck_assert_int_eq(over, n);
    ck_assert_int_gt(n, 3);
  }
}
END_TEST

/* ---- what is refused ---- */

START_TEST(test_refused) {
  static const struct {
    const char *deck, *path, *says;
  } bad[] = {
      {"'screen':{'body':'barel','shape':1}", "dem.screening.decks[0].screen.body", "did you mean \"barrel\""},
      {"'screen':{'body':'barrel','shape':0}", "dem.screening.decks[0].screen.shape", "is no screen"},
      {"'screen':{'body':'barrel','shape':2}", "dem.screening.decks[0].screen.shape", "has 2 shapes"},
      {"'screen':{'shape':1}", "dem.screening.decks[0].screen.body", "missing"},
      {"'blocking_time':1", "dem.screening.decks[0].blocking_time", "\"screen\""},
      {"'blocking_time':0,'screen':{'body':'barrel','shape':1}", "dem.screening.decks[0].blocking_time", "greater"},
      {"'screen':{'body':'barrel','shape':1},'sorted':1},{'name':'low','outlets':['o2'],'screen':{'body':'barrel',"
       "'shape':1}",
       "dem.screening.decks[1].screen", "each deck has its own"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
    tdm_error err = rig_refused(
        scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e5,'poisson_ratio':0.25}],"
                   "'pairs':[{'materials':['a','a'],'restitution':0.1,'friction':0}],'bodies':[{'name':'barrel','"
                   "material':'a',"
                   "'shapes':[{'type':'plane','normal':[0,0,1]},{'type':'screen','deck':'plate','hole':0.02,'bar':0.01,"
                   "'radius':0.2}]}],'sinks':[{'name':'o','type':'plane','point':[0,0,-1],'normal':[0,0,1]},"
                   "{'name':'o2','type':'plane','point':[0,0,-2],'normal':[0,0,1]}],"
                   "'screening':{'decks':[{'name':'top','outlets':['o'],%s}]}}",
                   bad[k].deck),
        NULL);
    ck_assert_msg(strcmp(err.path, bad[k].path) == 0, "%zu: %s: %s", k, err.path, err.message);
    ck_assert_msg(strstr(err.message, bad[k].says), "%zu: %s: %s", k, err.path, err.message);
  }
}
END_TEST

TEST_MAIN("dem: blocked holes", test_stays, test_slides, test_lies_on_a_bar, test_two_in_a_hole, test_deck_moves,
          test_states, test_number_of_holes, test_refused)

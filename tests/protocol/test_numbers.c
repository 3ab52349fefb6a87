/* Wrong numbers, wherever a solver puts them: the run ends before anything is computed with them, and names who sent
 * them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/test_main.h"

/* A deck on a spring, and a grain on it; ' stands for ". */
static const char scene[] =
    "{'time': {'end': 0.01, 'dt': 1e-4}, 'coupling': {'n': 10, 'bodies': [{'mbd': 'deck', 'dem': 'deck'}]},\n"
    " 'output': {'interval': 1e-3},\n"
    " 'mbd': {'bodies': [{'name': 'deck', 'mass': 2, 'inertia': [1, 1, 1], 'position': [0, 0, 0]}],\n"
    "  'joints': [{'name': 'rail', 'type': 'prismatic', 'bodies': ['ground', 'deck'], 'point': [0, 0, 0],\n"
    "   'axis': [0, 0, 1]}],\n"
    "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'deck'],\n"
    "   'points': [[0, 0, -1], [0, 0, 0]], 'stiffness': 2000, 'damping': 20}]},\n"
    " 'dem': {'materials': [{'name': 'grain', 'density': 2500, 'young_modulus': 1e7, 'poisson_ratio': 0.3}],\n"
    "  'pairs': [{'materials': ['grain', 'grain'], 'restitution': 0.3, 'friction': 0.3}],\n"
    "  'bodies': [{'name': 'deck', 'material': 'grain', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}]}],\n"
    "  'particles': [{'type': 'list', 'material': 'grain', 'radius': 0.02, 'positions': [[0, 0, 0.0199]]}]}}\n";

/* who lies about what, and words of the message behind "liar 1.0" */
static const struct {
  const char *role, *lie, *words[2];
} lies[] = {
    {"mbd", "ready inertia", {"malformed READY: the inertia of body \"deck\"", "negative about some axis"}},
    {"mbd", "ready lopsided inertia", {"malformed READY: the inertia of body \"deck\" is not symmetric", NULL}},
    {"mbd", "ready zero quaternion", {"malformed READY: the state of body \"deck\" has a quaternion", NULL}},
    {"mbd", "ready far away", {"malformed READY: the state of body \"deck\" is too large to be squared", NULL}},
    {"mbd", "ready mobility", {"malformed READY: the mobility has a negative number on its diagonal", NULL}},
    {"mbd", "ready channel", {"malformed READY: channel \"", "begins with 1e+300, which is too large"}},
    {"dem", "ready load", {"malformed READY: the load of body \"deck\" is too large to be squared", NULL}},
    {"mbd", "state", {"returned a state of body \"deck\" that is not finite", "from 0.003 s to 0.004 s"}},
    {"mbd", "zero quaternion", {"returned a state of body \"deck\" that has a quaternion that is not of norm 1", NULL}},
    {"mbd", "long quaternion", {"returned a state of body \"deck\" that has a quaternion that is not of norm 1", NULL}},
    {"mbd", "recorded state", {"returned a recorded state of body \"deck\" that is too large to be squared", NULL}},
    {"mbd", "recorded quaternion", {"returned a recorded state of body \"deck\" that has a quaternion", NULL}},
    {"mbd", "acceleration", {"returned an acceleration of body \"deck\" that is not finite", NULL}},
    {"mbd", "negative mobility", {"returned a mobility that has a negative number on its diagonal", NULL}},
    {"mbd", "lopsided mobility", {"returned a mobility that is not symmetric", NULL}},
    {"mbd", "indefinite mobility", {"returned a mobility that is not positive", NULL}},
    {"mbd", "path", {"returned a state of the path of body \"deck\" that is not finite", NULL}},
    {"mbd", "backwards", {"malformed RESULT: a path with a node at 0 s, asked for from 0.004 s to 0.005 s", NULL}},
    {"mbd", "exchanged", {"returned a supplied energy that is not finite", NULL}},
    {"mbd", "kinetic", {"returned an infinite energy", NULL}},
    {"mbd", "channel", {"returned nan for the channel \"", "which is not finite"}},
    {"mbd", "huge channel", {"returned -1e+155 for the channel \"", "which is too large to be squared"}},
    {"dem", "load", {"returned a load of body \"deck\" that is too large to be squared", NULL}},
    {"dem", "recorded load", {"returned a recorded load of body \"deck\" that is not finite", NULL}},
    {"dem", "end", {"returned an end of body \"deck\" that has a quaternion that is not of norm 1", NULL}},
    {"dem", "channel", {"returned nan for the channel \"particles.com.x\"", "which is not finite"}},
};

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static int run(const char *role, const char *lie) {
  return command("env LIE_ROLE=%s LIE='%s' tandem run %s/scene.json --force --out %s/out --set "
                 "coupling.solvers.%s=lying_solver",
                 role, lie, dir, dir, role);
}

START_TEST(liars_are_named) {
  setup();
  for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++) {
    char who[64];
    int status = run(lies[i].role, lies[i].lie);
    ck_assert_msg(status == 1, "%s %s: %d: %s", lies[i].role, lies[i].lie, status, command_output);
    snprintf(who, sizeof who, "%s (liar 1.0): ", lies[i].role);
    expect_output(who);
    for (int w = 0; w < 2 && lies[i].words[w]; w++)
      expect_output(lies[i].words[w]);
    expect_nothing_left(dir);
  }
  directory_remove(dir);
}
END_TEST

/* The same solvers, honest. */
START_TEST(others_pass) {
  setup();
  static const char *const roles[] = {"mbd", "dem"};
  for (int i = 0; i < 2; i++) {
    int status = run(roles[i], "");
    ck_assert_msg(status == 0, "%s: %d: %s", roles[i], status, command_output);
  }
  directory_remove(dir);
}
END_TEST

TEST_MAIN("numbers", liars_are_named, others_pass)

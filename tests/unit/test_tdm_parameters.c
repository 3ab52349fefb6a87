/* Parameters of scenes: values, conditions, errors with their places, overrides, hostile input. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/parameters/expression.h"
#include "protocol/parameters/load.h"
#include "protocol/scene/remark.h"
#include "tests/scene_json.h"
#include "tests/test_main.h"

#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Load a scene from its text, with single quotes for double ones; `set` may be NULL. */
static tdm_status load_long(tdm_scene *scene, char *text, const char *const *set, tdm_error *err) {
  char file[] = "/tmp/tandem-test-XXXXXX";
  const int fd = mkstemp(file);
  ck_assert_int_ge(fd, 0);
  double_quotes(text);
  ck_assert_int_eq(write(fd, text, strlen(text)), (ssize_t)strlen(text));
  close(fd);
  *err = (tdm_error){0};
  const tdm_status status = tdm_scene_load(scene, file, set, err);
  unlink(file);
  return status;
}

static tdm_status load(tdm_scene *scene, const char *text, const char *const *set, tdm_error *err) {
  char copy[8192];
  snprintf(copy, sizeof copy, "%s", text);
  return load_long(scene, copy, set, err);
}

/* ---- values ---- */

/* the value of an expression of a = 2, b = -3, in the section dem */
static double value(const char *expression) {
  tdm_scene scene;
  tdm_error err;
  char text[2048];
  snprintf(text, sizeof text, "{'parameters': {'a': 2, 'b': -3}, 'dem': {'x': '=%s'}}", expression);
  ck_assert_msg(load(&scene, text, NULL, &err) == TDM_OK, "%s: %s", expression, err.message);
  const json_t *x = tdm_scene_value(scene.root, "dem.x");
  ck_assert(json_is_number(x));
  const double number = json_number_value(x);
  tdm_scene_destroy(&scene);
  return number;
}

START_TEST(values_of_expressions) {
  const struct {
    const char *text;
    double value;
  } cases[] = {{"a", 2},
               {" 1.5e-3 * a", 3e-3},
               {"a+b*2", -4},
               {"(a+b)*2", -2},
               {"-a^2", -4},
               {"2^3^2", 512},
               {"a/b", 2.0 / -3.0},
               {"0.1+0.2", 0.1 + 0.2},
               {".5", 0.5},
               {"pi", M_PI},
               {"30*deg", 30 * (M_PI / 180)},
               {"sin(a)", sin(2)},
               {"cos(a)", cos(2)},
               {"tan(a)", tan(2)},
               {"asin(1/a)", asin(0.5)},
               {"acos(1/a)", acos(0.5)},
               {"atan(a)", atan(2)},
               {"atan2(b, a)", atan2(-3, 2)},
               {"sinh(a)", sinh(2)},
               {"cosh(a)", cosh(2)},
               {"tanh(a)", tanh(2)},
               {"exp(a)", exp(2)},
               {"ln(a)", log(2)},
               {"log10(a)", log10(2)},
               {"sqrt(a)", sqrt(2)},
               {"abs(b)", 3},
               {"sign(b)", -1},
               {"sign(0)", 0},
               {"rint(2.5)", 3},
               {"round(b/2)", -2},
               {"floor(b/2)", -2},
               {"ceil(b/2)", -1},
               {"min(a, b, 7)", -3},
               {"max(a, b, 7)", 7},
               {"sum(a, b, 7)", 6},
               {"avg(a, b, 7)", 2},
               {"a > b ? 10 : 20", 10},
               {"a < b ? 1/0 : 20", 20},
               {"a == 2 && b != 2", 1},
               {"a <= 1 || b >= 0", 0},
               {"min(max(a, 1), sum(a, b))", -1}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
    ck_assert_msg(fabs(value(cases[i].text) - cases[i].value) <= 4e-16 * fabs(cases[i].value), "%s = %.17g, not %.17g",
                  cases[i].text, value(cases[i].text), cases[i].value);
}
END_TEST

START_TEST(parameters_use_each_other_in_any_order) {
  tdm_scene scene;
  tdm_error err;
  ck_assert_int_eq(load(&scene,
                        "{'title': '= no expression', 'parameters': {'omega': '=rpm*f', 'f': '=2*pi/60', 'rpm': 50},\n"
                        " 'gravity': [0, 0, '=-9.5-0.31'], 'time': {'end': '=rpm/25'},\n"
                        " 'dem': {'list': [1, ['=rpm', {'deep': '=omega'}]], 'name': 'a=b', 'on': true}}",
                        NULL, &err),
                   TDM_OK);
  ck_assert(json_number_value(tdm_scene_value(scene.root, "parameters.omega")) == 50 * (2 * M_PI / 60));
  ck_assert(json_number_value(tdm_scene_value(scene.root, "dem.list[1][1].deep")) == 50 * (2 * M_PI / 60));
  ck_assert(json_number_value(tdm_scene_value(scene.root, "gravity[2]")) == -9.5 - 0.31);
  ck_assert(json_is_integer(tdm_scene_value(scene.root, "time.end"))); /* whole numbers are whole */
  ck_assert(json_is_integer(tdm_scene_value(scene.root, "dem.list[1][0]")));
  ck_assert_str_eq(json_string_value(tdm_scene_value(scene.root, "title")), "= no expression");
  ck_assert_str_eq(json_string_value(tdm_scene_value(scene.root, "dem.name")), "a=b");
  ck_assert_str_eq(json_string_value(tdm_scene_value(scene.written, "dem.list[1][1].deep")), "=omega");
  ck_assert(json_is_true(tdm_scene_value(scene.root, "dem.on")));
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(without_parameters_a_scene_stays_what_it_is) {
  tdm_scene scene;
  tdm_error err;
  ck_assert_int_eq(load(&scene, "{'time': {'end': 1.0}, 'dem': {'bodies': [{'x': 1}, {'x': 2}]}}", NULL, &err), TDM_OK);
  ck_assert_ptr_eq(scene.root, scene.written);
  ck_assert_ptr_null(scene.kept);
  ck_assert_ptr_null(tdm_scene_parameters(&scene));
  tdm_scene_destroy(&scene);
  /* resolving again what is resolved changes nothing */
  ck_assert_int_eq(
      load(&scene, "{'parameters': {'a': 2}, 'dem': {'x': '=a', 'y': [{'if': '=a', 'z': 3}]}}", NULL, &err), TDM_OK);
  json_t *once = json_incref(scene.root);
  ck_assert_int_eq(tdm_scene_resolve(&scene, &err), TDM_OK);
  ck_assert_ptr_eq(once, scene.root);
  json_t *again = tdm_scene_as_run(json_incref(once)), *run = tdm_scene_as_run(json_incref(scene.written));
  ck_assert(json_equal(once, again) && json_equal(once, run));
  ck_assert_ptr_null(tdm_scene_as_run(NULL));
  json_decref(again);
  json_decref(run);
  json_decref(once);
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(the_decimal_sign_is_a_point_in_every_locale) {
  static const char *const locales[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"};
  for (size_t i = 0; i < sizeof locales / sizeof locales[0]; i++) {
    if (!setlocale(LC_ALL, locales[i]))
      continue;
    ck_assert(value("1.5*a") == 3);
    setlocale(LC_ALL, "C");
  }
}
END_TEST

static void *many_loads(void *arg) {
  double *sum = arg;
  for (int i = 0; i < 200; i++)
    *sum += value("min(a*1.25, 100)");
  return NULL;
}

START_TEST(threads_do_not_share) {
  pthread_t thread[4];
  double sum[4] = {0};
  for (int i = 0; i < 4; i++)
    ck_assert_int_eq(pthread_create(&thread[i], NULL, many_loads, &sum[i]), 0);
  for (int i = 0; i < 4; i++) {
    pthread_join(thread[i], NULL);
    ck_assert(sum[i] == 500);
  }
}
END_TEST

/* ---- what is left out ---- */

static const char forked[] = "{'parameters': {'mode': 1, 'bad': 0},\n"
                             " 'dem': {'bodies': [\n"
                             "  {'if': '=mode == 2', 'name': 'a', 'x': '=1/bad'},\n"
                             "  {'if': '=mode == 1', 'name': 'b', 'shapes': [{'if': 0}, {'if': false}, {'y': 1}]},\n"
                             "  {'if': true, 'name': 'c'},\n"
                             "  {'name': 'd', 'x': '=mode'}]}}";

START_TEST(objects_of_lists_are_left_out) {
  tdm_scene scene;
  tdm_error err;
  ck_assert_msg(load(&scene, forked, NULL, &err) == TDM_OK, "%s", err.message);
  const json_t *bodies = tdm_scene_value(scene.root, "dem.bodies");
  ck_assert_uint_eq(json_array_size(bodies), 3);
  for (size_t i = 0; i < 3; i++) {
    const json_t *body = json_array_get(bodies, i);
    ck_assert_int_eq(json_string_value(json_object_get(body, "name"))[0], "bcd"[i]);
    ck_assert_ptr_null(json_object_get(body, "if"));
  }
  ck_assert_uint_eq(json_array_size(tdm_scene_value(scene.root, "dem.bodies[0].shapes")), 1);
  /* values by the index as written */
  ck_assert_int_eq(json_integer_value(tdm_scene_value_written_at(&scene, "dem.bodies[3].x")), 1);
  ck_assert_int_eq(json_integer_value(tdm_scene_value_written_at(&scene, "dem.bodies[1].shapes[2].y")), 1);
  ck_assert_ptr_null(tdm_scene_value_written_at(&scene, "dem.bodies[0].x"));
  ck_assert_ptr_null(tdm_scene_value_written_at(&scene, "dem.bodies[7]"));
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(later_errors_count_as_written) {
  tdm_scene scene;
  tdm_error err, later = {0};
  ck_assert_int_eq(load(&scene, forked, NULL, &err), TDM_OK);
  tdm_fail(&later, TDM_ERR_SCENE, "dem.bodies[0].shapes[0].y",
           "see dem.bodies[2].x, dem.bodies[2] and [2]; other.bodies[1]");
  tdm_scene_locate(&scene, &later);
  ck_assert_str_eq(later.path, "dem.bodies[1].shapes[2].y");
  ck_assert_msg(strstr(later.message, ":4:75: dem.bodies[1].shapes[2].y: see dem.bodies[3].x, dem.bodies[3] and [2]; "
                                      "other.bodies[1]"),
                "%s", later.message);
  /* and name the expression that gave the value */
  later = (tdm_error){0};
  tdm_fail(&later, TDM_ERR_SCENE, "dem.bodies[2].x", "is 1 but must be 2");
  tdm_scene_locate(&scene, &later);
  ck_assert_msg(strstr(later.message, ":6:17: dem.bodies[3].x: is 1 but must be 2 (the value of \"=mode\""), "%s",
                later.message);
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(remarks_count_as_written) {
  tdm_scene scene;
  tdm_error err;
  tdm_remarks table = {0};
  ck_assert_int_eq(load(&scene, forked, NULL, &err), TDM_OK);
  tdm_remarks_open(&table);
  tdm_remark(TDM_WARNING, "deep", "dem.bodies[0].x", 0, "dem.bodies[0] is deep");
  tdm_remarks_open(NULL);
  json_t *summary = json_object(), *remarks = tdm_remarks_to_json(&table, NULL);
  tdm_remarks_enter(summary, remarks, &scene);
  const json_t *entry = tdm_scene_value(summary, "warnings[0]");
  ck_assert_str_eq(json_string_value(json_object_get(entry, "path")), "dem.bodies[1].x");
  ck_assert_str_eq(json_string_value(json_object_get(entry, "message")), "dem.bodies[1] is deep");
  json_decref(summary);
  json_decref(remarks);
  tdm_scene_destroy(&scene);
}
END_TEST

/* ---- errors ---- */

static void expect_error(const char *text, const char *const *set, const char *words) {
  tdm_scene scene;
  tdm_error err;
  const tdm_status status = load(&scene, text, set, &err);
  tdm_scene_locate(&scene, &err);
  ck_assert_msg(status != TDM_OK, "%s: no error", text);
  ck_assert_msg(strstr(err.message, words) != NULL, "\"%s\" has no \"%s\"", err.message, words);
  tdm_scene_destroy(&scene);
}

/* 'dem': {'n': '=…'} on line 2, column 10 */
static void expect_wrong(const char *expression, const char *words) {
  char text[2048], message[512];
  snprintf(text, sizeof text, "{'parameters': {'rate': 2, 'zero': 0},\n 'dem': {'n': '=%s'}}", expression);
  snprintf(message, sizeof message, ":2:10: dem.n: \"=%s\" %s", expression, words);
  expect_error(text, NULL, message);
}

START_TEST(wrong_expressions) {
  expect_wrong("rat", "has the unknown name \"rat\"; did you mean \"rate\"?");
  expect_wrong("nothing_like_it", "has the unknown name \"nothing_like_it\"; add it to the section parameters");
  expect_wrong("rate(2)", "has the unknown function rate()");
  expect_wrong("sim(2)", "has the unknown function sim(); did you mean sin()?");
  expect_wrong("log(2)", "has the unknown function log(); did you mean ln()?");
  expect_wrong("sin", "has sin without its arguments; write sin(…)");
  expect_wrong("sin()", "has a function with too few arguments");
  expect_wrong("sin(1,2)", "has a function with too many arguments");
  expect_wrong("max()", "has a function with too few arguments");
  expect_wrong("pi(2)", "has the unknown function pi()");
  expect_wrong("", "is empty");
  expect_wrong("  ", "is empty");
  expect_wrong("rate*", "is not whole");
  expect_wrong("rate ? 1", "is not whole");
  expect_wrong("-", "is not whole");
  expect_wrong("1 : 2", "cannot be read at");
  expect_wrong("*2", "cannot be read at \"*2\"");
  expect_wrong("2 rate", "cannot be read at \"rate\"");
  expect_wrong("2rate", "cannot be read at \"rate\"");
  expect_wrong("1.2.3", "cannot be read at");
  expect_wrong("rate = 3", "cannot be read at \"= 3\"; write == to compare");
  expect_wrong("rate % 3", "cannot be read at \"% 3\"");
  expect_wrong("!rate", "cannot be read at \"!rate\"");
  expect_wrong("rate;", "cannot be read at \";\"");
  expect_wrong("é", "cannot be read at \"é\"");
  expect_wrong("(rate", "has a \"(\" without its \")\"");
  expect_wrong("rate)", "has a \")\" without its \"(\"");
  expect_wrong(")(", "has a \")\" without its \"(\"");
  expect_wrong("1,5", "has a comma outside of a function; the decimal sign is a point");
  expect_wrong("(1,5)", "");
  expect_wrong("()", "cannot be read at");
  expect_wrong("rate/zero", "is infinite (rate = 2, zero = 0)");
  expect_wrong("zero/zero", "is not a number (zero = 0)");
  expect_wrong("sqrt(-rate)", "is not a number (rate = 2)");
  expect_wrong("exp(1000)", "is infinite;");
}
END_TEST

START_TEST(wrong_parameters) {
  expect_error("{'parameters':\n {'a': '=b', 'b': '=c+1', 'c': '=2*b'}}", NULL,
               ":2:14: parameters.b: \"=c+1\" needs itself (b needs c needs b); give one of them a number");
  expect_error("{'parameters': {'a': '=a'}}", NULL, "\"=a\" needs itself (a needs a)");
  expect_error("{'parameters': {'a': '=bb*1'}}", NULL, "parameters.a: \"=bb*1\" has the unknown name \"bb\"");
  expect_error("{'parameters': {'a': '2'}}", NULL, "parameters.a: must be a number or an expression \"=…\"; put =");
  expect_error("{'parameters': {'a': [2]}}", NULL, "parameters.a: must be a number or an expression");
  expect_error("{'parameters': {'a b': 2}}", NULL, "\"a b\" is no name of a parameter");
  expect_error("{'parameters': {'_a': 2}}", NULL, "is no name of a parameter");
  expect_error("{'parameters': {'2a': 2}}", NULL, "is no name of a parameter");
  expect_error("{'parameters': {'': 2}}", NULL, "is no name of a parameter");
  expect_error("{'parameters': {'pi': 3}}", NULL, "is a function or a constant of expressions");
  expect_error("{'parameters': {'max': 3}}", NULL, "is a function or a constant of expressions");
  expect_error("{'parameters': [3]}", NULL, "parameters: must be an object of names and numbers");
  expect_error("{'parameters': {'a': '=1/0'}}", NULL, "parameters.a: \"=1/0\" is infinite");
  expect_error("{'dem': {'bodies': [{'if': 'yes'}]}}", NULL,
               "dem.bodies[0].if: must be a number, true, false, or an expression");
  expect_error("{'dem': {'bodies': [{'if': null}]}}", NULL, "dem.bodies[0].if: must be a number");
  expect_error("{'dem': {'bodies': [1, {'if': '=mood'}]}}", NULL, "dem.bodies[1].if: \"=mood\" has the unknown name");
}
END_TEST

START_TEST(a_whole_number_is_needed) {
  tdm_scene scene;
  tdm_error err;
  ck_assert_int_eq(load(&scene, "{'parameters': {'k': 5},\n 'dem': {'n': '=k/2', 'm': '=2*k'}}", NULL, &err), TDM_OK);
  tdm_object o = tdm_object_open(json_object_get(scene.root, "dem"), "dem", &err);
  ck_assert_int_eq(tdm_get_integer(&o, "m", 0, 0), 10);
  tdm_get_integer(&o, "n", 0, 0);
  tdm_scene_locate(&scene, &err);
  ck_assert_msg(strstr(err.message, ":2:10: dem.n: is 2.5 but must be a whole number (the value of \"=k/2\": change it "
                                    "or a parameter, or take round(), floor() or ceil() of it)"),
                "%s", err.message);
  tdm_scene_destroy(&scene);
}
END_TEST

/* ---- overrides ---- */

START_TEST(overrides_come_first) {
  static const char text[] = "{'parameters': {'rpm': 50, 'omega': '=rpm*2'}, 'dem': {'x': ['=omega', 7]}}";
  const char *const numbers[] = {"parameters.rpm=150", NULL};
  const char *const expressions[] = {"parameters.rpm==100/4", "dem.x[1]==omega+1", NULL};
  tdm_scene scene;
  tdm_error err;
  ck_assert_int_eq(load(&scene, text, numbers, &err), TDM_OK);
  ck_assert_int_eq(json_integer_value(tdm_scene_value(scene.root, "dem.x[0]")), 300);
  ck_assert_int_eq(json_integer_value(tdm_scene_value(scene.written, "parameters.rpm")), 150);
  tdm_scene_destroy(&scene);
  ck_assert_int_eq(load(&scene, text, expressions, &err), TDM_OK);
  ck_assert_int_eq(json_integer_value(tdm_scene_value(scene.root, "dem.x[0]")), 50);
  ck_assert_int_eq(json_integer_value(tdm_scene_value(scene.root, "dem.x[1]")), 51);
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(overrides_of_parameters_that_are_not_there) {
  const char *const slip[] = {"parameters.rmp=1", NULL}, *const other[] = {"parameters.zzzzzz=1", NULL};
  expect_error("{'parameters': {'rpm': 50}, 'dem': {}}", slip,
               "--set parameters.rmp: the scene has no such parameter; did you mean \"rpm\"?");
  expect_error("{'parameters': {'rpm': 50}, 'dem': {}}", other, "it has \"rpm\"");
  expect_error("{'dem': {}}", slip, "the scene has no such parameters: it has no section parameters");
}
END_TEST

START_TEST(a_parameter_that_nothing_uses) {
  tdm_scene scene;
  tdm_error err;
  tdm_remarks table = {0};
  tdm_remarks_open(&table);
  ck_assert_int_eq(load(&scene, forked, NULL, &err), TDM_OK); /* `bad` is used in what is left out */
  tdm_scene_remark_unused(&scene);
  ck_assert_int_eq(table.count, 0);
  tdm_scene_destroy(&scene);
  ck_assert_int_eq(load(&scene, "{'parameters': {'a': 1, 'b': '=a', 'c': 2}, 'dem': {}}", NULL, &err), TDM_OK);
  tdm_scene_remark_unused(&scene);
  tdm_remarks_open(NULL);
  ck_assert_int_eq(table.count, 1);
  ck_assert_int_eq(table.entry[0].level, TDM_NOTICE);
  ck_assert_str_eq(table.entry[0].path, "parameters.b");
  ck_assert_ptr_nonnull(strstr(table.entry[0].message, "no expression uses b, c of the 3 parameters"));
  tdm_scene_destroy(&scene);
}
END_TEST

/* ---- hostile input ---- */

START_TEST(long_chains) {
  enum { CHAIN = 10000, LINE = 32 };
  char *text = malloc((CHAIN + 4) * LINE);
  tdm_scene scene;
  tdm_error err;
  for (int closed = 0; closed < 2; closed++) { /* from the far end; then the end needs the first: a circle */
    size_t n = (size_t)sprintf(text, "{'parameters': {");
    for (int i = 0; i < CHAIN; i++)
      n += (size_t)sprintf(text + n, "'p%d': '=p%d+1', ", i, i + 1);
    n += (size_t)sprintf(text + n, closed ? "'p%d': '=p0'}}" : "'p%d': 1}}", CHAIN);
    const tdm_status status = load_long(&scene, text, NULL, &err);
    if (closed) {
      ck_assert_int_eq(status, TDM_ERR_SCENE);
      ck_assert_msg(strstr(err.message, "needs itself (p0 needs p1 needs"), "%s", err.message);
    } else {
      ck_assert_msg(status == TDM_OK, "%s", err.message);
      ck_assert_int_eq(json_integer_value(tdm_scene_value(scene.root, "parameters.p0")), CHAIN + 1);
    }
    tdm_scene_destroy(&scene);
  }
  free(text);
}
END_TEST

/* `times` of one text and then another, in an expression */
static tdm_status repeated(const char *head, const char *tail, int times, tdm_error *err) {
  char *text = malloc((strlen(head) + strlen(tail)) * (size_t)times + 100);
  size_t n = (size_t)sprintf(text, "{'dem': {'x': '=");
  for (int i = 0; i < times; i++)
    n += (size_t)sprintf(text + n, "%s", head);
  n += (size_t)sprintf(text + n, "1");
  for (int i = 0; i < times; i++)
    n += (size_t)sprintf(text + n, "%s", tail);
  sprintf(text + n, "'}}");
  tdm_scene scene;
  const tdm_status status = load_long(&scene, text, NULL, err);
  tdm_scene_locate(&scene, err);
  tdm_scene_destroy(&scene);
  free(text);
  return status;
}

START_TEST(deep_and_long_expressions) {
  tdm_error err;
  ck_assert_msg(repeated("(", ")", 499, &err) == TDM_OK, "%s", err.message);
  ck_assert_msg(repeated("1+", "", 499, &err) == TDM_OK, "%s", err.message);
  ck_assert_msg(repeated("sin(", ")", 199, &err) == TDM_OK, "%s", err.message);
  ck_assert_msg(repeated("1?", ":1", 199, &err) == TDM_OK, "%s", err.message);
  ck_assert_msg(repeated("max(1,", ")", 140, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(repeated("(", ")", 100000, &err), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "has 200001 characters, more than 1000; make parameters of its parts"), "%s",
                err.message);
  ck_assert_int_eq(repeated("a", "", 300, &err), TDM_ERR_SCENE); /* a name without end */
  ck_assert_ptr_nonnull(strstr(err.message, "unknown name"));
  repeated("-", "", 900, &err); /* an error or a value, and no more */
  repeated("2^", "", 400, &err);
  ck_assert_ptr_nonnull(strstr(err.message, "is infinite"));
}
END_TEST

START_TEST(deep_scenes) {
  enum { DEPTH = 600 };
  char *text = malloc(DEPTH * 16 + 100);
  size_t n = (size_t)sprintf(text, "{'dem': ");
  for (int i = 0; i < DEPTH; i++)
    n += (size_t)sprintf(text + n, "{'abc': [");
  n += (size_t)sprintf(text + n, "'=1+'");
  for (int i = 0; i < DEPTH; i++)
    n += (size_t)sprintf(text + n, "]}");
  sprintf(text + n, "}");
  tdm_scene scene;
  tdm_error err;
  ck_assert_int_eq(load_long(&scene, text, NULL, &err), TDM_ERR_SCENE);
  tdm_scene_locate(&scene, &err);
  ck_assert_msg(strstr(err.message, "is not whole"), "%s", err.message);
  tdm_scene_destroy(&scene);
  free(text);
}
END_TEST

TEST_MAIN("parameters", values_of_expressions, parameters_use_each_other_in_any_order,
          without_parameters_a_scene_stays_what_it_is, the_decimal_sign_is_a_point_in_every_locale,
          threads_do_not_share, objects_of_lists_are_left_out, later_errors_count_as_written, remarks_count_as_written,
          wrong_expressions, wrong_parameters, a_whole_number_is_needed, overrides_come_first,
          overrides_of_parameters_that_are_not_there, a_parameter_that_nothing_uses, long_chains,
          deep_and_long_expressions, deep_scenes)

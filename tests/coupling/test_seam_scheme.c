/* A coupling scheme in one file: settings, what it keeps from window to window, a statistic.
 *
 * blend: MBD goes first, on   w m_k-1 + (1 - w) m_k-2,   m_k the mean load of window k. With the weight w = 1 it is
 * `hold`.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/solve.h"
#include "coupler/scheme/schemes.h"
#include "tests/coupling/seam_run.h"
#include "tests/test_main.h"

typedef struct {
  double weight; /* w */
} settings;

/* The scheme's memory: two means of each body, then the statistic. */
typedef struct {
  tdm_wrench *last, *before; /* (nbody) */
  double *largest;           /* force that was blended [N] */
} memory;

static size_t memory_size(int nbody) {
  return 2 * (size_t)nbody * sizeof(tdm_wrench) + sizeof(double);
}

static memory memory_of(const cpl_loop *loop) {
  tdm_wrench *first = (tdm_wrench *)(void *)loop->memory;
  return (memory){first, first + loop->nbody, (double *)(void *)(first + 2 * loop->nbody)};
}

static void read_settings(void *own, tdm_object *o) {
  ((settings *)own)->weight = tdm_get_number(o, "weight", 1, TDM_POSITIVE);
}

static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  const memory m = memory_of(loop);
  for (int i = 0; i < loop->nbody; i++)
    m.last[i] = m.before[i] = loop->session->load[i];
  return err->status;
}

static tdm_vec3 blended(double w, tdm_vec3 last, tdm_vec3 before) {
  return w == 1 ? last : tdm_axpy(w, last, tdm_scale(1 - w, before));
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  const double w = ((const settings *)loop->scheme_settings)->weight;
  const memory m = memory_of(loop);
  for (int i = 0; i < loop->nbody; i++) {
    loop->load[i * TDM_LOAD_MAX] =
        (tdm_wrench){blended(w, m.last[i].force, m.before[i].force), blended(w, m.last[i].moment, m.before[i].moment)};
    *m.largest = fmax(*m.largest, tdm_norm(loop->load[i * TDM_LOAD_MAX].force));
    m.before[i] = m.last[i];
  }
  if (cpl_solve_mbd(loop, 1, err) != TDM_OK ||
      cpl_solve_dem_along(loop, loop->state_start, loop->state_end, err) != TDM_OK)
    return err->status;
  memcpy(m.last, loop->mean, (size_t)loop->nbody * sizeof *m.last);
  return TDM_OK;
}

static void enter(const cpl_loop *loop, json_t *summary) {
  json_object_set_new(summary, "blend", json_pack("{s:f}", "largest_N", *memory_of(loop).largest));
}

static void tell(const cpl_loop *loop, char *line, size_t size) {
  snprintf(line, size, "blended up to %.3g N", *memory_of(loop).largest);
}

static const cpl_scheme blend = {.name = "blend",
                                 .summary = "MBD first, on a mean of the last two window means",
                                 .better = "proxy",
                                 .settings_size = sizeof(settings),
                                 .read = read_settings,
                                 .memory = memory_size,
                                 .open = begin,
                                 .advance = advance,
                                 .enter = enter,
                                 .tell = tell};

static const cpl_scheme *const schemes[] = {&cpl_scheme_proxy, &cpl_scheme_hold, &blend, NULL};

static const char *dir;
static cpl_run_result result;
static tdm_error err;

static void set_up(void) {
  dir = directory_with_scene(seam_scene);
}

static void clean_up(void) {
  directory_remove(dir);
}

static tdm_status run(const char *out, const char *scheme, const char *more) {
  const char *const set[] = {scheme, more, NULL};
  err = (tdm_error){0};
  return seam_run(dir, out, set, schemes, NULL, &result, &err);
}

START_TEST(a_setting_and_the_bits_of_hold) {
  set_up();
  ck_assert_msg(run("hold", "coupling.scheme=hold", NULL) == TDM_OK, "%s", err.message);
  ck_assert_msg(run("one", "coupling.scheme=blend", NULL) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(command("cmp %s/hold/body_box.csv %s/one/body_box.csv", dir, dir), 0);
  ck_assert_msg(run("half", "coupling.scheme=blend", "coupling.blend.weight=0.5") == TDM_OK, "%s", err.message);
  ck_assert_int_eq(command("cmp -s %s/hold/body_box.csv %s/half/body_box.csv", dir, dir), 1);
  clean_up();
}
END_TEST

START_TEST(a_statistic_in_the_summary_and_on_the_terminal) {
  set_up();
  ck_assert_msg(run("one", "coupling.scheme=blend", NULL) == TDM_OK, "%s", err.message);
  json_t *summary = seam_summary(dir, "one");
  const double largest = json_number_value(json_object_get(json_object_get(summary, "blend"), "largest_N"));
  ck_assert_double_gt(largest, 0.1);
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(summary, "settings"), "coupling.scheme")),
                   "blend");
  json_decref(summary);
  char line[160];
  snprintf(line, sizeof line, "blended up to %.3g N", largest);
  ck_assert_str_eq(result.scheme_line, line);
  clean_up();
}
END_TEST

START_TEST(wrong_settings_have_their_place) {
  set_up();
  ck_assert_int_eq(run("bad", "coupling.scheme=blend", "coupling.blend.weight=-1"), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "coupling.blend.weight") != NULL, "%s", err.message);
  ck_assert_int_eq(run("bad", "coupling.scheme=blend", "coupling.blend.weigth=1"), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "weigth") != NULL && strstr(err.message, "weight\"") != NULL, "%s", err.message);
  /* it is read, too, when another scheme runs; and without the row nobody knows it */
  ck_assert_int_eq(run("bad", "coupling.scheme=hold", "coupling.blend.weight=-1"), TDM_ERR_SCENE);
  const char *const set[] = {"coupling.scheme=blend", NULL};
  err = (tdm_error){0};
  ck_assert_int_eq(seam_run(dir, "bad", set, NULL, NULL, &result, &err), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "blend") != NULL, "%s", err.message);
  clean_up();
}
END_TEST

TEST_MAIN("seam: a scheme", a_setting_and_the_bits_of_hold, a_statistic_in_the_summary_and_on_the_terminal,
          wrong_settings_have_their_place)

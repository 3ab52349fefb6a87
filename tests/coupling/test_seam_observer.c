/* An observer in one file: it counts windows and rows, and may end the run. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/observer.h"
#include "tests/coupling/seam_run.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

/* What the test knows of it afterwards. */
typedef struct {
  uint64_t ends_at; /* window that it does not like; 0: none */
  int opened, windows, rows, done, failed, closed, freed;
  uint64_t steps;
  double t, x; /* of the last window's end */
} account;

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  account *a = *own = self->context;
  a->opened++;
  ck_assert(loop->window == 0 && outlet->quiet && outlet->results->dir[0]);
  return err->status;
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  account *a = own;
  ck_assert_uint_eq(loop->step0, a->steps);
  a->windows++;
  a->rows += loop->nsample;
  a->steps = loop->step1;
  a->t = loop->t1;
  a->x = loop->state_end[0].pose.position.x;
  return a->ends_at && loop->window + 1 == a->ends_at ? tdm_fail(err, TDM_ERR_LIMIT, NULL, "seen enough") : TDM_OK;
}

static void done(void *own, const cpl_loop *loop) {
  (void)loop;
  ((account *)own)->done++;
}

static void failed(void *own, const cpl_loop *loop, const tdm_error *reason) {
  (void)loop;
  ck_assert_str_eq(reason->message, "seen enough");
  ((account *)own)->failed++;
}

static tdm_status end(void *own, tdm_error *err) {
  (void)err;
  ((account *)own)->closed++;
  return TDM_OK;
}

static void enter(const void *own, json_t *summary) {
  json_object_set_new(summary, "account", json_integer(((const account *)own)->windows));
}

static void let_go(void *own) {
  ((account *)own)->freed++;
}

static cpl_run_result result;
static tdm_error err;

static tdm_status run(const char *dir, account *a) {
  const cpl_observer row = {.name = "account",
                            .context = a,
                            .open = begin,
                            .window = window,
                            .done = done,
                            .failed = failed,
                            .close = end,
                            .enter = enter,
                            .free = let_go};
  const cpl_observer *const rows[] = {&row, NULL};
  err = (tdm_error){0};
  return seam_run(dir, "out", NULL, NULL, rows, &result, &err);
}

START_TEST(every_window_and_row_is_seen) {
  const char *dir = directory_with_scene(seam_scene);
  account a = {0};
  cpl_table body;
  ck_assert_msg(run(dir, &a) == TDM_OK, "%s", err.message);
  ck_assert(a.opened == 1 && a.done == 1 && a.failed == 0 && a.closed == 1 && a.freed == 1);
  ck_assert_int_eq(a.windows, 100);
  ck_assert_uint_eq(a.steps, 10000);
  read_table(&body, dir, "out/body_box.csv");
  ck_assert_int_eq(a.rows + 1, body.nrow); /* and that of t = 0 */
  ck_assert_double_eq(column(&body, "time")[body.nrow - 1], a.t);
  ck_assert_double_eq(column(&body, "x")[body.nrow - 1], a.x);
  cpl_table_free(&body);
  json_t *summary = seam_summary(dir, "out");
  ck_assert_int_eq(json_integer_value(json_object_get(summary, "account")), 100);
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

START_TEST(its_error_ends_the_run) {
  const char *dir = directory_with_scene(seam_scene);
  account a = {.ends_at = 7};
  cpl_table body;
  ck_assert_int_eq(run(dir, &a), TDM_ERR_LIMIT);
  ck_assert_str_eq(err.message, "seen enough");
  ck_assert(a.windows == 7 && a.done == 0 && a.failed == 1 && a.closed == 1 && a.freed == 1);
  read_table(&body, dir, "out/body_box.csv"); /* what was computed is kept */
  ck_assert_int_eq(body.nrow, 8);
  cpl_table_free(&body);
  json_t *summary = seam_summary(dir, "out");
  ck_assert_str_eq(json_string_value(json_object_get(summary, "error")), "seen enough");
  ck_assert_int_eq(json_integer_value(json_object_get(summary, "account")), 7);
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("seam: an observer", every_window_and_row_is_seen, its_error_ends_the_run)

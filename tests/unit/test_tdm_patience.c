/* When a wait looks for its message before it sleeps. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/wire/patience.h"
#include "tests/test_main.h"

/* waits that sleep at once before the next that looks */
static int sleeps(tdm_patience *p) {
  int n = 0;
  while (!tdm_patience_looks(p))
    n++;
  return n;
}

START_TEST(looks_that_pay_go_on) {
  tdm_patience p = {0};
  for (int i = 0; i < 100; i++) {
    ck_assert(tdm_patience_looks(&p));
    tdm_patience_learn(&p, true);
  }
}
END_TEST

START_TEST(looks_that_do_not_pay_become_rare) {
  tdm_patience p = {0};
  int looks = 0, waits = 0;
  for (int expected = 1; waits < 100000; looks++) {
    tdm_patience_learn(&p, false);
    int n = sleeps(&p);
    ck_assert_int_eq(n, expected);
    expected = expected < TDM_SLEEPS_MAX ? 2 * expected : TDM_SLEEPS_MAX;
    waits += n + 1;
  }
  ck_assert_int_lt(looks, 120);
}
END_TEST

START_TEST(one_that_pays_is_enough) {
  tdm_patience p = {0};
  for (int i = 0; i < 20; i++) {
    tdm_patience_learn(&p, false);
    sleeps(&p);
  }
  tdm_patience_learn(&p, true);
  ck_assert_int_eq(sleeps(&p), 0);
  tdm_patience_learn(&p, false); /* and forgets what was before */
  ck_assert_int_eq(sleeps(&p), 1);
}
END_TEST

TEST_MAIN("patience", looks_that_pay_go_on, looks_that_do_not_pay_become_rare, one_that_pays_is_enough)

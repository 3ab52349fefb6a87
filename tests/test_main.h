/* main() of a test file: TEST_MAIN("suite", test, test, ...) */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_MAIN_H
#define TEST_MAIN_H

#include <check.h>
#include <stdlib.h>

/* What hangs is ended after so long [s]. It judges nothing: no test has a limit on a time. */
enum { TEST_HANGS = 900 };

/* A test and how often it runs, as _i = 0 ... times - 1. */
typedef struct {
  const TTest *test;
  int times;
} test_row;

/* How many of n rows are run that look at the same code with other words: under AddressSanitizer, where programs take
 * long to start, the first quarter. */
#ifdef __SANITIZE_ADDRESS__
#define SOME_ROWS(n) (((int)(n) + 3) / 4)
#else
#define SOME_ROWS(n) ((int)(n))
#endif

static inline int test_run(const char *name, const test_row *rows, size_t nrow) {
  Suite *suite = suite_create(name);
  TCase *tests_of_file = tcase_create(name);
  tcase_set_timeout(tests_of_file, TEST_HANGS);
  for (size_t i = 0; i < nrow; i++)
    tcase_add_loop_test(tests_of_file, rows[i].test, 0, rows[i].times);
  suite_add_tcase(suite, tests_of_file);
  SRunner *runner = srunner_create(suite);
  srunner_run_all(runner, CK_NORMAL);
  int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#define TEST_MAIN(name, ...)                                   \
  int main(void) {                                             \
    const TTest *const tests[] = {__VA_ARGS__};                \
    test_row rows[sizeof tests / sizeof *tests];               \
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++)  \
      rows[i] = (test_row){tests[i], 1};                       \
    return test_run(name, rows, sizeof tests / sizeof *tests); \
  }

/* The same with loop tests: TEST_MAIN_ROWS("suite", {test, times}, {test, times}, ...) */
#define TEST_MAIN_ROWS(name, ...)                                           \
  int main(void) {                                                          \
    const test_row test_rows[] = {__VA_ARGS__};                             \
    return test_run(name, test_rows, sizeof test_rows / sizeof *test_rows); \
  }

#endif

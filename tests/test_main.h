/* main() of a test file: TEST_MAIN("suite", test, test, ...) */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_MAIN_H
#define TEST_MAIN_H

#include <check.h>
#include <stdlib.h>

/* What hangs is ended after so long [s]. It judges nothing: no test has a limit on a time. */
enum { TEST_HANGS = 900 };

/* Run a suite that a file has put together itself (loop tests); its exit status. */
static inline int run_suite(Suite *suite) {
  SRunner *runner = srunner_create(suite);
  srunner_run_all(runner, CK_NORMAL);
  int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

static inline int test_run(const char *name, const TTest *const *tests, size_t ntest) {
  Suite *suite = suite_create(name);
  TCase *tests_of_file = tcase_create(name);
  tcase_set_timeout(tests_of_file, TEST_HANGS);
  for (size_t i = 0; i < ntest; i++)
    tcase_add_test(tests_of_file, tests[i]);
  suite_add_tcase(suite, tests_of_file);
  return run_suite(suite);
}

#define TEST_MAIN(name, ...)                                    \
  int main(void) {                                              \
    const TTest *const tests[] = {__VA_ARGS__};                 \
    return test_run(name, tests, sizeof tests / sizeof *tests); \
  }

#endif

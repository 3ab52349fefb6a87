/* Signals around fork and exec, and under nohup. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"
#include "protocol/base/interrupt.h"
#include "tests/test_main.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

/* How a child ends that catches signals, gets one, and goes on to exec. -1: not by exit. */
static int ends_with(int number, bool ignored) {
  const pid_t pid = fork();
  if (pid == 0) {
    if (ignored)
      signal(number, SIG_IGN);
    tdm_catch_signals();
    raise(number);
    tdm_release_signals();
    execlp("true", "true", (char *)NULL);
    _exit(127);
  }
  int status = 0;
  ck_assert_int_eq(waitpid(pid, &status, 0), pid);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The program that exec starts would never hear of a signal that came before. */
START_TEST(a_signal_before_exec_ends_the_child) {
  ck_assert_int_eq(ends_with(SIGTERM, false), 130);
  ck_assert_int_eq(ends_with(SIGINT, false), 130);
  ck_assert_int_eq(ends_with(SIGHUP, false), 130);
}
END_TEST

START_TEST(nohup_stays) {
  ck_assert_int_eq(ends_with(SIGHUP, true), 0);
}
END_TEST

START_TEST(after_it_signals_act_by_default) {
  const pid_t pid = fork();
  if (pid == 0) {
    tdm_catch_signals();
    tdm_release_signals();
    raise(SIGTERM);
    _exit(0);
  }
  int status = 0;
  ck_assert_int_eq(waitpid(pid, &status, 0), pid);
  ck_assert(WIFSIGNALED(status) && WTERMSIG(status) == SIGTERM);
}
END_TEST

TEST_MAIN("signals", a_signal_before_exec_ends_the_child, nohup_stays, after_it_signals_act_by_default)

/* The live view in a browser: frames come while the run goes, the stop button stops it, and the page says so. Skipped
 * where there is no Chromium. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/browser/chrome.h"
#include "tests/command.h"
#include "tests/test_main.h"

START_TEST(button_stops_the_run) {
  chrome browser;
  char out[128], address[256];
  const char *dir = directory_make();
  snprintf(out, sizeof out, "%s/live", dir);
  const char *const words[] = {"run", "torsional", "--out", out, "--set", "time.end=1000", "--live", NULL};
  pid_t pid = background(dir, words);
  WAIT_FOR(background_said(dir, "token=") && strchr(strstr(command_output, "token="), '\n'));
  const char *at = strstr(command_output, "http://");
  snprintf(address, sizeof address, "%.*s", (int)strcspn(at, "\n"), at);
  chrome_open(&browser, 1280, 720);
  chrome_go(&browser, address);
  /* the page of the start gives way to that of the run by itself, whose scripts come one after the other */
  while (!json_is_true(chrome_value(&browser, "!!(window.tandem && tandem.run && tandem.place)")))
    usleep(100000);
  chrome_wait(&browser, "tandem.run.times.length >= 3 && tandem.place(0)[0] !== 0");
  chrome_wait(&browser, "progress.textContent.includes('windows')");
  chrome_wait(&browser, "document.querySelectorAll('.curve').length > 0");
  ck_assert(!json_is_true(chrome_value(&browser, "location.href.includes('token')")));
  ck_assert_msg(browser.errors[0] == 0, "%s", browser.errors);
  /* a button that moves while the text beside it changes is missed */
  ck_assert(json_is_true(chrome_value(
      &browser,
      "(() => { const left = () => document.getElementById('stop').getBoundingClientRect().left, before = left();"
      "for (const text of ['', '0 s', 'windows '.repeat(5), 'windows '.repeat(100)]) {"
      "progress.textContent = text; if (left() !== before) return false; } return true; })()")));
  json_t *place = chrome_value(&browser, "(() => { const r = document.getElementById('stop').getBoundingClientRect(); "
                                         "return [r.left + r.width / 2, r.top + r.height / 2]; })()");
  chrome_click(&browser, json_number_value(json_array_get(place, 0)), json_number_value(json_array_get(place, 1)));
  json_decref(place);
  ck_assert_int_eq(background_end(pid), 130);
  chrome_wait(&browser, "document.getElementById('status').textContent === 'interrupted'");
  chrome_close(&browser);
  directory_remove(dir);
}
END_TEST

int main(void) {
  if (!chrome_is_there()) {
    puts("skipped: there is no Chromium (.ci/install chromium)");
    return CHROME_SKIPPED;
  }
  const test_row rows[] = {{button_stops_the_run, 1}};
  return test_run("live page", rows, 1);
}

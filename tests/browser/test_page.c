/* `tandem view` in a browser: the page loads, the slider moves particles, a click tells numbers; pages of failed runs,
 * of runs without frames, in any window. Skipped where there is no Chromium. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/browser/chrome.h"
#include "tests/browser/invented.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static const char *const dir = TANDEM_TEST_DIR "/page";
static chrome browser;

static void no_errors(void) {
  ck_assert_msg(browser.errors[0] == 0, "%s", browser.errors);
}

/* The page of an invented run, opened from the file system. */
static void open_page(int nparticle, int nframe) {
  tdm_error err = {0};
  ck_assert_msg(invented_run(dir, nparticle, nframe, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(command("tandem view %s", dir), 0);
  chrome_open(&browser, 1280, 720);
  chrome_go(&browser, "file://" TANDEM_TEST_DIR "/page/view.html");
}

START_TEST(page_plays) {
  open_page(500, 40);
  ck_assert_double_eq(chrome_number(&browser, "tandem.run.times.length"), 40);
  /* the slider */
  chrome_wait(&browser, "tandem.place(0)[2] < 0.11");
  json_decref(chrome_value(&browser, "slider.value = 30, slider.dispatchEvent(new Event('input'))"));
  ck_assert_double_eq_tol(chrome_number(&browser, "tandem.place(0)[2]"), 0.1 + 0.5 * 0.3, 1e-4);
  /* keys */
  chrome_key(&browser, "ArrowRight");
  ck_assert_double_eq(chrome_number(&browser, "tandem.state().frame"), 31);
  chrome_key(&browser, "Home");
  ck_assert_double_eq(chrome_number(&browser, "tandem.state().frame"), 0);
  chrome_key(&browser, " ");
  chrome_wait(&browser, "tandem.state().frame > 3");
  chrome_key(&browser, "End");
  ck_assert_double_eq(chrome_number(&browser, "tandem.state().frame"), 39);
  /* the cursor of the histories follows: x = 0.3 sin 3 t, and 0.39 s is the last frame's time */
  chrome_wait(&browser, "[...document.querySelectorAll('.curve')].some((c) => "
                        "c.textContent.includes('bucket.x') && c.querySelector('output').value === '0.2762')");
  no_errors();
  chrome_close(&browser);
}
END_TEST

START_TEST(pixels_change) {
  open_page(500, 40);
  static const char hash[] =
      "(() => { tandem.show(%d); tandem.draw(); /* with all pixels, whatever is drawn while something moves */ "
      "const c = document.getElementById('space'), gl = c.getContext('webgl'), "
      "p = new Uint8Array(4 * c.width * c.height); "
      "gl.readPixels(0, 0, c.width, c.height, gl.RGBA, gl.UNSIGNED_BYTE, p); "
      "let sum = 0; for (let i = 0; i < p.length; i++) sum = (31 * sum + p[i]) %% 1000003; "
      "return sum; })()";
  char expression[2][600];
  for (int k = 0; k < 2; k++)
    snprintf(expression[k], sizeof expression[k], hash, 30 * k);
  const double first = chrome_number(&browser, expression[0]), later = chrome_number(&browser, expression[1]);
  ck_assert_double_eq(chrome_number(&browser, expression[0]), first);
  ck_assert_double_ne(first, later);
  no_errors();
  chrome_close(&browser);
}
END_TEST

/* Click where the page says that something is, and look for a text in what it then tells. */
static void click_on(const char *place, const char *text) {
  char wait[300];
  json_t *at = chrome_value(&browser, place);
  chrome_click(&browser, json_number_value(json_array_get(at, 0)), json_number_value(json_array_get(at, 1)));
  json_decref(at);
  snprintf(wait, sizeof wait, "!info.hidden && info.textContent.includes('%s')", text);
  chrome_wait(&browser, wait);
}

START_TEST(click_tells_numbers) {
  open_page(1, 10); /* one large particle, free to see */
  click_on("tandem.where(0)", "contact force");
  ck_assert_double_eq(chrome_number(&browser, "tandem.state().picked.id"), 0);
  chrome_key(&browser, "Escape");
  ck_assert_double_eq(chrome_number(&browser, "+info.hidden"), 1);
  json_decref(chrome_value(&browser, "showGrains.click()"));
  click_on("tandem.whereBody(1)", "bucket");
  chrome_wait(&browser, "info.textContent.includes('DEM and MBD')");
  /* the plane that cuts takes the bucket away */
  chrome_key(&browser, "Escape");
  json_decref(chrome_value(&browser, "cut.value = 'z', cutAt.value = 0, cut.dispatchEvent(new Event('input'))"));
  json_t *at = chrome_value(&browser, "tandem.whereBody(1)");
  chrome_click(&browser, json_number_value(json_array_get(at, 0)), json_number_value(json_array_get(at, 1)));
  json_decref(at);
  ck_assert_double_eq(chrome_number(&browser, "+info.hidden"), 1);
  no_errors();
  chrome_close(&browser);
}
END_TEST

START_TEST(failed_runs_say_why) {
  open_page(10, 5);
  chrome_wait(&browser, "notes.textContent.includes('the bucket </script> burst')");
  chrome_wait(&browser, "document.getElementById('status').textContent === 'failed'");
  /* how far it can be trusted */
  chrome_wait(&browser, "trust.textContent === 'error, estimated: 1.2 %, 2.50 s wall'");
  chrome_wait(&browser, "trust.title.includes('bucket: position 0.003 m')");
  /* names of anybody's stay text */
  json_decref(chrome_value(&browser, "colour.value = 'material', colour.dispatchEvent(new Event('change'))"));
  chrome_wait(&browser, "legend.textContent.includes('<b>sand</b></script>')");
  no_errors();
  chrome_close(&browser);
}
END_TEST

START_TEST(histories_alone) {
  ck_assert_int_eq(system("rm -rf " TANDEM_TEST_DIR "/page-csv && mkdir " TANDEM_TEST_DIR "/page-csv"), 0);
  write_file(TANDEM_TEST_DIR "/page-csv", "channels.csv", "time [s],body.a.x [m]\n0,1\n0.5,2\n1,nan\n");
  ck_assert_int_eq(command("tandem view %s-csv", dir), 0);
  chrome_open(&browser, 640, 480);
  chrome_go(&browser, "file://" TANDEM_TEST_DIR "/page-csv/view.html");
  chrome_wait(&browser, "notes.textContent.includes('output.particles_interval')");
  chrome_wait(&browser, "!nothing.hidden && document.querySelector('.curve').textContent.includes('body.a.x [m]')");
  no_errors();
  chrome_close(&browser);
}
END_TEST

int main(void) {
  if (!chrome_is_there()) {
    puts("skipped: there is no Chromium (.ci/install chromium)");
    return CHROME_SKIPPED;
  }
  const test_row rows[] = {
      {page_plays, 1}, {pixels_change, 1}, {click_tells_numbers, 1}, {failed_runs_say_why, 1}, {histories_alone, 1}};
  return test_run("page", rows, sizeof rows / sizeof rows[0]);
}

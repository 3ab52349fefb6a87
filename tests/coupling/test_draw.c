/* tandem draw and tandem movie, and pictures that a run has drawn, as a user would see them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"
#include "protocol/draw/drawer.h"
#include "protocol/view/frames.h"
#include "tests/command.h"
#include "tests/test_main.h"

enum { BALLS = 50 };

static tdm_scenery a_scenery(void) {
  tdm_scenery s = {.gravity = {0, 0, -9.81}};
  tdm_view_body ground = {.name = "ground", .dem = true, .still = true};
  tdm_view_polygon floor = {.body = 0, .ncorner = 4, .corner = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
  ck_assert_int_eq(tdm_scenery_add_body(&s, &ground, NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_polygon(&s, &floor, NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_material(&s, "gravel", NULL), TDM_OK);
  return s;
}

static tdm_snapshot a_snapshot(double time) {
  tdm_snapshot s = {0};
  ck_assert_int_eq(tdm_snapshot_resize(&s, 1, 0, 0, BALLS, NULL), TDM_OK);
  s.time = time;
  s.pose[0] = (tdm_pose){{0, 0, 0}, {1, 0, 0, 0}};
  for (int i = 0; i < BALLS; i++) {
    s.id[i] = i;
    s.material[i] = s.size_class[i] = 0;
    s.radius[i] = 0.05;
    s.position[i] = s.born[i] = (tdm_vec3){0.02 * i - 0.5, 0, 0.5 + 0.1 * time};
    s.velocity[i] = (tdm_vec3){0, 0, 0.01 * i};
    s.spin[i] = s.force[i] = (tdm_vec3){0, 0, 0};
  }
  return s;
}

/* DIR/frames.tdv with snapshots at 0, 0.1 ... */
static void write_frames(const char *dir, int count) {
  char path[512];
  tdm_scenery scenery = a_scenery();
  tdm_view_bytes bytes = {0};
  snprintf(path, sizeof path, "%s/" TDM_FRAMES_FILE, dir);
  FILE *f = fopen(path, "wb");
  ck_assert_ptr_nonnull(f);
  ck_assert_int_eq(tdm_frames_write_scenery(f, path, &scenery, &bytes, NULL), TDM_OK);
  for (int k = 0; k < count; k++) {
    tdm_snapshot s = a_snapshot(0.1 * k);
    tdm_frame_place place;
    ck_assert_int_eq(tdm_frames_write(f, path, &s, &place, &bytes, NULL), TDM_OK);
    ck_assert_int_eq(tdm_frames_end(f, path, &place, NULL), TDM_OK);
    tdm_snapshot_free(&s);
  }
  fclose(f);
  tdm_view_bytes_free(&bytes);
  tdm_scenery_free(&scenery);
}

/* ---- after a run ---- */

START_TEST(pictures_after_a_run) {
  const char *dir = directory_make();
  write_frames(dir, 4);
  ck_assert_msg(command("tandem draw %s", dir) == 0, "%s", command_output);
  expect_output("drawn_000.png: t = 0.3 s");
  ck_assert_msg(command("tandem draw %s --times 0,0.21,7 --view xz --set color=force --out %s/side", dir, dir) == 0,
                "%s", command_output);
  expect_output("side_000.png: t = 0 s");
  expect_output("side_001.png: t = 0.2 s");
  expect_output("7 s is after the last snapshot, 0.3 s");
  ck_assert_msg(
      command("tandem draw %s --all --view '{\"from\": [0, -3, 1], \"parallel\": 2}' --set 'size=[64,64]'", dir) == 0,
      "%s", command_output);
  ck_assert(is_there(dir, "", "drawn_003.png"));
  directory_remove(dir);
}
END_TEST

/* The views of the scene have names. */
START_TEST(views_of_the_scene) {
  const char *dir = directory_make();
  write_frames(dir, 2);
  write_file(dir, "scene.json",
             "{\"output\": {\"pictures\": [{\"times\": [0], \"size\": [320, 200]}, {\"name\": \"top\", \"times\": [0], "
             "\"view\": \"xy\", \"size\": [200, 320]}]}}");
  ck_assert_msg(command("tandem draw %s --view top --out %s/top", dir, dir) == 0, "%s", command_output);
  ck_assert_msg(command("od -An -tu1 -j16 -N8 %s/top_000.png", dir) == 0, "%s", command_output);
  expect_output("0   0   0 200   0   0   1  64");
  ck_assert_msg(command("tandem draw %s --out %s/first && od -An -tu1 -j16 -N8 %s/first_000.png", dir, dir, dir) == 0,
                "%s", command_output);
  expect_output("0   0   1  64   0   0   0 200");
  directory_remove(dir);
}
END_TEST

START_TEST(a_killed_run_shows_what_there_is) {
  const char *dir = directory_make();
  write_frames(dir, 3);
  ck_assert_int_eq(command("truncate -s -10 %s/frames.tdv", dir), 0);
  ck_assert_msg(command("tandem draw %s --all", dir) == 0, "%s", command_output);
  expect_output("ends within a snapshot");
  ck_assert(is_there(dir, "", "drawn_001.png") && !is_there(dir, "", "drawn_002.png"));
  directory_remove(dir);
}
END_TEST

START_TEST(what_is_wrong_is_named) {
  static const struct {
    const char *words, *output;
    int status;
  } rows[] = {{"draw", "name one result directory", 2},
              {"draw %s/empty", "particles_interval", 1},
              {"draw %s/none", "No such file", 1},
              {"movie %s/empty", "particles_interval", 1},
              {"draw %s/no_snapshot", "has no snapshot yet", 1},
              {"draw %s --view side", "view: ", 1},
              {"draw %s --view '{\"from\": [0, 0, 0], \"at\": [0, 0, 0]}'", "away from the eye", 1},
              {"draw %s --set colour=id", "did you mean \"color\"", 1},
              {"draw %s --times soon", "commas between them", 2},
              {"draw %s --times 99", "nothing was drawn", 2},
              {"draw %s --out /nowhere/x", "/nowhere/x_000.png: cannot be written", 1},
              {"draw %s --fps 3", "unknown option --fps", 2},
              {"movie %s --fps 0", "more than 0", 2},
              {"movie %s --size 12", "WIDTHxHEIGHT", 2}};
  const char *dir = directory_make();
  char path[256];
  ck_assert_int_eq(command("mkdir %s/empty %s/no_snapshot", dir, dir), 0);
  snprintf(path, sizeof path, "%s/no_snapshot", dir);
  write_frames(path, 0);
  write_frames(dir, 1);
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    char line[512];
    snprintf(line, sizeof line, "tandem %s", rows[i].words);
    int status = command(line, dir);
    ck_assert_msg(status == rows[i].status, "%s: %d: %s", rows[i].words, status, command_output);
    ck_assert_msg(strstr(command_output, rows[i].output) != NULL, "%s: %s", rows[i].words, command_output);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(an_animation) {
  const char *dir = directory_make();
  write_frames(dir, 3);
  ck_assert_msg(command("env PATH=/nowhere " TANDEM_BIN_DIR "/tandem movie %s --size 320x241", dir) == 1, "%s",
                command_output);
  expect_output("ffmpeg is not installed");
  expect_output("3 pictures are in");
  ck_assert(is_there(dir, "movie.mp4.frames", "000002.png"));
  ck_assert(!is_there(dir, "", "movie.mp4"));
  if (command("ffmpeg -version >/dev/null") == 0) { /* an odd height is made even */
    ck_assert_msg(command("tandem movie %s --size 320x241 --fps 10", dir) == 0, "%s", command_output);
    expect_output("3 pictures, 10 a second: 0.3 s of animation for 0.2 s of the run");
    ck_assert_int_eq(command("test -s %s/movie.mp4", dir), 0);
    ck_assert(!is_there(dir, "movie.mp4.frames", ""));
  }
  directory_remove(dir);
}
END_TEST

/* ---- during a run ---- */

static const char views[] = "[{\"times\": [0, 1, 2], \"size\": [320, 240]}, {\"name\": \"space\", \"times\": [0, 1], "
                            "\"view\": {}, \"size\": [320, 240]}]";

/* A run that submits all pictures of `views`; notice: what was said about them. */
static void draw_run(const char *dir, tdm_error *notice) {
  tdm_drawer d;
  tdm_error err = {0};
  tdm_pictures pictures;
  json_t *json = json_pack("{s:o}", "pictures", json_loads(views, 0, NULL));
  tdm_object output = tdm_object_open(json, "output", &err);
  tdm_pictures_read(&pictures, &output, 10);
  ck_assert_msg(tdm_drawer_begin(&d, &pictures, json_object_get(json, "pictures"), dir, &err) == TDM_OK, "%s",
                err.message);
  tdm_scenery scenery = a_scenery();
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < pictures.picture[k].ntime; i++) {
      tdm_snapshot s = a_snapshot(i);
      ck_assert_msg(tdm_drawer_submit(&d, k, &scenery, &s, &err) == TDM_OK, "%s", err.message);
      tdm_snapshot_free(&s);
    }
  tdm_drawer_finish(&d, notice);
  tdm_drawer_end(&d);
  tdm_scenery_free(&scenery);
  tdm_pictures_free(&pictures);
  json_decref(json);
}

/* The programs that runs of a test start: tandem-draw as built, or a shell script in its place. */
static void take_program(const char *dir, const char *script) {
  char path[4096];
  if (script) {
    write_file(dir, "tandem-draw", script);
    ck_assert_int_eq(command("chmod +x %s/tandem-draw", dir), 0);
  }
  snprintf(path, sizeof path, "%s:%s", script ? dir : TANDEM_BIN_DIR, getenv("PATH"));
  setenv("PATH", path, 1);
}

static const char *const names[] = {"picture_000", "picture_001", "picture_002", "picture_space_000",
                                    "picture_space_001"};

START_TEST(pictures_of_a_run) {
  const char *dir = directory_make();
  tdm_error notice = {0};
  take_program(dir, NULL);
  draw_run(dir, &notice);
  ck_assert_msg(notice.status == TDM_OK, "%s", notice.message);
  for (int i = 0; i < 5; i++)
    ck_assert_msg(command("test -s %s/%s.png -a ! -e %s/%s.frame", dir, names[i], dir, names[i]) == 0, "%s", names[i]);
  ck_assert(is_there(dir, "", "pictures.png") && is_there(dir, "", "pictures_space.png"));
  ck_assert(!is_there(dir, "", "draw.log"));
  directory_remove(dir);
}
END_TEST

/* Whatever becomes of tandem-draw: the run goes on, the notice says what, and the frames can be drawn later. */
START_TEST(a_program_that_fails) {
  static const struct {
    const char *script, *words;
    tdm_status status;
  } rows[] = {{"#!/bin/sh\necho no luck today >&2\nexit 3\n", "no luck today", TDM_ERR_FILE},
              {"#!/bin/sh\nkill -9 $$\n", "status 137", TDM_ERR_FILE},
              {"#!/bin/sh\nexec sleep 1000\n", "TANDEM_PLOT_TIMEOUT", TDM_ERR_TIMEOUT}};
  const char *dir = directory_make();
  tdm_error notice = {0};
  setenv("TANDEM_PLOT_TIMEOUT", "0.05", 1);
  take_program(dir, rows[_i].script);
  draw_run(dir, &notice);
  ck_assert_int_eq(notice.status, rows[_i].status);
  ck_assert_msg(strstr(notice.message, rows[_i].words) != NULL, "%s", notice.message);
  for (int i = 0; i < 5; i++)
    ck_assert_msg(command("test -s %s/%s.frame", dir, names[i]) == 0, "%s", names[i]);
  ck_assert_msg(command("tandem draw %s/picture_001.frame --view yz", dir) == 0, "%s", command_output);
  ck_assert(is_there(dir, "", "picture_001.png"));
  directory_remove(dir);
}
END_TEST

START_TEST(no_program) {
  const char *dir = directory_make();
  tdm_error notice = {0};
  setenv("PATH", "/nowhere", 1);
  draw_run(dir, &notice);
  ck_assert_msg(strstr(notice.message, "neither beside this program nor in PATH") != NULL, "%s", notice.message);
  ck_assert(is_there(dir, "", "picture_002.frame"));
  setenv("PATH", "/usr/bin:/bin", 1);
  directory_remove(dir);
}
END_TEST

START_TEST(a_signal_ends_it) {
  const char *dir = directory_make();
  tdm_error notice = {0};
  take_program(dir, "#!/bin/sh\nexec sleep 1000\n");
  tdm_catch_signals();
  pid_t self = getpid(), other = fork();
  if (other == 0) {
    WAIT_FOR(is_there(dir, "", "draw.log"));
    while (kill(self, SIGINT) == 0) /* until it waits for the pictures: before that a signal is the run's business */
      usleep(100000);
    _exit(0);
  }
  draw_run(dir, &notice);
  kill(other, SIGKILL);
  ck_assert_int_eq(notice.status, TDM_ERR_INTERRUPTED);
  directory_remove(dir);
}
END_TEST

/* ---- runs ---- */

/* Runs of all three kinds draw; what they compute is the same bit for bit. */
START_TEST(runs_draw_and_compute_the_same) {
  static const struct {
    const char *program, *scene, *options, *history;
  } rows[] = {{"tandem", "torsional", "--set time.end=0.02", "body_box.csv"},
              {"tandem-dem", "repose", "--no-plots --set time.end=0.01", "channels.csv"},
              {"tandem-mbd", "slider_crank", "--no-plots --set time.end=0.02", "channels.csv"}};
  const char *dir = directory_make();
  const char *program = rows[_i].program, *scene = rows[_i].scene, *options = rows[_i].options;
  ck_assert_msg(command("%s run %s --out %s/plain %s", program, scene, dir, options) == 0, "%s", command_output);
  const char *pictures = "--set 'output.pictures=[{\"times\": [0, 0.001], \"size\": [300, 300]}, {\"name\": \"space\", "
                         "\"interval\": 0.001, \"view\": {}, \"size\": [300, 200]}]'";
  ck_assert_msg(command("%s run %s --out %s/drawn %s %s", program, scene, dir, options, pictures) == 0, "%s",
                command_output);
  ck_assert_msg(command("cmp %s/plain/%s %s/drawn/%s", dir, rows[_i].history, dir, rows[_i].history) == 0, "%s",
                command_output);
  static const char *const files[] = {"picture_001.png", "pictures.png", "picture_space_002.png", "pictures_space.png"};
  for (int i = 0; i < 4; i++)
    ck_assert_msg(is_there(dir, "drawn", files[i]), "%s", files[i]);
  ck_assert_msg(command("ls %s/drawn/*.frame", dir) != 0, "%s", command_output);
  ck_assert_int_eq(command("test -e %s/drawn/draw.log", dir), 1);
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("draw", {pictures_after_a_run, 1}, {views_of_the_scene, 1}, {a_killed_run_shows_what_there_is, 1},
               {what_is_wrong_is_named, 1}, {an_animation, 1}, {pictures_of_a_run, 1}, {a_program_that_fails, 3},
               {no_program, 1}, {a_signal_ends_it, 1}, {runs_draw_and_compute_the_same, 3})

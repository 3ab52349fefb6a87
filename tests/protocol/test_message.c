/* Messages: what is written reads back; whatever else comes is refused, never believed. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/wire/message.h"
#include "tests/test_main.h"

#include <stdlib.h>
#include <string.h>

static tdm_status read_header(tdm_header *header, const tdm_frame *frame, tdm_error *err) {
  *err = (tdm_error){0};
  return tdm_header_read(header, frame->data, frame->size, err);
}

START_TEST(control_round_trip) {
  tdm_frame frame = {0};
  tdm_error err = {0};
  tdm_header header;
  json_t *back, *json = json_pack("{s:f, s:s}", "x", 0.1, "name", "box");
  ck_assert_int_eq(tdm_control_write(&frame, TDM_READY, 7, json, &err), TDM_OK);
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
  ck_assert_int_eq(header.type, TDM_READY);
  ck_assert_uint_eq(header.window, 7);
  ck_assert_int_eq(tdm_control_read(&header, &back, &err), TDM_OK);
  ck_assert(json_equal(json, back)); /* doubles survive the text exactly */
  json_decref(back);
  json_decref(json);
  tdm_frame_free(&frame);
}
END_TEST

static tdm_step example_step(void) {
  static tdm_state start[2], end[2];
  static tdm_wrench load[6];
  static double times[3] = {1.25, 1.5, 2};
  for (int i = 0; i < 26; i++) {
    ((double *)(void *)start)[i] = i;
    ((double *)(void *)end)[i] = 100 + i;
  }
  for (int i = 0; i < 36; i++)
    ((double *)(void *)load)[i] = -i;
  return (tdm_step){.window = 3,
                    .t0 = 1,
                    .t1 = 2,
                    .nstep = 10,
                    .nbody = 2,
                    .nstate = 2,
                    .nload = 3,
                    .nsample = 3,
                    .start = start,
                    .end = end,
                    .load = load,
                    .sample_time = times};
}

START_TEST(step_round_trip) {
  tdm_frame frame = {0}, store = {0};
  tdm_error err = {0};
  tdm_header header;
  tdm_step out = example_step(), in;
  ck_assert_int_eq(tdm_step_write(&frame, &out, &err), TDM_OK);
  ck_assert_uint_eq(frame.size, TDM_HEADER_BYTES + TDM_STEP_BYTES + 8 * (52 + 36 + 3));
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
  ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_OK);
  ck_assert_uint_eq(in.window, 3);
  ck_assert_double_eq(in.t0, 1);
  ck_assert_double_eq(in.t1, 2);
  ck_assert_uint_eq(in.nstep, 10);
  ck_assert_mem_eq(in.start, out.start, 2 * sizeof(tdm_state));
  ck_assert_mem_eq(in.end, out.end, 2 * sizeof(tdm_state));
  ck_assert_mem_eq(in.load, out.load, 6 * sizeof(tdm_wrench));
  ck_assert_mem_eq(in.sample_time, out.sample_time, 3 * sizeof(double));
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
}
END_TEST

/* a STEP with a proxy of f freedoms for the two bodies; `block` has its numbers */
static tdm_step step_with_proxy(int f, double *block) {
  tdm_step s = example_step();
  s.nload = 0;
  s.has_proxy = true;
  for (int i = 0; i < 2000; i++)
    block[i] = 3000 + i;
  s.proxy = (tdm_proxy){.acceleration = block,
                        .load = (const tdm_wrench *)(const void *)(block + 12),
                        .correction = block + 24,
                        .mobility = {.nbody = 2, .nfree = f}};
  tdm_mobility_point(&s.proxy.mobility, block + 48);
  return s;
}

START_TEST(proxy_round_trip) {
  tdm_frame frame = {0}, store = {0};
  tdm_error err = {0};
  tdm_header header;
  double block[2000];
  for (int f = 0; f <= 4; f += 2) {
    tdm_step out = step_with_proxy(f, block), in;
    size_t n = 48 + tdm_mobility_doubles(&out.proxy.mobility);
    ck_assert_int_eq(tdm_step_write(&frame, &out, &err), TDM_OK);
    ck_assert_uint_eq(frame.size, TDM_HEADER_BYTES + TDM_STEP_BYTES + 8 * (52 + 3 + n));
    ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
    ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_OK);
    ck_assert(in.has_proxy);
    ck_assert_int_eq(in.proxy.mobility.nfree, f);
    ck_assert_mem_eq(in.sample_time, out.sample_time, 3 * sizeof(double));
    ck_assert_mem_eq(in.proxy.acceleration, block, n * sizeof(double)); /* one block, in wire order */
    ck_assert_ptr_eq(in.proxy.mobility.B_rate + 12 * f, in.proxy.acceleration + n);
    ck_assert(!in.seen);
    frame.data[TDM_HEADER_BYTES + 40] ^= 4; /* a snapshot is */
    ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_OK);
    ck_assert(in.seen && in.has_proxy);
    frame.data[TDM_HEADER_BYTES + 40] ^= 12; /* something else is announced */
    ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_ERR_PROTOCOL);
    frame.data[TDM_HEADER_BYTES + 40] ^= 9; /* nothing is */
    ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_ERR_PROTOCOL);
    frame.data[TDM_HEADER_BYTES + 40] ^= 1;
    frame.data[TDM_HEADER_BYTES + 42] = TDM_FREE_MAX + 1; /* too much freedom */
    ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_ERR_PROTOCOL);
    err = (tdm_error){0};
  }
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
}
END_TEST

/* three nodes of a path of two bodies that begins at t0 and ends at t1 */
static tdm_nodes example_path(double t0, double t1) {
  static double time[3];
  static tdm_state state[6];
  for (int k = 0; k < 3; k++)
    time[k] = k < 2 ? t0 + (t1 - t0) * (k + 1) / 3 : t1;
  for (int i = 0; i < 6 * TDM_STATE_DOUBLES; i++)
    ((double *)(void *)state)[i] = 500 + i;
  return (tdm_nodes){3, 2, time, state};
}

static tdm_status step_back(tdm_step *in, const tdm_step *out, tdm_frame *frame, tdm_frame *store, tdm_error *err) {
  tdm_header header;
  ck_assert_int_eq(tdm_step_write(frame, out, err), TDM_OK);
  ck_assert_int_eq(read_header(&header, frame, err), TDM_OK);
  return tdm_step_read(in, &header, store, err);
}

/* STEP: where to look ahead to, and nodes with and without a proxy */
START_TEST(path_in_a_step) {
  tdm_frame frame = {0}, store = {0};
  tdm_error err = {0};
  tdm_step in;
  double block[2000];
  for (int proxy = 0; proxy < 2; proxy++) {
    tdm_step out = proxy ? step_with_proxy(2, block) : example_step();
    out.path = example_path(out.t0, out.t1);
    out.ahead = proxy ? 0 : 2.5;
    ck_assert_int_eq(step_back(&in, &out, &frame, &store, &err), TDM_OK);
    ck_assert_double_eq(in.ahead, out.ahead);
    ck_assert_int_eq(in.path.nnode, 3);
    ck_assert_int_eq(in.path.nbody, 2);
    ck_assert_mem_eq(in.path.time, out.path.time, 3 * sizeof(double));
    ck_assert_mem_eq(in.path.state, out.path.state, 6 * sizeof(tdm_state));
    ck_assert_mem_eq(in.sample_time, out.sample_time, 3 * sizeof(double));
    ck_assert(in.has_proxy == proxy);
    if (proxy)
      ck_assert_mem_eq(in.proxy.acceleration, block, 48 * sizeof(double));
  }
  /* not in order, not to the end, looking back */
  for (int bad = 0; bad < 4; bad++) {
    tdm_step out = example_step();
    out.path = example_path(out.t0, bad == 1 ? 1.9 : out.t1);
    out.path.time[0] = bad == 0 ? 1.9 : bad == 3 ? 1 : out.path.time[0];
    out.ahead = bad == 2 ? 1.5 : 0;
    err = (tdm_error){0};
    ck_assert_int_eq(step_back(&in, &out, &frame, &store, &err), TDM_ERR_PROTOCOL);
  }
  frame.data[TDM_HEADER_BYTES + 44] = TDM_NODES_MAX + 1;
  tdm_header header;
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
  ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_ERR_PROTOCOL);
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
}
END_TEST

START_TEST(result_round_trip) {
  tdm_frame frame = {0}, store = {0}, store2 = {0};
  tdm_error err = {0};
  tdm_header header;
  /* both kinds of solver: states (mbd) and loads (dem) */
  for (int nstate = 0; nstate <= 2; nstate += 2) {
    tdm_result out = {.window = 5, .t = 2, .wall = 0.5, .nbody = 2, .nstate = nstate, .nload = nstate ? 0 : 1};
    out.nsample = 3;
    out.nchannel = 4;
    tdm_result in;
    ck_assert_int_eq(tdm_result_layout(&out, &store, &err), TDM_OK);
    for (size_t i = 0; i < store.size / 8; i++)
      ((double *)(void *)store.data)[i] = (double)i;
    ck_assert_int_eq(tdm_result_write(&frame, &out, &err), TDM_OK);
    ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_OK);
    ck_assert_double_eq(in.wall, 0.5);
    ck_assert_int_eq(in.nstate, nstate);
    ck_assert_uint_eq(store2.size, store.size);
    ck_assert_mem_eq(store2.data, store.data, store.size);
    ck_assert_double_eq(in.channel[11], (double)(store.size / 8 - 1)); /* channels come last */
  }
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
  tdm_frame_free(&store2);
}
END_TEST

/* a RESULT of k bodies with accelerations and a reduced model of f freedoms; the arrays are in `store` and `block` */
static tdm_result extended_result(int k, int f, tdm_frame *store, double *block) {
  tdm_error err = {0};
  tdm_result out = {.window = 5, .t = 2, .nbody = k, .nstate = k, .nsample = 1, .nchannel = 1};
  out.nacceleration = out.ninterface = out.nfurther = k;
  out.has_mobility = out.has_energy = true;
  out.mobility = (tdm_mobility){.nbody = k, .nfree = f};
  ck_assert_int_eq(tdm_result_layout(&out, store, &err), TDM_OK);
  for (size_t i = 0; i < store->size / 8; i++)
    ((double *)(void *)store->data)[i] = (double)i;
  tdm_mobility_point(&out.mobility, block);
  for (size_t i = 0; i < tdm_mobility_doubles(&out.mobility); i++)
    block[i] = 1000 + (double)i;
  return out;
}

START_TEST(mobility_round_trip) {
  tdm_frame frame = {0}, store = {0}, store2 = {0};
  tdm_error err = {0};
  tdm_header header;
  double block[2000];
  for (int f = 0; f <= 4; f += 2) {
    tdm_result in, out = extended_result(2, f, &store, block);
    size_t n = tdm_mobility_doubles(&out.mobility);
    ck_assert_uint_eq(n, (size_t)(144 + 2 * f + 4 * 12 * f + 2 * f * f));
    ck_assert_int_eq(tdm_result_write(&frame, &out, &err), TDM_OK);
    ck_assert_uint_eq(frame.size, TDM_HEADER_BYTES + TDM_RESULT_BYTES + store.size + 8 * n);
    ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_OK);
    ck_assert_int_eq(in.nacceleration, 2);
    ck_assert(in.has_mobility);
    ck_assert_int_eq(in.mobility.nfree, f);
    ck_assert_int_eq(in.ninterface, 2);
    ck_assert(in.has_energy);
    ck_assert_mem_eq(in.acceleration, out.acceleration, 12 * sizeof(double));
    ck_assert_mem_eq(in.body, out.body, 2 * sizeof *in.body);
    ck_assert_mem_eq(in.energy, out.energy, sizeof *in.energy);
    ck_assert_int_eq(in.nfurther, 2);
    ck_assert_mem_eq(in.further, out.further, 2 * TDM_FURTHER * sizeof *in.further);
    ck_assert_mem_eq(in.mobility.Y, block, n * sizeof(double)); /* one block, in wire order */
    ck_assert_ptr_eq(in.mobility.B_rate + 12 * f, in.mobility.Y + n);
    frame.data[TDM_HEADER_BYTES + 36] ^= 4; /* something else is announced */
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_ERR_PROTOCOL);
    frame.data[TDM_HEADER_BYTES + 36] ^= 4;
    frame.data[TDM_HEADER_BYTES + 38] = TDM_FREE_MAX + 1; /* too much freedom */
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_ERR_PROTOCOL);
    err = (tdm_error){0};
  }
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
  tdm_frame_free(&store2);
}
END_TEST

/* RESULT: as many nodes as the frame has left */
START_TEST(path_in_a_result) {
  tdm_frame frame = {0}, store = {0}, store2 = {0};
  tdm_error err = {0};
  tdm_header header;
  double block[2000];
  for (int f = 0; f <= 2; f += 2) {
    tdm_result in, out = extended_result(2, f, &store, block);
    out.path = example_path(2, 3);
    ck_assert_int_eq(tdm_result_write(&frame, &out, &err), TDM_OK);
    ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_OK);
    ck_assert_int_eq(in.path.nnode, 3);
    ck_assert_mem_eq(in.path.time, out.path.time, 3 * sizeof(double));
    ck_assert_mem_eq(in.path.state, out.path.state, 6 * sizeof(tdm_state));
    ck_assert_mem_eq(in.mobility.Y, block, tdm_mobility_doubles(&out.mobility) * sizeof(double));
    header.size -= 8; /* no whole number of nodes */
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_ERR_PROTOCOL);
    out.path.nnode = 0; /* announced, and none there */
    ck_assert_int_eq(tdm_result_write(&frame, &out, &err), TDM_OK);
    frame.data[TDM_HEADER_BYTES + 36] |= 32;
    err = (tdm_error){0};
    ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
    ck_assert_int_eq(tdm_result_read(&in, &header, &store2, &err), TDM_ERR_PROTOCOL);
    err = (tdm_error){0};
  }
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
  tdm_frame_free(&store2);
}
END_TEST

START_TEST(malformed_headers_are_refused) {
  tdm_frame frame = {0};
  tdm_error err = {0};
  tdm_header header;
  ck_assert_int_eq(tdm_control_write(&frame, TDM_FINISH, 0, NULL, &err), TDM_OK);
  for (size_t n = 0; n < frame.size; n++) {
    tdm_error short_err = {0};
    ck_assert_int_eq(tdm_header_read(&header, frame.data, n, &short_err), TDM_ERR_PROTOCOL);
  }
  frame.data[4] = 2; /* version */
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_ERR_VERSION);
  ck_assert_ptr_nonnull(strstr(err.message, "version 2"));
  frame.data[4] = 1;
  frame.data[6] = 99; /* type */
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_ERR_PROTOCOL);
  frame.data[6] = TDM_FINISH;
  frame.data[16] = 1; /* size */
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_ERR_PROTOCOL);
  frame.data[16] = 0;
  frame.data[0] = 'X';
  ck_assert_int_eq(read_header(&header, &frame, &err), TDM_ERR_PROTOCOL);
  tdm_frame_free(&frame);
  size_t large = (size_t)TDM_FRAME_MAX + 1;
  char *oversized = calloc(1, large);
  memcpy(oversized, "TNDM\1\0\11\0", 8);
  err = (tdm_error){0};
  ck_assert_int_eq(tdm_header_read(&header, oversized, large, &err), TDM_ERR_PROTOCOL);
  ck_assert_ptr_nonnull(strstr(err.message, "oversized"));
  free(oversized);
}
END_TEST

/* Every byte of a STEP and of a RESULT changed, every length: read or refused, never a crash (run under ASan). */
START_TEST(any_damage_is_survived) {
  tdm_frame frame = {0}, store = {0};
  tdm_error err = {0};
  double block[2000], other[2000];
  for (int kind = 0; kind < 4; kind++) {
    tdm_step step = kind == 3 ? step_with_proxy(1, other) : example_step();
    tdm_result result = extended_result(1, 2, &store, block);
    result.path = example_path(2, 3);
    result.path.nbody = 1;
    if (kind == 3)
      step.path = example_path(step.t0, step.t1);
    if (kind != 2)
      ck_assert_int_eq(tdm_step_write(&frame, &step, &err), TDM_OK);
    else
      ck_assert_int_eq(tdm_result_write(&frame, &result, &err), TDM_OK);
    frame.data[6] = kind == 0 || kind == 3 ? TDM_STEP : TDM_RESULT;
    for (size_t i = 0; i < frame.size; i++)
      for (int bit = 0; bit < 8; bit++) {
        tdm_header header;
        tdm_step s;
        tdm_result r;
        err = (tdm_error){0};
        frame.data[i] ^= (uint8_t)(1 << bit);
        uint8_t *exact = malloc(frame.size); /* a block of its own, so that ASan sees a read past its end */
        memcpy(exact, frame.data, frame.size);
        if (tdm_header_read(&header, exact, frame.size, &err) == TDM_OK) {
          tdm_step_read(&s, &header, &store, &err);
          err = (tdm_error){0};
          tdm_result_read(&r, &header, &store, &err);
        }
        free(exact);
        frame.data[i] ^= (uint8_t)(1 << bit);
      }
  }
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
}
END_TEST

START_TEST(absurd_steps_are_refused) {
  tdm_frame frame = {0}, store = {0};
  tdm_header header;
  tdm_step in;
  enum { NBAD = 6 };
  tdm_step bad[NBAD];
  const double late[3] = {1.25, 1.5, 2.1}, twice[3] = {1.25, 1.25, 2};
  for (int i = 0; i < NBAD; i++)
    bad[i] = example_step();
  bad[0].t1 = 0.5;      /* backwards */
  bad[1].nstep = 0;     /* without steps */
  bad[2].t1 = INFINITY; /* without end */
  tdm_wrench nan = {{NAN, 0, 0}, {0, 0, 0}};
  bad[3].nbody = 1;
  bad[3].nstate = 0;
  bad[3].nload = 1;
  bad[3].load = &nan; /* not a number */
  bad[4].sample_time = late;
  bad[5].sample_time = twice;
  for (int i = 0; i < NBAD; i++) {
    tdm_error err = {0};
    ck_assert_int_eq(tdm_step_write(&frame, &bad[i], &err), TDM_OK);
    ck_assert_int_eq(read_header(&header, &frame, &err), TDM_OK);
    ck_assert_int_eq(tdm_step_read(&in, &header, &store, &err), TDM_ERR_PROTOCOL);
  }
  tdm_frame_free(&frame);
  tdm_frame_free(&store);
}
END_TEST

START_TEST(errors_travel) {
  tdm_error err = {0}, back = {0};
  tdm_fail(&err, TDM_ERR_SCENE, "dem.materials[0].density", "is -1 but must be greater than 0");
  json_t *json = tdm_error_to_json(&err);
  tdm_error_from_json(json, &back);
  ck_assert_int_eq(back.status, TDM_ERR_SCENE);
  ck_assert_str_eq(back.path, err.path);
  ck_assert_str_eq(back.message, err.message);
  json_decref(json);
}
END_TEST

TEST_MAIN("message", control_round_trip, step_round_trip, proxy_round_trip, path_in_a_step, result_round_trip,
          mobility_round_trip, path_in_a_result, malformed_headers_are_refused, any_damage_is_survived,
          absurd_steps_are_refused, errors_travel)

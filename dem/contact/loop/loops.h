/* The contact loops of a normal law, over pairs of particles and over particles and walls.
 *
 * The file of a normal law includes this after its kernel:
 *   #define DEM_LAW hooke            its name in C
 *   #define DEM_LAW_KERNEL kernel    void kernel(dem_contact *, vd *history)
 *   #define DEM_LAW_COLUMNS 0        of history, unless none
 *   #define DEM_LAW_CIRCLE true      if the kernel fills contact.circle
 *   #define DEM_LAW_SUMS 3           sums over the contacts of a particle, unless none
 *   #define DEM_LAW_SUMS_KERNEL sum  void sum(const dem_contact *, vd of[]): what a contact adds to those of a particle
 *   #define DEM_LAW_NOTES_KERNEL note   void note(const dem_contact *, const vd *history, dem_note *): what a contact
 *                                       tells the others of its particles; with it, functions of a chunk's task
 *   #define DEM_LAW_NOTES_SHARE share   void share(dem_loop_task *): what they give each other
 *   #define DEM_LAW_NOTES_AGAIN again   double again(dem_loop_task *, double *largest): the notes from these (task.h)
 *   #define DEM_LAW_NOTES_ITERATIONS(model) …   how often, and up to which change
 *   #define DEM_LAW_NOTES_TOLERANCE(model) …
 *   #define DEM_LAW_PLANES 1         with sums or notes: their kernel asks for no masses, so planes go DEM_W at a time
 *   #include "dem/contact/loop/loops.h"
 * It makes dem_loops_hooke_avx512, or what else the file is compiled for; DEM_LAW_LOOPS are those of all instruction
 * sets, for the law's row.
 *
 * In the loops the kernels are constants of an always-inlined function, so no call and no branch on a law is left.
 * Besides a pair of loops with each tangential law there is one with all terms, in which the scene's other laws are
 * switches, and in plain C one more that calls laws that a program adds (dem_law_add). DEM_W contacts go at a time, one
 * a lane, whether they touch or not; what does not touch adds nothing. Forces are added lane after lane, in the order
 * of the list, so the sums are those of a loop over one contact at a time.
 *
 * The loop over planes is a function of its own: as a part of the loop over walls it would spill more registers.
 *
 * With sums there is a pass over all contacts before that of the forces: it adds up what the second kernel makes of the
 * geometry of each contact (the upper part of dem_contact, without rate, slip and spins), for both particles with the
 * normal that points to them. The first kernel then has the sums of both. This is the place of multi-contact laws
 * in which the particles' means count. With notes each contact is written down first (seam/notes.h), and a pass over
 * particles works out what each of their contacts gives each other, for laws in which places and directions count. Laws
 * without either pay nothing.
 *
 * apply.h has what pairs and walls share, pair_loop.h and wall_loop.h the loops, part_loop.h that over the triangles of
 * meshes (triangles.h), batch.h the contacts with walls that are gathered.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_LOOPS_H
#define DEM_CONTACT_LOOP_LOOPS_H

#ifndef DEM_LAW_COLUMNS
#define DEM_LAW_COLUMNS 0
#endif
#ifndef DEM_LAW_CIRCLE
#define DEM_LAW_CIRCLE false
#endif
#ifndef DEM_LAW_SUMS
#define DEM_LAW_SUMS 0
#endif
#ifndef DEM_LAW_PLANES
#define DEM_LAW_PLANES 0
#endif
#ifdef DEM_LAW_NOTES_KERNEL
#define DEM_LAW_NOTES 1
#else
#define DEM_LAW_NOTES 0
#endif

#include "dem/contact/loop/notes.h"
#include "dem/contact/loop/pair_loop.h"
#include "dem/contact/loop/sums.h"
#include "dem/contact/loop/wall_loop.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

/* ---- with each tangential law ---- */

#define ROW(t)                                                    \
  ((row){.normal = DEM_LAW_KERNEL,                                \
         .tangential = dem_tangential_##t,                        \
         .ncolumn = DEM_LAW_COLUMNS + dem_tangential_columns_##t, \
         .column = dem_tangential_columns_##t,                    \
         .rubs = TANGENTIAL_##t != TANGENTIAL_none,               \
         .flush = batch_##t,                                      \
         .planes = planes_##t})
#define X(t)                                                                                        \
  static void planes_##t(dem_loop_task *task, size_t begin, size_t end);                            \
  static __attribute__((noinline)) void batch_##t(dem_loop_task *task, batch *b) {                  \
    wall_batch(task, b, ROW(t));                                                                    \
  }                                                                                                 \
  static __attribute__((noinline)) void planes_##t(dem_loop_task *task, size_t begin, size_t end) { \
    plane_loop(task, begin, end, ROW(t));                                                           \
  }                                                                                                 \
  static void pairs_##t(dem_loop_task *task) {                                                      \
    pair_loop(task, ROW(t));                                                                        \
  }                                                                                                 \
  static void walls_##t(dem_loop_task *task) {                                                      \
    wall_loop(task, ROW(t));                                                                        \
  }
DEM_TANGENTIALS(X)
#undef X

#define GOES_WITH(t) (DEM_LAW_CIRCLE || !dem_tangential_circle_##t)
#define X(t) {GOES_WITH(t) ? pairs_##t : NULL, GOES_WITH(t) ? walls_##t : NULL},
static const dem_loops with[] = {DEM_TANGENTIALS(X)};
#undef X

/* ---- with all terms ---- */

#define ROW_OF_SCENE(name, kernel, is_called) \
  ((row){.normal = DEM_LAW_KERNEL,            \
         .tangential = kernel,                \
         .all_terms = true,                   \
         .calls = is_called,                  \
         .rubs = true,                        \
         .flush = batch_##name})
#define LOOPS_OF_SCENE(name, kernel, is_called)                                       \
  static __attribute__((noinline)) void batch_##name(dem_loop_task *task, batch *b) { \
    wall_batch(task, b, row_of(task->model, ROW_OF_SCENE(name, kernel, is_called)));  \
  }                                                                                   \
  static void pairs_##name(dem_loop_task *task) {                                     \
    pair_loop(task, ROW_OF_SCENE(name, kernel, is_called));                           \
  }                                                                                   \
  static void walls_##name(dem_loop_task *task) {                                     \
    wall_loop(task, ROW_OF_SCENE(name, kernel, is_called));                           \
  }

LOOPS_OF_SCENE(all_terms, tangential_of_scene, false)
#if DEM_SIMD == 0
LOOPS_OF_SCENE(called, tangential_that_is_called, true)
#define LOOPS_CALLED \
  { pairs_called, walls_called }
#else
#define LOOPS_CALLED \
  { NULL, NULL }
#endif

/* ---- sums ---- */

#if DEM_LAW_SUMS > 0
static __attribute__((noinline)) void batch_sums(dem_loop_task *task, batch *b) {
  sum_batch(task, b, DEM_LAW_SUMS_KERNEL);
}

static __attribute__((noinline)) void planes_sums(dem_loop_task *task, size_t begin, size_t end) {
  sum_planes(task, begin, end, DEM_LAW_SUMS_KERNEL);
}

static void pairs_sums(dem_loop_task *task) {
  sum_pairs(task, DEM_LAW_SUMS_KERNEL);
}

static void walls_sums(dem_loop_task *task) {
  wall_loop(task, (row){.flush = batch_sums, .planes = planes_sums});
}
#define LOOPS_SUMS \
  { pairs_sums, walls_sums }
#else
#define LOOPS_SUMS \
  { NULL, NULL }
#endif

/* ---- notes ---- */

#if DEM_LAW_NOTES
static __attribute__((noinline)) void batch_notes(dem_loop_task *task, batch *b) {
  note_batch(task, b, DEM_LAW_NOTES_KERNEL);
}

static __attribute__((noinline)) void planes_notes(dem_loop_task *task, size_t begin, size_t end) {
  note_planes(task, begin, end, DEM_LAW_NOTES_KERNEL);
}

static void pairs_notes(dem_loop_task *task) {
  note_pairs(task, DEM_LAW_NOTES_KERNEL);
}

static void walls_notes(dem_loop_task *task) {
  note_walls(task, (row){.flush = batch_notes, .planes = planes_notes});
}

static void share_notes(dem_loop_task *task) {
  DEM_LAW_NOTES_SHARE(task);
}

static double again_notes(dem_loop_task *task, double *largest) {
  return DEM_LAW_NOTES_AGAIN(task, largest);
}

static long iterations_of_notes(const dem_model *m) {
  return DEM_LAW_NOTES_ITERATIONS(m);
}

static double tolerance_of_notes(const dem_model *m) {
  return DEM_LAW_NOTES_TOLERANCE(m);
}

static const dem_noting noting = {
    {pairs_notes, walls_notes}, share_notes, again_notes, iterations_of_notes, tolerance_of_notes};
#define NOTING &noting
#else
#define NOTING NULL
#endif

/* ---- for the row ---- */

#define DEM_LAW_LOOPS_FOR(set) JOIN(JOIN(dem_loops_, DEM_LAW), set)
#if DEM_SIMD_WIDEST == 512
#define DEM_LAW_LOOPS \
  { &DEM_LAW_LOOPS_FOR(_avx512), &DEM_LAW_LOOPS_FOR(_avx2), &DEM_LAW_LOOPS_FOR(_plain) }
#elif DEM_SIMD_WIDEST == 256
#define DEM_LAW_LOOPS \
  { [DEM_AVX2] = &DEM_LAW_LOOPS_FOR(_avx2), [DEM_PLAIN] = &DEM_LAW_LOOPS_FOR(_plain) }
#else
#define DEM_LAW_LOOPS \
  { [DEM_PLAIN] = &DEM_LAW_LOOPS_FOR(_plain) }
#endif
extern const dem_loop_set DEM_LAW_LOOPS_FOR(_avx512), DEM_LAW_LOOPS_FOR(_avx2), DEM_LAW_LOOPS_FOR(_plain);

const dem_loop_set DEM_ISA(JOIN(dem_loops_, DEM_LAW)) = {.with = with,
                                                         .all_terms = {pairs_all_terms, walls_all_terms},
                                                         .called = LOOPS_CALLED,
                                                         .nsum = DEM_LAW_SUMS,
                                                         .sums = LOOPS_SUMS,
                                                         .noting = NOTING};

#endif

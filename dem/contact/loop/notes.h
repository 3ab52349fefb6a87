/* The loops that write what each contact tells the others of its particles (seam/notes.h), and how the loops of forces
 * read what came of it. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_NOTES_H
#define DEM_CONTACT_LOOP_NOTES_H

#include "dem/contact/loop/pair_loop.h"
#include "dem/contact/loop/wall_loop.h"

#ifdef DEM_LAW_NOTES_KERNEL

typedef void note_kernel(const dem_contact *, const vd *history, dem_note *);

/* the contacts of the lanes as columns of notes; those that are open have no width */
DEM_KERNEL void write_notes(double *column, size_t stride, const dem_contact *c, vd share, const dem_note *n) {
  vd_store(column + DEM_NOTE_X * stride, c->normal.x);
  vd_store(column + DEM_NOTE_Y * stride, c->normal.y);
  vd_store(column + DEM_NOTE_Z * stride, c->normal.z);
  vd_store(column + DEM_NOTE_SHARE * stride, share);
  vd_store(column + DEM_NOTE_WIDTH * stride, vd_only(c->touching, c->radius * c->overlap));
  vd_store(column + DEM_NOTE_FORCE * stride, vd_only(c->touching, n->force));
  if (!n->again)
    return;
  vd_store(column + DEM_NOTE_OVERLAP * stride, vd_only(c->touching, c->overlap));
  vd_store(column + DEM_NOTE_HERTZ * stride, vd_only(c->touching, n->hertz));
  vd_store(column + DEM_NOTE_WEIGHT * stride, vd_only(c->touching, n->weight));
}

/* the columns of a normal law's history, behind those of the tangential law */
DEM_INLINE int note_history(const dem_model *m) {
  return m->columns.normal < 0 ? 0 : m->columns.normal;
}

DEM_KERNEL void note_pairs(dem_loop_task *task, note_kernel *what) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_pairs *list = &d->lists.pairs;
  const int first = note_history(m);
  dem_contact c = contact_of(task, (row){0});
  for (size_t k = list->chunk[task->chunk]; k < list->chunk[task->chunk + 1]; k += DEM_W) {
    const int *i = list->one + k, *j = list->other + k;
    vd s[8], boxes[3], sum = vd_radii(d->state.sphere, i) + vd_radii(d->state.sphere, j), h[DEM_LAW_COLUMNS + 1];
    vd_sphere_difference(d->state.sphere, i, j, s);
    if (m->domain.repeats)
      nearest_image(d, s, boxes);
    vd3 x = {s[0], s[1], s[2]};
    vd r2 = vd3_dot(x, x);
    c.touching = vm_less(r2, sum * sum);
    if (!vm_any(c.touching)) {
      vd_store(note_column(d, DEM_NOTE_WIDTH) + k, vd_set(0));
      continue;
    }
    pair_arms arms = pair_geometry(d, i, j, s, x, r2, sum, &c);
    for (int q = 0; q < DEM_LAW_COLUMNS; q++)
      h[q] = vd_load(list->history + (size_t)(first + q) * list->capacity + k);
    dem_note note;
    what(&c, h, &note);
    write_notes(d->work.notes.column + k, d->work.notes.stride, &c, arms.share, &note);
  }
}

DEM_KERNEL void note_planes(dem_loop_task *task, size_t begin, size_t end, note_kernel *what) {
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->lists.walls;
  dem_contact c = contact_of(task, (row){0});
  for (size_t k = begin; k < end; k += DEM_W) {
    int i[DEM_W];
    vd arm, h[DEM_LAW_COLUMNS + 1];
    if (!touch_plane(task, k, i, &c, &arm))
      continue;
    for (int q = 0; q < DEM_LAW_COLUMNS; q++)
      h[q] = vd_load(list->history + (size_t)(note_history(task->model) + q) * list->capacity + k);
    dem_note note;
    what(&c, h, &note);
    write_notes(d->work.notes.column + dem_note_of_wall(d, k), d->work.notes.stride, &c, arm, &note);
  }
}

DEM_KERNEL void note_batch(dem_loop_task *task, batch *b, note_kernel *what) {
  dem_data *d = task->data;
  batch_motion motion;
  dem_contact c;
  batch_contact(task, b, (row){0}, &c, &motion);
  double lane[DEM_NOTES][DEM_W], history[DEM_LAW_COLUMNS + 1][DEM_W];
  vd h[DEM_LAW_COLUMNS + 1];
  batch_load_history(d, b, note_history(task->model), DEM_LAW_COLUMNS, history);
  for (int q = 0; q < DEM_LAW_COLUMNS; q++)
    h[q] = vd_load(history[q]);
  dem_note note;
  what(&c, h, &note);
  write_notes(lane[0], DEM_W, &c, motion.arm, &note);
  const int written = note.again ? DEM_NOTE_SIDE : DEM_NOTE_OVERLAP;
  for (int l = 0; l < b->count; l++)
    for (int q = 0; q < written; q++)
      note_column(d, q)[dem_note_of_wall(d, (size_t)b->entry[l])] = lane[q][l];
  b->count = 0;
}

/* the walls of a chunk; what does not touch is in no batch */
DEM_KERNEL void note_walls(dem_loop_task *task, row r) {
  dem_data *d = task->data;
  r.ncolumn = task->model->columns.ncolumn;
  if (task->wall_end > task->wall_first)
    memset(note_column(d, DEM_NOTE_WIDTH) + dem_note_of_wall(d, task->wall_first), 0,
           (task->wall_end - task->wall_first) * sizeof(double));
  wall_loop(task, r);
}

#endif

#endif

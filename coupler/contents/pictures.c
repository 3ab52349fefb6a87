/* Pictures of time histories for a report: see pictures.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/contents/pictures.h"

#include "coupler/contents/words.h"
#include "coupler/settings/settings.h"
#include "protocol/app/plot.h"
#include "protocol/results/thin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SETUP = 256 }; /* bytes of a plot's own settings */

/* What plots borrow, by panel and by channel of the contents. */
typedef struct {
  const cpl_contents *c;
  tdm_thin *thin;            /* (ntable) */
  tdm_plot *plot;            /* (npanel + nsection) those that vary, in the order of the pictures */
  tdm_plot_data *data;       /* (npanel + nsection) */
  char (*axis)[192];         /* (npanel + nsection) */
  char (*setup)[SETUP];      /* (npanel + nsection) of paths */
  tdm_curve *curve;          /* (nchannel + nsection) */
  char (*using)[16];         /* (nchannel + nsection) */
  tdm_plot_picture *picture; /* (npanel) */
  char (*title)[192];        /* (npanel) of pictures */
  int nplot, ncurve;
} drawing;

static bool allocate(drawing *d, const cpl_contents *c) {
  const size_t more = (size_t)c->nsection + 1; /* of a path: its plane */
  const size_t panels = (size_t)c->npanel + more, channels = (size_t)c->nchannel + more;
  *d = (drawing){.c = c};
  d->thin = calloc((size_t)c->ntable + 1, sizeof *d->thin);
  d->plot = calloc(panels, sizeof *d->plot);
  d->data = calloc(panels, sizeof *d->data);
  d->axis = calloc(panels, sizeof *d->axis);
  d->setup = calloc(panels, sizeof *d->setup);
  d->curve = calloc(channels, sizeof *d->curve);
  d->using = calloc(channels, sizeof *d->using);
  d->picture = calloc(panels, sizeof *d->picture);
  d->title = calloc(panels, sizeof *d->title);
  return d->thin && d->plot && d->data && d->axis && d->setup && d->curve && d->using && d->picture && d->title;
}

static void let_go(drawing *d) {
  for (int i = 0; d->thin && i < d->c->ntable; i++)
    tdm_thin_free(&d->thin[i]);
  for (int i = 0; d->data && i < d->nplot; i++)
    free(d->data[i].value);
  free(d->thin);
  free(d->plot);
  free(d->data);
  free(d->axis);
  free(d->setup);
  free(d->curve);
  free(d->using);
  free(d->picture);
  free(d->title);
}

/* ---- data ---- */

/* all columns behind the time */
static bool thin_table(tdm_thin *thin, const cpl_table *t) {
  const int n = t->ncolumn - 1;
  double *values = calloc((size_t)n + 1, sizeof *values);
  const bool good = tdm_thin_begin(thin, n) && values;
  for (int i = 0; good && i < t->nrow; i++) {
    for (int k = 0; k < n; k++)
      values[k] = t->data[(size_t)(k + 1) * (size_t)t->nrow + (size_t)i];
    tdm_thin_add(thin, t->data[i], values);
  }
  free(values);
  return good;
}

/* ---- plots ---- */

/* of a history, also behind a plane: the key above, where nothing is hidden */
static const char key[] =
    "set size noratio\nset autoscale\nset xtics norotate\nset key tmargin right horizontal samplen 2\n";

/* Components of vectors have a colour each, in all panels, also where one of them does not change. */
static const char *style_of(const cpl_panel *p, const char *component) {
  static const char *const styles[] = {"lines lw 1.5 lc 1", "lines lw 1.5 lc 2", "lines lw 1.5 lc 3",
                                       "lines lw 1.5 lc 4"};
  static const char axes[] = "xyzw";
  const char *axis = p->vector && component[0] ? strchr(axes, component[0]) : NULL;
  return axis ? styles[axis - axes] : "lines lw 1.5";
}

/* The panel as the next plot, with the channels that vary. false: out of memory. */
static bool add_plot(drawing *d, const cpl_panel *p) {
  char unit[48];
  int column[CPL_PANEL_CHANNELS], k = d->nplot++;
  tdm_plot *plot = &d->plot[k];
  snprintf(d->axis[k], sizeof d->axis[k], "%s [%s]", p->quantity, cpl_words_unit(p->unit, unit, sizeof unit));
  *plot =
      (tdm_plot){.title = "", .xlabel = "time [s]", .ylabel = d->axis[k], .setup = key, .curve = &d->curve[d->ncurve]};
  for (int i = 0; i < p->nchannel; i++) {
    const cpl_channel *channel = &d->c->channel[p->channel[i]];
    if (channel->course != CPL_VARIES)
      continue;
    column[plot->ncurve] = channel->column - 1;
    snprintf(d->using[d->ncurve], sizeof d->using[d->ncurve], "1:%d", plot->ncurve + 2);
    const bool named = p->vector || p->nchannel > 1 || strcmp(p->unit, "J") == 0;
    d->curve[d->ncurve] = (tdm_curve){.using = d->using[d->ncurve],
                                      .title = named ? channel->component : "",
                                      .style = style_of(p, channel->component)};
    d->ncurve++;
    plot->ncurve++;
  }
  double *rows = tdm_thin_table(&d->thin[p->table], column, plot->ncurve);
  d->data[k] = (tdm_plot_data){rows, tdm_thin_rows(&d->thin[p->table]), plot->ncurve + 1};
  return rows != NULL;
}

/* The channel of the panel that is called so and varies; NULL: none. */
static const cpl_channel *component(const cpl_contents *c, const cpl_panel *p, const char *name) {
  for (int i = 0; i < p->nchannel; i++) {
    const cpl_channel *channel = &c->channel[p->channel[i]];
    if (channel->course == CPL_VARIES && strcmp(channel->component, name) == 0)
      return channel;
  }
  return NULL;
}

/* A path in the plane of x and y, where its panel of places has both. */
static const cpl_panel *path_of(const cpl_contents *c, int section) {
  for (int i = 0; i < c->npanel && c->section[section].group == CPL_PATHS; i++)
    if (c->panel[i].section == section && strcmp(c->panel[i].quantity, "position") == 0 &&
        component(c, &c->panel[i], "x") && component(c, &c->panel[i], "y"))
      return &c->panel[i];
  return NULL;
}

/* A square that holds both, a length across being one up; into out. */
static void square(const cpl_channel *x, const cpl_channel *y, char out[SETUP]) {
  const double middle[] = {0.5 * (x->least + x->greatest), 0.5 * (y->least + y->greatest)};
  const double half = 0.525 * fmax(x->greatest - x->least, y->greatest - y->least);
  snprintf(out, SETUP,
           "set size square\nset xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\nset xtics rotate by -45\n"
           "set key off\n",
           middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half);
}

/* That as the next plot. false: out of memory. */
static bool add_path(drawing *d, const cpl_panel *p) {
  const cpl_channel *x = component(d->c, p, "x"), *y = component(d->c, p, "y");
  const int column[] = {x->column - 1, y->column - 1}, k = d->nplot++;
  square(x, y, d->setup[k]);
  d->curve[d->ncurve] = (tdm_curve){.using = "2:3", .title = "", .style = "lines lw 1"};
  d->plot[k] = (tdm_plot){.title = "",
                          .xlabel = "x [m]",
                          .ylabel = "y [m]",
                          .setup = d->setup[k],
                          .ncurve = 1,
                          .curve = &d->curve[d->ncurve++]};
  double *rows = tdm_thin_table(&d->thin[p->table], column, 2);
  d->data[k] = (tdm_plot_data){rows, tdm_thin_rows(&d->thin[p->table]), 3};
  return rows != NULL;
}

/* A file name of its own for each picture: with the section's name where that fits one. */
static void name_picture(cpl_picture *picture, int number, const char *title, int part) {
  char name[96];
  snprintf(name, sizeof name, "%.90s", title);
  for (char *c = name; *c; c++)
    if (*c == ' ' || *c == ':')
      *c = '_';
  snprintf(picture->name, sizeof picture->name, "report_%02d%s%s", number, cpl_name_fits_file(name) ? "_" : "",
           cpl_name_fits_file(name) ? name : "");
  if (part > 0)
    snprintf(picture->name + strlen(picture->name), 16, "_%d", part + 1);
}

/* Room for a plot of the section: in the last picture, or a new one. */
static void add_place(drawing *d, cpl_pictures *all, int section, int *part) {
  tdm_plot_picture *now = all->n > 0 ? &d->picture[all->n - 1] : NULL;
  if (*part == 0 || now->nplot == CPL_PICTURE_PANELS) {
    cpl_picture *picture = &all->picture[all->n];
    *picture = (cpl_picture){.section = section};
    cpl_section_title(&d->c->section[section], d->title[all->n], sizeof d->title[all->n]);
    name_picture(picture, all->n + 1, d->title[all->n], (*part)++);
    now = &d->picture[all->n];
    *now = (tdm_plot_picture){.name = picture->name, .title = d->title[all->n], .plot = d->plot + d->nplot};
    now->data = d->data + d->nplot;
    all->n++;
  }
  now->nplot++;
  now->across = now->nplot > 1 ? 2 : 1;
}

/* The panels of a section that vary, eight a picture; of a path its plane first. false: out of memory. */
static bool add_section(drawing *d, cpl_pictures *all, int section) {
  int part = 0;
  const cpl_panel *path = path_of(d->c, section);
  bool good = true;
  if (path) {
    add_place(d, all, section, &part);
    good = add_path(d, path);
  }
  for (int i = 0; good && i < d->c->npanel; i++) {
    const cpl_panel *p = &d->c->panel[i];
    if (p->section != section || !cpl_panel_varies(d->c, p))
      continue;
    add_place(d, all, section, &part);
    good = add_plot(d, p);
  }
  return good;
}

/* ---- the whole ---- */

tdm_status cpl_pictures_make(cpl_pictures *p, const char *dir, const cpl_contents *c, tdm_error *err) {
  drawing d;
  char path[4352];
  *p = (cpl_pictures){.picture = calloc((size_t)c->npanel + 1, sizeof *p->picture)};
  bool good = allocate(&d, c) && p->picture;
  for (int i = 0; good && i < c->ntable; i++)
    good = thin_table(&d.thin[i], &c->table[i]);
  for (int i = 0; good && i < c->nsection; i++)
    good = add_section(&d, p, i);
  for (int i = 0; good && i < p->n; i++) { /* one of an earlier report */
    snprintf(path, sizeof path, "%s/%s.png", dir, p->picture[i].name);
    unlink(path);
  }
  if (!good)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: no memory for its plots", dir);
  else if (p->n > 0)
    tdm_plot_pictures(dir, "report", p->n, d.picture, err);
  for (int i = 0; good && i < p->n; i++) {
    snprintf(path, sizeof path, "%s/%s.png", dir, p->picture[i].name);
    p->picture[i].there = access(path, R_OK) == 0;
  }
  let_go(&d);
  return err->status;
}

void cpl_pictures_free(cpl_pictures *p) {
  free(p->picture);
  *p = (cpl_pictures){0};
}

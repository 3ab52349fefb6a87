/* The time histories of a result directory, gathered for reading: see contents.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/contents/contents.h"

#include "coupler/contents/words.h"
#include "coupler/observe/observers.h"
#include "coupler/settings/settings.h"
#include "protocol/scene/input.h"

#include <dirent.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const double round_off = 1e-12; /* of the largest of its unit: what changes by less is not plotted */

static const struct {
  const char *title, *one; /* of the group, and what stands before the name of one of its sections */
} groups[CPL_NGROUP] = {
    [CPL_BODIES] = {"Bodies", "body "},
    [CPL_JOINTS] = {"Joints", "joint "},
    [CPL_DRIVERS] = {"Drivers", "driver "},
    [CPL_FORCES] = {"Forces", "force "},
    [CPL_MECHANISM] = {"Mechanism", ""},
    [CPL_PARTICLES] = {"Particles", ""},
    [CPL_FLOW] = {"Sources and sinks", ""},
    [CPL_SCREENING] = {"Screening", "screening: "},
    [CPL_PATHS] = {"Paths of particles", "path "},
    [CPL_EXCHANGE] = {"Exchange", "exchange: "},
    [CPL_OTHERS] = {"Others", ""},
};

const char *cpl_group_title(cpl_group group) {
  return groups[group].title;
}

const char *cpl_section_title(const cpl_section *section, char *out, size_t size) {
  snprintf(out, size, "%s%s", groups[section->group].one, section->name);
  return out;
}

/* ---- what a channel belongs to ---- */

typedef struct {
  cpl_group group;
  char section[128];
  char name[128]; /* without what it belongs to: "wx" */
} place;

/* the names of the two solvers' channels begin with what they belong to; with an object its name follows */
static const struct {
  const char *kind;
  cpl_group group;
  bool object;
  const char *section; /* of channels without an object */
} kinds[] = {
    {"body", CPL_BODIES, true, NULL},
    {"marker", CPL_BODIES, true, NULL},
    {"joint", CPL_JOINTS, true, NULL},
    {"driver", CPL_DRIVERS, true, NULL},
    {"force", CPL_FORCES, true, NULL},
    {"source", CPL_FLOW, true, NULL},
    {"sink", CPL_FLOW, true, NULL},
    {"container", CPL_FLOW, true, NULL},
    {"screening", CPL_SCREENING, true, "all decks"},
    {"path", CPL_PATHS, true, NULL},
    {"constraint", CPL_MECHANISM, false, "mechanism as a whole"},
    {"particles", CPL_PARTICLES, false, "particles as a whole"},
    {"balance", CPL_PARTICLES, false, "particles as a whole"},
    {"fixed", CPL_PARTICLES, false, "load on fixed walls"},
};

static void channel_place(const char *name, cpl_role role, place *p) {
  const char *first = strchr(name, '.'), *last = strrchr(name, '.');
  const int n = first ? (int)(first - name) : 0;
  *p = (place){.group = CPL_OTHERS};
  snprintf(p->section, sizeof p->section, "%.*s", first ? n : (int)sizeof p->section, name);
  snprintf(p->name, sizeof p->name, "%s", first ? first + 1 : name);
  for (size_t k = 0; first && k < sizeof kinds / sizeof kinds[0]; k++) {
    if ((int)strlen(kinds[k].kind) != n || strncmp(kinds[k].kind, name, (size_t)n) != 0)
      continue;
    p->group = kinds[k].group;
    if (kinds[k].section && (!kinds[k].object || last == first)) {
      snprintf(p->section, sizeof p->section, "%s", kinds[k].section);
    } else if (last > first) {
      snprintf(p->section, sizeof p->section, "%s%s%.*s", p->group == CPL_FLOW ? kinds[k].kind : "",
               p->group == CPL_FLOW ? " " : "", (int)(last - first - 1), first + 1);
      snprintf(p->name, sizeof p->name, "%s", last + 1);
    }
  }
  if (first && n == 6 && strncmp(name, "energy", 6) == 0) {
    p->group = role == CPL_MBD ? CPL_MECHANISM : CPL_PARTICLES;
    snprintf(p->section, sizeof p->section, "%s", role == CPL_MBD ? "mechanism as a whole" : "energy of the particles");
  }
}

/* a column of ledger.csv: "box.impulse.x" of a coupled body, or "balance" of all */
static void ledger_place(const char *name, const json_t *bodies, place *p) {
  size_t i;
  json_t *body;
  *p = (place){.group = CPL_EXCHANGE, .section = "energy ledger"};
  snprintf(p->name, sizeof p->name, "%s", name);
  json_array_foreach(bodies, i, body) {
    const char *of = json_string_value(json_object_get(body, "mbd"));
    const size_t n = of ? strlen(of) : 0;
    if (n > 0 && strncmp(name, of, n) == 0 && name[n] == '.') {
      snprintf(p->section, sizeof p->section, "%s", of);
      snprintf(p->name, sizeof p->name, "%s", name + n + 1);
    }
  }
}

/* ---- files ---- */

/* what the columns of a file are */
typedef struct {
  const char *file;
  enum { BODY, CHANNELS, LEDGER } kind;
  cpl_role role;
  const char *body;
  const json_t *bodies;
} source;

static cpl_section *find_section(cpl_contents *c, const place *p) {
  for (int i = 0; i < c->nsection; i++)
    if (c->section[i].group == p->group && strcmp(c->section[i].name, p->section) == 0)
      return &c->section[i];
  cpl_section *s = &c->section[c->nsection++];
  *s = (cpl_section){.group = p->group};
  snprintf(s->name, sizeof s->name, "%s", p->section);
  return s;
}

/* The panel of the channel's quantity that has room, or a new one. */
static cpl_panel *find_panel(cpl_contents *c, cpl_section *s, const cpl_channel *channel, const cpl_words *w) {
  const int section = (int)(s - c->section);
  for (int i = 0; i < c->npanel; i++) {
    cpl_panel *p = &c->panel[i];
    if (p->section == section && p->table == channel->table && strcmp(p->quantity, w->quantity) == 0 &&
        strcmp(p->unit, channel->unit) == 0 && p->vector == w->vector && p->nchannel < CPL_PANEL_CHANNELS &&
        (w->vector || w->shared))
      return p;
  }
  cpl_panel *p = &c->panel[c->npanel++];
  *p = (cpl_panel){.table = channel->table, .section = section, .vector = w->vector};
  snprintf(p->quantity, sizeof p->quantity, "%s", w->quantity);
  snprintf(p->unit, sizeof p->unit, "%s", channel->unit);
  s->npanel++;
  return p;
}

/* whose force a force on a body is, and a joint's; what drifts */
static void tell_whose(const place *p, cpl_words *w) {
  const bool load = strcmp(w->quantity, "force") == 0 || strcmp(w->quantity, "moment") == 0;
  char plain[sizeof w->quantity];
  memcpy(plain, w->quantity, sizeof plain);
  if (load && w->vector && p->group == CPL_BODIES)
    snprintf(w->quantity, sizeof w->quantity, "%.60s of the particles", plain);
  else if (load && w->vector && p->group == CPL_JOINTS)
    snprintf(w->quantity, sizeof w->quantity, "reaction %.60s", plain);
  else if (p->group == CPL_MECHANISM && strcmp(p->name, "drift") == 0)
    snprintf(w->quantity, sizeof w->quantity, "opening of the joints");
  else if (p->group == CPL_FLOW && strcmp(p->name, "number") == 0)
    snprintf(w->quantity, sizeof w->quantity, "particles inside");
  else if (p->group == CPL_FLOW && strcmp(p->name, "left") == 0)
    snprintf(w->quantity, sizeof w->quantity, "particles that left");
}

static void look_at(cpl_channel *channel, const cpl_table *t) {
  const double *x = t->data + (size_t)channel->column * (size_t)t->nrow;
  channel->course = CPL_NO_NUMBER;
  for (int i = 0; i < t->nrow; i++) {
    if (!isfinite(x[i]))
      continue;
    if (channel->course == CPL_NO_NUMBER)
      channel->start = channel->least = channel->greatest = x[i];
    channel->course = CPL_CONSTANT;
    channel->end = x[i];
    channel->least = fmin(channel->least, x[i]);
    channel->greatest = fmax(channel->greatest, x[i]);
  }
  if (channel->course == CPL_CONSTANT && channel->greatest > channel->least)
    channel->course = CPL_VARIES;
}

static void add_channel(cpl_contents *c, const source *from, const char *head, int column) {
  cpl_channel *channel = &c->channel[c->nchannel];
  place p = {.group = CPL_BODIES};
  const char *unit = strchr(head, '[');
  *channel = (cpl_channel){.table = c->ntable - 1, .column = column};
  snprintf(channel->unit, sizeof channel->unit, "%.*s", unit ? (int)strcspn(unit + 1, "]") : 0, unit ? unit + 1 : "");
  snprintf(channel->name, sizeof channel->name, "%s%s%s%.*s", from->kind == BODY ? "body." : "",
           from->kind == BODY ? from->body : "", from->kind == BODY ? "." : "", (int)strcspn(head, " "), head);
  if (from->kind == LEDGER)
    ledger_place(channel->name, from->bodies, &p);
  else
    channel_place(channel->name, from->role, &p);
  cpl_words w = cpl_words_of(p.name, channel->unit);
  tell_whose(&p, &w);
  snprintf(channel->component, sizeof channel->component, "%s", w.component);
  look_at(channel, &c->table[channel->table]);
  cpl_panel *panel = find_panel(c, find_section(c, &p), channel, &w);
  panel->channel[panel->nchannel++] = c->nchannel++;
}

/* Room for `more` channels, each perhaps with a panel and a section of its own. */
static bool make_room(cpl_contents *c, int more) {
  const size_t n = (size_t)(c->nchannel + more) + 1;
  cpl_channel *channel = realloc(c->channel, n * sizeof *channel);
  c->channel = channel ? channel : c->channel;
  cpl_panel *panel = realloc(c->panel, n * sizeof *panel);
  c->panel = panel ? panel : c->panel;
  cpl_section *section = realloc(c->section, n * sizeof *section);
  c->section = section ? section : c->section;
  return channel && panel && section;
}

/* The head line as it is, with units; NULL: it cannot be read. The caller frees. */
static char *read_head(const char *path) {
  const char *why;
  char *line = NULL;
  size_t size = 0;
  FILE *f = tdm_open_input(path, false, &why);
  if (f && getline(&line, &size, f) <= 0) {
    free(line);
    line = NULL;
  }
  if (f)
    fclose(f);
  return line;
}

static void lack(cpl_contents *c, const char *why) {
  char(*longer)[512] = realloc(c->lack, ((size_t)c->nlack + 1) * sizeof *longer);
  if (!longer)
    return;
  c->lack = longer;
  snprintf(c->lack[c->nlack++], sizeof *c->lack, "%.500s", why);
}

static tdm_status read_file(cpl_contents *c, const char *dir, const source *from, tdm_error *err) {
  char path[4352];
  tdm_error bad = {0};
  cpl_table table;
  snprintf(path, sizeof path, "%s/%s", dir, from->file);
  if (access(path, F_OK) != 0)
    return TDM_OK;
  if (cpl_table_read(&table, path, &bad) != TDM_OK) {
    lack(c, bad.message);
    return TDM_OK;
  }
  char *line = read_head(path);
  cpl_table *tables = realloc(c->table, ((size_t)c->ntable + 1) * sizeof *tables);
  c->table = tables ? tables : c->table;
  if (!line || !tables || !make_room(c, table.ncolumn)) {
    free(line);
    cpl_table_free(&table);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory", path);
  }
  c->table[c->ntable++] = table;
  int column = 0;
  for (char *rest = line, *cell; (cell = strsep(&rest, ",")) != NULL && column < table.ncolumn; column++) {
    cell[strcspn(cell, "\r\n")] = 0;
    if (column > 0)
      add_channel(c, from, cell, column);
  }
  free(line);
  return TDM_OK;
}

/* ---- the whole ---- */

static double magnitude(const cpl_channel *channel) {
  return channel->course == CPL_NO_NUMBER ? 0 : fmax(fabs(channel->least), fabs(channel->greatest));
}

/* What changes by round-off alone is as good as constant. */
static void find_round_off(cpl_contents *c) {
  for (int i = 0; i < c->nchannel; i++) {
    cpl_channel *channel = &c->channel[i];
    double largest = 0;
    for (int k = 0; k < c->nchannel && channel->course == CPL_VARIES; k++)
      if (strcmp(c->channel[k].unit, channel->unit) == 0)
        largest = fmax(largest, magnitude(&c->channel[k]));
    if (channel->course == CPL_VARIES && channel->greatest - channel->least <= round_off * largest)
      channel->course = CPL_ROUND_OFF;
  }
}

/* Sections into the order of the index; within a group they keep theirs. Panels follow. */
static bool sort_sections(cpl_contents *c) {
  const size_t n = (size_t)c->nsection;
  cpl_section *sorted = calloc(n + 1, sizeof *sorted);
  int *now = calloc(n + 1, sizeof *now), filled = 0;
  for (int group = 0; sorted && now && group < CPL_NGROUP; group++)
    for (int i = 0; i < c->nsection; i++)
      if ((int)c->section[i].group == group) {
        now[i] = filled;
        sorted[filled++] = c->section[i];
      }
  const bool good = sorted && now;
  for (int i = 0; good && i < c->npanel; i++)
    c->panel[i].section = now[c->panel[i].section];
  free(now);
  if (!good) {
    free(sorted);
    return false;
  }
  free(c->section);
  c->section = sorted;
  return true;
}

static int is_body_file(const struct dirent *entry) {
  const size_t n = strlen(entry->d_name), around = strlen("body_.csv");
  return n > around && strncmp(entry->d_name, "body_", 5) == 0 && strcmp(entry->d_name + n - 4, ".csv") == 0;
}

/* The coupled bodies as a scene names them (new reference), from the names of their files: there is no scene. */
static json_t *guess_bodies(const char *dir) {
  json_t *bodies = json_array();
  struct dirent **file = NULL;
  const int n = scandir(dir, &file, is_body_file, alphasort);
  for (int i = 0; i < n; i++) {
    const char *name = file[i]->d_name + strlen("body_");
    json_array_append_new(bodies, json_pack("{s:s%}", cpl_role_names[CPL_MBD], name, strlen(name) - strlen(".csv")));
    free(file[i]);
  }
  free(file);
  return bodies;
}

static tdm_status read_bodies(cpl_contents *c, const char *dir, const json_t *bodies, tdm_error *err) {
  size_t i;
  json_t *body;
  json_array_foreach(bodies, i, body) {
    char file[256];
    const char *name = json_string_value(json_object_get(body, cpl_role_names[CPL_MBD]));
    if (!name || !cpl_name_fits_file(name))
      continue;
    const source from = {cpl_record_body_file(name, file, sizeof file), BODY, CPL_MBD, name, NULL};
    if (read_file(c, dir, &from, err) != TDM_OK)
      return err->status;
  }
  return TDM_OK;
}

tdm_status cpl_contents_read(cpl_contents *c, const char *dir, const json_t *scene, const json_t *summary,
                             tdm_error *err) {
  *c = (cpl_contents){0};
  json_t *bodies =
      scene ? json_incref(json_object_get(json_object_get(scene, "coupling"), "bodies")) : guess_bodies(dir);
  const char *software = json_string_value(json_object_get(summary, "software"));
  const bool mbd = scene ? json_object_get(scene, "dem") == NULL : software && strstr(software, "mbd");
  const source others[] = {{"mbd.csv", CHANNELS, CPL_MBD, NULL, NULL},
                           {"dem.csv", CHANNELS, CPL_DEM, NULL, NULL},
                           {"channels.csv", CHANNELS, mbd ? CPL_MBD : CPL_DEM, NULL, NULL},
                           {"ledger.csv", LEDGER, CPL_MBD, NULL, bodies}};
  read_bodies(c, dir, bodies, err);
  for (size_t k = 0; k < sizeof others / sizeof others[0] && err->status == TDM_OK; k++)
    read_file(c, dir, &others[k], err);
  json_decref(bodies);
  if (err->status != TDM_OK)
    return err->status;
  find_round_off(c);
  return sort_sections(c) ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory", dir);
}

void cpl_contents_free(cpl_contents *c) {
  for (int i = 0; i < c->ntable; i++)
    cpl_table_free(&c->table[i]);
  free(c->table);
  free(c->channel);
  free(c->panel);
  free(c->section);
  free(c->lack);
  *c = (cpl_contents){0};
}

bool cpl_panel_varies(const cpl_contents *c, const cpl_panel *panel) {
  for (int k = 0; k < panel->nchannel; k++)
    if (c->channel[panel->channel[k]].course == CPL_VARIES)
      return true;
  return false;
}

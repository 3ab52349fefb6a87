/* Sources and sinks: see flow.h. */
#include "dem/flow.h"

#include "dem/geometry/walls.h"
#include "protocol/log.h"

enum {
  TRIES = 20,       /* places tried in a region in one step */
  LOGGED_WAITS = 10 /* of a source; the channel tells the rest */
};

/* ---- drawing ---- */

/* SplitMix64's mixing function (Steele, Lea & Flood 2014) */
static uint64_t mix(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* A number in [0, 1) that depends on its arguments alone. */
static double uniform(uint64_t seed, uint64_t particle, uint64_t draw) {
  const uint64_t golden = 0x9e3779b97f4a7c15u;
  uint64_t z = mix(seed + golden);
  z = mix(z + golden * (particle + 1));
  z = mix(z + golden * (draw + 1));
  return (double)(z >> 11) * 0x1p-53;
}

static double radius_of(const dem_source *s, uint64_t particle) {
  if (s->radius[0] == s->radius[1])
    return s->radius[0];
  return s->radius[0] + (s->radius[1] - s->radius[0]) * uniform(s->seed, particle, 0);
}

static double mass_of(const dem_model *m, const dem_source *s, uint64_t particle) {
  double r = radius_of(s, particle);
  return s->mass > 0 ? s->mass : m->material[s->kind].density * 4.0 / 3 * M_PI * r * r * r;
}

static tdm_vec3 place_of(const dem_source *s, uint64_t particle, uint64_t draw) {
  tdm_vec3 size = tdm_sub(s->high, s->low);
  const double u[3] = {uniform(s->seed, particle, 3 * draw + 1), uniform(s->seed, particle, 3 * draw + 2),
                       uniform(s->seed, particle, 3 * draw + 3)};
  return tdm_add(s->low, tdm_v3(size.x * u[0], size.y * u[1], size.z * u[2]));
}

/* ---- sources ---- */

/* when the particle with `number` and `mass` before it is due */
static double due_time(const dem_source *s, uint64_t number, double mass) {
  return s->start + (s->mass_rate > 0 ? mass / s->mass_rate : (double)number / s->rate);
}

/* count the particles that should be there at time t */
static void advance_due(const dem_model *m, const dem_source *s, dem_source_state *now, double t, double round_off) {
  while (now->due < s->count) {
    double due = due_time(s, now->due, now->due_mass);
    if (!(due <= t + round_off) || !(due < s->end - round_off))
      return;
    now->due_mass += mass_of(m, s, now->due);
    now->due++;
  }
}

/* does a sphere at x overlap a particle or a wall? Not one that is altogether behind a plane. */
static bool occupied(const dem_data *d, tdm_vec3 x, double radius) {
  const dem_model *m = d->model;
  for (int w = 0; w < m->nwall; w++) {
    tdm_vec3 n;
    double gap = dem_wall_gap(&m->wall[w], &d->wall[w], x, &n);
    if (gap < radius && !(dem_wall_endless(&m->wall[w]) && gap <= -radius))
      return true;
  }
  for (int i = 0; i < d->nparticle; i++) {
    tdm_vec3 c = tdm_sub(x, d->sphere[i].position);
    double sum = radius + d->sphere[i].radius;
    if (tdm_dot(c, c) < sum * sum)
      return true;
  }
  return false;
}

/* The source's next particle, which was due `late` [s] ago, if there is room for it. */
static bool find_room(const dem_data *d, const dem_source *s, dem_source_state *now, double late, dem_newcomer *out) {
  const dem_model *m = d->model;
  bool point = s->low.x == s->high.x && s->low.y == s->high.y && s->low.z == s->high.z;
  out->radius = radius_of(s, now->made);
  out->mass = mass_of(m, s, now->made);
  out->kind = s->kind;
  tdm_vec3 v = s->velocity;
  if (s->relative >= 0)
    v = tdm_axpy(s->factor, d->twist[s->relative].velocity, v);
  out->velocity = tdm_axpy(late, m->gravity, v);
  for (int k = 0; k < (point ? 1 : TRIES); k++) {
    tdm_vec3 x = point ? s->low : place_of(s, now->made, now->draw);
    out->position = tdm_axpy(0.5 * late * late, m->gravity, tdm_axpy(late, v, x));
    now->draw++;
    if (!occupied(d, out->position, out->radius))
      return true;
  }
  return false;
}

static void note_wait(const dem_source *s, dem_source_state *now, double t) {
  if (now->blocked)
    return;
  now->blocked = 1;
  if (++now->waits <= LOGGED_WAITS)
    tdm_log(TDM_LOG_WARNING, "source_waits",
            "t=%.9g source=%s particle=%llu reason=\"its place is taken by a particle or a wall\"%s", t, s->name,
            (unsigned long long)now->made, now->waits == LOGGED_WAITS ? " further=not_logged" : "");
}

static void note_room(const dem_source *s, dem_source_state *now, double t) {
  if (now->blocked && now->waits <= LOGGED_WAITS)
    tdm_log(TDM_LOG_INFO, "source_resumes", "t=%.9g source=%s particle=%llu", t, s->name,
            (unsigned long long)now->made);
  now->blocked = 0;
}

static bool run_source(dem_data *d, const dem_source *s, dem_source_state *now, double t, double dt) {
  const double round_off = 1e-6 * dt; /* times on the grid of steps are on it */
  advance_due(d->model, s, now, t, round_off);
  while (now->made < now->due) {
    /* one that waited, or queued behind one, starts where the source is */
    double late = t - due_time(s, now->made, now->made_mass);
    if (now->blocked || late < round_off || late > dt - round_off)
      late = 0;
    dem_newcomer newcomer;
    if (!find_room(d, s, now, late, &newcomer)) {
      note_wait(s, now, t);
      return true;
    }
    note_room(s, now, t);
    if (!dem_data_add(d, &newcomer))
      return false;
    now->made++;
    now->made_mass += newcomer.mass;
    now->draw = 0;
  }
  return true;
}

/* ---- sinks ---- */

static bool touches(const dem_data *d, int i, int w) {
  const dem_wall *wall = &d->model->wall[w];
  tdm_vec3 n;
  double gap = dem_wall_gap(wall, &d->wall[w], d->sphere[i].position, &n);
  return gap < d->sphere[i].radius && !(dem_wall_endless(wall) && gap <= -d->sphere[i].radius);
}

/* is particle i inside sink s by its place alone? */
static bool inside(const dem_sink *s, tdm_vec3 x) {
  if (s->type == DEM_SINK_PLANE)
    return tdm_dot(tdm_sub(x, s->point), s->normal) < 0;
  return s->type == DEM_SINK_BOX && x.x >= s->low.x && x.x <= s->high.x && x.y >= s->low.y && x.y <= s->high.y &&
         x.z >= s->low.z && x.z <= s->high.z;
}

/* Has particle i rebounded from the body of sink s? One that went through a wall has not: it is lost. */
static bool rebounded(dem_data *d, int s, int i) {
  const dem_model *m = d->model;
  uint32_t bit = (uint32_t)1 << s;
  int body = m->sink[s].body;
  for (int w = 0; w < m->nwall; w++)
    if (m->wall[w].body == body && touches(d, i, w)) {
      d->touched[i] |= bit;
      return false;
    }
  if (!(d->touched[i] & bit))
    return false;
  for (int w = 0; w < m->nwall; w++)
    if (m->wall[w].body == body && dem_through(d, i, w))
      return false;
  return true;
}

/* the sink that takes particle i, -1: none */
static int taker(dem_data *d, int i) {
  const dem_model *m = d->model;
  int first = -1;
  for (int s = 0; s < m->nsink; s++) { /* all of them, so that each notes its contacts */
    bool takes =
        m->sink[s].type == DEM_SINK_AFTER_CONTACT ? rebounded(d, s, i) : inside(&m->sink[s], d->sphere[i].position);
    if (takes && first < 0)
      first = s;
  }
  return first;
}

static void run_sinks(dem_data *d) {
  int *gone = d->number; /* scratch */
  long many = 0;
  for (int i = 0; i < d->nparticle; i++) {
    gone[i] = taker(d, i);
    if (gone[i] < 0)
      continue;
    d->sink[gone[i]].removed++;
    d->sink[gone[i]].mass += d->mass[i];
    many++;
  }
  if (many > 0)
    dem_data_remove(d, gone);
}

bool dem_flow(dem_data *d, double t, double dt) {
  const dem_model *m = d->model;
  if (m->nsink > 0)
    run_sinks(d);
  for (int s = 0; s < m->nsource; s++)
    if (!run_source(d, &m->source[s], &d->source[s], t, dt))
      return false;
  return true;
}

/* ---- balances ---- */

double dem_balance_number(const dem_data *d) {
  return (double)d->ledger.created - (double)d->ledger.removed - (double)d->nparticle;
}

double dem_balance_mass(const dem_data *d) {
  dem_exact rest = d->ledger.mass;
  for (int i = 0; i < d->nparticle; i++)
    dem_exact_add(&rest, -d->mass[i]);
  return dem_exact_value(&rest);
}

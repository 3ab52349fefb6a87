/* Contacts that act on each other at walls of meshes and of coupled bodies: the same forces as at a plane, what walls
 * and particles push each other with, the same bits. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_multi_support.h"
#include "tests/test_main.h"

#include <unistd.h>

static const char *const laws[][2] = {{"'restitution':0.8,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain'"},
                                      {"'restitution':0.8,'friction':0.3,'gamma':1.12",
                                       "'multi_contact':'mc-strain','first_forces':'hertz','iterations':3"},
                                      {"'restitution':0.8,'friction':0.3,'beta':1.65", "'multi_contact':'mc-stress'"}};
enum { LAWS = sizeof laws / sizeof *laws };

static const char *mesh_file(void) {
  static char path[256];
  snprintf(path, sizeof path, "%s/multi_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  return path;
}

/* The plane z = 0 in 32 x 32 triangles that face up, from -1/8 to 3/8. */
static void write_plane(void) {
  FILE *f = fopen(mesh_file(), "w");
  ck_assert_ptr_nonnull(f);
  fputs("solid s\n", f);
  for (int k = 0; k < 2 * 16 * 16; k++) {
    static const int corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
    fputs("facet normal 0 0 1\nouter loop\n", f);
    for (int c = 0; c < 3; c++)
      fprintf(f, "vertex %g %g 0\n", 0.03125 * (k / 2 % 16 + corner[k % 2][c][0]) - 0.125,
              0.03125 * (k / 32 + corner[k % 2][c][1]) - 0.125);
    fputs("endloop\nendfacet\n", f);
  }
  fputs("endsolid s\n", f);
  fclose(f);
}

#define PLANE "{'type':'plane','normal':[0,0,1]}"

/* Balls in layers on a floor, between it and a lid that comes down, in a cylinder; they move about. */
static rig *pressed(const char *more, const char *floor, int law, int n, bool coupled) {
  const double middle = 0.0193 * (n - 1) / 2;
  char there[2000];
  snprintf(there, sizeof there,
           "'bodies':[{'name':'floor','material':'a','shapes':[%s]},{'name':'lid','material':'a',%s'shapes':[{'type':"
           "'plane','normal':[0,0,-1]}]%s},{'name':'wall','material':'a','shapes':[{'type':'cylinder','side':'inside',"
           "'radius':%.17g,'length':0.4,'point':[%.17g,%.17g,0.1],'axis':[0,0,1]}]}],'particles':[{'type':'list',"
           "'material':'a','radius':0.01,'positions':[]}]",
           floor, coupled ? "" : "'position':[0,0,0.0572],", coupled ? "" : ",'motion':{'velocity':[0,0,-0.2]}",
           middle * sqrt(2) + 0.0095, middle, middle);
  const tdm_assigned_body body[] = {{.name = "floor", .mass = 1e12, .state = state_at(0, 0, 0)},
                                    {.name = "lid", .mass = 1e12, .state = state_at(0, 0, 0.0572)}};
  json_t *scene = scene_json(SCENE, more, "0.46", laws[law][0], laws[law][1], there);
  json_t *positions = json_object_get(json_array_get(json_object_get(scene, "particles"), 0), "positions");
  for (int k = 0; k < 3 * n * n; k++)
    json_array_append_new(
        positions, json_pack("[f,f,f]", 0.0193 * (k % n), 0.0193 * (k / n % n), 0.0095 + 0.0191 * (k / (n * n))));
  rig *r = rig_make(scene, 1e-5, coupled ? 2 : 0, body);
  for (int i = 0; i < r->data->state.nparticle; i++)
    r->data->state.pace[i].velocity = tdm_v3(0.2 * sin(3.0 * i), 0.2 * cos(5.0 * i), 0.2 * sin(7.0 * i));
  r->data->state.restart = true;
  return r;
}

static const char *meshed(void) {
  static char text[300];
  snprintf(text, sizeof text, "{'type':'mesh','file':'%s'}", mesh_file());
  return text;
}

/* A meshed plane is the plane: forces at the start, and where the balls are and what the bodies feel later. */
START_TEST(test_mesh_is_plane) {
  write_plane();
  rig *plane = pressed("", PLANE, _i, 6, false), *mesh = pressed("", meshed(), _i, 6, false);
  const dem_state *a = &plane->data->state, *b = &mesh->data->state;
  for (int steps = 0; steps <= 400; steps += 200) {
    double largest = 0;
    ck_assert_int_eq(a->ncontact, b->ncontact);
    for (int i = 0; i < a->nparticle; i++)
      largest = fmax(largest, tdm_norm(a->push[i].force));
    for (int i = 0; i < a->nparticle; i++) {
      ck_vector(b->sphere[i].position, a->sphere[i].position, 1e-10 * radius);
      ck_vector(b->push[i].force, a->push[i].force, 1e-8 * largest);
      ck_vector(b->push[i].twist, a->push[i].twist, 1e-8 * largest);
    }
    ck_assert_double_gt(tdm_norm(a->body_load[0].force), 10 * largest * 0.01);
    ck_vector(b->body_load[0].force, a->body_load[0].force, 1e-8 * tdm_norm(a->body_load[0].force));
    rig_steps(plane, 200);
    rig_steps(mesh, 200);
  }
  rig_free(plane);
  rig_free(mesh);
  unlink(mesh_file());
}
END_TEST

/* What acts on the bodies is what acts on the particles, turned round: force, and moment about the origin. */
static void ck_third_law(const dem_data *d) {
  const dem_state *s = &d->state;
  tdm_vec3 force = {0}, moment = {0};
  double size = 0;
  for (int i = 0; i < s->nparticle; i++) {
    const tdm_vec3 f = s->push[i].force;
    force = tdm_add(force, f);
    moment = tdm_add(moment, tdm_axpy(-s->sphere[i].radius, s->push[i].twist, tdm_cross(s->sphere[i].position, f)));
    size += tdm_norm(f);
  }
  for (int b = 0; b < d->model->nload; b++) {
    const tdm_wrench w = s->body_load[b];
    force = tdm_add(force, w.force);
    moment = tdm_add(moment, tdm_add(w.moment, tdm_cross(s->pose[b].position, w.force)));
  }
  ck_assert_double_gt(size, 0);
  ck_assert_double_lt(tdm_norm(force), 1e-13 * size);
  ck_assert_double_lt(tdm_norm(moment), 1e-13 * size * 0.2);
}

START_TEST(test_third_law) {
  const int law = _i % LAWS;
  const bool coupled = _i / LAWS % 2, mesh = _i / LAWS / 2;
  write_plane();
  rig *r = pressed("", mesh ? meshed() : PLANE, law, 6, coupled);
  ck_assert_int_eq(r->model->ncoupled, coupled ? 2 : 0);
  for (int k = 0; k < 5; k++) {
    ck_third_law(r->data);
    ck_assert_double_lt(r->data->state.body_load[0].force.z, 0);
    ck_assert_double_gt(r->data->state.body_load[1].force.z, 0);
    rig_steps(r, 100);
  }
  rig_free(r);
  unlink(mesh_file());
}
END_TEST

/* Threads, instruction set, search and lists change nothing. More than one chunk of balls. */
START_TEST(test_same_bits) {
  static const char *const ways[] = {"'threads':2,", "'simd':'plain',", "'search':'sweep','skin':0.003,",
                                     "'energy':true,'threads':2,"};
  const int law = _i % LAWS, way = _i / LAWS;
  write_plane();
  rig *r = pressed("", meshed(), law, 28, true), *other = pressed(ways[way], meshed(), law, 28, true);
  ck_assert_int_gt(r->data->lists.crossings.count, 0);
  for (int k = 0; k < 10; k++) {
    rig_steps(r, 1);
    rig_steps(other, 1);
    ck_assert_mem_eq(r->data->state.body_load, other->data->state.body_load,
                     (size_t)r->model->nload * sizeof *r->data->state.body_load);
  }
  ck_same_run(r, other, 20);
  unlink(mesh_file());
}
END_TEST

TEST_MAIN_ROWS("contacts that act on each other at walls", {test_mesh_is_plane, LAWS}, {test_third_law, 4 * LAWS},
               {test_same_bits, 4 * LAWS})

/* What the outputs of a run work out: slopes of heaps, walls as polygons, the starts of particles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/repose.h"
#include "dem/output/view.h"
#include "protocol/output/histogram.h"
#include "tests/numerics/test_dem_support.h"
#include "tests/test_main.h"

#include <math.h>

enum { MANY = 2000 };

static tdm_vec3 position[MANY];
static double radius[MANY];

/* rows of particles under the lines z = height - tan(low) |x| (x < 0) and height - tan(high) x */
static tdm_snapshot heap(double low_deg, double high_deg, double height, double r) {
  tdm_snapshot s = {.position = position, .radius = radius};
  double slope[2] = {tan(low_deg * M_PI / 180), tan(high_deg * M_PI / 180)};
  for (int column = -40; column <= 40; column++) {
    double x = 2 * r * column, top = height - slope[x > 0] * fabs(x);
    for (double z = top - r; z > r && s.nparticle < MANY; z -= 2 * r) {
      position[s.nparticle] = tdm_v3(x, 0.3 * x, z);
      radius[s.nparticle++] = r;
    }
  }
  return s;
}

START_TEST(the_slopes_of_a_heap) {
  static const double angles[][2] = {{30, 30}, {20, 35}, {5, 5}};
  for (int k = 0; k < 3; k++) {
    tdm_snapshot s = heap(angles[k][0], angles[k][1], k == 2 ? 0.06 : 0.4, 0.01);
    dem_repose found = dem_repose_of(&s, 0);
    ck_assert_double_eq_tol(found.low, angles[k][0], 0.6);
    ck_assert_double_eq_tol(found.high, angles[k][1], 0.6);
    ck_assert_double_eq_tol(found.mean, 0.5 * (found.low + found.high), 1e-12);
  }
}
END_TEST

START_TEST(no_heap_has_no_slope) {
  tdm_snapshot none = {0};
  ck_assert(isnan(dem_repose_of(&none, 0).mean));
  tdm_snapshot s = heap(30, 30, 0.4, 0.01);
  s.nparticle = 1;
  ck_assert(isnan(dem_repose_of(&s, 1).mean));
}
END_TEST

/* ---- polygons ---- */

static double area(const dem_polygon *p) {
  tdm_vec3 twice = {0, 0, 0};
  for (int c = 2; c < p->ncorner; c++)
    twice = tdm_add(twice, tdm_cross(tdm_sub(p->corner[c - 1], p->corner[0]), tdm_sub(p->corner[c], p->corner[0])));
  return 0.5 * tdm_norm(twice);
}

/* a container that is open above and turned about z, a block in it, and planes */
static rig *walled_scene(void) {
  return rig_make(
      scene_json(
          "{'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e7, 'poisson_ratio': 0.3}],"
          "'pairs': [{'materials': ['m', 'm'], 'restitution': 0.8, 'friction': 0.4}],"
          "'bodies': [{'name': 'tub', 'material': 'm', 'position': [5, 0, 0], 'orientation': [0.9, 0, 0, 0.3],"
          "  'shapes': [{'type': 'box', 'side': 'inside', 'size': [1, 2, 3], 'open': ['+z']}]},"
          " {'name': 'block', 'material': 'm', 'shapes': [{'type': 'box', 'side': 'outside', 'size': [1, 1, 2]}]},"
          " {'name': 'far', 'material': 'm', 'shapes': [{'type': 'plane', 'point': [0, 0, -50], 'normal': [0, 0, "
          "1]}]},"
          " {'name': 'slanted', 'material': 'm', 'shapes': [{'type': 'plane', 'normal': [1, 2, 3]}]}]}"),
      1e-4, 0, NULL);
}

START_TEST(walls_as_polygons) {
  rig *r = walled_scene();
  dem_polygons all = {0};
  tdm_error err = {0};
  dem_bounds bounds = {{-1, -1, -1}, {1, 1, 1}};
  ck_assert_int_eq(dem_polygons_make(&all, r->data, &bounds, &err), TDM_OK);
  ck_assert_int_eq(all.count, 5 + 6 + 1); /* the plane that is far away is not seen */
  double total[4] = {0};
  for (int k = 0; k < all.count; k++) {
    const dem_polygon *p = &all.polygon[k];
    total[p->body] += area(p);
    ck_assert_int_eq(p->solid, p->body == 1);
  }
  ck_near(total[0], 2 * (2 * 3 + 1 * 3) + 1 * 2, 1e-6);
  ck_near(total[1], 2 * (1 + 2 + 2), 1e-12);
  /* x + 2y + 3z = 0 in the cube [-1, 1]^3: over the square in x, y as far as |x + 2y| <= 3, seen at cos = 3/sqrt(14).
   * That leaves out nothing but the corners where x = 1, y = 1. */
  ck_near(total[3], 4 * sqrt(14) / 3, 1e-6);
  const dem_polygon *slanted = &all.polygon[all.count - 1];
  for (int c = 0; c < slanted->ncorner; c++) {
    tdm_vec3 x = slanted->corner[c]; /* its body stands at the origin */
    ck_near(x.x + 2 * x.y + 3 * x.z, 0, 1e-6);
    ck_assert(fmax(fabs(x.x), fmax(fabs(x.y), fabs(x.z))) < 1 + 1e-6);
  }
  dem_polygons_free(&all);
  rig_free(r);
}
END_TEST

START_TEST(the_bounds_of_a_scene) {
  rig *r = walled_scene();
  dem_bounds b = dem_scene_bounds(r->data);
  double angle = 2 * atan2(0.3, 0.9);
  ck_near(b.low.x, -0.5, 1e-12);
  ck_near(b.high.x, 5 + 0.5 * cos(angle) + 1 * sin(angle), 1e-12);
  ck_near(b.low.z, -1.5, 1e-12);
  rig_free(r);
}
END_TEST

/* Polygons are in the axes of their body: with its pose they are where the walls are. */
START_TEST(what_there_is_to_see) {
  rig *r = walled_scene();
  tdm_error err = {0};
  dem_view view = {0};
  tdm_scenery scenery = {0};
  tdm_snapshot now = {0};
  ck_assert_int_eq(dem_view_scenery(&view, r->data, &scenery, &err), TDM_OK);
  ck_assert_int_eq(dem_view_snapshot(&view, r->data, 0.5, &now, &err), TDM_OK);
  ck_assert_int_eq(tdm_snapshot_check(&now, &scenery, &err), TDM_OK);
  ck_assert_int_eq(scenery.nbody, 4);
  ck_assert_str_eq(scenery.body[1].name, "block");
  ck_assert(scenery.body[1].dem && !scenery.body[1].mbd && scenery.body[1].still && !scenery.body[1].marked);
  ck_assert_int_eq(scenery.nmaterial, 1);
  ck_assert_double_eq(now.time, 0.5);
  for (int k = 0; k < scenery.npolygon; k++) {
    const tdm_view_polygon *p = &scenery.polygon[k];
    double nearest = INFINITY; /* of the walls of its body */
    for (int w = 0; w < r->model->nwall; w++) {
      tdm_vec3 n, x = tdm_pose_point(now.pose[p->body], p->corner[0]);
      if (r->model->wall[w].body == p->body)
        nearest = fmin(nearest, fabs(dem_wall_gap(&r->model->wall[w], &r->data->state.wall[w], x, &n)));
    }
    ck_near(nearest, 0, 1e-12);
  }
  tdm_scenery_free(&scenery);
  tdm_snapshot_free(&now);
  dem_view_free(&view);
  rig_free(r);
}
END_TEST

/* ---- contacts ---- */

/* a pressed block of 4 x 4 x 4 without friction: in a box, or on a floor that repeats along x and y */
static rig *pressed_block(const char *law, const char *factor, bool repeats) {
  char text[8192], places[6000];
  size_t at = 0;
  for (int k = 0; k < 64; k++)
    at += (size_t)snprintf(places + at, sizeof places - at, "%s[%.5f, %.5f, %.5f]", k > 0 ? "," : "",
                           0.0098 + 0.0196 * (k % 4), 0.0099 + 0.0196 * (k / 4 % 4), 0.0097 + 0.0196 * (k / 16));
  snprintf(text, sizeof text,
           "{'gravity': [0, 0, 0], 'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e6,"
           " 'poisson_ratio': 0.4}], 'pairs': [{'materials': ['m', 'm'], 'restitution': 1 %s}],"
           "'contact': {'tangential': 'none' %s}, %s 'bodies': [{'name': 'box', 'material': 'm', 'shapes': [%s]}],"
           "'particles': [{'type': 'list', 'material': 'm', 'radius': 0.01, 'positions': [%s]}],"
           "'guard': {'overlap': 0.9}}",
           factor, law,
           repeats ? "'domain': {'min': [0, 0, -1], 'max': [0.0784, 0.0784, 1], 'x': 'periodic', 'y': 'periodic'},"
                   : "",
           repeats ? "{'type': 'plane', 'normal': [0, 0, 1]}"
                   : "{'type': 'box', 'side': 'inside', 'size': [0.0784, 0.0784, 0.0784],"
                     " 'center': [0.0392, 0.0392, 0.0392]}",
           places);
  return rig_make(scene_json("%s", text), 1e-5, 0, NULL);
}

/* Without friction the contacts' forces along their lines are all there is: they add up to the force on each particle,
 * whatever the law; and looking changes no bit of the state. */
START_TEST(contacts_add_up) {
  static const char *const laws[] = {"", ", 'multi_contact': 'mc-stress'", ", 'multi_contact': 'mc-strain'"};
  static const char *const factors[] = {"", ", 'beta': 1", ", 'gamma': 1"};
  for (int k = 0; k < 6; k++) {
    tdm_error err = {0};
    rig *r = pressed_block(laws[k % 3], factors[k % 3], k >= 3);
    dem_view view = {0};
    tdm_snapshot s = {.with_contacts = true};
    tdm_vec3 sum[64] = {{0}};
    const dem_push before = r->data->state.push[13];
    const long touching = r->data->state.ncontact;
    ck_assert_int_eq(dem_view_snapshot(&view, r->data, 0, &s, &err), TDM_OK);
    ck_assert_int_eq(s.ncontact, touching);
    ck_assert_int_eq(memcmp(&before, &r->data->state.push[13], sizeof before), 0);
    double largest = 0;
    int walls = 0;
    for (int c = 0; c < s.ncontact; c++) {
      const tdm_view_contact *contact = &s.contact[c];
      const tdm_vec3 pull = tdm_scale(contact->force, tdm_unit(tdm_sub(contact->from, contact->to)));
      ck_assert_double_le(tdm_norm(tdm_sub(contact->from, contact->to)), 0.02);
      sum[contact->particle] = tdm_add(sum[contact->particle], pull);
      if (contact->other >= 0)
        sum[contact->other] = tdm_sub(sum[contact->other], pull);
      walls += contact->other < 0;
      largest = fmax(largest, contact->force);
    }
    ck_assert_int_eq(walls, k >= 3 ? 16 : 96);
    ck_assert_double_gt(largest, 0);
    for (int i = 0; i < 64; i++)
      ck_assert_double_le(tdm_norm(tdm_sub(sum[i], s.force[i])), 1e-12 * largest);
    tdm_snapshot_free(&s);
    dem_view_free(&view);
    rig_free(r);
  }
}
END_TEST

START_TEST(forces_over_their_mean) {
  static tdm_view_contact contact[4] = {{.force = 1}, {.force = 3}, {.force = -5}, {.force = 0}};
  const tdm_force_bins b = tdm_force_bins_of(&(tdm_snapshot){.ncontact = 4, .contact = contact});
  double all = 0;
  ck_assert_int_eq(b.n, 2); /* those that repel */
  ck_assert_double_eq(b.mean, 2);
  for (int k = 0; k < TDM_FORCE_BINS; k++) {
    const double low = k * b.width, high = low + b.width;
    all += b.density[k] * b.width;
    ck_near(b.density[k] * b.width, (0.5 >= low && 0.5 < high) || (1.5 >= low && 1.5 < high) ? 0.5 : 0, 1e-12);
  }
  ck_near(all, 1, 1e-12);
  ck_assert_int_eq(tdm_force_bins_of(&(tdm_snapshot){0}).n, 0);
}
END_TEST

TEST_MAIN("dem_output", the_slopes_of_a_heap, no_heap_has_no_slope, walls_as_polygons, the_bounds_of_a_scene,
          what_there_is_to_see, contacts_add_up, forces_over_their_mean)

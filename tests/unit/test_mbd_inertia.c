/* Bodies: markers, and mass, centre and inertia of shapes: primitives against finely divided or known solids, meshes
 * against exact values.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/shape/inertia.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

static mbd_shape shape_of(const char *text) {
  tdm_error err = {0};
  json_t *json = scene_json("%s", text);
  tdm_object o = tdm_object_open(json, "", &err);
  mbd_shape s = mbd_shape_read(&o);
  ck_assert_msg(!err.status, "%s: %s", err.path, err.message);
  json_decref(json);
  return s;
}

/* Volume, centre and gyration of what `inside` says, on a grid of 2 n cells a side over [-1, 1]^3. */
static mbd_shape by_grid(bool (*inside)(double x, double y, double z), int n) {
  double m0 = 0, m1 = 0, xx = 0, zz = 0, h = 1.0 / n;
  for (int i = -n; i < n; i++)
    for (int j = -n; j < n; j++)
      for (int k = -n; k < n; k++) {
        double x = (i + 0.5) * h, y = (j + 0.5) * h, z = (k + 0.5) * h;
        if (!inside(x, y, z))
          continue;
        m0 += 1;
        m1 += z;
        xx += y * y + z * z;
        zz += x * x + y * y;
      }
  double c = m1 / m0;
  return (mbd_shape){.volume = m0 * h * h * h,
                     .centre = {0, 0, c},
                     .gyration = {{{xx / m0 - c * c, 0, 0}, {0, xx / m0 - c * c, 0}, {0, 0, zz / m0}}}};
}

static bool in_sphere(double x, double y, double z) {
  return x * x + y * y + z * z < 0.81;
}
static bool in_cylinder(double x, double y, double z) {
  return x * x + y * y < 0.25 && fabs(z) < 0.8;
}
static bool in_tube(double x, double y, double z) {
  return in_cylinder(x, y, z) && x * x + y * y > 0.09;
}
static bool in_cone(double x, double y, double z) {
  double r = 0.45 * (1 - z);
  return x * x + y * y < r * r;
}
static bool in_capsule(double x, double y, double z) {
  double end = fmax(0, fabs(z) - 0.5);
  return x * x + y * y + end * end < 0.16;
}
static bool in_box(double x, double y, double z) {
  return fabs(x) < 0.5 && fabs(y) < 0.5 && fabs(z) < 0.9;
}

START_TEST(test_primitives) {
  static const struct {
    const char *text;
    bool (*inside)(double x, double y, double z);
  } solids[] = {
      {"{'shape':{'type':'sphere','radius':0.9}}", in_sphere},
      {"{'shape':{'type':'cylinder','radius':0.5,'length':1.6}}", in_cylinder},
      {"{'shape':{'type':'tube','radius':0.5,'inner_radius':0.3,'length':1.6}}", in_tube},
      {"{'shape':{'type':'cone','radius':0.9,'length':2}}", in_cone},
      {"{'shape':{'type':'capsule','radius':0.4,'length':1}}", in_capsule},
      {"{'shape':{'type':'box','size':[1,1,1.8]}}", in_box},
  };
  for (size_t i = 0; i < sizeof solids / sizeof solids[0]; i++) {
    mbd_shape s = shape_of(solids[i].text), g = by_grid(solids[i].inside, 80);
    CLOSE(s.volume, g.volume, 3e-3 * g.volume);
    for (int k = 0; k < 3; k++)
      CLOSE(s.gyration.m[k][k], g.gyration.m[k][k], 3e-3 * g.gyration.m[k][k]);
    CLOSE(tdm_norm(s.centre), 0, 0);
  }
  mbd_shape box = shape_of("{'shape':{'type':'box','size':[1,2,3]}}");
  CLOSE(box.gyration.m[0][0], 13.0 / 12, 1e-15);
  CLOSE(box.gyration.m[1][1], 10.0 / 12, 1e-15);
  CLOSE(box.gyration.m[2][2], 5.0 / 12, 1e-15);
}
END_TEST

/* ---- meshes ---- */

/* The box [p, p + s] as 12 triangles into corner (36). */
static void box_mesh(tdm_vec3 *corner, tdm_vec3 p, tdm_vec3 s) {
  static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int f = 0; f < 6; f++) {
    const int order[6] = {0, 1, 2, 0, 2, 3};
    for (int k = 0; k < 6; k++) {
      int v = faces[f][order[k]];
      corner[6 * f + k] = tdm_v3(p.x + (v & 1 ? s.x : 0), p.y + (v & 2 ? s.y : 0), p.z + (v & 4 ? s.z : 0));
    }
  }
}

/* a box far from the origin, exact to rounding */
START_TEST(test_box_mesh) {
  tdm_vec3 corner[36];
  tdm_stl stl = {12, corner};
  tdm_error err = {0};
  mbd_shape s;
  box_mesh(corner, tdm_v3(100, -200, 300), tdm_v3(1, 2, 3));
  ck_assert_msg(mbd_shape_of_mesh(&s, &stl, "box", "p", &err) == TDM_OK, "%s", err.message);
  CLOSE(s.volume, 6, 1e-13);
  CLOSE(s.centre.x, 100.5, 1e-13);
  CLOSE(s.centre.y, -199, 1e-13);
  CLOSE(s.centre.z, 301.5, 1e-13);
  const double expected[3] = {13.0 / 12, 10.0 / 12, 5.0 / 12};
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      CLOSE(s.gyration.m[i][k], i == k ? expected[i] : 0, 1e-13);
}
END_TEST

/* the tetrahedron 0, e1, e2, e3: volume 1/6, centre 1/4, mean of x^2 1/10, of xy 1/20 */
START_TEST(test_tetrahedron) {
  const tdm_vec3 o = {0, 0, 0}, x = {1, 0, 0}, y = {0, 1, 0}, z = {0, 0, 1};
  tdm_vec3 corner[12] = {o, y, x, o, x, z, o, z, y, x, y, z};
  tdm_stl stl = {4, corner};
  tdm_error err = {0};
  mbd_shape s;
  ck_assert_int_eq(mbd_shape_of_mesh(&s, &stl, "tet", "p", &err), TDM_OK);
  CLOSE(s.volume, 1.0 / 6, 1e-16);
  CLOSE(s.centre.y, 0.25, 1e-16);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      CLOSE(s.gyration.m[i][k], i == k ? 0.2 - 2.0 / 16 : -(1.0 / 20 - 1.0 / 16), 1e-16);
}
END_TEST

START_TEST(test_bad_meshes) {
  tdm_vec3 corner[36];
  tdm_stl stl = {11, corner}; /* a triangle is missing */
  tdm_error err = {0};
  mbd_shape s;
  box_mesh(corner, tdm_v3(0, 0, 0), tdm_v3(1, 2, 3));
  ck_assert_int_eq(mbd_shape_of_mesh(&s, &stl, "part.stl", "p", &err), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "part.stl") && strstr(err.message, "3 of its 18 edges"), "%s", err.message);

  stl.count = 12; /* all turned round */
  for (int t = 0; t < 12; t++) {
    tdm_vec3 keep = corner[3 * t];
    corner[3 * t] = corner[3 * t + 1];
    corner[3 * t + 1] = keep;
  }
  err.status = TDM_OK;
  ck_assert_int_eq(mbd_shape_of_mesh(&s, &stl, "part.stl", "p", &err), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "volume -6"), "%s", err.message);

  tdm_vec3 keep = corner[0]; /* one is not */
  corner[0] = corner[1];
  corner[1] = keep;
  err.status = TDM_OK;
  ck_assert_int_eq(mbd_shape_of_mesh(&s, &stl, "part.stl", "p", &err), TDM_ERR_SCENE);
  ck_assert_msg(strstr(err.message, "at 3 of its 18 edges"), "%s", err.message);
}
END_TEST

/* A body from a file stands where the coordinates put it, turned by its orientation, or where "position" says. */
START_TEST(test_mesh_body) {
  tdm_vec3 corner[36];
  tdm_stl stl = {12, corner};
  tdm_error err = {0};
  char scene[1024];
  box_mesh(corner, tdm_v3(1000, 0, 0), tdm_v3(1000, 2000, 4000)); /* mm */
  ck_assert_int_eq(tdm_stl_write(&stl, TANDEM_TEST_DIR "/test_mbd_inertia.stl", &err), TDM_OK);
  for (int placed = 0; placed < 2; placed++) {
    snprintf(
        scene, sizeof scene,
        "{'bodies':[{'name':'b','shape':{'type':'mesh','file':'%s/test_mbd_inertia.stl','scale':0.001,'density':2},"
        "'orientation':{'euler313':[1.5707963267948966,0,0]}%s}]}",
        TANDEM_TEST_DIR, placed ? ",'position':[7,8,9]" : "");
    run r;
    run_open_good(&r, scene, "b");
    CLOSE(r.ready.body[0].mass, 16, 1e-12);
    CLOSE(r.ready.body[0].inertia.m[0][0], 16 * 20.0 / 12, 1e-11);
    CLOSE(r.ready.body[0].inertia.m[2][2], 16 * 5.0 / 12, 1e-11);
    CLOSE(r.state[0].pose.position.x, placed ? 7 : -1, 1e-12);
    CLOSE(r.state[0].pose.position.y, placed ? 8 : 1.5, 1e-12);
    CLOSE(r.state[0].pose.position.z, placed ? 9 : 2, 1e-12);
    run_close(&r);
  }
}
END_TEST

/* ---- markers ---- */

/* the same hinge by numbers and by markers, given in the body and in the world */
START_TEST(test_markers) {
#define HINGED(markers, rest)                                                                                      \
  "{'bodies':[{'name':'b','mass':2,'inertia':[1,2,2.5],'position':[1,0,0.5],'orientation':{'euler313':[0.5,0.7,0]" \
  "}" markers "}],'joints':[{'name':'j','type':'revolute','bodies':['ground','b']," rest "}]}"
  static const char *const scenes[] = {
      HINGED("", "'point':[0.4,0.1,0.2],'axis':[0,0.6,0.8]"),
      HINGED(",'markers':[{'name':'pin','frame':'world','point':[0.4,0.1,0.2],'orientation':"
             "[0.9486832980505138,-0.31622776601683794,0,0]}]",
             "'point':'b.pin','axis':'b.pin.z'"),
      HINGED(",'markers':[{'name':'other'},{'name':'pin','frame':'world','point':[0.4,0.1,0.2]}]",
             "'points':['b.pin',[0.4,0.1,0.2]],'axes':[[0,0.6,0.8],[0,0.6,0.8]]"),
  };
  run r[3];
  for (int i = 0; i < 3; i++) {
    run_open_good(&r[i], scenes[i], "b");
    run_to(&r[i], 0.5);
    CLOSE(r[i].state[0].pose.position.x, r[0].state[0].pose.position.x, 1e-9);
    CLOSE(r[i].state[0].pose.position.z, r[0].state[0].pose.position.z, 1e-9);
    CLOSE(r[i].state[0].pose.orientation.w, r[0].state[0].pose.orientation.w, 1e-9);
  }
  ck_assert_double_gt(fabs(r[0].state[0].pose.position.z - 0.5), 0.01);
  for (int i = 0; i < 3; i++)
    run_close(&r[i]);
  /* body axes, from the centre of mass */
  run_open_good(&r[0],
                "{'bodies':[{'name':'b','mass':2,'inertia':[1,2,2.5],'position':[1,0,0.5],'orientation':{'euler313':"
                "[1.5707963267948966,0,0]},'markers':[{'name':'tip','point':[0.5,0,0]}]}],'joints':[{'name':'j','type':"
                "'rod','bodies':['ground','b'],'points':[[1,0.5,4.5],'b.tip']}],'forces':[{'name':'f','type':"
                "'spring_damper','bodies':['ground','b'],'points':[[1,0.5,2.5],'b.tip'],'stiffness':0}]}",
                "b");
  CLOSE(r[0].ready.initial[run_channel(&r[0], "force.f.length")], 2, 1e-12);
  run_close(&r[0]);
}
END_TEST

TEST_MAIN("mbd inertia", test_primitives, test_box_mesh, test_tetrahedron, test_bad_meshes, test_mesh_body,
          test_markers)

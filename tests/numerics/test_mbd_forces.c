/* Forces against solutions in closed form and against the balance of energy. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#define TIGHT "'solver':{'relative_tolerance':1e-10}"

#define SLIDER(mass, velocity, force)                                                                              \
  "'bodies':[{'name':'b','mass':" mass ",'inertia':[1,1,1],'position':[0,0,0],'velocity':[0,0," velocity "]}],"    \
  "'joints':[{'name':'rail','type':'prismatic','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]}],'forces':" \
  "[" force "]," TIGHT "}"

/* A mass falls freely until its cable is taut, is caught and thrown back: no force before, energy kept, the same height
 */
START_TEST(test_cable) {
  run r;
  run_open_good(&r,
                "{" SLIDER("2", "0",
                           "{'name':'c','type':'cable','bodies':['ground','b'],'points':[[0,0,0.5],[0,0,0]],"
                           "'free_length':1.5,'stiffness':5000}"),
                "");
  double top = 0, most = 0, least = 0;
  for (int k = 1; k <= 300; k++) {
    run_to(&r, 0.005 * k);
    double z = run_value(&r, "body.b.z"), tension = run_value(&r, "force.c.value");
    if (r.t < 0.45) {
      CLOSE(z, -0.5 * 9.81 * r.t * r.t, 1e-9);
      CLOSE(tension, 0, 0);
    }
    CLOSE(energy(&r), 0, 2e-6);
    least = fmin(least, tension);
    most = fmax(most, tension);
    if (k > 150)
      top = fmax(top == 0 ? -1 : top, z);
  }
  CLOSE(least, 0, 0);
  CLOSE(top, 0, 1e-3);
  /* k s^2/2 = m g (1 + s), but for the length over which the stiffness sets in */
  double s = (2 * 9.81 + sqrt(4 * 9.81 * 9.81 + 2 * 5000 * 2 * 9.81)) / 5000;
  CLOSE(most, 5000 * s, 0.02 * 5000 * s);
  run_close(&r);
}
END_TEST

/* with a damper the cable never pushes either, and energy only falls */
START_TEST(test_damped_cable) {
  run r;
  run_open_good(&r,
                "{" SLIDER("2", "0",
                           "{'name':'c','type':'cable','bodies':['ground','b'],'points':[[0,0,0.5],[0,0,0]],"
                           "'free_length':1,'stiffness':5000,'damping':60,'smoothing':0.01}"),
                "");
  double last = first_energy(&r);
  for (int k = 1; k <= 600; k++) {
    run_to(&r, 0.005 * k);
    ck_assert_double_ge(run_value(&r, "force.c.value"), 0);
    ck_assert_double_le(energy(&r), last + 1e-6);
    last = energy(&r);
  }
  CLOSE(run_value(&r, "body.b.z"), -0.5 - 2 * 9.81 / 5000 - 0.005, 2e-4);
  run_close(&r);
}
END_TEST

/* A stop that throws a mass back and forth without loss for 20 bounces, and one that takes energy away; no pulling */
START_TEST(test_stop) {
  for (int damped = 0; damped < 2; damped++) {
    run r;
    run_open_good(&r,
                  damped ? "{'gravity':[0,0,0]," SLIDER("2", "1.5",
                                                        "{'name':'s','type':'stop','joint':'rail','lower':-0.1,"
                                                        "'upper':0.2,'stiffness':1e5,'exponent':1.5,'damping':0.3}")
                         : "{'gravity':[0,0,0]," SLIDER("2", "1.5",
                                                        "{'name':'s','type':'stop','joint':'rail','lower':-0.1,"
                                                        "'upper':0.2,'stiffness':1e5}"),
                  "");
    int bounces = 0;
    double last = first_energy(&r), way = 1;
    for (int k = 1; k <= 2000; k++) {
      run_to(&r, 0.002 * k);
      double z = run_value(&r, "joint.rail.translation"), f = run_value(&r, "force.s.value");
      ck_assert(z > 0.2 ? f >= 0 : z < -0.1 ? f <= 0 : f == 0);
      if (z > -0.1 && z < 0.2) { /* nothing is stored: what there is moves */
        double now = run_value(&r, "energy.kinetic"), v = run_value(&r, "joint.rail.speed");
        if (damped)
          ck_assert_double_le(now, last + 1e-7);
        else
          CLOSE(now, 2.25, 1e-5);
        last = now;
        bounces += v * way < 0;
        way = v;
      }
    }
    ck_assert_int_ge(bounces, damped ? 8 : 18);
    if (damped)
      ck_assert_double_lt(last, 1.5);
    run_close(&r);
  }
}
END_TEST

/* Dry friction takes speed away at a constant rate, then holds; in rotation too */
START_TEST(test_friction) {
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,0]," SLIDER("2", "3",
                                             "{'name':'f','type':'friction','joint':'rail','coefficient':0.3,'preload':"
                                             "20,'velocity_scale':1e-3}"),
                "");
  for (int k = 1; k <= 9; k++) {
    run_to(&r, 0.1 * k);
    CLOSE(run_value(&r, "joint.rail.speed"), 3 - 3 * r.t, 1e-7);
    CLOSE(run_value(&r, "force.f.value"), 6, 1e-9);
  }
  run_on(&r, 3, 0.1);
  CLOSE(run_value(&r, "joint.rail.translation"), 1.5, 1e-8);
  CLOSE(run_value(&r, "joint.rail.speed"), 0, 1e-12);
  run_close(&r);

  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'w','mass':1,'inertia':[1,1,0.5],'position':[0,0,0],"
                "'angular_velocity':[0,0,4]}],'joints':[{'name':'axle','type':'revolute','bodies':['ground','w'],"
                "'point':[0,0,0],'axis':[0,0,1]}],'forces':[{'name':'f','type':'friction','joint':'axle','coefficient':"
                "0.2,'preload':50,'radius':0.1,'velocity_scale':1e-3}]," TIGHT "}",
                "");
  run_on(&r, 0.9, 0.1);
  CLOSE(run_value(&r, "joint.axle.rate"), 4 - 2 * 0.9, 1e-7);
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "force.f.value")].unit, "N m");
  run_close(&r);
}
END_TEST

/* A body at rest on a bushing: deflection m g/k and M/k along each of its axes, which stand askew */
START_TEST(test_bushing_static) {
  run r;
  run_open_good(&r,
                "{'gravity':[3,-2,-9.81],'bodies':[{'name':'b','mass':2,'inertia':[1,1,1],'position':[0,0,0]}],"
                "'forces':[{'name':'k','type':'bushing','bodies':['ground','b'],'point':[0,0,0],'orientation':"
                "[0.9,0.1,0.3,-0.3],'stiffness':[4000,3000,5000,200,300,400],'damping':[200,200,200,30,30,30]},"
                "{'name':'m','type':'wrench','body':'b','moment':[0.02,0.01,-0.03]}]," TIGHT "}",
                "");
  run_on(&r, 6, 0.1);
  tdm_quat q = tdm_quat_unit((tdm_quat){0.9, 0.1, 0.3, -0.3});
  tdm_vec3 f = tdm_quat_rotate(tdm_quat_conj(q), tdm_v3(6, -4, -19.62));
  tdm_vec3 m = tdm_quat_rotate(tdm_quat_conj(q), tdm_v3(0.02, 0.01, -0.03));
  tdm_vec3 u = tdm_quat_rotate(q, tdm_v3(f.x / 4000, f.y / 3000, f.z / 5000));
  tdm_vec3 phi = tdm_quat_rotate(q, tdm_v3(m.x / 200, m.y / 300, m.z / 400));
  CLOSE(run_value(&r, "body.b.x"), u.x, 1e-8);
  CLOSE(run_value(&r, "body.b.y"), u.y, 1e-8);
  CLOSE(run_value(&r, "body.b.z"), u.z, 1e-8);
  CLOSE(2 * run_value(&r, "body.b.qx"), phi.x, 1e-8);
  CLOSE(2 * run_value(&r, "body.b.qy"), phi.y, 1e-8);
  CLOSE(2 * run_value(&r, "body.b.qz"), phi.z, 1e-8);
  CLOSE(run_value(&r, "force.k.deflection"), tdm_norm(u), 1e-8);
  CLOSE(run_value(&r, "force.k.ux"), f.x / 4000, 1e-8); /* by component, in its own axes */
  CLOSE(run_value(&r, "force.k.uy"), f.y / 3000, 1e-8);
  CLOSE(run_value(&r, "force.k.uz"), f.z / 5000, 1e-8);
  CLOSE(run_value(&r, "force.k.phix"), m.x / 200, 1e-8);
  CLOSE(run_value(&r, "force.k.phiy"), m.y / 300, 1e-8);
  CLOSE(run_value(&r, "force.k.phiz"), m.z / 400, 1e-8);
  run_close(&r);
}
END_TEST

/* Two bodies on a coupled bushing that swing through large rotations: energy and angular momentum stay */
START_TEST(test_bushing_energy) {
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':1,'inertia':[0.1,0.2,0.25],'position':[0,0,0],"
                "'angular_velocity':[2,0,-3]},{'name':'b','mass':2,'inertia':[0.3,0.2,0.25],'position':[0.5,0,0],"
                "'velocity':[0,0.4,0.3],'angular_velocity':[-2,4,1]}],'forces':[{'name':'k','type':'bushing','bodies':"
                "['a','b'],'point':[0.2,0.1,0],'stiffness':[[300,20,10,3,2,1],[20,200,40,1,2,3],[10,40,100,1,1,1],"
                "[3,1,1,9,2,1],[2,2,1,2,8,1],[1,3,1,1,1,7]],'preload':[1,2,-1,0.3,0.2,0.1]}]," TIGHT "}",
                "");
  const double start = first(&r, "energy.kinetic"); /* the potential is 0 at the start */
  double most = 0;
  for (int k = 1; k <= 60; k++) {
    run_to(&r, 0.05 * k);
    CLOSE(energy(&r), start, 2e-7 * start);
    most = fmax(most, run_value(&r, "energy.springs"));
  }
  ck_assert_double_gt(most, 0.3 * start);
  CLOSE(run_value(&r, "body.a.vx") + 2 * run_value(&r, "body.b.vx"), 0, 1e-8);
  CLOSE(run_value(&r, "body.a.vy") + 2 * run_value(&r, "body.b.vy"), 0.8, 1e-8);
  run_close(&r);
}
END_TEST

/* A bushing of 1e9 N/m beside a spring of 1 N/m: the slow swing is that of both masses on the spring, the stiff one is
 * damped and follows */
START_TEST(test_stiff_bushing) {
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':2,'inertia':[1,1,1],'position':[0,0,0]},{'name':'b',"
                "'mass':1,'inertia':[1,1,1],'position':[1,0,0]}],'forces':[{'name':'k','type':'bushing','bodies':"
                "['a','b'],'point':[1,0,0],'stiffness':[1e9,1e9,1e9,1e9,1e9,1e9],'damping':[1e5,1e5,1e5,1e5,1e5,1e5]},"
                "{'name':'s','type':'spring_damper','bodies':['ground','a'],'points':[[-3,0,0],[0,0,0]],'stiffness':1,"
                "'free_length':2.5}]}",
                "");
  for (int k = 1; k <= 40; k++) {
    run_to(&r, 0.25 * k);
    CLOSE(run_value(&r, "body.a.x"), 0.5 * cos(r.t / sqrt(3)) - 0.5, 1e-6);
    CLOSE(run_value(&r, "body.b.x") - run_value(&r, "body.a.x"), 1, 1e-8);
  }
  run_close(&r);
}
END_TEST

/* Spheres at rest: on a plane after (m g/k)^(2/3), and in a row between two stops; free fall before */
START_TEST(test_bump) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'b','mass':2,'inertia':[1,1,1],'position':[0,0,0.5]}],'forces':[{'name':'floor',"
                "'type':'bump','bodies':['ground','b'],'point':[0,0,0.5],'radius':0.1,'plane_point':[3,4,0],'normal':"
                "[0,0,2],'stiffness':1e5,'exponent':1.5,'damping':2}]," TIGHT "}",
                "");
  run_on(&r, 0.2, 0.05);
  CLOSE(run_value(&r, "body.b.z"), 0.5 - 0.5 * 9.81 * 0.04, 1e-9);
  CLOSE(run_value(&r, "force.floor.gap"), 0.4 - 0.5 * 9.81 * 0.04, 1e-9);
  run_on(&r, 20, 0.05);
  CLOSE(run_value(&r, "body.b.z"), 0.1 - pow(2 * 9.81 / 1e5, 2.0 / 3), 2e-5);
  run_close(&r);

  /* two equal spheres meet: they swap their velocities */
  run_open_good(
      &r,
      "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':2,'inertia':[1,1,1],'position':[0,0,0],'velocity':"
      "[1,0,0]},{'name':'b','mass':2,'inertia':[1,1,1],'position':[1,0,0]}],'forces':[{'name':'hit','type':"
      "'bump','bodies':['a','b'],'points':[[0,0,0],[1,0,0]],'radii':[0.1,0.2],'stiffness':1e4,'exponent':1.5}]"
      "," TIGHT "}",
      "");
  run_on(&r, 2, 0.05);
  CLOSE(run_value(&r, "body.a.vx"), 0, 1e-6);
  CLOSE(run_value(&r, "body.b.vx"), 1, 1e-6);
  CLOSE(run_value(&r, "force.hit.value"), 0, 0);
  run_close(&r);
}
END_TEST

/* A force that turns with a spinning body, and a moment that rises with time */
START_TEST(test_wrench) {
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':2,'inertia':[1,1,1],'position':[0,0,0],"
                "'angular_velocity':[0,0,3]},{'name':'b','mass':2,'inertia':[1,1,0.5],'position':[1,0,0]}],'forces':"
                "[{'name':'jet','type':'wrench','body':'a','force':[4,0,0],'axes':'body'},"
                "{'name':'m','type':'wrench','body':'b','moment':[0,0,2],'factor':{'type':'polynomial','coefficients':"
                "[0,3]}},{'name':'off','type':'wrench','body':'b','point':[1,0.2,0],'force':[5,0,0]}]," TIGHT "}",
                "");
  run_to(&r, 0.001);
  CLOSE(run_value(&r, "body.b.wz"), (3e-6 - 0.2 * 5e-3) / 0.5, 1e-9);
  run_on(&r, 1.3, 0.05);
  CLOSE(run_value(&r, "body.a.vx"), 4.0 / 6 * sin(3 * r.t), 1e-8);
  CLOSE(run_value(&r, "body.a.vy"), 4.0 / 6 * (1 - cos(3 * r.t)), 1e-8);
  CLOSE(run_value(&r, "force.m.factor"), 3 * r.t, 1e-12);
  CLOSE(run_value(&r, "body.b.vx"), 2.5 * r.t, 1e-8);
  run_close(&r);
}
END_TEST

/* A spring by table swings through its points and beyond its ends without a change of energy; a straight one is linear,
 * a damper by table is too */
START_TEST(test_tables) {
  run r, s;
  run_open_good(
      &r,
      "{'gravity':[0,0,0]," SLIDER("2", "4",
                                   "{'name':'k','type':'spring_damper','bodies':['ground','b'],'points':"
                                   "[[0,0,-1],[0,0,0]],'stiffness_table':[[-0.3,-0.1,0,0.1,0.4],[-90,-20,0,10,"
                                   "80]],'preload':3}"),
      "");
  double most = 0, least = 0;
  for (int k = 1; k <= 300; k++) {
    run_to(&r, 0.01 * k);
    CLOSE(energy(&r), 16, 5e-6);
    most = fmax(most, run_value(&r, "body.b.z"));
    least = fmin(least, run_value(&r, "body.b.z"));
  }
  ck_assert(most > 0.41 && least < -0.31); /* beyond both ends */
  run_close(&r);

  /* between its points a table stays within them, unless the scene asks for a spline */
  for (int spline = 0; spline < 2; spline++) {
    run_open_good(
        &r,
        spline ? "{'gravity':[0,0,0]," SLIDER("2", "2",
                                              "{'name':'k','type':'spring_damper','bodies':['ground','b'],'points':"
                                              "[[0,0,-1],[0,0,0]],'interpolation':'cspline','stiffness_table':"
                                              "[[0,0.1,0.2,0.3,0.4,0.5],[0,0,0,10,10,10]]}")
               : "{'gravity':[0,0,0]," SLIDER("2", "2",
                                              "{'name':'k','type':'spring_damper','bodies':['ground','b'],'points':"
                                              "[[0,0,-1],[0,0,0]],'stiffness_table':"
                                              "[[0,0.1,0.2,0.3,0.4,0.5],[0,0,0,10,10,10]]}"),
        "");
    double low = 0, high = 0;
    for (int k = 1; k <= 25; k++) {
      run_to(&r, 0.01 * k);
      low = fmin(low, run_value(&r, "force.k.value"));
      high = fmax(high, run_value(&r, "force.k.value"));
    }
    if (spline)
      ck_assert(low < -1 && high > 11);
    else
      ck_assert(low >= -1e-12 && high <= 10 + 1e-12 && high > 9);
    run_close(&r);
  }

#define DAMPED(law)    \
  "{" SLIDER("2", "1", \
             "{'name':'k','type':'spring_damper','bodies':['ground','b'],'points':[[0,0,-1],[0,0,0]]," law "}")
  run_open_good(&r, DAMPED("'stiffness_table':[[-1,0,1,2],[-100,0,100,200]],'damping_table':[[-1,0,2],[-5,0,10]]"), "");
  run_open_good(&s, DAMPED("'stiffness':100,'damping':5"), "");
  run_on(&r, 1.5, 0.05);
  run_on(&s, 1.5, 0.05);
  CLOSE(run_value(&r, "body.b.z"), run_value(&s, "body.b.z"), 1e-8);
  CLOSE(energy(&r), energy(&s), 1e-7);
  run_close(&r);
  run_close(&s);
}
END_TEST

/* A torsional spring on a ball joint: bodies that tilt against each other keep their energy */
START_TEST(test_tilting_coil) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'a','mass':1,'inertia':[0.2,0.3,0.4],'position':[0.3,0,0],'angular_velocity':"
                "[1,2,3],'velocity':[0,0.9,-0.6]}],'joints':[{'name':'ball','type':'spherical','bodies':['ground','a'],"
                "'point':[0,0,0]}],'forces':[{'name':'coil','type':'torsional_spring_damper','bodies':['ground','a'],"
                "'axis':[0,0,1],'stiffness':6,'preload':1}]," TIGHT "}",
                "");
  const double start = first_energy(&r);
  for (int k = 1; k <= 40; k++) {
    run_to(&r, 0.05 * k);
    CLOSE(energy(&r), start, 1e-6);
  }
  run_close(&r);
}
END_TEST

/* a bushing that is wound up: its rotation, and an error before it jumps */
START_TEST(test_bushing_turns) {
  static const char *const formulation[] = {"'ggl'", "'index3'", "'one_step'"};
  for (int k = 0; k < 3; k++) {
    char scene[1024];
    snprintf(scene, sizeof scene,
             "{'gravity':[0,0,0],'formulation':%s,'bodies':[{'name':'b','mass':1,'inertia':[1,1,1],'position':[0,0,0],"
             "'angular_velocity':[0,0,10]}],'forces':[{'name':'k','type':'bushing','bodies':['ground','b'],'point':"
             "[0,0,0],'stiffness':[1,1,1,1,1,1]}],'solver':{'max_step':0.001}}",
             formulation[k]);
    run r;
    run_open_good(&r, scene, "");
    run_to(&r, 0.2);
    CLOSE(run_value(&r, "force.k.rotation"), 10 * sin(0.2), 1e-5);
    ck_assert_int_eq(run_step(&r, 1, NULL, 0, 0, NULL), TDM_ERR_NUMERIC);
    ck_assert_str_eq(r.err.path, "mbd.forces[0]");
    ck_assert_ptr_nonnull(strstr(r.err.message, "\"k\" has turned by 3 rad at t = 0.30"));
    run_close(&r);
  }
}
END_TEST

/* A spring without length at the start: it swings through its own point as a spring does and loses what its damper
 * takes; one that would push or pull in no direction is refused. */
START_TEST(test_no_length) {
  static const char *const formulation[] = {"ggl", "index3", "one_step"};
  static const char *const bad[][2] = {{"'free_length':0.5", "\"free_length\": 0"}, {"'preload':4", "preload"}};
  const double m = 2, k = 50, damping[] = {0, 3}, v = 1.5,
               most[] = {1e-8, 1e-5, 1e-5}; /* index3 does not test velocities */
  char scene[1024];
  run r;
  for (int i = 0; i < 6; i++) {
    const double c = damping[i % 2] / (2 * m), w = sqrt(k / m - c * c), tolerance = most[i / 2];
    snprintf(
        scene, sizeof scene,
        "{'gravity':[0,0,0],'formulation':'%s','bodies':[{'name':'b','mass':2,'inertia':[1,1,1],'position':[1,2,3],"
        "'velocity':[0.9,0,1.2]}],'forces':[{'name':'s','type':'spring_damper','bodies':['ground','b'],'points':"
        "[[1,2,3],[1,2,3]],'stiffness':%g,'damping':%g}]," TIGHT "}",
        formulation[i / 2], k, damping[i % 2]);
    run_open_good(&r, scene, "");
    CLOSE(first(&r, "force.s.length"), 0, 0);
    CLOSE(first(&r, "force.s.fx"), -damping[i % 2] * 0.9, 1e-12);
    CLOSE(first(&r, "force.s.fz"), -damping[i % 2] * 1.2, 1e-12);
    while (r.t < 0.9995) { /* 0.8 of a period, once through the point */
      run_to(&r, r.t + 1e-3);
      double x = v / w * exp(-c * r.t) * sin(w * r.t);
      CLOSE(run_value(&r, "body.b.x"), 1 + 0.6 * x, tolerance);
      CLOSE(run_value(&r, "body.b.z"), 3 + 0.8 * x, tolerance);
      CLOSE(run_value(&r, "body.b.y"), 2, 1e-12);
    }
    CLOSE(run_value(&r, "energy.balance"), 0, 10 * tolerance);
    run_close(&r);
  }
  for (int i = 0; i < 2; i++) {
    snprintf(scene, sizeof scene,
             "{'bodies':[{'name':'b','mass':2,'inertia':[1,1,1],'position':[0,0,0]}],'forces':[{'name':'s','type':"
             "'spring_damper','bodies':['ground','b'],'points':[[0,0,0],[0,0,0]],'stiffness':1,%s}]}",
             bad[i][0]);
    run_open(&r, scene, "");
    ck_assert_int_eq(r.status, TDM_ERR_SCENE);
    ck_assert_str_eq(r.err.path, "mbd.forces[0].points");
    ck_assert_msg(strstr(r.err.message, bad[i][1]) != NULL, "%s", r.err.message);
    run_close(&r);
  }
}
END_TEST

/* The forces and moments that outputs have, each at its point, are those that move the body. */
START_TEST(test_vectors) {
  static const struct {
    const char *name;
    tdm_vec3 point;
  } force[] = {{"s", {0.1, 0.2, 0.3}}, {"u", {0.2, -0.1, 0.4}}, {"w", {0.3, 0, 0}}, {"c", {0, 0, 0}}};
  run r;
  run_open_good(
      &r,
      "{'bodies':[{'name':'b','mass':2,'inertia':[1,2,2.5],'position':[0,0,0],'velocity':[1,2,3]}],'forces':[{'name':"
      "'s','type':'spring_damper','bodies':['ground','b'],'points':[[1,2,-1],[0.1,0.2,0.3]],'stiffness':40,'damping':"
      "3,'free_length':1},{'name':'u','type':'bushing','bodies':['ground','b'],'point':[0.2,-0.1,0.4],'stiffness':"
      "[30,20,10,7,5,8],'damping':[3,2,1,0.7,0.5,0.8],'preload':[1,2,3,4,5,6]},{'name':'w','type':'wrench','body':'b',"
      "'point':[0.3,0,0],'force':[1,2,3],'moment':[4,5,6]},{'name':'c','type':'torsional_spring_damper','bodies':["
      "'ground','b'],'axis':[0,0.6,0.8],'stiffness':1,'preload':10}]}",
      "");
  tdm_vec3 sum = {0, 0, -2 * 9.81}, moment = {0, 0, 0};
  for (size_t i = 0; i < sizeof force / sizeof force[0]; i++) {
    double wrench[6];
    for (int k = 0; k < 6; k++) {
      char name[32];
      snprintf(name, sizeof name, "force.%s.%c%c", force[i].name, "fm"[k / 3], "xyz"[k % 3]);
      wrench[k] = first(&r, name);
    }
    sum = tdm_add(sum, mbd_get3(wrench));
    moment = tdm_add(moment, tdm_add(mbd_get3(wrench + 3), tdm_cross(force[i].point, mbd_get3(wrench))));
  }
  CLOSE(first(&r, "force.w.my"), 5, 1e-12);
  CLOSE(first(&r, "force.u.mx"), -4, 1e-12);
  CLOSE(first(&r, "force.c.my"), -6, 1e-12);
  CLOSE(2 * first(&r, "body.b.ax"), sum.x, 1e-11);
  CLOSE(2 * first(&r, "body.b.ay"), sum.y, 1e-11);
  CLOSE(2 * first(&r, "body.b.az"), sum.z, 1e-11);
  CLOSE(first(&r, "body.b.alphax"), moment.x, 1e-11);
  CLOSE(2 * first(&r, "body.b.alphay"), moment.y, 1e-11);
  CLOSE(2.5 * first(&r, "body.b.alphaz"), moment.z, 1e-11);
  run_close(&r);
}
END_TEST

/* so has friction, as it slides and as it sticks */
START_TEST(test_friction_vector) {
  for (int sticks = 0; sticks < 2; sticks++) {
    run r;
    run_open_good(
        &r,
        sticks ? "{'gravity':[0,0,0]," SLIDER("2", "0",
                                              "{'name':'f','type':'friction','joint':'rail','limit':6},"
                                              "{'name':'w','type':'wrench','body':'b','force':[0,0,5]}")
               : "{'gravity':[0,0,0]," SLIDER("2", "3", "{'name':'f','type':'friction','joint':'rail','limit':6}"),
        "");
    run_to(&r, 0.1);
    CLOSE(run_value(&r, "force.f.fz"), sticks ? -5 : -6, 1e-9);
    CLOSE(run_value(&r, "force.f.fx"), 0, 1e-12);
    CLOSE(run_value(&r, "force.f.my"), 0, 1e-12);
    run_close(&r);
  }
}
END_TEST

TEST_MAIN("mbd forces", test_cable, test_damped_cable, test_stop, test_friction, test_bushing_static,
          test_bushing_energy, test_stiff_bushing, test_bushing_turns, test_bump, test_wrench, test_tables,
          test_tilting_coil, test_no_length, test_vectors, test_friction_vector)

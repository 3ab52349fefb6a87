/* Joints against solutions in closed form: screw, gears over many turns, rack, rod, universal joint, planar joint,
 * points on lines, and poses prescribed by drivers.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#define TIGHT "'solver':{'relative_tolerance':1e-10}"

/* A nut falls along a screw: (m + I/p^2) a = -m g with p = pitch/2pi; 40 turns */
START_TEST(test_screw) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'nut','mass':2,'inertia':[1,1,5e-4],'position':[0.1,0,0]}],"
                "'joints':[{'name':'s','type':'screw','bodies':['ground','nut'],'point':[0.1,0,0],'axis':[0,0,1],"
                "'pitch':0.05}]," TIGHT "}",
                "");
  const double p = 0.05 / (2 * M_PI), a = 9.81 * 2 / (2 + 5e-4 / (p * p)), start = first_energy(&r);
  run_on(&r, 1.2, 0.05);
  double z = -0.5 * a * 1.2 * 1.2;
  ck_assert_double_gt(-z / 0.05, 20);
  CLOSE(run_value(&r, "body.nut.z"), z, 1e-7);
  CLOSE(run_value(&r, "joint.s.translation"), z, 1e-7);
  CLOSE(run_value(&r, "joint.s.angle"), z / p, 1e-7 / p);
  CLOSE(run_value(&r, "joint.s.rate"), run_value(&r, "joint.s.speed") / p, 1e-8);
  CLOSE(run_value(&r, "joint.s.translation") - p * run_value(&r, "joint.s.angle"), 0, 1e-11);
  CLOSE(energy(&r), start, 1e-7 * run_value(&r, "energy.kinetic"));
  run_close(&r);
}
END_TEST

/* A moment on the first of two wheels: (I1 + I2/ratio^2) w1' = M, for an external and an internal mesh; 80 turns */
START_TEST(test_gear) {
  const double ratio = _i ? -2.5 : 2.5;
  char scene[2048];
  snprintf(scene, sizeof scene,
           "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':1,'inertia':[1,1,0.2],'position':[0,0,0]},"
           "{'name':'b','mass':1,'inertia':[2,2,3],'position':[1,0,0]}],"
           "'joints':[{'name':'ja','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},"
           "{'name':'jb','type':'revolute','bodies':['ground','b'],'point':[1,0,0],'axis':[0,0,1]},"
           "{'name':'mesh','type':'gear','joints':['ja','jb'],'ratio':%g}],"
           "'forces':[{'name':'m','type':'wrench','body':'a','moment':[0,0,4]}]," TIGHT "}",
           ratio);
  run r;
  run_open_good(&r, scene, "");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 1);
  const double rise = 4 / (0.2 + 3 / (ratio * ratio)), end = 14, angle = 0.5 * rise * end * end;
  run_on(&r, end, 0.07);
  ck_assert_double_gt(angle, 80 * 2 * M_PI);
  CLOSE(run_value(&r, "joint.ja.angle"), angle, 1e-7 * angle);
  CLOSE(run_value(&r, "joint.jb.angle"), -angle / ratio, 1e-7 * angle);
  CLOSE(run_value(&r, "joint.ja.angle") + ratio * run_value(&r, "joint.jb.angle"), 0, 1e-9);
  /* the second wheel gets its moment through the mesh */
  CLOSE(run_value(&r, "joint.mesh.mz"), -3 * rise / ratio, 1e-8);
  run_close(&r);
}
END_TEST

/* A rotor at 1e4 rpm geared to a wheel, also with so loose a tolerance that IDA takes its longest steps: no turn is
 * lost in long windows */
START_TEST(test_fast_gear) {
  static const char *const tolerance[] = {"1e-8", "0.05"};
  char scene[2048];
  snprintf(scene, sizeof scene,
           "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':1,'inertia':[0.3,0.3,0.2],'position':[0,0,0]},"
           "{'name':'b','mass':1,'inertia':[2,2,3],'position':[1,0,0]}],"
           "'joints':[{'name':'ja','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},"
           "{'name':'jb','type':'revolute','bodies':['ground','b'],'point':[1,0,0],'axis':[0,0,1]},"
           "{'name':'mesh','type':'gear','joints':['ja','jb'],'ratio':0.37}],"
           "'drivers':[{'name':'m','type':'rotational_motor','joint':'ja','motion':{'type':'constant_rate','rate':"
           "1047.1975511965977,'start':'step'}}],'solver':{'relative_tolerance':%s}}",
           tolerance[_i]);
  run r;
  run_open_good(&r, scene, "");
  run_on(&r, 0.3, 0.1);
  const double angle = 1047.1975511965977 * 0.3, tol = _i ? 2 : 1e-6;
  CLOSE(run_value(&r, "joint.ja.angle"), angle, tol);
  CLOSE(run_value(&r, "joint.ja.angle") + 0.37 * run_value(&r, "joint.jb.angle"), 0, tol);
  CLOSE(run_value(&r, "joint.jb.rate"), -1047.1975511965977 / 0.37, 1e-3 * (_i ? 1e3 : 1));
  run_close(&r);
}
END_TEST

/* A planet that rolls about a fixed sun, driven by its carrier: it turns by (1 + sun/planet) of the carrier's angle */
START_TEST(test_planet) {
  run r;
  run_open_good(
      &r,
      "{'gravity':[0,0,0],'bodies':[{'name':'carrier','mass':1,'inertia':[1,1,1],'position':[0,0,0]},"
      "{'name':'planet','mass':1,'inertia':[1,1,1],'position':[1,0,0]}],"
      "'joints':[{'name':'sun','type':'revolute','bodies':['carrier','ground'],'point':[0,0,0],'axis':[0,0,1]},"
      "{'name':'pin','type':'revolute','bodies':['carrier','planet'],'point':[1,0,0],'axis':[0,0,1]},"
      "{'name':'mesh','type':'gear','joints':['sun','pin'],'ratio':0.4}],"
      "'drivers':[{'name':'m','type':'rotational_motor','joint':'sun','motion':{'type':'harmonic','amplitude':-30,"
      "'frequency':0.1}}]," TIGHT "}",
      "");
  run_on(&r, 7.3, 0.05);
  double w = 30 * 0.2 * M_PI * cos(0.2 * M_PI * 7.3); /* of the carrier: the driver turns the ground against it */
  CLOSE(run_value(&r, "body.carrier.wz"), w, 1e-8);
  CLOSE(run_value(&r, "body.planet.wz"), w * (1 + 1 / 0.4), 1e-7);
  double angle = 30 * sin(0.2 * M_PI * 7.3), alpha = -0.04 * M_PI * M_PI * angle;
  CLOSE(run_value(&r, "body.planet.alphaz"), alpha * (1 + 1 / 0.4), 1e-6);
  CLOSE(run_value(&r, "body.planet.ax"), -w * w * cos(angle) - alpha * sin(angle), 1e-6);
  CLOSE(run_value(&r, "body.planet.ay"), -w * w * sin(angle) + alpha * cos(angle), 1e-6);
  CLOSE(run_value(&r, "body.planet.az"), 0, 1e-9);
  run_close(&r);
}
END_TEST

/* A rack falls and turns its pinion: (m + I/R^2) a = -m g */
START_TEST(test_rack) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'pinion','mass':1,'inertia':[0.02,0.03,0.02],'position':[0,0,0]},"
                "{'name':'rack','mass':4,'inertia':[1,1,1],'position':[0,0.1,0]}],"
                "'joints':[{'name':'p','type':'revolute','bodies':['ground','pinion'],'point':[0,0,0],'axis':[0,1,0]},"
                "{'name':'r','type':'prismatic','bodies':['ground','rack'],'point':[0,0,0],'axis':[0,0,1]},"
                "{'name':'mesh','type':'rack_and_pinion','joints':['p','r'],'radius':-0.05}]," TIGHT "}",
                "");
  const double a = 9.81 * 4 / (4 + 0.03 / 0.0025), z = -0.5 * a * 4;
  run_on(&r, 2, 0.05);
  CLOSE(run_value(&r, "joint.r.translation"), z, 1e-7);
  CLOSE(run_value(&r, "joint.p.angle"), z / -0.05, 2e-6);
  CLOSE(run_value(&r, "joint.r.translation") + 0.05 * run_value(&r, "joint.p.angle"), 0, 1e-11);
  run_close(&r);
}
END_TEST

/* A moment on the first of two wheels and a weight, their angles and its place z coupled by s_k: with a multiplier m,
 * I_k q_k'' = F_k + s_k m and sum s_k q_k'' = 0. And two weights on a pulley block: z_a + 2 z_b = 0. */
START_TEST(test_coupler) {
  const double s[] = {2, -3, 5}, size[] = {0.2, 3, 4}, load[] = {4, 0, -4 * 9.81}, end = 3;
  double up = 0, down = 0, q[3];
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'a','mass':1,'inertia':[1,1,0.2],'position':[0,0,0]},"
                "{'name':'b','mass':1,'inertia':[2,2,3],'position':[1,0,0]},"
                "{'name':'c','mass':4,'inertia':[1,1,1],'position':[2,0,0]}],"
                "'joints':[{'name':'ja','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},"
                "{'name':'jb','type':'revolute','bodies':['ground','b'],'point':[1,0,0],'axis':[0,0,1]},"
                "{'name':'jc','type':'prismatic','bodies':['ground','c'],'point':[2,0,0],'axis':[0,0,1]},"
                "{'name':'mesh','type':'coupler','joints':['ja','jb','jc'],'scales':[2,-3,5]}],"
                "'forces':[{'name':'m','type':'wrench','body':'a','moment':[0,0,4]}]," TIGHT "}",
                "");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 2);
  for (int k = 0; k < 3; k++) {
    up -= s[k] * load[k] / size[k];
    down += s[k] * s[k] / size[k];
  }
  for (int k = 0; k < 3; k++)
    q[k] = 0.5 * end * end * (load[k] + s[k] * up / down) / size[k];
  run_on(&r, end, 0.05);
  CLOSE(run_value(&r, "joint.ja.angle"), q[0], 1e-7 * fabs(q[0]));
  CLOSE(run_value(&r, "joint.jb.angle"), q[1], 1e-7 * fabs(q[1]));
  CLOSE(run_value(&r, "joint.jc.translation"), q[2], 1e-7 * fabs(q[2]));
  CLOSE(run_value(&r, "joint.mesh.mz"), s[1] * up / down, 1e-7 * fabs(up / down));
  run_close(&r);
  run_open_good(&r,
                "{'bodies':[{'name':'a','mass':1,'inertia':[1,1,1],'position':[0,0,0]},"
                "{'name':'b','mass':4,'inertia':[1,1,1],'position':[1,0,0]}],"
                "'joints':[{'name':'ja','type':'prismatic','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},"
                "{'name':'jb','type':'cylindrical','bodies':['ground','b'],'point':[1,0,0],'axis':[0,0,1]},"
                "{'name':'rope','type':'coupler','joints':['ja','jb'],'coordinates':['translation','translation'],"
                "'scales':[1,2]}]," TIGHT "}",
                "");
  run_on(&r, 1, 0.05);
  /* a_a = g (2 m_b - 4 m_a)/(m_b + 4 m_a), a_b = -a_a/2 */
  const double a = 9.81 * (2 * 4 - 4 * 1) / (4 + 4 * 1.0);
  CLOSE(run_value(&r, "joint.ja.translation"), 0.5 * a, 1e-8);
  CLOSE(run_value(&r, "joint.jb.translation"), -0.25 * a, 1e-8);
  run_close(&r);
}
END_TEST

/* A mass on a rod in a circle: w^2 = g/(L cos b), tension m g/cos b, height and distance stay */
START_TEST(test_conical_pendulum) {
  const double L = 0.8, b = 0.6, w = sqrt(9.81 / (L * cos(b))), turn = 2 * M_PI / w;
  char scene[1024];
  snprintf(scene, sizeof scene,
           "{'bodies':[{'name':'bob','mass':3,'inertia':[0.1,0.2,0.15],'position':[%.17g,0,%.17g],'velocity':"
           "[0,%.17g,0],'angular_velocity':[1,2,3]}],'joints':[{'name':'rod','type':'rod','bodies':['ground','bob'],"
           "'points':[[0,0,0],[%.17g,0,%.17g]]}]," TIGHT "}",
           L * sin(b), -L * cos(b), w * L * sin(b), L * sin(b), -L * cos(b));
  run r;
  run_open_good(&r, scene, "");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 5);
  for (int k = 1; k <= 20; k++) {
    run_to(&r, 0.25 * k * turn);
    double phase = 0.5 * M_PI * k;
    CLOSE(run_value(&r, "body.bob.x"), L * sin(b) * cos(phase), 1e-7);
    CLOSE(run_value(&r, "body.bob.y"), L * sin(b) * sin(phase), 1e-7);
    CLOSE(run_value(&r, "joint.rod.fz"), 3 * 9.81, 1e-5);
    CLOSE(hypot(run_value(&r, "joint.rod.fx"), run_value(&r, "joint.rod.fy")), 3 * 9.81 * tan(b), 1e-5);
  }
  run_close(&r);
}
END_TEST

/* A mass on a rod, and one that is fixed to an arm of its own on a ball: the same but for the small inertia */
START_TEST(test_rod_or_ball) {
  run r, s;
#define SWING(inertia, rest)                                                                         \
  "{'bodies':[{'name':'bob','mass':2,'inertia':" inertia ",'position':[1,0,0],'velocity':[0,1,0.5]," \
  "'angular_velocity':[0,-0.5,1]}],'joints':[{'name':'j','bodies':['ground','bob']," rest "}]," TIGHT "}"
  run_open_good(&r, SWING("[0.1,0.1,0.1]", "'type':'rod','points':[[0,0,0],[1,0,0]]"), "");
  run_open_good(&s, SWING("[1e-6,1e-6,1e-6]", "'type':'spherical','point':[0,0,0]"), "");
  run_on(&r, 2, 0.1);
  run_on(&s, 2, 0.1);
  CLOSE(run_value(&r, "body.bob.x"), run_value(&s, "body.bob.x"), 1e-5);
  CLOSE(run_value(&r, "body.bob.y"), run_value(&s, "body.bob.y"), 1e-5);
  CLOSE(run_value(&r, "body.bob.z"), run_value(&s, "body.bob.z"), 1e-5);
  run_close(&r);
  run_close(&s);
}
END_TEST

/* Two shafts at the angle b: w2/w1 = cos b/(1 - sin^2 b cos^2 th), th from where the first arm lies in their plane */
START_TEST(test_universal) {
  const double b = 0.5, w1 = 7;
  char scene[2048];
  snprintf(
      scene, sizeof scene,
      "{'gravity':[0,0,0],'bodies':[{'name':'in','mass':1,'inertia':[0.1,0.2,0.2],'position':[-0.3,0,0]},"
      "{'name':'out','mass':1,'inertia':[0.1,0.2,0.2],'position':[%.17g,%.17g,0],'orientation':[%.17g,0,0,%.17g]}],"
      "'joints':[{'name':'bearing','type':'revolute','bodies':['ground','in'],'point':[-0.5,0,0],'axis':[1,0,0]},"
      "{'name':'cross','type':'universal','bodies':['in','out'],'point':[0,0,0],'axes':[[0,0,1],[%.17g,%.17g,0]]},"
      "{'name':'end','type':'point_on_line','bodies':['ground','out'],'point':[%.17g,%.17g,0],'axis':"
      "[%.17g,%.17g,0]}],'drivers':[{'name':'m','type':'rotational_motor','joint':'bearing','motion':{'type':"
      "'constant_rate','rate':%g,'start':'step'}}]," TIGHT "}",
      0.3 * cos(b), 0.3 * sin(b), cos(b / 2), sin(b / 2), -sin(b), cos(b), 0.6 * cos(b), 0.6 * sin(b), cos(b), sin(b),
      w1);
  run r;
  run_open_good(&r, scene, "");
  double least = 10, most = 0;
  for (int k = 1; k <= 100; k++) {
    run_to(&r, 0.02 * k);
    double c = cos(w1 * r.t + 0.5 * M_PI),
           w2 = run_value(&r, "body.out.wx") * cos(b) + run_value(&r, "body.out.wy") * sin(b);
    CLOSE(w2 / w1, cos(b) / (1 - sin(b) * sin(b) * c * c), 1e-7);
    CLOSE(run_value(&r, "body.out.x"), 0.3 * cos(b), 1e-8);
    least = fmin(least, w2 / w1);
    most = fmax(most, w2 / w1);
  }
  CLOSE(least, cos(b), 2e-3);
  CLOSE(most, 1 / cos(b), 2e-3);
  run_close(&r);
}
END_TEST

/* A plate slides down an inclined plane and spins about its normal; a bead slides down a wire and tumbles freely */
START_TEST(test_slopes) {
  run r;
  run_open_good(
      &r,
      "{'bodies':[{'name':'plate','mass':1,'inertia':[1,1,2],'position':[0,0,0],"
      "'orientation':{'euler313':[0,0.5,0]},'velocity':[1,0,0],'angular_velocity':[0,-1.438276615812609,"
      "2.6327476856711183]},{'name':'bead','mass':2,'inertia':[0.1,0.1,0.1],'position':[5,0,0],"
      "'angular_velocity':[1,2,3]}],'joints':[{'name':'p','type':'planar','bodies':['ground','plate'],"
      "'point':[0,0,0],'axis':[0,-0.479425538604203,0.8775825618903728]},"
      "{'name':'wire','type':'point_on_line','bodies':['ground','bead'],'point':[5,0,0],'axis':[0,0.6,0.8]}]," TIGHT
      "}",
      "");
  run_on(&r, 2, 0.05);
  const double s = sin(0.5), c = cos(0.5), way = -0.5 * 9.81 * s * 4, fall = -0.5 * 9.81 * 0.8 * 4;
  CLOSE(run_value(&r, "body.plate.x"), 2, 1e-7);
  CLOSE(run_value(&r, "body.plate.y"), way * c, 1e-7);
  CLOSE(run_value(&r, "body.plate.z"), way * s, 1e-7);
  CLOSE(run_value(&r, "body.plate.wz"), 3 * c, 1e-8);
  CLOSE(run_value(&r, "joint.wire.translation"), fall, 1e-7);
  CLOSE(run_value(&r, "body.bead.y"), 0.6 * fall, 1e-7);
  CLOSE(run_value(&r, "body.bead.wy"), 2, 1e-8);
  run_close(&r);
}
END_TEST

/* An unbalanced body that spins about an axis held parallel to the ground's: it falls freely, goes on spinning, and the
 * joint gives the moment w x I w */
START_TEST(test_parallel_axes) {
  run r;
  const double w = 4, product = 0.2, g = 9.81;
  run_open_good(&r,
                "{'bodies':[{'name':'b','mass':3,'inertia':[1,2,2.5,0,0.2,0],'position':[0,1,0],"
                "'velocity':[2,0,0],'angular_velocity':[0,0,4]}],'joints':[{'name':'p','type':'parallel_axes',"
                "'bodies':['ground','b'],'point':[5,0,0],'axis':[0,0,1]}]," TIGHT "}",
                "");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 4);
  CLOSE(first(&r, "joint.p.my"), w * w * product, 1e-9);
  CLOSE(first(&r, "joint.p.mx"), 0, 1e-9);
  run_on(&r, 1, 0.05);
  CLOSE(run_value(&r, "body.b.x"), 2, 1e-8);
  CLOSE(run_value(&r, "body.b.z"), -0.5 * g, 1e-8);
  CLOSE(run_value(&r, "body.b.wz"), w, 1e-8);
  CLOSE(run_value(&r, "body.b.wx"), 0, 1e-8);
  CLOSE(run_value(&r, "joint.p.f"), 0, 1e-9);
  run_close(&r);
}
END_TEST

/* A body whose point above the centre of mass stays in an inclined plane and which starts in balance below it: it
 * slides down as on a plane, does not turn, and is held by its weight across the plane */
START_TEST(test_point_in_plane) {
  run r;
  const double s = sin(0.5), c = cos(0.5), m = 3, g = 9.81;
  run_open_good(
      &r,
      "{'bodies':[{'name':'b','mass':3,'inertia':[1,2,2.5],'position':[0,0.14382766158126089,-0.26327476856711"
      "187],'velocity':[2,0,0]}],'joints':[{'name':'p','type':'point_in_plane','bodies':['ground','b'],'points"
      "':[[5,0,0],[0,0,0]],'axis':[0,-0.479425538604203,0.8775825618903728]}]," TIGHT "}",
      "");
  CLOSE(first(&r, "joint.p.fy"), -m * g * c * s, 1e-9);
  CLOSE(first(&r, "joint.p.fz"), m * g * c * c, 1e-9);
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 5);
  run_on(&r, 1, 0.05);
  CLOSE(run_value(&r, "body.b.x"), 2, 1e-8);
  CLOSE(run_value(&r, "body.b.y"), 0.3 * s - 0.5 * g * s * c, 1e-7);
  CLOSE(run_value(&r, "body.b.z"), -0.3 * c - 0.5 * g * s * s, 1e-7);
  CLOSE(run_value(&r, "body.b.wx"), 0, 1e-8);
  CLOSE(run_value(&r, "joint.p.mx"), 0, 1e-9);
  run_close(&r);
}
END_TEST

/* A link of 2 m that turns about z at its foot and carries a weight at its ball: it swings as a pendulum of that length
 * in its plane, 0.7 m beside the foot along the axis, and pulls along itself alone in that plane */
START_TEST(test_link) {
  run r;
  const double g = 9.81, m = 2, length = 2;
  run_open_good(
      &r,
      "{'gravity':[0,-9.81,0],'bodies':[{'name':'b','mass':2,'inertia':[0.1,0.2,0.3],'position':[2,0,0.7],"
      "'angular_velocity':[0,0,1]}],'joints':[{'name':'l','type':'revolute_spherical','bodies':['ground','b'],"
      "'points':[[0,0,0],[2,0,0.7]],'axis':[0,0,1]}]," TIGHT "}",
      "");
  for (int i = 1; i <= 10; i++) {
    run_to(&r, 0.1 * i);
    double x = run_value(&r, "body.b.x"), y = run_value(&r, "body.b.y"), speed2 = -2 * g * y;
    CLOSE(hypot(x, y), length, 1e-9);
    CLOSE(run_value(&r, "body.b.z"), 0.7, 1e-9);
    CLOSE(pow(run_value(&r, "body.b.vx"), 2) + pow(run_value(&r, "body.b.vy"), 2), speed2, 1e-7);
    CLOSE(run_value(&r, "body.b.wz"), 1, 1e-8);           /* the ball turns nothing */
    double pull = m * (speed2 / length - g * y / length); /* towards the axis */
    CLOSE(run_value(&r, "joint.l.fx"), -pull * x / length, 1e-6);
    CLOSE(run_value(&r, "joint.l.fy"), -pull * y / length, 1e-6);
    CLOSE(run_value(&r, "joint.l.fz"), 0, 1e-9);
  }
  run_close(&r);
}
END_TEST

/* Both coordinates of a cylindrical joint driven: force m (x'' + g), torque I th'' */
START_TEST(test_two_drivers) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'b','mass':2,'inertia':[1,1,0.3],'position':[0,0,0]}],'joints':[{'name':'c','type':"
                "'cylindrical','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]}],'drivers':[{'name':'turn',"
                "'type':'rotational_motor','joint':'c','motion':{'type':'polynomial','coefficients':[0,0,1,2]}},"
                "{'name':'push','type':'linear_motor','joint':'c','motion':{'type':'step','to':0.5,'rise':1}}]," TIGHT
                "}",
                "");
  run_on(&r, 0.4, 0.02);
  double t = 0.4;
  CLOSE(run_value(&r, "driver.turn.torque"), 0.3 * (2 + 12 * t), 1e-9);
  CLOSE(run_value(&r, "driver.turn.rate"), 2 * t + 6 * t * t, 1e-9);
  CLOSE(run_value(&r, "driver.push.force"), 2 * (9.81 + 0.5 * 60 * t * (1 - t) * (1 - 2 * t)), 1e-8);
  CLOSE(run_value(&r, "driver.push.translation"), 0.5 * t * t * t * (10 - 15 * t + 6 * t * t), 1e-9);
  CLOSE(run_value(&r, "joint.c.translation"), run_value(&r, "driver.push.translation"), 1e-12);
  CLOSE(run_value(&r, "joint.c.angle"), t * t + 2 * t * t * t, 1e-9);
  run_close(&r);
}
END_TEST

/* Three point motions and three orientation motions prescribe a pose: position, force m x'', and the rotation whose
 * Rodrigues parameters are tan(angle/2) */
START_TEST(test_prescribed_pose) {
  run r;
#define MOVE(name, way, motion)                                                                       \
  "{'name':'" name "','type':'point_motion','bodies':['ground','b'],'point':[1,2,3],'direction':" way \
  ",'motion':{" motion "}}"
#define TURN(name, way, motion) \
  "{'name':'" name "','type':'orientation_motion','bodies':['ground','b'],'axis':" way ",'motion':{" motion "}}"
  run_open_good(
      &r,
      "{'gravity':[0,0,0],'bodies':[{'name':'b','mass':2,'inertia':[1,2,3],'position':[1,2,3]}],'drivers':"
      "[" MOVE("x", "[1,0,0]", "'type':'harmonic','amplitude':0.3,'frequency':0.5") "," MOVE("y", "[0,1,0]", "'type':'polynomial','coefficients':[0,0,0.2]") "," MOVE(
          "z", "[0,0,1]",
          "'type':'constant'") "," TURN("u", "[1,0,0]",
                                        "'type':'step','to':1,'rise':2") "," TURN("v", "[0,1,0]",
                                                                                  "'type':'harmonic','"
                                                                                  "amplitude':0.7,'frequency'"
                                                                                  ":0.3") "," TURN("w", "[0,0,1]",
                                                                                                   "'type':'"
                                                                                                   "table','"
                                                                                                   "times':["
                                                                                                   "0,0.5,1,"
                                                                                                   "2],'"
                                                                                                   "values':["
                                                                                                   "0,0.2,0."
                                                                                                   "3,-0.4]") "]," TIGHT
                                                                                                              "}",
      "");
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 0);
  run_on(&r, 0.8, 0.05);
  CLOSE(run_value(&r, "body.b.x"), 1 + 0.3 * sin(M_PI * 0.8), 1e-9);
  CLOSE(run_value(&r, "body.b.y"), 2 + 0.2 * 0.64, 1e-9);
  CLOSE(run_value(&r, "body.b.z"), 3, 1e-9);
  CLOSE(run_value(&r, "driver.x.force"), -2 * 0.3 * M_PI * M_PI * sin(M_PI * 0.8), 1e-7);
  CLOSE(run_value(&r, "driver.y.force"), 2 * 0.4, 1e-7);
  double w = run_value(&r, "body.b.qw");
  CLOSE(run_value(&r, "body.b.qx") / w, tan(0.5 * run_value(&r, "driver.u.angle")), 1e-9);
  CLOSE(run_value(&r, "body.b.qy") / w, tan(0.5 * 0.7 * sin(0.6 * M_PI * 0.8)), 1e-9);
  run_close(&r);
}
END_TEST

/* A law that is not zero at the start: the assembly puts the body there and says so, and the run goes on from there */
START_TEST(test_offset_law) {
  run r;
  run_open_good(&r,
                "{'gravity':[0,0,0],'bodies':[{'name':'b','mass':2,'inertia':[1,1,0.3],'position':[1,0,0]}],'joints':"
                "[{'name':'c','type':'cylindrical','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]}],'drivers':"
                "[{'name':'turn','type':'rotational_motor','joint':'c','motion':{'type':'harmonic','amplitude':2.5,"
                "'frequency':1,'phase':1.5707963267948966}},{'name':'push','type':'linear_motor','joint':'c','motion':"
                "{'type':'constant','value':-0.7}}]," TIGHT "}",
                "b");
  ck_assert_int_eq(r.ready.nwarning, 1);
  ck_assert_ptr_nonnull(strstr(r.ready.warning[0].message, "drivers"));
  CLOSE(r.state[0].pose.position.x, cos(2.5), 1e-10);
  CLOSE(r.state[0].pose.position.z, -0.7, 1e-10);
  run_on(&r, 0.3, 0.05);
  CLOSE(r.state[0].pose.position.y, sin(2.5 * cos(0.6 * M_PI)), 1e-8);
  CLOSE(run_value(&r, "joint.c.angle"), 2.5 * cos(0.6 * M_PI), 1e-8);
  run_close(&r);
}
END_TEST

/* A table that ends before the run does is refused when the run reaches its end */
START_TEST(test_table_ends) {
  run r;
  run_open_good(&r,
                "{'bodies':[{'name':'b','mass':2,'inertia':[1,1,0.3],'position':[0,0,0]}],'joints':[{'name':'c','type':"
                "'revolute','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]}],'drivers':[{'name':'turn',"
                "'type':'rotational_motor','joint':'c','motion':{'type':'table','times':[0,0.5,1],'values':[0,1,0]}}]}",
                "");
  run_on(&r, 1, 0.1);
  CLOSE(run_value(&r, "driver.turn.angle"), 0, 1e-8);
  ck_assert_int_eq(run_step(&r, 1.1, NULL, 0, 0, NULL), TDM_ERR_SCENE);
  ck_assert_ptr_nonnull(strstr(r.err.message, "\"turn\" ends at t = 1 s"));
  run_close(&r);
}
END_TEST

TEST_MAIN_ROWS("mbd_joints", {test_screw, 1}, {test_gear, 2}, {test_fast_gear, 2}, {test_planet, 1}, {test_rack, 1},
               {test_coupler, 1}, {test_conical_pendulum, 1}, {test_rod_or_ball, 1}, {test_universal, 1},
               {test_slopes, 1}, {test_point_in_plane, 1}, {test_parallel_axes, 1}, {test_link, 1},
               {test_two_drivers, 1}, {test_prescribed_pose, 1}, {test_offset_law, 1}, {test_table_ends, 1})

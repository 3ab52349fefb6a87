/* Wrong scenes: each is refused with the status, the path and a word that tells the user what to do. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#define BODY(name, rest) "{'name':'" name "','mass':1,'inertia':[1,1,1],'position':[0,0,0]" rest "}"
#define BOX "'bodies':[" BODY("box", "") "]"
#define JOINT(rest) "{" BOX ",'joints':[{'name':'j'," rest "}]}"
#define FORCE(rest) "{" BOX ",'forces':[{'name':'f'," rest "}]}"

#define HINGE(type) "{'name':'hinge','type':'" type "','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]}"
#define TWO_HINGES(rest)                                                                                               \
  "{'bodies':[" BODY("box", "") "," BODY("b", "") "],'joints':[" HINGE(                                                \
      "cylindrical") ",{'name':'h','type':"                                                                            \
                     "'revolute','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]},{'name':'c','type':'coupler'" \
                     ",'joints':"                                                                                      \
                     "['hinge','h']," rest "}]}"
#define STEP "'motion':{'type':'constant_rate','rate':1,'start':'step'}"
#define DRIVERS(rest) "{" BOX ",'joints':[" HINGE("revolute") "],'drivers':[" rest "]}"
#define DRIVER(rest) DRIVERS("{'name':'motor'," rest "}")
#define MOTOR(rest) DRIVER("'type':'rotational_motor','joint':'hinge','motion':{" rest "}")

#define MARKED(rest)                                                                                              \
  "{'bodies':[" BODY("box", ",'markers':[{'name':'tip'}]") "],'joints':[{'name':'j','type':'revolute','bodies':[" \
                                                           "'ground','box']," rest "}]}"
#define ON_HINGE(type, rest) "{" BOX ",'joints':[" HINGE(type) "],'forces':[{'name':'f','joint':'hinge'," rest "}]}"

typedef struct {
  const char *scene, *coupled;
  tdm_status status;
  const char *path, *word;
} bad_case;

static const bad_case cases[] = {
    {"{}", "", TDM_ERR_SCENE, "mbd.bodies", ""},
    {"{'bodies':[]}", "", TDM_ERR_SCENE, "mbd.bodies", "at least one"},
    {"{" BOX ",'gravitty':[0,0,0]}", "", TDM_ERR_SCENE, "mbd.gravitty", "gravity"},
    {"{" BOX ",'gravity':[0,0]}", "", TDM_ERR_SCENE, "mbd.gravity", ""},
    {"{'bodies':[{'name':'a','mass':-1,'inertia':[1,1,1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].mass", ""},
    {"{'bodies':[{'name':'a','mass':0,'inertia':[1,1,1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE, "mbd.bodies[0].mass",
     ""},
    {"{'bodies':[{'name':'a','mass':1,'inertia':[1,2,0],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].inertia", "larger than the sum"},
    {"{'bodies':[{'name':'a','mass':1,'inertia':[1,0,0],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].inertia", "one alone zero"},
    {"{'bodies':[{'name':'a','mass':1,'inertia':[1,1,1,2,0,0],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].inertia", "none may be negative"},
    {"{'bodies':[{'name':'a','mass':1,'inertia':[1,1,2.1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].inertia", "sum"},
    {"{'bodies':[{'name':'a','mass':1,'inertia':[1,1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].inertia", ""},
    {"{'bodies':[{'name':'a b','mass':1,'inertia':[1,1,1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].name", "letters"},
    {"{'bodies':[{'name':'a,b','mass':1,'inertia':[1,1,1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].name", "letters"},
    {"{'bodies':[" BODY("ground", "") "]}", "", TDM_ERR_SCENE, "mbd.bodies[0].name", "fixed world"},
    {"{'bodies':[" BODY("a", "") "," BODY("a", "") "]}", "", TDM_ERR_SCENE, "mbd.bodies[1].name", "own name"},
    {"{'bodies':[" BODY("a", ",'masss':2") "]}", "", TDM_ERR_SCENE, "mbd.bodies[0].masss", "mass"},
    {"{'bodies':[7]}", "", TDM_ERR_SCENE, "mbd.bodies[0]", ""},
    {JOINT("'type':'revolut','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].type", "revolute"},
    {JOINT("'type':'fixed','bodies':['ground','bxo'],'point':[0,0,0]"), "", TDM_ERR_SCENE, "mbd.joints[0].bodies[1]",
     "box"},
    {JOINT("'type':'fixed','bodies':['box','box'],'point':[0,0,0]"), "", TDM_ERR_SCENE, "mbd.joints[0].bodies",
     "itself"},
    {JOINT("'type':'fixed','bodies':['box'],'point':[0,0,0]"), "", TDM_ERR_SCENE, "mbd.joints[0].bodies", "two"},
    {JOINT("'type':'fixed','bodies':['box',3],'point':[0,0,0]"), "", TDM_ERR_SCENE, "mbd.joints[0].bodies[1]", "name"},
    {JOINT("'type':'fixed','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].axis", ""},
    {JOINT("'type':'revolute','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,0]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].axis", "zero"},
    {JOINT("'type':'revolute','bodies':['ground','box'],'axis':[0,0,1]"), "", TDM_ERR_SCENE, "mbd.joints[0].point", ""},
    {JOINT("'type':'revolute','bodies':['ground','box'],'axis':[0,0,1],'points':[[0,0,0]]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].points", "two"},
    {JOINT("'type':'revolute','bodies':['ground','box'],'axis':[0,0,1],'points':[[0,0,0],[0,1]]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].points[1]", ""},
    {"{" BOX ",'joints':[{'name':'j','type':'fixed','bodies':['ground','box'],'point':[0,0,0]},"
     "{'name':'j','type':'fixed','bodies':['ground','box'],'point':[0,0,0]}]}",
     "", TDM_ERR_SCENE, "mbd.joints[1].name", "own name"},
    {"{'bodies':[" BODY(
         "a",
         "") "],'joints':[{'name':'j1','type':'spherical','bodies':['ground','a'],'point':[0,0,1]},"
             "{'name':'j2','type':'prismatic','bodies':['ground','a'],'points':[[5,0,0],[0,0.5,0]],'axis':[0,1,0]}]}",
     "", TDM_ERR_SCENE, "mbd.joints[1]", "joint \"j2\""},
    {"{'bodies':[{'name':'a','mass':1,'inertia':[1,1,1],'position':[0.5,0,0.5]},"
     "{'name':'b','mass':1,'inertia':[1,1,1],'position':[1.5,0,0.5]}],"
     "'joints':[{'name':'j1','type':'spherical','bodies':['ground','a'],'point':[0,0,0]},"
     "{'name':'j2','type':'spherical','bodies':['a','b'],'point':[1,0,1]},"
     "{'name':'far','type':'spherical','bodies':['b','ground'],'points':[[2,0,0],[9,0,0]]}]}",
     "", TDM_ERR_SCENE, "mbd.joints", "cannot be assembled"},
    /* the start is 30 m from its joint, or 99 m from the end of a rod */
    {"{'bodies':[" BODY("a",
                        "") "],'joints':[{'name':'j','type':'spherical','bodies':['ground','a'],'points':[[30,0,0],"
                            "[0,0,0]]}]}",
     "", TDM_ERR_SCENE, "mbd.bodies[0].position", "move by 30 m"},
    {"{'bodies':[" BODY("a", "") "],'joints':[{'name':'j','type':'rod','bodies':['ground','a'],'points':[[1,0,0],"
                                 "[0,0,0]],'length':100}]}",
     "", TDM_ERR_SCENE, "mbd.bodies[0].position", "move by 99 m"},
    /* the start is more than a radian from where the joint wants the body */
    {"{'bodies':[" BODY("a", "") "],'joints':[{'name':'j','type':'prismatic','bodies':['ground','a'],'point':[0,0,0],"
                                 "'axes':[[0,0,1],[0,2,1]]}]}",
     "", TDM_ERR_SCENE, "mbd.bodies[0].position", "turn by 1.11 rad"},
    {FORCE("'type':'spring','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness':1"), "", TDM_ERR_SCENE,
     "mbd.forces[0].type", ""},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,1],[0,0,1]],'stiffness':1,'free_length':1"),
     "", TDM_ERR_SCENE, "mbd.forces[0].points", "coincide"},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness':-1"), "",
     TDM_ERR_SCENE, "mbd.forces[0].stiffness", ""},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]]"), "", TDM_ERR_SCENE,
     "mbd.forces[0].stiffness", ""},
    {FORCE("'type':'spring_damper','bodies':['grund','box'],'points':[[0,0,0],[0,0,1]],'stiffness':1"), "",
     TDM_ERR_SCENE, "mbd.forces[0].bodies[0]", "ground"},
    {FORCE("'type':'torsional_spring_damper','joint':'hinge','stiffness':1"), "", TDM_ERR_SCENE, "mbd.forces[0].joint",
     "no joint"},
    {FORCE("'type':'torsional_spring_damper','bodies':['ground','box'],'axis':[0,0,0],'stiffness':1"), "",
     TDM_ERR_SCENE, "mbd.forces[0].axis", "zero"},
    {"{" BOX ",'joints':[{'name':'rail','type':'prismatic','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]}],"
     "'forces':[{'name':'f','type':'torsional_spring_damper','joint':'rail','stiffness':1}]}",
     "", TDM_ERR_SCENE, "mbd.forces[0].joint", "revolute"},
    {DRIVER("'type':'rotational_moter','joint':'hinge'," STEP), "", TDM_ERR_SCENE, "mbd.drivers[0].type",
     "rotational_motor"},
    {DRIVER("'type':'rotational_motor','joint':'hynge'," STEP), "", TDM_ERR_SCENE, "mbd.drivers[0].joint",
     "did you mean \"hinge\""},
    {DRIVER("'type':'rotational_motor'," STEP), "", TDM_ERR_SCENE, "mbd.drivers[0].joint", ""},
    {DRIVER("'type':'rotational_motor','joint':'hinge'"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion", ""},
    {DRIVER("'type':'rotational_motor','joint':'hinge','speed':1," STEP), "", TDM_ERR_SCENE, "mbd.drivers[0].speed",
     ""},
    {DRIVERS("{'name':'m 1','type':'rotational_motor','joint':'hinge'," STEP "}"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].name", "letters"},
    {"{" BOX ",'joints':[" HINGE(
         "prismatic") "],'drivers':[{'name':'motor','type':'rotational_motor','joint':'hinge'," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[0].joint", "name a revolute, "},
    {"{" BOX ",'drivers':[{'name':'motor','type':'rotational_motor','joint':'hinge'," STEP "}]}", "", TDM_ERR_SCENE,
     "mbd.drivers[0].joint", "no joint"},
    {DRIVERS("{'name':'m1','type':'rotational_motor','joint':'hinge'," STEP
             "},{'name':'m2','type':'rotational_motor','joint':'hinge'," STEP "}"),
     "", TDM_ERR_SCENE, "mbd.drivers[1].joint", "driven by \"m1\" already"},
    {"{" BOX ",'joints':[" HINGE("revolute") ",{'name':'back','type':'revolute','bodies':['box','ground'],"
                                             "'point':[0,0,0],'axis':[0,0,1]}],'drivers':[{'name':'m','type':'"
                                             "rotational_motor','joint':'hinge'," STEP "},"
                                             "{'name':'m','type':'rotational_motor','joint':'back'," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[1].name", "own name"},
    {"{" BOX ",'joints':[{'name':'weld','type':'fixed','bodies':['ground','box'],'point':[0,0,0]}],'drivers':[{"
     "'name':'motor','type':'rotational_motor','joint':'weld'," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[0].joint", "is fixed"},
    {"{'bodies':[" BODY("box", "") "," BODY("b", "") "],'joints':[" HINGE(
         "revolute") ","
                     "{'name':'weld','type':'fixed','bodies':['box','b'],'point':[0,0,0]},"
                     "{'name':'ball','type':'spherical','bodies':['ground','b'],'point':[0,1,0]}],'drivers':[{"
                     "'name':'motor','type':'rotational_motor','joint':'hinge'," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[0]", "redundant"},
    /* a four-bar: one crank drives the other */
    {"{'bodies':[{'name':'c1','mass':1,'inertia':[1,1,1],'position':[0,0.5,0]},"
     "{'name':'rod','mass':1,'inertia':[1,1,1],'position':[1,1,0.1]},"
     "{'name':'c2','mass':1,'inertia':[1,1,1],'position':[2,0.5,0.2]}],"
     "'joints':[{'name':'h1','type':'revolute','bodies':['ground','c1'],'point':[0,0,0],'axis':[0,0,1]},"
     "{'name':'b1','type':'spherical','bodies':['c1','rod'],'point':[0,1,0]},"
     "{'name':'b2','type':'spherical','bodies':['rod','c2'],'point':[2,1,0.2]},"
     "{'name':'h2','type':'revolute','bodies':['ground','c2'],'point':[2,0,0.2],'axis':[0,0,1]}],"
     "'drivers':[{'name':'m1','type':'rotational_motor','joint':'h1'," STEP "},"
     "{'name':'m2','type':'rotational_motor','joint':'h2'," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[1]", "and the driver \"m1\" fix"},
    {MOTOR(""), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.type", ""},
    {MOTOR("'type':'constant_speed'"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.type", "constant_rate"},
    {MOTOR("'type':'constant_rate','start':'step'"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.rate", ""},
    {MOTOR("'type':'constant_rate','rate':1"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.start", ""},
    {MOTOR("'type':'constant_rate','rate':1,'start':'soft'"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.start",
     "smooth"},
    {MOTOR("'type':'constant_rate','rate':1,'start':'smooth'"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.rise", ""},
    {MOTOR("'type':'constant_rate','rate':1,'start':'smooth','rise':0"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.rise", "greater than 0"},
    {MOTOR("'type':'constant_rate','rate':1,'start':'smooth','rise':-1"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.rise", "greater than 0"},
    {MOTOR("'type':'constant_rate','rate':1,'start':'step','rise':1"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.rise",
     "smooth"},
    {MOTOR("'type':'constant_rate','rate':1,'start':'step','ramp':1"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.ramp",
     ""},
    {MOTOR("'type':'triangle','rate':1,'period':2"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.corner", ""},
    {MOTOR("'type':'triangle','rate':1,'period':2,'corner':0"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.corner",
     "greater than 0"},
    {MOTOR("'type':'triangle','rate':1,'period':2,'corner':1.1"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.corner",
     "half a period"},
    {MOTOR("'type':'triangle','period':2,'corner':1"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.rate", ""},
    {MOTOR("'type':'triangle','rate':1,'amplitude':1,'period':2,'corner':1"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.rate", "amplitude"},
    {MOTOR("'type':'sum'"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.laws", ""},
    {MOTOR("'type':'sum','laws':[]"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.laws", "empty"},
    {MOTOR("'type':'sum','laws':[{'type':'constant'},{'type':'polynomial'}]"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.laws[1].coefficients", ""},
    {MOTOR("'type':'sum','laws':[{'type':'constant','rate':1}]"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.laws[0].rate", ""},
    {MOTOR("'type':'polynomial','coefficients':[]"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.coefficients", "empty"},
    {MOTOR("'type':'polynomial','coefficients':[1,'a']"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.coefficients",
     "element 1"},
    {MOTOR("'type':'harmonic','amplitude':1,'frequency':1,'omega':1"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.omega",
     "keep one"},
    {MOTOR("'type':'step','to':1,'rise':0"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.rise", "greater than 0"},
    {MOTOR("'type':'table','times':[0,1,1],'values':[0,1,2]"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.times",
     "ascending"},
    {MOTOR("'type':'table','times':[0,1,2],'values':[0,1]"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.values",
     "one for each"},
    {MOTOR("'type':'table','times':[0],'values':[0]"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion.times", "at least 2"},
    {MOTOR("'type':'table','times':[0,1],'values':[0,0],'interpolation':'periodic'"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.times", "at least 3"},
    {MOTOR("'type':'table','file':'/nowhere/law.csv'"), "", TDM_ERR_FILE, "mbd.drivers[0].motion.file", "opened"},
    {MOTOR("'type':'table','times':[0,1,2],'values':[0,1,2],'interpolation':'periodic'"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.times", "end where it begins"},
    {MOTOR("'type':'table','times':[0,1,2],'values':[0,1,2],'after':'hold'"), "", TDM_ERR_SCENE,
     "mbd.drivers[0].motion.after", "at rest"},
    {MOTOR("'type':'table','times':[0,0.2,0.5],'values':[0,1,2]"), "", TDM_ERR_SCENE, "mbd.drivers[0].motion",
     "ends at t = 0.5 s"},
    {"{" BOX
     ",'joints':[" HINGE("cylindrical") "],'drivers':[{'name':'turn','type':'rotational_motor','joint':'hinge'," STEP
                                        "},{'name':'push','type':'linear_motor','joint':'hinge'," STEP
                                        "},{'name':'push_2','type':'linear_motor',"
                                        "'joint':'hinge'," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[2].joint", "driven by \"push\" already"},
    {"{" BOX ",'joints':[" HINGE("revolute") "],'drivers':[{'name':'push','type':'linear_motor','joint':'hinge'," STEP
                                             "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[0].joint", "is revolute"},
    {"{" BOX ",'drivers':[{'name':'m','type':'point_motion','bodies':['ground','box'],'point':[0,0,0],'direction':"
     "[0,0,0]," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[0].direction", "zero"},
    {"{" BOX ",'drivers':[{'name':'m','type':'point_motion','bodies':['ground','box'],'point':[0,0,0],'direction':"
     "[0,0,1]," STEP "},{'name':'n','type':'point_motion','bodies':['ground','box'],'point':[0,0,1],'direction':"
     "[0,0,1]," STEP "}]}",
     "", TDM_ERR_SCENE, "mbd.drivers[1]", "and the driver \"m\" fix"},
    {JOINT("'type':'universal','bodies':['ground','box'],'point':[0,0,0],'axes':[[0,0,1],[0,1,1]]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].axes", "45 degrees"},
    {JOINT("'type':'universal','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].axis", "one for each body"},
    {JOINT("'type':'rod','bodies':['ground','box'],'points':[[0,0,1],[0,0,1]]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].points", "coincide"},
    {JOINT("'type':'rod','bodies':['ground','box'],'points':[[0,0,1],[0,0,2]],'length':0"), "", TDM_ERR_SCENE,
     "mbd.joints[0].length", "greater than 0"},
    {JOINT("'type':'screw','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]"), "", TDM_ERR_SCENE,
     "mbd.joints[0].pitch", ""},
    {JOINT("'type':'screw','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1],'pitch':0"), "", TDM_ERR_SCENE,
     "mbd.joints[0].pitch", "is zero"},
    {"{" BOX ",'joints':[{'name':'g','type':'gear','joints':['hinge','other'],'ratio':1}," HINGE("revolute") "]}", "",
     TDM_ERR_SCENE, "mbd.joints[0].joints[0]", "stands later"},
    {"{" BOX ",'joints':[{'name':'g','type':'gear','joints':['g','g'],'ratio':1}]}", "", TDM_ERR_SCENE,
     "mbd.joints[0].joints[0]", "stands before this one"},
    {"{" BOX ",'formulation':'one_step','corrector':'modified'}", "", TDM_ERR_SCENE, "mbd.corrector", "one_step"},
    {JOINT("'type':'gear','joints':['a','b'],'ratio':1"), "", TDM_ERR_SCENE, "mbd.joints[0].joints[0]",
     "stands before this one"},
    {JOINT("'type':'gear','bodies':['ground','box'],'ratio':1"), "", TDM_ERR_SCENE, "mbd.joints[0].joints", ""},
    {"{" BOX ",'joints':[" HINGE("revolute") ",{'name':'g','type':'gear','joints':['hinge','hinge'],'ratio':1}]}", "",
     TDM_ERR_SCENE, "mbd.joints[1].joints", "itself"},
    {"{" BOX ",'joints':[" HINGE("revolute") ",{'name':'g','type':'gear','joints':['hinge','hynge'],'ratio':1}]}", "",
     TDM_ERR_SCENE, "mbd.joints[1].joints[1]", "did you mean \"hinge\""},
    {"{'bodies':[" BODY("box", "") "," BODY("b", "") "],'joints':[" HINGE(
         "revolute") ",{'name':'h','type':'revolute','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]},"
                     "{'name':'g','type':'rack_and_pinion','joints':['hinge','h'],'radius':1}]}",
     "", TDM_ERR_SCENE, "mbd.joints[2].joints[1]", "is revolute"},
    {"{'bodies':[" BODY("box", "") "," BODY("b", "") "],'joints':[" HINGE(
         "revolute") ",{'name':'h','type':'revolute','bodies':['ground','b'],'point':[0,0,0],'axis':[0,0,1]},"
                     "{'name':'g','type':'gear','joints':['hinge','h'],'ratio':0}]}",
     "", TDM_ERR_SCENE, "mbd.joints[2].ratio", "zero"},
    {"{" BOX ",'joints':[" HINGE("cylindrical") ",{'name':'c','type':'coupler','joints':['hinge'],'scales':[1]}]}", "",
     TDM_ERR_SCENE, "mbd.joints[1].joints", "two or three joints"},
    {TWO_HINGES("'scales':[1,2]"), "", TDM_ERR_SCENE, "mbd.joints[2].coordinates", "\"hinge\" is cylindrical"},
    {TWO_HINGES("'scales':[1,2],'coordinates':['angle','translation']"), "", TDM_ERR_SCENE, "mbd.joints[2].coordinates",
     "\"h\" is revolute"},
    {TWO_HINGES("'scales':[1,2],'coordinates':['angle']"), "", TDM_ERR_SCENE, "mbd.joints[2].coordinates",
     "there are 2 joints"},
    {TWO_HINGES("'scales':[1,0],'coordinates':['angle','angle']"), "", TDM_ERR_SCENE, "mbd.joints[2].scales",
     "\"h\" is zero"},
    {TWO_HINGES("'scales':[1],'coordinates':['angle','angle']"), "", TDM_ERR_SCENE, "mbd.joints[2].scales", ""},
    {"{'bodies':[{'name':'dot','mass':1,'inertia':[0,0,0],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].inertia", "body \"dot\" would be a point"},
    {"{'bodies':[{'name':'air','mass':0,'inertia':[1,1,1],'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].mass", "body \"air\""},
    {"{'bodies':[{'name':'a','shape':{'type':'bal','radius':1},'mass':1,'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].shape.type", ""},
    {"{'bodies':[{'name':'a','shape':{'type':'sphere','radius':1},'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].mass", "density"},
    {"{'bodies':[{'name':'a','mass':1,'shape':{'type':'sphere','radius':1,'density':5},'position':[0,0,0]}]}", "",
     TDM_ERR_SCENE, "mbd.bodies[0].mass", "keep one"},
    {"{'bodies':[" BODY("a", ",'shape':{'type':'sphere','radius':1}") "]}", "", TDM_ERR_SCENE, "mbd.bodies[0].inertia",
     "keep one"},
    {"{'bodies':[{'name':'a','mass':1,'shape':{'type':'sphere','radius':0},'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].shape.radius", "greater than 0"},
    {"{'bodies':[{'name':'a','mass':1,'shape':{'type':'box','size':[1,1,0]},'position':[0,0,0]}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].shape.size", "positive"},
    {"{'bodies':[{'name':'a','mass':1,'shape':{'type':'tube','radius':1,'inner_radius':1,'length':1},'position':"
     "[0,0,0]}]}",
     "", TDM_ERR_SCENE, "mbd.bodies[0].shape.inner_radius", "below"},
    {"{'bodies':[{'name':'a','shape':{'type':'sphere','radius':1e200,'density':1},'position':[0,0,0]}]}", "",
     TDM_ERR_SCENE, "mbd.bodies[0].shape", "no finite"},
    {"{'bodies':[{'name':'a','mass':1,'shape':{'type':'sphere','radius':1e-300},'position':[0,0,0]}]}", "",
     TDM_ERR_SCENE, "mbd.bodies[0].shape", "would be a point"},
    {"{'bodies':[{'name':'a','mass':1,'shape':{'type':'sphere','radius':1}}]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].position", ""},
    {"{'bodies':[{'name':'a','shape':{'type':'mesh','file':'/nowhere/part.stl','density':1}}]}", "", TDM_ERR_FILE,
     "mbd.bodies[0].shape.file", "opened"},
    {"{'bodies':[" BODY("a", ",'markers':[{'name':'tip'},{'name':'tip'}]") "]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].markers[1].name", "each its own name"},
    {"{'bodies':[" BODY("a", ",'markers':[{'name':'tip','frame':'world'}]") "]}", "", TDM_ERR_SCENE,
     "mbd.bodies[0].markers[0].point", ""},
    {MARKED("'point':'box.tipp'"), "", TDM_ERR_SCENE, "mbd.joints[0].point", "(did you mean \"tip\"?); name one"},
    {MARKED("'point':'bxo.tip'"), "", TDM_ERR_SCENE, "mbd.joints[0].point", "did you mean \"box\""},
    {"{'bodies':[{'name':'a_body_whose_name_is_very_very_long','mass':1,'inertia':[1,1,1],'position':[0,0,0],"
     "'markers':[{'name':'a_marker_of_length','output':true}]}]}",
     "", TDM_ERR_SCENE, "mbd.bodies[0].markers[0].output", "too long"},
    {MARKED("'point':'tip'"), "", TDM_ERR_SCENE, "mbd.joints[0].point", "\"body.marker\""},
    {MARKED("'point':'box.tip.z'"), "", TDM_ERR_SCENE, "mbd.joints[0].point", "names no point"},
    {MARKED("'point':'box.tip','axis':'box.tip'"), "", TDM_ERR_SCENE, "mbd.joints[0].axis", "body.marker.z"},
    {MARKED("'point':'box.tip','axis':'box.tip.w'"), "", TDM_ERR_SCENE, "mbd.joints[0].axis", "names no direction"},
    {MARKED("'points':['box.tip','box.top']"), "", TDM_ERR_SCENE, "mbd.joints[0].points[1]", "no marker \"top\""},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness_table':[[0,1],[1]]"),
     "", TDM_ERR_SCENE, "mbd.forces[0].stiffness_table", "same length"},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness_table':"
           "[[0,1,2],[0,1,2]],'stiffness':1"),
     "", TDM_ERR_SCENE, "mbd.forces[0].stiffness", ""},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness':1,'damping_table':"
           "[[-1,0,1],[1,0,1]]"),
     "", TDM_ERR_SCENE, "mbd.forces[0].damping_table", "sign of the rate"},
    {FORCE("'type':'spring_damper','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness':1,'damping_table':"
           "[[-1,1,2],[-1,1,1]]"),
     "", TDM_ERR_SCENE, "mbd.forces[0].damping_table", "(0, 0)"},
    {FORCE("'type':'bushing','bodies':['ground','box'],'point':[0,0,0],'stiffness':[1,1,1]"), "", TDM_ERR_SCENE,
     "mbd.forces[0].stiffness", ""},
    {FORCE("'type':'bushing','bodies':['ground','box'],'point':[0,0,0],'stiffness':[1,1,1,1,-1,1]"), "", TDM_ERR_SCENE,
     "mbd.forces[0].stiffness", "negative eigenvalue"},
    {FORCE("'type':'bushing','bodies':['ground','box'],'point':[0,0,0],'stiffness':[[1,1,0,0,0,0],[0,1,0,0,0,0],"
           "[0,0,1,0,0,0],[0,0,0,1,0,0],[0,0,0,0,1,0],[0,0,0,0,0,1]]"),
     "", TDM_ERR_SCENE, "mbd.forces[0].stiffness", "not symmetric"},
    {FORCE("'type':'bushing','bodies':['ground','box'],'point':[0,0,0],'stiffness':[[1,1],[1,1]]"), "", TDM_ERR_SCENE,
     "mbd.forces[0].stiffness", "6 rows"},
    {FORCE("'type':'cable','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'stiffness':1,'smoothing':0"), "",
     TDM_ERR_SCENE, "mbd.forces[0].smoothing", "greater than 0"},
    {FORCE("'type':'friction','joint':'j','limit':1,'velocity_scale':1"), "", TDM_ERR_SCENE, "mbd.forces[0].joint",
     "no joint"},
    {ON_HINGE("cylindrical", "'type':'friction','limit':1,'velocity_scale':1"), "", TDM_ERR_SCENE,
     "mbd.forces[0].coordinate", ""},
    {ON_HINGE("revolute", "'type':'friction','coordinate':'translation','limit':1,'velocity_scale':1"), "",
     TDM_ERR_SCENE, "mbd.forces[0].coordinate", "has no translation"},
    {ON_HINGE("revolute", "'type':'friction','limit':1,'coefficient':1,'velocity_scale':1"), "", TDM_ERR_SCENE,
     "mbd.forces[0].limit", "keep one"},
    {ON_HINGE("revolute", "'type':'friction','limit':{'static':1,'dynamic':2}"), "", TDM_ERR_SCENE,
     "mbd.forces[0].limit.static", "at least the dynamic one"},
    {ON_HINGE("revolute", "'type':'friction'"), "", TDM_ERR_SCENE, "mbd.forces[0].limit", "missing"},
    {ON_HINGE("revolute", "'type':'friction','coefficient':0.1"), "", TDM_ERR_SCENE, "mbd.forces[0].radius", "missing"},
    {ON_HINGE("revolute", "'type':'friction','coefficient':0.1,'radius':0.1,'reaction':false"), "", TDM_ERR_SCENE,
     "mbd.forces[0].preload", "missing"},
    {ON_HINGE("revolute", "'type':'friction','limit':0.1,'radius':0.1"), "", TDM_ERR_SCENE, "mbd.forces[0].radius", ""},
    {ON_HINGE("revolute", "'type':'stop','stiffness':1"), "", TDM_ERR_SCENE, "mbd.forces[0].upper", "both"},
    {ON_HINGE("revolute", "'type':'stop','stiffness':1,'lower':1,'upper':0"), "", TDM_ERR_SCENE, "mbd.forces[0].upper",
     "not above"},
    {ON_HINGE("revolute", "'type':'stop','stiffness':1,'upper':0,'exponent':0.5"), "", TDM_ERR_SCENE,
     "mbd.forces[0].exponent", "Hertz"},
    {FORCE("'type':'bump','bodies':['ground','box'],'points':[[0,0,0],[0,0,1]],'radii':[0,0],'stiffness':1"), "",
     TDM_ERR_SCENE, "mbd.forces[0].radii", "positive"},
    {FORCE("'type':'wrench','body':'box'"), "", TDM_ERR_SCENE, "mbd.forces[0].force", "zero"},
    {FORCE("'type':'wrench','body':'ground','force':[1,0,0]"), "", TDM_ERR_SCENE, "mbd.forces[0].body", "moves"},
    {FORCE("'type':'wrench','body':'bx','force':[1,0,0]"), "", TDM_ERR_SCENE, "mbd.forces[0].body", "box"},
    {FORCE(
         "'type':'wrench','body':'box','force':[1,0,0],'factor':{'type':'table','times':[0,0.1,0.2],'values':[0,1,2]}"),
     "", TDM_ERR_SCENE, "mbd.forces[0].factor", "ends at"},
    {"{" BOX ",'drivers':{}}", "", TDM_ERR_SCENE, "mbd.drivers", ""},
    {"{" BOX ",'solver':{'max_order':6}}", "", TDM_ERR_SCENE, "mbd.solver.max_order", "1 to 5"},
    {"{" BOX ",'solver':{'relative_tolerance':0}}", "", TDM_ERR_SCENE, "mbd.solver.relative_tolerance", ""},
    {"{" BOX ",'solver':{'rtol':1e-3}}", "", TDM_ERR_SCENE, "mbd.solver.rtol", ""},
    {"{" BOX "}", "bxo", TDM_ERR_SCENE, "coupling.bodies[0].mbd", "did you mean \"box\""},
    {"{" BOX "}", "ground", TDM_ERR_SCENE, "coupling.bodies[0].mbd", "ground"},
    {"{" BOX "}", "box box", TDM_ERR_SCENE, "coupling.bodies[1].mbd", "already"},
};

START_TEST(test_bad_scene) {
  const bad_case *c = &cases[_i];
  run r;
  run_open(&r, c->scene, c->coupled);
  ck_assert_msg(r.status == c->status && r.err.status == c->status, "%s: %s: %s", c->scene,
                tdm_status_name(r.err.status), r.err.message);
  ck_assert_msg(strncmp(r.err.path, c->path, strlen(c->path)) == 0, "path %s, expected %s (%s)", r.err.path, c->path,
                r.err.message);
  ck_assert_msg(strstr(r.err.message, c->word) != NULL, "no \"%s\" in: %s", c->word, r.err.message);
  run_close(&r);
}
END_TEST

/* a scene with every key is read without warnings, and the channels are there with their units */
START_TEST(test_good_scene) {
  run r;
  run_open_good(
      &r,
      "{'gravity':[0,0,-9.81],'bodies':[{'name':'box','mass':10,'inertia':[1,1,1,0.1,0.1,0.1],'position':[0,0,1],"
      "'orientation':{'euler313':[0.1,0.2,0.3]},'velocity':[0,0,0],'angular_velocity':[0,0,0]}," BODY(
          "free",
          "") "],'joints':[{'name':'rail','type':'prismatic','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,2]}]"
              ","
              "'forces':[{'name':'spring','type':'spring_damper','bodies':['ground','box'],'points':[[0,0,3],[0,0,1]],"
              "'stiffness':100,'damping':1,'free_length':1,'preload':5}],"
              "'solver':{'relative_tolerance':1e-6,'absolute_tolerance':1e-9,'max_order':3,'max_step':0.01}}",
      "box");
  ck_assert_int_eq(r.ready.nwarning, 0);
  ck_assert_int_eq(r.ready.nchannel, 8 + 2 + 8 + 19 + 7);
  ck_assert_str_eq(r.ready.body[0].name, "box");
  CLOSE(r.ready.body[0].mass, 10, 0);
  CLOSE(r.ready.body[0].inertia.m[0][2], 0.1, 0);
  CLOSE(r.ready.initial[run_channel(&r, "force.spring.value")], 105, 1e-12);
  CLOSE(r.ready.initial[run_channel(&r, "energy.potential")], 10 * 9.81, 1e-9);
  CLOSE(r.ready.initial[run_channel(&r, "energy.springs")], 50 + 5, 1e-9);
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "joint.rail.mx")].unit, "N m");
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "body.free.wz")].unit, "rad/s");
  ck_assert_str_eq(r.ready.channel[run_channel(&r, "body.free.alphaz")].unit, "rad/s2");
  CLOSE(r.ready.initial[run_channel(&r, "body.free.az")], -9.81, 1e-12);
  ck_assert_int_eq((int)json_integer_value(json_object_get(r.ready.report, "degrees_of_freedom")), 7);
  for (int i = 0; i < r.ready.nchannel; i++)
    ck_assert(strpbrk(r.ready.channel[i].name, " ,\"") == NULL);
  run_to(&r, 0.1);
  run_close(&r);
}
END_TEST

/* a load polynomial that is too long is the partner's fault, not a crash */
START_TEST(test_long_polynomial) {
  run r;
  tdm_wrench load[TDM_LOAD_MAX + 1] = {{{0, 0, 0}, {0, 0, 0}}};
  run_open_good(&r, "{" BOX "}", "box");
  ck_assert_int_eq(run_step(&r, 0.1, load, TDM_LOAD_MAX + 1, 0, NULL), TDM_ERR_PROTOCOL);
  run_close(&r);
}
END_TEST

/* a load beyond all bounds ends with the time and advice */
START_TEST(test_hopeless_load) {
  run r;
  tdm_wrench load = {{1e300, 0, 0}, {0, 1e300, 0}};
  run_open_good(&r, "{" BOX "}", "box");
  tdm_status status = TDM_OK;
  for (int k = 1; k < 50 && !status; k++)
    status = run_step(&r, 0.1 * k, &load, 1, 0, NULL);
  ck_assert_int_eq(status, TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(r.err.message, "t = "));
  run_close(&r);
}
END_TEST

TEST_MAIN_ROWS("mbd_input", {test_bad_scene, sizeof cases / sizeof cases[0]}, {test_good_scene, 1},
               {test_long_polynomial, 1}, {test_hopeless_load, 1})

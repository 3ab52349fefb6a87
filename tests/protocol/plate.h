/* A scene in which both sides have something to answer: a plate on a spring, guided along z, and two particles on it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_PLATE_H
#define TEST_PLATE_H

static const char plate_scene[] =
    "{'time':{'end':0.05,'dt':1e-4},'coupling':{'n':5,'bodies':[{'mbd':'plate','dem':'plate'}]},\n"
    "'output':{'interval':1e-3},\n"
    "'mbd':{'bodies':[{'name':'plate','mass':2,'inertia':[0.1,0.2,0.3],'position':[0,0,0],'velocity':[0,0,0.1]}],\n"
    "'joints':[{'name':'guide','type':'prismatic','bodies':['ground','plate'],'point':[0,0,0],'axis':[0,0,1]}],\n"
    "'forces':[{'name':'spring','type':'spring_damper','bodies':['ground','plate'],'points':[[0,0,-1],[0,0,0]],\n"
    "'stiffness':500,'damping':1}]},\n"
    "'dem':{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],\n"
    "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],\n"
    "'bodies':[{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],\n"
    "'particles':[{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0.0498],[0.2,0.1,0.0499]]}]}}\n";

#endif

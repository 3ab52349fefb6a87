# A closed box with spheres in it, settled and, if `press` is given, pressed by its lid, for tandem-yade.
#
# tandem.variables: size, center (of the box, from its centre of mass, body axes), radius, count, total_mass,
# young_modulus, restitution, friction, press [N]
# SPDX-License-Identifier: GPL-3.0-or-later
import random

p = tandem.variables
box, dt = tandem.bodies["box"], tandem.dt
size, center, radius = Vector3(*p["size"]), Vector3(*p.get("center", (0, 0, 0))), p["radius"]
up = max(range(3), key=lambda k: -tandem.gravity[k])  # the axis along which the box stands
lid_face = 2 << 2 * up

grain = O.materials.append(FrictMat(young=p["young_modulus"], poisson=0.2, frictionAngle=0,
                                    density=p["total_mass"] / (p["count"] * 4 / 3 * pi * radius**3)))
wall = O.materials.append(FrictMat(young=p["young_modulus"], poisson=0.2, frictionAngle=atan(p["friction"])))
middle = box.position + box.orientation * center
walls = O.bodies.append(geom.facetBox(middle, size / 2, box.orientation, wallMask=63 - lid_face, material=wall))
lid = O.bodies.append(geom.facetBox(middle, size / 2, box.orientation, wallMask=lid_face, material=wall))


def fill():
    """A sphere in each of `count` cells of a grid, anywhere in its cell."""
    cells = [int(s / (2.05 * radius)) for s in size]
    places = [(i, j, k) for i in range(cells[0]) for j in range(cells[1]) for k in range(cells[2])]
    chance = random.Random(1)  # its own: sphere() seeds that of the module by the clock
    for place in chance.sample(places, p["count"]):
        at = [(i + 0.5) * s / n - s / 2 + chance.uniform(-1, 1) * (s / n / 2 - radius)
              for i, s, n in zip(place, size, cells)]
        O.bodies.append(sphere(middle + box.orientation * Vector3(*at), radius, material=grain))


def settle():
    """Until all spheres are slow: less than 10 mm/s, for 3 s at most."""
    until = O.time + 3
    while O.time < until:
        O.run(500, wait=True)
        if max(b.state.vel.norm() for b in O.bodies if isinstance(b.shape, Sphere)) < 0.01:
            break


def press():
    """The lid goes down while it is pressed less than it should be."""
    lack = 1 - sumForces(lid, axis) / p["press"]
    for i in lid:
        O.bodies[i].state.vel = -0.05 * min(1, max(-1, 5 * lack)) * axis


fill()
newton = NewtonIntegrator(damping=0.4, gravity=tandem.gravity)
presser = PyRunner(command="press()", iterPeriod=1, dead=True)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=0.1 * radius),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],
                    [Ip2_FrictMat_FrictMat_MindlinPhys(en=p["restitution"], es=p["restitution"])],
                    [Law2_ScGeom_MindlinPhys_Mindlin()]),
    presser,
    newton,
]
settle()
if "press" in p:
    axis = box.orientation * Vector3.Unit(up)
    top = max(axis.dot(b.state.pos - middle) for b in O.bodies if isinstance(b.shape, Sphere)) + radius
    for i in lid:
        O.bodies[i].state.pos += (top - size[up] / 2) * axis
    presser.dead = False
    settle()
    for i in lid:
        O.bodies[i].state.vel = Vector3.Zero
O.engines = [e for e in O.engines if e is not presser]
newton.damping = 0
setContactFriction(atan(p["friction"]))

coupled = {"box": walls + lid}
channels = {"kinetic": ("J", kineticEnergy)}

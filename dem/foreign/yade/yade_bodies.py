# SPDX-License-Identifier: GPL-3.0-or-later
"""A coupled body: bodies of Yade that move as one, as the multibody solver says, and the load on them."""
from collections import Counter

from yade import CombinedKinematicEngine, O, Quaternion, RotationEngine, TranslationEngine, Vector3
from yade.utils import sumForces, sumTorques

from tandem_participant import SceneError

AXES = [Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)]
ROUNDING = 1e-12  # what poses may be off by before they are set again, of their size [1]
ASTRAY = 1e-6     # the same, for another hand that moves the body
CHECKED = 100     # members that are looked at after a window


def turn_between(a, b):
    """Axis and angle [rad] of the short turn from one orientation to another."""
    axis, angle = (b * a.conjugate()).toAxisAngle()
    return axis, angle


class CoupledBody:
    """Yade's integrator moves it by velocities that two kinematic engines set: a step costs a few calls, whatever the
    number of its facets."""

    def __init__(self, index, name, ids, state, script):
        self.name, self.path = name, "coupling.bodies[%d].dem" % index
        self.moved, self.loaded = self._resolve(ids, script)
        self.position, self.orientation = Vector3(*state[0:3]), Quaternion(*state[3:7])
        back = self.orientation.conjugate()
        self.places = []  # (id, position from the centre of mass, orientation), body axes; members of clumps too
        for i in dict.fromkeys(self.moved + self.loaded):
            at = O.bodies[i].state
            self.places.append((i, back * (at.pos - self.position), back * at.ori))
        for i in self.moved:
            O.bodies[i].dynamic = False
        self.next = None  # member from which the next check goes on; None: all
        self.walls = [O.bodies[i].shape.axis for i in self.moved if type(O.bodies[i].shape).__name__ == "Wall"]
        self.start = self.orientation
        self.translation, self.rotation = TranslationEngine(), RotationEngine(rotateAroundZero=True)
        self.engine = CombinedKinematicEngine(ids=self.moved, comb=[self.translation, self.rotation])
        self._set_pace(Vector3(*state[7:10]), Vector3(*state[10:13]))

    def _resolve(self, ids, script):
        """What is moved (single bodies, clumps), and what loads act on (single bodies, members of clumps)."""
        moved, loaded = [], []
        if not ids:
            raise SceneError("dem.script", '%s: coupled["%s"] is empty' % (script, self.name))
        for i in dict.fromkeys(ids):
            body = O.bodies[i] if 0 <= i < len(O.bodies) else None
            if body is None:
                raise SceneError("dem.script", '%s: coupled["%s"] names body %d, which there is not' %
                                 (script, self.name, i))
            if body.isClumpMember:
                raise SceneError("dem.script", '%s: coupled["%s"] names body %d, a part of clump %d; name the clump' %
                                 (script, self.name, i, body.clumpId))
            moved.append(i)
            loaded += list(body.shape.members) if body.isClump else [i]
        return moved, loaded

    def kinds(self):
        """What it is made of, for the report."""
        return dict(Counter(type(O.bodies[i].shape).__name__ for i in self.loaded))

    # ---- where it is ----

    def _set_pace(self, velocity, spin):
        """Velocities of all it is made of, for contacts before the first step."""
        for i in dict.fromkeys(self.moved + self.loaded):
            state = O.bodies[i].state
            state.vel, state.angVel = velocity + spin.cross(state.pos - self.position), spin

    def put(self, position, orientation):
        """Set it somewhere, without a velocity of that."""
        self.position, self.orientation = position, orientation
        for i, place, turn in self.places:
            state = O.bodies[i].state
            state.pos, state.ori = position + orientation * place, orientation * turn

    def begin(self, start, end, dt, nstep):
        """A window from state to state: the turn is the same in each of its steps."""
        position, orientation = Vector3(*start[0:3]), Quaternion(*start[3:7])
        if self._off(position, orientation) > ROUNDING:
            self.put(position, orientation)
        goal = Quaternion(*end[3:7])
        axis, angle = turn_between(self.orientation, goal)
        self.spin = axis * (angle / (nstep * dt))
        self.rotation.rotationAxis, self.rotation.angularVelocity = axis, angle / (nstep * dt)
        self.quarter = (self.orientation, axis, angle / nstep)  # from where it turns, and how far in a step
        if self.walls:
            self._check_walls(goal)

    def step_to(self, place, k, dt):
        """The next step leads there: it is the k-th of the window."""
        position = Vector3(*place)
        way = position - self.position
        length = way.norm()
        if length > 0:
            self.translation.translationAxis = way / length
        self.translation.velocity = length / dt
        self.rotation.zeroPoint = self.position
        first, axis, angle = self.quarter
        self.position, self.orientation = position, Quaternion(axis, k * angle) * first

    def check(self):
        """After a window: whether Yade has moved it, and nobody else. All members are looked at in the first window, then
        up to CHECKED in each, in turn."""
        astray = max(self._stray(*self.places[k]) for k in self._next_members())
        if astray > ROUNDING:
            self.put(self.position, self.orientation)

    def _next_members(self):
        n = len(self.places)
        first, self.next = self.next, 0 if self.next is None else (self.next + CHECKED) % n
        return range(n) if first is None else [(first + k) % n for k in range(min(n, CHECKED))]

    def _stray(self, i, place, turn):
        """How far a member is from where it should be, of its size [1]."""
        state = O.bodies[i].state
        off = (state.pos - self.position - self.orientation * place).norm() / (1 + self.position.norm())
        off += abs(turn_between(state.ori, self.orientation * turn)[1])
        if not off < ASTRAY:
            raise SceneError(self.path, 'Yade has body %d of "%s" at (%g, %g, %g), not where it was moved to: let no '
                             'other engine move it, and NewtonIntegrator leave no group out (mask)' %
                             (i, self.name, *state.pos))
        return off

    def _off(self, position, orientation):
        return ((position - self.position).norm() / (1 + position.norm()) +
                abs(turn_between(self.orientation, orientation)[1]))

    def _check_walls(self, goal):
        """Yade's Wall is a plane across an axis, for ever."""
        axis, angle = turn_between(self.start, goal)
        for k in self.walls:
            across = axis - axis[k] * AXES[k]
            if angle * across.norm() > ASTRAY:
                raise SceneError(self.path, 'it turns, but "%s" has a Wall of Yade in it, which cannot: make it of '
                                 'facets or boxes' % self.name)

    # ---- what acts on it ----

    def load(self):
        """Force [N] and moment about the centre of mass [N m], world axes, of all contacts."""
        return ([sumForces(self.loaded, axis) for axis in AXES] +
                [sumTorques(self.loaded, axis, self.position) for axis in AXES])

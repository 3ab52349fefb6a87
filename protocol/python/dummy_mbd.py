#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A multibody solver in a page: free bodies that are balls, so that moments of inertia are alike about all axes.

    "mbd": {"bodies": [{"name": "ball", "mass": 2, "inertia": 0.1, "position": [0, 0, 0], "velocity": [1, 0, 0]}],
            "gravity": [0, 0, -9.81]}

The load is a polynomial of time within a window, so the motion is one, too: nothing is integrated step by step. The
capabilities acceleration and mobility let the scheme `proxy` take it.
"""
from tandem_participant import Participant, SceneError


class Ball:
    def __init__(self, given, path):
        self.name = given.get("name")
        self.mass, self.inertia = given.get("mass"), given.get("inertia")
        for key, value in (("mass", self.mass), ("inertia", self.inertia)):
            if isinstance(value, bool) or not isinstance(value, (int, float)) or value <= 0:
                raise SceneError("%s.%s" % (path, key), "give a number above 0")
        self.x = [float(c) for c in given.get("position", (0, 0, 0))]
        self.v = [float(c) for c in given.get("velocity", (0, 0, 0))]
        self.q, self.w = [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        self.gravity = [0.0, 0.0, 0.0]

    def state(self):
        return self.x + self.q + self.v + self.w

    def acceleration(self, load):
        return [f / self.mass + g for f, g in zip(load[:3], self.gravity)] + [m / self.inertia for m in load[3:]]

    def at(self, s, h, load):
        """The state at s = 0 ... 1 of a window of length h under a load polynomial."""
        def rate(k, scale):  # integral of the load from 0 to s, over mass or inertia
            return sum(c[k] * s**(j + 1) / (j + 1) for j, c in enumerate(load)) * h * scale

        def way(k, scale):
            return sum(c[k] * s**(j + 2) / ((j + 1) * (j + 2)) for j, c in enumerate(load)) * h * h * scale

        t = s * h
        v = [self.v[k] + self.gravity[k] * t + rate(k, 1 / self.mass) for k in range(3)]
        x = [self.x[k] + self.v[k] * t + self.gravity[k] * t * t / 2 + way(k, 1 / self.mass) for k in range(3)]
        w = [self.w[k] + rate(3 + k, 1 / self.inertia) for k in range(3)]
        turn = [self.w[k] * t + way(3 + k, 1 / self.inertia) for k in range(3)]  # to second order in time
        return x + turned(self.q, turn) + v + w

    def go(self, state):
        self.x, self.q, self.v, self.w = state[:3], state[3:7], state[7:10], state[10:]


def turned(q, turn):
    """A quaternion turned by a rotation vector in world axes."""
    from math import cos, sin, sqrt
    angle = sqrt(sum(c * c for c in turn))
    f = sin(angle / 2) / angle if angle > 0 else 0.5
    a, (bx, by, bz) = cos(angle / 2), (f * c for c in turn)
    w, x, y, z = q
    p = [a * w - bx * x - by * y - bz * z, a * x + bx * w + by * z - bz * y, a * y - bx * z + by * w + bz * x,
         a * z + bx * y - by * x + bz * w]
    norm = sqrt(sum(c * c for c in p))
    return [c / norm for c in p]


def read(assignment):
    given = assignment.scene.get("bodies") or []
    balls = [Ball(body, "mbd.bodies[%d]" % i) for i, body in enumerate(given)]
    for ball in balls:
        ball.gravity = [float(g) for g in assignment.scene.get("gravity", (0, 0, 0))]
    by_name = {ball.name: ball for ball in balls}
    for i, body in enumerate(assignment.bodies):
        if body["name"] not in by_name:
            raise SceneError("coupling.bodies[%d].mbd" % i, 'there is no body "%s"' % body["name"])
    return [by_name[body["name"]] for body in assignment.bodies]


def mobility(balls):
    """Accelerations by loads, 6k x 6k, row by row; no reduced model."""
    k = 6 * len(balls)
    Y = [0.0] * (k * k)
    for i in range(k):
        ball = balls[i // 6]
        Y[i * k + i] = 1 / ball.mass if i % 6 < 3 else 1 / ball.inertia
    return 0, Y


def run(p):
    balls, slots = read(p.initialize()), {}
    no_load = [0.0] * 6

    def restore(slot):
        for ball, state in zip(balls, slots[slot]):
            ball.go(list(state))

    p.keep(lambda slot: slots.__setitem__(slot, [ball.state() for ball in balls]), restore)
    nfree, Y = mobility(balls)
    told = {"acceleration": [a for ball in balls for a in ball.acceleration(no_load)],
            "mobility": {"nfree": nfree, "numbers": Y}}
    told = {name: told[name] for name in told if name in p.assignment.results}
    p.ready(bodies=[{"name": b.name, "mass": b.mass, "inertia": [b.inertia, 0, 0, 0, b.inertia, 0, 0, 0, b.inertia],
                     "state": b.state()} for b in balls], **told)
    for step in p.steps():
        result, h = p.result(step), step.t1 - step.t0
        for i, ball in enumerate(balls):
            for k, t in enumerate(step.sample_time):
                result.sample_state[k][i] = ball.at((t - step.t0) / h, h, step.load[i])
            ball.go(ball.at(1.0, h, step.load[i]))
            result.state[i] = ball.state()
            if result.acceleration:
                result.acceleration[i] = ball.acceleration(step.load_at(i, 1.0))
        result.mobility = (nfree, Y) if result.mobility else None
        p.advance(result)


with Participant.from_arguments("mbd", "python balls 1.0", ["acceleration", "mobility", "restore"]) as participant:
    run(participant)

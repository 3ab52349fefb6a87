#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A DEM solver in a page: each coupled body is pulled back to where it started by one spring and a damper.

    "dem": {"stiffness": 100, "damping": 0}

F = -k (x - x0) - c v, along the path that ASSIGN names. The load is the mean over the values after each of the window's
steps, as section 5 of PROTOCOL.md has it; output times get the mean since the one before.
"""
from tandem_participant import Participant, SceneError


def positive(scene, key, fallback=None):
    value = scene.get(key, fallback)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value < 0:
        raise SceneError("dem." + key, "give a number, not negative")
    return float(value)


def read(assignment):
    scene = assignment.scene
    unknown = [key for key in scene if key not in ("stiffness", "damping", "gravity")]
    if unknown:
        raise SceneError("dem." + unknown[0], "unknown key; the keys are stiffness and damping")
    return positive(scene, "stiffness"), positive(scene, "damping", 0.0)


class Springs:
    def __init__(self, assignment):
        self.k, self.c = read(assignment)
        self.start = [body["state"][:3] for body in assignment.bodies]
        self.sum = [[0.0] * 3 for _ in self.start]  # of forces since the last output time
        self.count = 0
        self.slots = {}

    def save(self, slot):
        self.slots[slot] = [row[:] for row in self.sum], self.count

    def restore(self, slot):
        rows, self.count = self.slots[slot]
        self.sum = [row[:] for row in rows]

    def force(self, step, body, s):
        place, velocity = step.path_at(body, s)
        return [-self.k * (x - x0) - self.c * v for x, x0, v in zip(place, self.start[body], velocity)]

    def take_mean(self):
        mean = [[x / self.count for x in row] for row in self.sum]
        self.sum = [[0.0] * 3 for _ in self.start]
        self.count = 0
        return mean

    def solve(self, step, result, alive):
        sample, h = 0, step.t1 - step.t0
        for k in range(1, step.nstep + 1):
            s = k / step.nstep
            for body in range(step.nbody):
                force = self.force(step, body, s)
                for axis in range(3):
                    result.load[body][axis] += force[axis] / step.nstep
                    self.sum[body][axis] += force[axis]
            self.count += 1
            due = [t for t in step.sample_time[sample:] if t <= step.t0 + s * h + 1e-9 * h]
            mean = self.take_mean() if due else None
            for t in due:
                for body in range(step.nbody):
                    result.sample_load[sample][body][:3] = mean[body]
                result.channel[sample][0] = t
                sample += 1
            alive()


with Participant.from_arguments("dem", "python springs 1.0", ["restore"]) as p:
    springs = Springs(p.initialize())
    p.keep(springs.save, springs.restore)
    p.ready(loads=[[0.0] * 6 for _ in springs.start], channels=[{"name": "springs.time", "unit": "s", "initial": 0.0}],
            report={"springs": len(springs.start)})
    for step in p.steps():
        result = p.result(step)
        springs.solve(step, result, p.alive)
        p.advance(result)

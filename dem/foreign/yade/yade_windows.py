# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows of the co-simulation, inside Yade's loop.

A step of Yade is: contacts and their forces at time t, then NewtonIntegrator, which moves everything to t + dt. Between
the two a PyRunner calls Windows.exchange: the forces are the loads at t, after the step before; where t ends a window
they are answered and the next one is awaited; and the integrator is told where coupled bodies go.
"""
import ctypes
import os
import re
import stat
import sys
import threading

import numpy
import yade.config
from yade import O, PyRunner, TimeStepper
from yade.utils import PWaveTimeStep

from tandem_participant import ProtocolError, SceneError
from yade_bodies import CoupledBody

WALL_MASS = ("Yade's contact laws take coupled bodies for walls of infinite mass: where dampers go by the masses, they "
             "take the particle's alone, not the effective mass of both")


class Means:
    """Mean loads of the bodies between output times; (nbody, 6)."""

    def __init__(self, nbody):
        self.sum, self.mean, self.steps = numpy.zeros((nbody, 6)), numpy.zeros((nbody, 6)), 0.0

    def add(self, load, share):
        self.sum += share * load
        self.steps += share

    def close(self):
        if self.steps > 0:
            self.mean = self.sum / self.steps
        self.sum, self.steps = numpy.zeros_like(self.sum), 0.0
        return self.mean.tolist()


def interface_rows(step, load, twist):
    """The window as the particles felt it (PROTOCOL.md, section 7), 33 numbers a body: Yade's leapfrog gives them a
    kick of F dt at each step; of the first and the last one half belongs to this window. load, twist (nstep + 1, nbody, 6),
    at the times from t0 to t1."""
    x = numpy.linspace(-1, 1, step.nstep + 1)
    share = numpy.full(step.nstep + 1, 1 / step.nstep)
    share[[0, -1]] /= 2
    moment = numpy.einsum("jk,kbc->bjc", share * (x**0, x, 1.5 * x**2 - 0.5), load)
    work = (step.t1 - step.t0) * numpy.einsum("k,kbc,kbc->b", share, load, twist)
    return [moment[i].ravel().tolist() + list(step.end[i]) + [work[i], 0.0] for i in range(step.nbody)]


class Windows:
    """The exchange. The server's messages are read and answered in Yade's own thread, while the main one waits."""

    def __init__(self, participant, assignment, script):
        self.participant, self.assignment, self.script = participant, assignment, script
        self.bodies = self._couple()
        self.newton = self._place_engines()
        self.steps, self.step, self.error = participant.steps(), None, None
        self.done = threading.Event()
        self.means = Means(len(self.bodies))

    # ---- before the first step ----

    def _couple(self):
        bodies, taken = [], {}
        for i, body in enumerate(self.assignment.bodies):
            name = body["name"]
            if name not in self.script.coupled:
                raise SceneError("coupling.bodies[%d].dem" % i, '"%s" is not in the dictionary coupled of %s: %s' %
                                 (name, self.script.path, ", ".join(self.script.coupled) or "it is empty"))
            one = CoupledBody(i, name, self.script.coupled[name], body["state"], self.script.path)
            for k in one.moved:
                if k in taken:
                    raise SceneError("dem.script", '%s: body %d is in "%s" and in "%s"' %
                                     (self.script.path, k, taken[k], name))
                taken[k] = name
            bodies.append(one)
        return bodies

    def _place_engines(self):
        """What moves the bodies, and the exchange before it, in front of the integrator."""
        engines = list(O.engines)
        kinds = [type(engine).__name__ for engine in engines]
        if kinds.count("NewtonIntegrator") != 1 or "ForceResetter" not in kinds:
            raise SceneError("dem.script", "%s: O.engines must have a ForceResetter and one NewtonIntegrator, and has: "
                             "%s" % (self.script.path, ", ".join(kinds) or "nothing"))
        at = kinds.index("NewtonIntegrator")
        self.script.main.tandem.exchange = self.exchange
        runner = PyRunner(command="tandem.exchange()", iterPeriod=1, initRun=True)
        O.engines = engines[:at] + [runner] + [body.engine for body in self.bodies] + engines[at:]
        for engine in engines:
            if isinstance(engine, TimeStepper):
                engine.active = False  # the scene has the step
        O.dt = self.assignment.dt
        return engines[at]

    def _warnings(self):
        def doubt(path, message):
            warnings.append({"path": path, "message": message})

        warnings, critical = [], PWaveTimeStep()
        if 0 < critical < self.assignment.dt:
            doubt("time.dt", "is %.3g s, but a wave crosses the smallest particle in %.3g s (Yade's PWaveTimeStep); "
                  "take a shorter step" % (self.assignment.dt, critical))
        if self.newton.damping > 0:
            doubt("dem.script", "NewtonIntegrator has damping = %g (0.2 unless told otherwise), which takes energy "
                  "from all that moves; give damping=0 if contacts are to damp alone" % self.newton.damping)
        return warnings

    def _fill(self):
        """Number, mass, centre of mass and inertia about it of what the integrator moves (as tandem-dem reports)."""
        coupled = {k for body in self.bodies for k in body.moved}
        rows = [b for b in O.bodies if b is not None and b.id not in coupled and b.dynamic and not b.isClumpMember]
        mass = numpy.array([b.state.mass for b in rows])
        place = numpy.array([list(b.state.pos) for b in rows]).reshape(-1, 3)
        if not numpy.isfinite(place).all():
            raise SceneError("dem.script", "%s: a particle's place is not finite at the start" % self.script.path)
        total = mass.sum()
        center = mass @ place / total if total > 0 else numpy.zeros(3)
        inertia = numpy.zeros((3, 3))
        for b, m, x in zip(rows, mass, place - center):
            turn = numpy.array(b.state.ori.toRotationMatrix()).reshape(3, 3)
            inertia += turn @ numpy.diag(list(b.state.inertia)) @ turn.T
            inertia += m * (x @ x * numpy.eye(3) - numpy.outer(x, x))
        return {"number": len(rows), "mass": float(total), "com": center.tolist(), "inertia": inertia.ravel().tolist()}

    def _ready(self, load):
        report = {"yade": yade.config.version, "script": self.script.path, "threads": O.numThreads,
                  "fill": self._fill(), "bodies": {body.name: body.kinds() for body in self.bodies},
                  "wall_mass": "infinite: contacts take the particle's mass alone"}
        self.participant.remark("wall_mass", WALL_MASS, path="coupling.bodies", t=self.assignment.start)
        values = self.script.channel_values()
        self.participant.ready(
            loads=load.tolist(), gravity=list(self.newton.gravity), warnings=self._warnings(), report=report,
            channels=[{"name": name, "unit": unit, "initial": value}
                      for (name, unit, _), value in zip(self.script.channels, values)])

    # ---- in Yade's loop ----

    def exchange(self):
        """Called once in each of Yade's steps."""
        if self.step is None:
            ctypes.pythonapi.PyGILState_Ensure()  # else Python forgets Yade's thread after each call, for 0.13 ms
        try:
            self._visit()
        except BaseException as error:  # goes to the main thread, which tells the server
            self.error = error
            O.pause()
            self.done.set()

    def _visit(self):
        load = self._loads()
        if self.step is None:
            self._ready(load)
            self._begin(load)
        else:
            self._after_step(load)
            if self.k == self.step.nstep:
                self._end()
                self._begin(load)
        self.k += 1
        for i, body in enumerate(self.bodies):
            place, velocity = self.step.path_at(i, self.k / self.step.nstep)
            self.twist.append([*velocity, *body.spin])
            body.step_to(place, self.k, self.dt)
        self.participant.alive()

    def _loads(self):
        load = numpy.array([body.load() for body in self.bodies]).reshape(-1, 6)
        if not numpy.isfinite(load).all():
            raise ProtocolError("the loads of Yade's contacts are no longer finite at step %d: take a shorter step "
                                "(time.dt), or look for particles that overlap at the start" % O.iter,
                                "TDM_ERR_NUMERIC")
        return load

    def _begin(self, load):
        """Wait for the next window, and enter it: load is the one at its start."""
        self.step = step = next(self.steps)
        self.dt, own = self.assignment.dt, (step.t1 - step.t0) / step.nstep
        if abs(own - self.dt) > 1e-6 * self.dt:
            self.dt = own
        O.dt = self.dt
        for body, start, end in zip(self.bodies, step.start, step.end):
            body.begin(start, end, self.dt, step.nstep)
        self.k, self.sample = 0, 0
        self.load = [load]  # at the times from t0 to t1
        self.twist = [[*step.path_at(i, 0.0)[1], *body.spin] for i, body in enumerate(self.bodies)]
        self.result = self.participant.result(step)

    def _after_step(self, load):
        """A step is done: what is summed up, and the output times that it reached."""
        step, h = self.step, self.step.t1 - self.step.t0
        self.load.append(load)
        t, before = step.t0 + h * self.k / step.nstep, 0.0
        while self.sample < len(step.sample_time) and (self.k == step.nstep or
                                                       step.sample_time[self.sample] <= t + 1e-6 * self.dt):
            share = min(1.0, max(before, 1 - (t - step.sample_time[self.sample]) / self.dt))
            self.means.add(load, share - before)
            before = share
            self.result.sample_load[self.sample] = self.means.close()
            self.result.channel[self.sample] = self.script.channel_values()
            self.sample += 1
        self.means.add(load, 1 - before)

    def _end(self):
        step, result = self.step, self.result
        for body in self.bodies:
            body.check()
        load = numpy.array(self.load)
        result.load = load[1:].mean(axis=0).tolist()
        if result.interface:
            result.interface = interface_rows(step, load, numpy.reshape(self.twist, load.shape))
        self.participant.advance(result)

    # ---- the main thread ----

    def run(self):
        """Until FINISH. What ends Yade's loop otherwise is raised here."""
        log = Log()
        O.run()
        while O.running and not self.done.wait(0.1):
            pass
        raise self.error or self._what_yade_says(log)

    @staticmethod
    def _what_yade_says(log):
        """Yade has stopped by itself: its exceptions, where it raises any, say nothing, but it has written a log."""
        failed = False
        try:
            O.wait()
        except BaseException:
            failed = True
        words = log.errors()
        if failed or words:
            return ProtocolError("an engine of Yade failed: %s" % (words or "see dem.log"), "TDM_ERR_NUMERIC")
        return ProtocolError("Yade has ended the simulation: let the script neither set O.stopAtIter nor call "
                             "O.pause()")


class Log:
    """What is written to standard error from now on, if that is a file, as it is when the server starts this."""

    def __init__(self):
        sys.stderr.flush()
        status = os.fstat(2)
        self.start = status.st_size if stat.S_ISREG(status.st_mode) else None

    def errors(self):
        """The last line that tells an exception, or what Yade calls fatal."""
        if self.start is None:
            return ""
        with open("/proc/self/fd/2", "rb") as log:
            log.seek(max(self.start, os.fstat(2).st_size - 10000))
            text = re.sub(r"\x1b\[[0-9;]*m", "", log.read().decode(errors="replace"))
        lines = [line.strip() for line in text.splitlines()]
        found = [line for line in lines if re.match(r"[A-Za-z_.]*(Error|Exception)\b", line)]
        found = found or [line for line in lines if re.search(r"FATAL|ERROR|[Ee]xception", line)]
        return found[-1] if found else ""

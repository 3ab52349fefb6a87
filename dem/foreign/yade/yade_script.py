# SPDX-License-Identifier: GPL-3.0-or-later
"""Yade itself, the section `dem` of a scene for it, and the user's script.

The script is an ordinary one: bodies, materials, O.engines. It sees what `yade SCRIPT` would show it, and the object
`tandem` (of the class below); it leaves the dictionary `coupled` of the bodies that the multibody solver moves, and may
leave `channels`.
"""
import builtins
import glob
import os
import signal
import sys
import threading
import traceback
import types

from tandem_participant import ProtocolError, SceneError

KEYS = ("solver", "script", "gravity")
PREAMBLE = """
from yade import *
from yade import geom, pack, utils
from yade.pack import *
from yade.utils import *
from math import *
"""


def boot(threads):
    """Load Yade into this process, as its own program does; what went wrong, or None. The number of threads cannot be
    changed later."""
    prefix = os.environ.get("YADE_PREFIX", "/usr")
    found = sorted(glob.glob(os.path.join(prefix, "lib", "*", "yade-double", "py", "yade", "__init__.py")))
    if not found:
        return ProtocolError("Yade is not installed in %s: install Debian's package yade" % prefix, "TDM_ERR_SYSTEM")
    sys.path.insert(1, os.path.dirname(os.path.dirname(found[0])))
    os.environ["OMP_NUM_THREADS"] = str(threads)
    os.environ.pop("DISPLAY", None)  # no windows
    try:
        import yade
    except Exception as error:
        traceback.print_exc()
        return ProtocolError("Yade cannot be loaded from %s: %s" % (found[0], error), "TDM_ERR_SYSTEM")
    for name in (signal.SIGSEGV, signal.SIGABRT, signal.SIGFPE, signal.SIGTERM, signal.SIGHUP):
        signal.signal(name, signal.SIG_DFL)  # Yade would ask a debugger
    yade.O.engines = []
    return None


class Section:
    """dem: script (file, a path; variables, whatever the script wants). solver is the server's key, gravity that of
    the scene's root."""

    def __init__(self, scene):
        self._check_keys("dem", scene, KEYS)
        self.gravity = scene.get("gravity")
        if self.gravity is not None and not (isinstance(self.gravity, list) and len(self.gravity) == 3 and
                                             all(isinstance(g, (int, float)) for g in self.gravity)):
            raise SceneError("dem.gravity", "give three numbers [m/s2], or leave it to the scene's root")
        script = scene.get("script")
        if not isinstance(script, dict):
            raise SceneError("dem.script", 'give {"file": a Yade script, "variables": {names and values for it}}')
        self._check_keys("dem.script", script, ("file", "variables"))
        self.variables = script.get("variables", {})
        if not isinstance(self.variables, dict):
            raise SceneError("dem.script.variables", "give an object: names and values for the script")
        self.script, self.text = self._read(script.get("file"))

    @staticmethod
    def _check_keys(path, json, keys):
        unknown = [key for key in json if key not in keys and not key.startswith("$")]
        if unknown:
            raise SceneError("%s.%s" % (path, unknown[0]), "unknown key; tandem-yade has %s there" % ", ".join(keys))

    @staticmethod
    def _read(path):
        """Path and text of the script."""
        if not isinstance(path, str) or not path:
            raise SceneError("dem.script.file", "give the path of a Yade script")
        if not os.path.isfile(path):
            raise SceneError("dem.script.file", "%s: there is no such file; relative names start at the scene's folder"
                             % path)
        try:
            with open(path, encoding="utf-8") as file:
                return path, file.read()
        except (OSError, UnicodeError) as error:
            raise SceneError("dem.script.file", "%s: cannot be read: %s" % (path, error)) from None


class Bodies(dict):
    """The coupled bodies by name."""

    def __missing__(self, name):
        raise KeyError('of coupling.bodies in the scene none is called "%s" (dem): %s' % (name, ", ".join(self)))


class Given:
    """What the script sees as `tandem`: variables (a dictionary), dt, start, end [s], gravity (a vector, or None if
    the scene has none), and bodies: by name, where each coupled body is at the start: mass, inertia (9 numbers, about
    the centre of mass, body axes), position, orientation, velocity, angular_velocity (of Yade's types)."""

    def __init__(self, section, assignment):
        from yade import Quaternion, Vector3
        self.variables = section.variables
        self.dt, self.start, self.end = assignment.dt, assignment.start, assignment.end
        self.gravity = Vector3(*section.gravity) if section.gravity else None
        self.bodies = Bodies()
        for body in assignment.bodies:
            s = body["state"]
            self.bodies[body["name"]] = types.SimpleNamespace(
                mass=body["mass"], inertia=body["inertia"], position=Vector3(*s[0:3]), orientation=Quaternion(*s[3:7]),
                velocity=Vector3(*s[7:10]), angular_velocity=Vector3(*s[10:13]))


class Script:
    """The script as it has run. coupled: ids of Yade's bodies by name; channels: (name, unit, function)."""

    def __init__(self, section, assignment, participant):
        self.path = section.script
        self.main = types.ModuleType("__main__")
        self.main.__file__, self.main.__builtins__ = self.path, builtins  # Yade puts labels of engines there
        self.main.tandem = Given(section, assignment)
        sys.modules["__main__"] = self.main  # where Yade's PyRunner looks for what the script defines
        sys.argv = [self.path]
        sys.path.insert(0, os.path.dirname(os.path.abspath(self.path)))
        self._run(section.text, assignment, participant)
        self.coupled = self._read_coupled()
        self.channels = self._read_channels()

    def _run(self, text, assignment, participant):
        from yade import O
        exec(PREAMBLE, self.main.__dict__)
        O.dt = assignment.dt
        with Pulse(participant):
            try:
                exec(compile(text, self.path, "exec"), self.main.__dict__)
            except SystemExit:
                raise SceneError("dem.script", "%s: it ends by itself; leave out exit()" % self.path) from None
            except BaseException as error:
                traceback.print_exc()
                raise SceneError("dem.script", self.told(error)) from None
        if O.running:
            raise SceneError("dem.script", "%s: it leaves Yade running; take out its last O.run(), which tandem-yade "
                             "does, or give that wait=True" % self.path)

    def told(self, error):
        """An exception as a line: where in the script, and what."""
        line = error.lineno if isinstance(error, SyntaxError) and error.filename == self.path else None
        for frame in traceback.extract_tb(error.__traceback__):
            line = frame.lineno if frame.filename == self.path else line
        what = "%s: %s" % (type(error).__name__, error)
        return "%s%s: %s" % (self.path, "" if line is None else ", line %d" % line, " ".join(what.split()))

    def _read_coupled(self):
        coupled = getattr(self.main, "coupled", None)
        if not isinstance(coupled, dict):
            raise SceneError("dem.script", '%s: it does not say which bodies the multibody solver moves; give '
                             'coupled = {"name": [ids of bodies]}' % self.path)
        for name, ids in coupled.items():
            try:
                coupled[name] = [int(i) for i in ids]
            except (TypeError, ValueError):
                raise SceneError("dem.script", '%s: coupled["%s"] must be a list of ids of bodies, as O.bodies.append '
                                 'returns them' % (self.path, name)) from None
        return coupled

    def _read_channels(self):
        channels = getattr(self.main, "channels", {})
        try:
            rows = [(str(name), str(unit), function) for name, (unit, function) in channels.items()]
        except (AttributeError, TypeError, ValueError):
            rows = [(None, None, None)]
        if any(not callable(function) for _, _, function in rows):
            raise SceneError("dem.script", '%s: channels must be {"name": ("unit", function)}' % self.path)
        return rows

    def channel_values(self):
        """The channels now."""
        values = []
        for name, _, function in self.channels:
            try:
                values.append(float(function()))
            except Exception as error:
                raise SceneError("dem.script", 'channel "%s": %s' % (name, self.told(error))) from None
        return values


class Pulse:
    """While the script runs: HEARTBEAT as long as Yade's own steps go on, so that a bed may settle for minutes, and a
    script that hangs is still found out by the server."""

    def __init__(self, participant):
        self.participant, self.stop = participant, threading.Event()
        self.thread = threading.Thread(target=self._beat, daemon=True)

    def _beat(self):
        from yade import O
        last = O.iter
        while not self.stop.wait(0.5):
            if O.iter != last:
                last = O.iter
                self.participant.alive()

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *error):
        self.stop.set()
        self.thread.join()

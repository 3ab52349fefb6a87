# SPDX-License-Identifier: MIT
"""A solver's side of the tandem protocol (PROTOCOL.md) in Python, on pyzmq alone.

    with Participant.from_arguments("dem", "mine 1.0", ["restore"]) as p:
        a = p.initialize()                          # ASSIGN: a.scene, a.bodies, a.dt ...
        p.ready(loads=[[0.0] * 6 for _ in a.bodies])
        p.keep(save, restore)                       # with the capability "restore"
        for step in p.steps():                      # a Step for each window
            result = p.result(step)
            result.load[0] = [0, 0, -9.81, 0, 0, 0]
            p.advance(result)

Numbers are plain lists of floats: a state is 13 of them (position, quaternion w x y z, velocity, angular velocity), a
load 6 (force, moment about the centre of mass); SI units, world axes. An exception inside the block becomes ERROR, with
its text, and exit status 1.
"""
import copy
import json
import math
import signal
import struct
import sys
import time

import zmq

VERSION = 1
HELLO, ASSIGN, READY, STEP, RESULT, SAVE, RESTORE, CHECKPOINT, FINISH, ERROR, HEARTBEAT, REMARKS, VIEW = range(1, 14)
NAMES = ["", "HELLO", "ASSIGN", "READY", "STEP", "RESULT", "SAVE", "RESTORE", "CHECKPOINT", "FINISH", "ERROR",
         "HEARTBEAT", "REMARKS", "VIEW"]
HEADER = struct.Struct("<4sHHQII")
STEP_HEAD = struct.Struct("<ddQIIIIHHI")  # t0 t1 nstep, nbody nstate nload nsample, flags nfree, nnode
RESULT_HEAD = struct.Struct("<ddIIIIIHH")
HEARTBEAT_S = 0.5
FRAME_MAX = 64 * 1024 * 1024
REMARKS_MAX = 256
EXTRAS = ["acceleration", "mobility", "interface", "energy", "matched_load"]  # flag 1 << k in RESULT


class ProtocolError(Exception):
    """What came is not what PROTOCOL.md allows, or the server is gone. `status` is one of its names."""

    def __init__(self, message, status="TDM_ERR_PROTOCOL", path=""):
        super().__init__(message)
        self.status, self.path = status, path


class SceneError(ProtocolError):
    """A value of the scene is wrong: path ("dem.stiffness"), what is wrong and what to do."""

    def __init__(self, path, message):
        super().__init__(message, "TDM_ERR_SCENE", path)


class _Finished(Exception):
    pass


class _Given(Exception):
    """The server has sent ERROR."""


class Assignment:
    """ASSIGN: scene (the solver's section), start, end, dt, n, bodies (names for mbd; objects for dem), results, ..."""

    def __init__(self, message):
        self.scene = message.get("scene") or {}
        for key in ("start", "end", "dt"):
            setattr(self, key, _number(message, key))
        self.n = int(_number(message, "n"))
        self.interpolation = message.get("interpolation", "hermite")
        self.timeout = _number(message, "timeout")
        self.bodies = message.get("bodies") or []
        self.results = message.get("results") or []
        self.restores = bool(message.get("restores"))
        self.proxy = bool(message.get("proxy"))
        self.remarks = bool(message.get("remarks"))
        self.ahead = message.get("ahead")
        self.wall_velocity = message.get("wall_velocity", "path")


class Step:
    """One window. start, end: a state for each body (to dem); load: for each body its coefficients of s (to mbd),
    W(s) = sum of load[i][j] s**j; sample_time: output times; ahead, nodes [(time, states)], proxy (dict): None without.
    """

    def load_at(self, body, s):
        """The load of a body at s = 0 ... 1."""
        return [sum(c[k] * s**j for j, c in enumerate(self.load[body])) for k in range(6)]

    def path_at(self, body, s):
        """Position, velocity of a body at s on the straight or Hermite path from start to end, as ASSIGN has it."""
        a, b, h = self.start[body], self.end[body], self.t1 - self.t0
        if self.interpolation == "linear":
            rate = [(b[k] - a[k]) / h for k in range(3)]
            return [a[k] + s * (b[k] - a[k]) for k in range(3)], rate
        w = [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
        d = [(6 * s**2 - 6 * s) / h, 1 - 4 * s + 3 * s**2, (6 * s - 6 * s**2) / h, 3 * s**2 - 2 * s]
        terms = [(a[k], a[7 + k], b[k], b[7 + k]) for k in range(3)]
        return ([sum(x * y for x, y in zip(w, t)) for t in terms], [sum(x * y for x, y in zip(d, t)) for t in terms])


class Result:
    """What goes back: state (mbd) or load (dem) of each body at t1; samples; what ASSIGN's `results` asks for."""


def _number(message, key):
    value = message.get(key)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ProtocolError('malformed message: "%s" must be a number' % key)
    return float(value)


def _finite(values, what):
    for x in values:
        if not math.isfinite(x) or abs(x) > 1e150:
            raise ProtocolError("malformed STEP: %s has %g" % (what, x))
    return values


def _rows(values, width):
    return [list(values[i:i + width]) for i in range(0, len(values), width)]


class Participant:
    """The connection of one solver."""

    def __init__(self, endpoint, role, software, capabilities=(), name=None, timeout=30.0):
        self.role, self.timeout = role, timeout
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.DEALER)
        self._socket.setsockopt(zmq.LINGER, 500)
        self._socket.connect(endpoint)
        self._beat = time.monotonic()
        self._window = 0
        self._keeper = None
        self._channels = 0
        self._begin = None
        self.assignment = None
        self._remarks, self._remarks_changed, self._remarks_kept = {}, False, {}
        self._send_json(HELLO, {"name": name or role, "role": role, "software": software,
                                "capabilities": list(capabilities)})

    @classmethod
    def from_arguments(cls, role, software, capabilities=(), arguments=None):
        """From --connect ENDPOINT --name NAME --timeout SECONDS, as the server starts a solver."""
        words = sys.argv[1:] if arguments is None else arguments
        given = {"--name": role, "--timeout": "30"}
        for option, value in zip(words[::2], words[1::2]):
            if option not in ("--connect", "--name", "--timeout"):
                sys.exit("unknown option %s" % option)
            given[option] = value
        if len(words) % 2 or "--connect" not in given:
            sys.exit('no server given; use --connect ENDPOINT, or let "tandem run" start this solver')
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends it
        return cls(given["--connect"], role, software, capabilities, given["--name"], float(given["--timeout"]))

    # ---- frames ----

    def _send(self, kind, payload=b""):
        self._socket.send(HEADER.pack(b"TNDM", VERSION, kind, self._window, len(payload), 0) + payload)
        self._beat = time.monotonic()

    def _send_json(self, kind, message):
        self._send(kind, json.dumps(message, allow_nan=False).encode())

    def _send_remarks(self):
        if self._remarks_changed and self.assignment and self.assignment.remarks:
            self._send_json(REMARKS, {"remarks": list(self._remarks.values())})
            self._remarks_changed = False

    def _receive(self):
        """The next message that is no HEARTBEAT: its type and payload."""
        while True:
            if not self._socket.poll(int(1000 * self.timeout)):
                raise ProtocolError("the server is silent for %g s" % self.timeout, "TDM_ERR_TIMEOUT")
            frame = self._socket.recv()
            if len(frame) < HEADER.size or frame[:4] != b"TNDM":
                raise ProtocolError("malformed frame: it does not begin with TNDM, or is cut")
            _, version, kind, window, size, _ = HEADER.unpack_from(frame)
            if version != VERSION:
                raise ProtocolError("the server speaks protocol version %d, here it is %d" % (version, VERSION),
                                    "TDM_ERR_VERSION")
            if len(frame) > FRAME_MAX or size != len(frame) - HEADER.size or not HELLO <= kind <= VIEW:
                raise ProtocolError("malformed frame: its size or its type is wrong")
            if kind == HEARTBEAT:
                continue
            if kind == FINISH:
                raise _Finished()
            if kind == ERROR:
                raise _Given(frame[HEADER.size:].decode(errors="replace"))
            self._window = window
            return kind, frame[HEADER.size:]

    def _object(self, payload):
        try:
            message = json.loads(payload.decode()) if payload else {}
        except ValueError as error:
            raise ProtocolError("malformed message: %s" % error) from None
        if not isinstance(message, dict):
            raise ProtocolError("malformed message: no JSON object")
        return message

    # ---- the session ----

    def initialize(self):
        """Wait for ASSIGN."""
        kind, payload = self._receive()
        if kind != ASSIGN:
            raise ProtocolError("%s came where ASSIGN was expected" % NAMES[kind])
        self.assignment = Assignment(self._object(payload))
        return self.assignment

    def ready(self, bodies=(), loads=(), channels=(), warnings=(), report=None, **more):
        """READY. bodies: {"name", "mass", "inertia": [9], "state": [13]} (mbd); loads: six numbers a body (dem);
        channels: {"name", "unit", "initial"}; more: acceleration, mobility, rest, energy, gravity ... as section 4 has
        them."""
        self._channels = len(channels)
        self._send_remarks()
        self._send_json(READY, {"bodies": list(bodies), "loads": list(loads), "channels": list(channels),
                                "warnings": list(warnings), "report": report or {}, **more})

    def remark(self, event, message, level="notice", path="", t=None):
        """What the user should know and what does not end the run: a "warning" makes results doubtful. path: in the
        scene; t [s]. An event that comes again is counted; the first one's words stay. Goes before the next message."""
        if event not in self._remarks and len(self._remarks) == REMARKS_MAX:
            return
        entry = self._remarks.setdefault(event, {"event": event, "level": level, "path": path, "message": message,
                                                 "count": 0, "first_s": t})
        entry["count"] += 1
        entry["last_s"] = t
        self._remarks_changed = True

    def keep(self, save, restore):
        """With the capability "restore": save(slot) and restore(slot) are called between windows; a KeyError of restore
        says that nothing was saved there."""
        self._keeper = (save, restore)

    def steps(self):
        """A Step for each window, until FINISH."""
        while True:
            kind, payload = self._receive()
            if kind in (SAVE, RESTORE) and self._keeper:
                self._answer_keeper(kind, self._object(payload))
            elif kind == STEP:
                self._begin = time.monotonic()
                yield self._read_step(payload)
            else:
                raise ProtocolError("%s came where STEP was expected" % NAMES[kind])

    def _answer_keeper(self, kind, message):
        slot = message.get("slot")
        if not isinstance(slot, int) or not 0 <= slot < 16:
            raise ProtocolError('malformed %s: "slot" must be a whole number from 0 to 15' % NAMES[kind])
        try:
            self._keeper[0 if kind == SAVE else 1](slot)
        except KeyError:
            raise ProtocolError("nothing was saved in slot %d" % slot) from None
        if kind == SAVE:
            self._remarks_kept[slot] = copy.deepcopy(self._remarks)
        else:
            self._remarks, self._remarks_changed = copy.deepcopy(self._remarks_kept[slot]), True
        self._send_json(kind, {"slot": slot})

    def _read_step(self, payload):
        if len(payload) < STEP_HEAD.size or (len(payload) - STEP_HEAD.size) % 8:
            raise ProtocolError("malformed STEP: it is cut")
        step = Step()
        (step.t0, step.t1, step.nstep, step.nbody, nstate, nload, nsample, flags, nfree,
         nnode) = STEP_HEAD.unpack_from(payload)
        values = struct.unpack_from("<%dd" % ((len(payload) - STEP_HEAD.size) // 8), payload, STEP_HEAD.size)
        _finite((step.t0, step.t1), "a time")
        n, bodies = step.nbody, len(self.assignment.bodies)
        if not step.t1 > step.t0 or step.nstep < 1 or n != bodies:
            raise ProtocolError("malformed STEP: from %g s to %g s in %d steps with %d bodies, of %d" %
                                (step.t0, step.t1, step.nstep, n, bodies))
        proxy = 24 * n + self._mobility_size(n, nfree) if flags & 1 else 0
        want = [nstate * 13, nstate * 13, n * nload * 6, nsample, 1 if flags & 2 else 0, nnode, nnode * n * 13, proxy]
        if nstate not in (0, n) or sum(want) != len(values):
            raise ProtocolError("malformed STEP: %d numbers, not %d" % (len(values), sum(want)))
        parts, at = [], 0
        for count in want:
            parts.append(_finite(values[at:at + count], "a number"))
            at += count
        for times in (parts[3], parts[5]):
            if any(b <= a for a, b in zip([step.t0, *times], times)) or (times and times[-1] > step.t1 + 1e-9 * (
                    step.t1 - step.t0) + 1e-15 * abs(step.t1)):
                raise ProtocolError("malformed STEP: times of samples or nodes are not in order, or not in it")
        step.window, step.interpolation = self._window, self.assignment.interpolation
        step.start, step.end = _rows(parts[0], 13), _rows(parts[1], 13)
        step.load = [_rows(parts[2][6 * nload * i:6 * nload * (i + 1)], 6) for i in range(n)]
        step.sample_time = list(parts[3])
        step.ahead = parts[4][0] if parts[4] else None
        step.nodes = [(t, _rows(parts[6][13 * n * k:13 * n * (k + 1)], 13)) for k, t in enumerate(parts[5])]
        step.seen = bool(flags & 4)
        step.proxy = {"acceleration": _rows(parts[7][:6 * n], 6), "load": _rows(parts[7][6 * n:12 * n], 6),
                      "correction": _rows(parts[7][12 * n:24 * n], 12), "nfree": nfree,
                      "mobility": list(parts[7][24 * n:])} if proxy else None
        return step

    @staticmethod
    def _mobility_size(n, f):
        k = 6 * n
        return k * k + 2 * f + 4 * k * f + 2 * f * f

    def result(self, step):
        """A Result for a step, with zeros of the right sizes: state (mbd) or load (dem) at t1, sample_state or
        sample_load at each output time, channel, and of ASSIGN's `results`: acceleration, interface (33 numbers a
        body), energy (4), matched_load (36 a body); mobility: (nfree, numbers in wire order)."""
        r, n, m = Result(), step.nbody, len(step.sample_time)
        mbd = self.role == "mbd"
        r.t, r.nsample = step.t1, m
        r.state = [[0.0] * 13 for _ in range(n if mbd else 0)]
        r.load = [[0.0] * 6 for _ in range(0 if mbd else n)]
        r.sample_state = [[[0.0] * 13 for _ in range(n)] for _ in range(m if mbd else 0)]
        r.sample_load = [[[0.0] * 6 for _ in range(n)] for _ in range(0 if mbd else m)]
        r.channel = [[0.0] * self._channels for _ in range(m)]
        asked = self.assignment.results
        r.acceleration = [[0.0] * 6 for _ in range(n)] if "acceleration" in asked else None
        r.interface = [[0.0] * 33 for _ in range(n)] if "interface" in asked else None
        r.energy = [0.0] * 4 if "energy" in asked else None
        r.matched_load = [[0.0] * 36 for _ in range(n)] if "matched_load" in asked else None
        r.mobility = (0, [0.0] * (36 * n * n)) if "mobility" in asked else None
        return r

    def advance(self, r):
        """Send the RESULT."""
        n, asked = len(self.assignment.bodies), self.assignment.results
        flags = sum(1 << k for k, name in enumerate(EXTRAS) if name in asked)
        nfree = r.mobility[0] if r.mobility else 0
        parts = [r.state, r.load, *r.sample_state, *r.sample_load, r.channel, r.acceleration or [], r.interface or [],
                 [r.energy or []], r.matched_load or [], [r.mobility[1] if r.mobility else []]]
        values = [float(x) for part in parts for row in part for x in row]
        head = RESULT_HEAD.pack(r.t, time.monotonic() - self._begin, n, len(r.state), 1 if self.role == "dem" else 0,
                                r.nsample, self._channels, flags, nfree)
        self._send_remarks()
        self._send(RESULT, head + struct.pack("<%dd" % len(values), *values))

    def alive(self):
        """To be called after every step of the solver's own: tells the server that it lives, at most twice a second."""
        if time.monotonic() - self._beat > HEARTBEAT_S:
            self._send(HEARTBEAT)

    # ---- the end ----

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        """FINISH is an end like any other; other exceptions go to the server as ERROR, and end the program with 1."""
        if kind is not None and kind is not _Finished and kind is not _Given:
            status, path = getattr(error, "status", "TDM_ERR_SYSTEM"), getattr(error, "path", "")
            text = str(error) if isinstance(error, ProtocolError) else "%s: %s" % (kind.__name__, error)
            self._send_remarks()
            self._send_json(ERROR, {"status": status, "path": path, "message": text})
            print(text, file=sys.stderr)
        self._socket.close()
        self._context.term()
        if kind is None or kind is _Finished:
            return True
        if issubclass(kind, (ProtocolError, _Given)):
            sys.exit(1)
        return False  # with its trace in the log


# ---- poses, as other codes speak of them ----


def translation(x, start):
    """How far a body has moved since the start ([L18] Eq. 15)."""
    return [a - b for a, b in zip(x, start)]


def degrees(radians):
    """Angles in degrees ([L18] Eq. 16)."""
    return [math.degrees(a) for a in radians]


def quaternion_to_matrix(q):
    """Rows of the matrix that turns body axes into world axes."""
    w, x, y, z = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]


def matrix_to_quaternion(m):
    """The unit quaternion of an orthonormal matrix, w >= 0."""
    squares = [1 + m[0][0] + m[1][1] + m[2][2], 1 + m[0][0] - m[1][1] - m[2][2], 1 - m[0][0] + m[1][1] - m[2][2],
               1 - m[0][0] - m[1][1] + m[2][2]]
    k = max(range(4), key=lambda i: squares[i])
    r = 2 * math.sqrt(squares[k])  # 4 times the largest entry
    sums = {(0, 1): m[2][1] - m[1][2], (0, 2): m[0][2] - m[2][0], (0, 3): m[1][0] - m[0][1],
            (1, 2): m[1][0] + m[0][1], (1, 3): m[0][2] + m[2][0], (2, 3): m[2][1] + m[1][2]}
    q = [r / 4 if i == k else sums[min(i, k), max(i, k)] / r for i in range(4)]
    return [-x for x in q] if q[0] < 0 else q


def euler313_to_matrix(phi, theta, psi):
    """Matrix of 3-1-3 Euler angles [rad]: about z by phi, about the new x by theta, about the new z by psi."""
    cf, sf, ct, st, cp, sp = (f(a) for a in (phi, theta, psi) for f in (math.cos, math.sin))
    return [[cf * cp - sf * ct * sp, -cf * sp - sf * ct * cp, sf * st],
            [sf * cp + cf * ct * sp, -sf * sp + cf * ct * cp, -cf * st],
            [st * sp, st * cp, ct]]


def matrix_to_euler313(m):
    """3-1-3 Euler angles [rad] of an orthonormal matrix, theta from 0 to pi; psi = 0 where phi and psi are one."""
    theta = math.acos(max(-1.0, min(1.0, m[2][2])))
    if math.hypot(m[0][2], m[1][2]) < 1e-12:
        return math.atan2(m[1][0], m[0][0]), theta, 0.0
    return math.atan2(m[0][2], -m[1][2]), theta, math.atan2(m[2][0], m[2][1])


def slerp(a, b, s):
    """The quaternion between two, the short way."""
    dot = sum(x * y for x, y in zip(a, b))
    b, dot = ([-x for x in b], -dot) if dot < 0 else (b, dot)
    angle = math.acos(min(1.0, dot))
    if angle < 1e-9:
        return list(a)
    u, v = math.sin((1 - s) * angle) / math.sin(angle), math.sin(s * angle) / math.sin(angle)
    return [u * x + v * y for x, y in zip(a, b)]

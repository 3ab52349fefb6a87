"""Runs of tandem-dem on ranks, for bench_ranks.py and bench_ranks_model.py: scenes, times, counted work, traces."""
# SPDX-License-Identifier: GPL-3.0-or-later
import contextlib
import hashlib
import json
import os
import pathlib
import signal
import subprocess
import sys

RADIUS, DT = 0.005, 2e-5  # [m], [s]
PRESSED = 0.9995  # distance of neighbours, in diameters
MPIRUN = ["mpirun", "--oversubscribe", "-n"]


def _block(count, corner, spacing, **more):
    entry = {"type": "block", "material": "grain", "radius": RADIUS, "count": count, "corner": corner}
    return {**entry, "spacing": spacing, **more}


def lattice(particles):
    """N spheres in layers, each overlapping its neighbours by a thousandth of a radius: three contacts a sphere"""
    across = max(2, round(particles ** (1 / 3)))
    spacing = 2 * RADIUS * PRESSED
    layers, side = -(-particles // across**2), across * spacing
    cells = ((k % across, k // across % across, k // across**2) for k in range(particles))
    places = [[round((c + 0.5) * spacing, 9) for c in cell] for cell in cells]
    entry = {"type": "list", "material": "grain", "radius": RADIUS, "positions": places}
    return [entry], [side, side, layers * spacing + 4 * RADIUS], ["+z"]


def packed(particles):
    """about N spheres in the densest packing: six contacts a sphere"""
    across = max(2, round((particles / 4) ** (1 / 3)))
    layers = max(1, round(particles / 4 / across**2))
    cell = 2 * RADIUS * PRESSED * 2**0.5
    entries = [
        _block([across, across, layers], [RADIUS + 0.5 * cell * x for x in at], cell)
        for at in ((0, 0, 0), (1, 1, 0), (1, 0, 1), (0, 1, 1))
    ]
    side = (across - 0.5) * cell + 2 * RADIUS
    return entries, [side, side, (layers - 0.5) * cell + 6 * RADIUS], ["+z"]


def flying(particles, velocity):
    """about N spheres that fly into a corner of a box: few contacts"""
    across = max(2, round(particles ** (1 / 3)))
    layers = max(1, round(particles / across**2))
    spacing = 2.2 * RADIUS
    entry = _block([across, across, layers], 3 * [0.6 * spacing], spacing, velocity=velocity)
    return [entry], [(n + 0.2) * spacing for n in (across, across, layers)], []


def thrown(particles):
    """lists are made often"""
    return flying(particles, [1.5, 2, -3])


def drifting(particles):
    """lists are made now and then"""
    return flying(particles, [0.3, 0.4, -0.6])


def falling(particles):
    """about N spheres in a block that falls into a corner, made by each rank from a few numbers"""
    across = max(2, round(particles ** (1 / 3)))
    size = 2 * RADIUS * across
    return (
        [_block(3 * [across], 3 * [RADIUS], 2 * RADIUS, velocity=[-0.3, -0.2, -0.5])],
        [size, size, size + 4 * RADIUS],
        ["+z"],
    )


KINDS = {"lattice": lattice, "packed": packed, "drifting": drifting, "thrown": thrown}


def scene(kind, particles, steps):
    entries, size, open_sides = {**KINDS, "falling": falling}[kind](particles)
    shape = {"type": "box", "side": "inside", "size": size, "center": [s / 2 for s in size], "open": open_sides}
    dem = {
        "materials": [{"name": "grain", "density": 2500, "young_modulus": 1e7, "poisson_ratio": 0.25}],
        "pairs": [{"materials": ["grain", "grain"], "restitution": 0.5, "friction": 0.4}],
        "bodies": [{"name": "box", "material": "grain", "shapes": [shape]}],
        "particles": entries,
    }
    return {"time": {"end": steps * DT, "dt": DT}, "output": {"interval": steps * DT}, "dem": dem}


def write(options, name, content):
    file = options.out / name
    file.write_text(json.dumps(content))
    return file


def call(command, log, folder=None, **more):
    """run a command, in this folder or here; peak memory of its largest process [bytes]. Exits with its words where it
    fails."""
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1", **more)
    command = [str(word) for word in command]
    with open(log, "w", encoding="utf-8") as file:
        process = subprocess.Popen(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=file, stderr=file
        )
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit status {process.returncode}\n{pathlib.Path(log).read_text()}")
    return 1024 * usage.ru_maxrss


def run(options, file, ranks=1, threads=1, mpi=False, trace=None, before=()):
    """summary.json of a run of tandem-dem, with its peak_bytes; mpi: that program for one rank, too; before: words
    before the command"""
    out = options.out / "run"
    mpi = mpi or ranks > 1 or trace
    command = [options.bin / ("tandem-dem-mpi" if mpi else "tandem-dem"), "run", file, "--out", out, "--force"]
    command += ["--no-plots", "--set", f"dem.threads={threads}"]
    if mpi:
        command = MPIRUN + [ranks] + command
    more = {"TANDEM_RANKS_TRACE": str(trace)} if trace else {}
    peak = call([*before, *command], options.out / "log", **more)
    summary = json.loads((out / "summary.json").read_text())
    summary["peak_bytes"] = peak
    return summary


@contextlib.contextmanager
def beside(options, file):
    """the same on one process, again and again, as long as this lasts"""
    command = [options.bin / "tandem-dem", "run", file, "--out", options.out / "beside", "--force", "--no-plots"]
    loop = ["sh", "-c", 'while kill -0 $PPID && "$@"; do :; done', "sh", *(str(word) for word in command)]
    process = subprocess.Popen(loop, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        yield
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def build(options):
    """which program runs: its version, its bytes, and the commit where this is a checkout of it"""
    program = options.bin / "tandem-dem-mpi"
    words = subprocess.run([options.bin / "tandem-dem", "--version"], capture_output=True, text=True, check=True)
    git = ["git", "-C", pathlib.Path(__file__).parent, "describe", "--always", "--dirty"]
    commit = subprocess.run(git, capture_output=True, text=True, check=False)
    digest = hashlib.sha256(program.read_bytes()).hexdigest()[:12]
    return {"version": words.stdout.strip(), "commit": commit.stdout.strip(), "program": digest}


def sums(trace, ranks):
    """of each rank: times of computing, exchanging, waiting, and processor time of computing [s]"""
    found = []
    for rank in range(ranks):
        with open(f"{trace}.{rank}", encoding="utf-8") as file:
            found.append([float(x) for x in file.readlines()[-1].split(",")[1:]])
    return found


def spans(trace, ranks):
    """of each rank: what it did, (begin, end, what, bytes) [s]"""
    found = []
    for rank in range(ranks):
        with open(f"{trace}.{rank}", encoding="utf-8") as file:
            rows = (line.strip().split(",") for line in file.readlines()[1:-1])
            found.append([(float(b), float(e), what, float(n)) for b, e, what, n in rows])
    return found


def gnuplot(text):
    subprocess.run(["gnuplot"], input=text, text=True, check=True)


def numbers(text):
    return [int(float(x)) for x in text.split(",")]


def prepare(options):
    """the folder of results; exits where the program is not built"""
    if not (options.bin / "tandem-dem-mpi").exists():
        sys.exit(f"{options.bin}/tandem-dem-mpi is not there: install libopenmpi-dev and build again")
    options.out.mkdir(parents=True, exist_ok=True)
    options.out = options.out.resolve()

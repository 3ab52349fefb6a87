"""tandem-dem and LIGGGHTS on the same bed, on one core and on two, for bench_ranks.py --liggghts.

All of a round run one after the other, the next round in the opposite order; what is compared is compared in each
round, and of the rounds the median counts.
"""
# SPDX-License-Identifier: GPL-3.0-or-later
import os
import pathlib
import shutil
import statistics
import sys

from ranks import runs

INPUT = pathlib.Path(__file__).parent.parent / "peers/liggghts.in"
DT, SKIN, TILES = 8.6e-5, 5e-4, (5, 2)  # [s], [m]; beds side by side that make a bed of ten times as many particles
CORE, CORES = ["taskset", "-c", "0"], ["taskset", "-c", "0,1"]


def read_bed(options, particles):
    """positions of a settled bed of spheres of 5 mm, from a file, or made and kept by tandem-dem bench"""
    file = options.bed
    if not file:
        cache = options.out / "beds"
        command = [options.bin / "tandem-dem", "bench", "--particles", particles, "--radius", runs.RADIUS, "--steps", 1]
        runs.call(command, options.out / "log", XDG_CACHE_HOME=str(cache))
        file = next(cache.glob(f"tandem/bed_{particles}_*.txt"))
    rows = (line.split("#")[0].split() for line in pathlib.Path(file).read_text().splitlines())
    return [[float(x) for x in row[:3]] for row in rows if row]


def side_of(places):
    return float(f"{max(max(p[0], p[1]) for p in places) + runs.RADIUS:.4g}")


def beside(places, side):
    """so many beds side by side, every other one mirrored, so that spheres at a border face each other"""
    found = []
    for k in range(TILES[0]):
        for m in range(TILES[1]):
            for x, y, z in places:
                found.append([k * side + (side - x if k % 2 else x), m * side + (side - y if m % 2 else y), z])
    return found


def bed(options, particles):
    """positions, and the two sides of the floor [m]"""
    wide = particles >= 1e6
    places = read_bed(options, particles // 10 if wide else particles)
    side = side_of(places)
    if wide:
        return beside(places, side), (TILES[0] * side, TILES[1] * side)
    return places, (side, side)


def scene(places, floor, steps):
    size = [*floor, 1000]
    shape = {"type": "box", "side": "inside", "size": size, "center": [x / 2 for x in size], "open": ["+z"]}
    dem = {
        "gravity": [0, 0, -9.81],
        "materials": [{"name": "grain", "density": 2500, "young_modulus": 1e7, "poisson_ratio": 0.3}],
        "pairs": [{"materials": ["grain", "grain"], "restitution": 0.5, "friction": 0.5}],
        "bodies": [{"name": "box", "material": "grain", "shapes": [shape]}],
        "particles": [{"type": "list", "material": "grain", "radius": runs.RADIUS, "positions": places}],
    }
    return {"time": {"end": steps * DT, "dt": DT}, "output": {"interval": steps * DT}, "dem": dem}


def write_data(file, places, floor):
    """the bed as LIGGGHTS reads it"""
    height = max(p[2] for p in places) + 0.03
    with open(file, "w", encoding="utf-8") as out:
        out.write(f"bed\n\n{len(places)} atoms\n1 atom types\n\n0 {floor[0]} xlo xhi\n0 {floor[1]} ylo yhi\n")
        out.write(f"0 {height:.6f} zlo zhi\n\nAtoms\n\n")
        for k, (x, y, z) in enumerate(places, 1):
            out.write(f"{k} 1 {2 * runs.RADIUS:.9g} 2500 {x:.9g} {y:.9g} {z:.9g}\n")


def liggghts(options, data, floor, steps, ranks):
    """time of the steps [s]; walls at the two sides, with the input that peers.sh has. It runs in the folder of results,
    where it leaves files (restart_forced_*) when it is killed."""
    text = INPUT.read_text().replace("yplane ${L}", "yplane ${B}")
    (options.out / "liggghts.in").write_text(text)
    log = options.out / "liggghts.log"
    command = ["liggghts", "-in", options.out / "liggghts.in", "-log", log, "-screen", "none"]
    values = {"bed": data, "dt": DT, "steps": steps, "warm": steps // 10, "skin": SKIN, "L": floor[0], "B": floor[1]}
    for name, value in values.items():
        command += ["-var", name, value]
    if ranks > 1:
        command = runs.MPIRUN + [ranks] + command
    runs.call((CORES if ranks > 1 else CORE) + command, options.out / "log", folder=options.out)
    return float([line for line in log.read_text().splitlines() if line.startswith("Loop time")][-1].split()[3])


def kinds(options, file, data, floor, steps):
    """name -> a run that returns its time [s]"""
    def ours(before, **how):
        return lambda: runs.run(options, file, before=before, **how)["wall_s"]["dem"]

    return {
        "tandem": ours(CORE),
        "tandem, MPI build, 1 rank": ours(CORE, mpi=True),
        "tandem, 2 threads": ours(CORES, threads=2),
        "tandem, 2 ranks": ours(CORES, ranks=2),
        "LIGGGHTS": lambda: liggghts(options, data, floor, steps, 1),
        "LIGGGHTS, 2 ranks": lambda: liggghts(options, data, floor, steps, 2),
    }


def table(times, particles):
    """the rows of issue and README: medians of what is compared within a round"""
    one, build, threads, ranks, peer, peers = times.values()

    def median(*factors):  # of a/b, or (a/b)/(c/d)
        return statistics.median(
            a / b if not rest else a / b / (rest[0] / rest[1]) for a, b, *rest in zip(*factors)
        )

    top, ceiling = f"{particles} particles: ", median(peer, peers)
    print(f"| {top}medians of {len(one)} rounds | measured | goal |\n| --- | --- | --- |")
    print(f"| 2 ranks against LIGGGHTS on 2 ranks | {median(peers, ranks):.2f} | at least 3 |")
    print(f"| 1 core against LIGGGHTS on one | {median(peer, one):.2f} | |")
    print(f"| 2 ranks of LIGGGHTS against 1: the machine's ceiling | {ceiling:.2f} | |")
    for name, t in (("ranks", ranks), ("threads", threads)):
        goal = "at least 1.75 where LIGGGHTS gets that" if name == "ranks" else "as LIGGGHTS or better"
        print(f"| 2 {name} against 1 | {median(one, t):.2f} | {goal} |")
        print(f"| the same, as a share of LIGGGHTS's ratio | {median(one, t, peer, peers):.2f} | at least 1 |")
    print(f"| 1 rank of the MPI build against the plain build, time | {median(build, one):.3f} | at most 1.02 |\n")


def compare(options):
    """for each number of particles: rounds, times, the table"""
    if not shutil.which("liggghts"):
        sys.exit("liggghts is not there: install the package liggghts")
    if len(os.sched_getaffinity(0)) < 2:
        sys.exit("two cores are wanted")
    for particles in options.particles:
        places, floor = bed(options, particles)
        steps = options.steps or max(300, round(1e8 / particles))
        file = runs.write(options, f"bed-{particles}.json", scene(places, floor, steps))
        data = options.out / f"bed-{particles}.data"
        write_data(data, places, floor)
        todo = kinds(options, file, data, floor, steps)
        times = {name: [] for name in todo}
        for k in range(options.repeat):
            for name in list(todo)[:: -1 if k % 2 else 1]:
                times[name].append(todo[name]())
                print(f"round {k + 1}: {name}: {times[name][-1]:.3f} s", file=sys.stderr, flush=True)
        print(f"{len(places)} particles, {steps} steps: million particle-steps a second, and each time [s]")
        for name, t in times.items():
            speed = 1e-6 * len(places) * steps / statistics.median(t)
            print(f"  {name:26s} {speed:7.2f}   {'  '.join(f'{x:.3f}' for x in t)}")
        print()
        table(times, len(places))

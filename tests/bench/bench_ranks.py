#!/usr/bin/env python3
"""tandem-dem on ranks: the tables and pictures of [A07] Chapter 3.

usage: tests/bench/bench_ranks.py [--bin DIR] [--out DIR] [--particles N,N,...] [--ranks P,P,...] [--repeat K]
       tests/bench/bench_ranks.py --memory N [--ranks P,P,...] [--steps K] [--bin DIR] [--out DIR]

A lattice of spheres in a box, pressed a little, for so many steps that a run takes seconds. Prints for each number of
particles and ranks the time of the steps t, speed-up tau = t_1/t, efficiency eta = tau/P, normalised cost nu = P t/t_1
and overhead nu - 1 ([A07] Eq. 3.22 to 3.24), [A07]'s speed-up on several machines beside them, which share of its time
a rank computes, exchanges and waits (least and most of all ranks, from one more run that measures that), and the
largest processor time that any rank computes, which other programs do not disturb: that of one rank divided by it is
the speed-up without exchanges. 1 rank: tandem-dem without MPI. Times are medians. Draws speedup.svg, efficiency.svg,
cost.svg (Fig. 3.13 to 3.15) and, of the most ranks, trace-N.svg (Fig. 3.16) with gnuplot.

--memory N [--ranks P,P,...] [--steps K]: instead, the peak memory of each rank with N particles that fall, beside the
share: what one process takes, divided by P. What a program takes with a thousand particles is subtracted first. More
than 1000 steps have a renewal of the order in them.
"""
# SPDX-License-Identifier: GPL-3.0-or-later
import argparse
import csv
import json
import os
import pathlib
import statistics
import subprocess
import sys

PUBLISHED = pathlib.Path(__file__).parent.parent / "reference/dem/alkhaldi_2007_speedup.csv"
RADIUS, DT, WORK = 0.005, 2e-5, 6e6  # [m], [s], particle-steps of a run


def scene(particles):
    """N spheres in layers, each overlapping its neighbours by a thousandth of a radius"""
    across = max(2, round(particles ** (1 / 3)))
    spacing = 2 * RADIUS * 0.9995
    layers = -(-particles // across**2)
    size = [across * spacing, across * spacing, layers * spacing + 4 * RADIUS]
    places = [
        [(k % across + 0.5) * spacing, (k // across % across + 0.5) * spacing, (k // across**2 + 0.5) * spacing]
        for k in range(particles)
    ]
    steps = max(100, round(WORK / particles))
    shape = {"type": "box", "side": "inside", "size": size, "center": [s / 2 for s in size], "open": ["+z"]}
    entry = {"type": "list", "material": "grain", "radius": RADIUS, "positions": places}
    dem = {
        "materials": [{"name": "grain", "density": 2500, "young_modulus": 1e7, "poisson_ratio": 0.25}],
        "pairs": [{"materials": ["grain", "grain"], "restitution": 0.5, "friction": 0.4}],
        "bodies": [{"name": "box", "material": "grain", "shapes": [shape]}],
        "particles": [entry],
    }
    return {"time": {"end": steps * DT, "dt": DT}, "output": {"interval": steps * DT}, "dem": dem}


def run(options, file, ranks, trace=None):
    """time of the steps [s]"""
    out = options.out / "run"
    command = [str(options.bin / "tandem-dem"), "run", str(file), "--out", str(out), "--force", "--no-plots"]
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    if trace:
        environment["TANDEM_RANKS_TRACE"] = str(trace)
    if trace:
        command[0] += "-mpi"
    if trace or ranks > 1:
        command = ["mpirun", "--oversubscribe", "-n", str(ranks)] + command
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return json.loads((out / "summary.json").read_text())["wall_s"]["dem"]


# run a command; how much memory it took at most [kB] goes to a file, of each rank
PEAK = """import os, subprocess, sys
child = subprocess.Popen(sys.argv[2:])
_, status, usage = os.wait4(child.pid, 0)
open(sys.argv[1] + "." + os.environ.get("OMPI_COMM_WORLD_RANK", "0"), "w").write(str(usage.ru_maxrss))
sys.exit(os.waitstatus_to_exitcode(status))
"""


def falling(particles, steps):
    """a block of spheres that falls into a corner, made by each rank from a few numbers"""
    across = max(2, round(particles ** (1 / 3)))
    size = [2 * RADIUS * across, 2 * RADIUS * across, 2 * RADIUS * across + 4 * RADIUS]
    made = scene(8)
    made["time"]["end"] = made["output"]["interval"] = steps * DT
    made["dem"]["bodies"][0]["shapes"][0].update(size=size, center=[s / 2 for s in size])
    made["dem"]["particles"] = [
        {"type": "block", "material": "grain", "radius": RADIUS, "count": [across] * 3, "corner": [RADIUS] * 3}
        | {"spacing": 2 * RADIUS, "velocity": [-0.3, -0.2, -0.5]}
    ]
    return made


def peaks(options, particles, ranks):
    """most memory of each rank [MB]"""
    file, peak = options.out / "memory.json", options.out / "peak"
    file.write_text(json.dumps(falling(particles, options.steps)))
    command = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks > 1 else []
    command += [sys.executable, "-c", PEAK, str(peak), str(options.bin / "tandem-dem-mpi"), "run", str(file)]
    command += ["--out", str(options.out / "run"), "--force", "--no-plots"]
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return [int(pathlib.Path(f"{peak}.{rank}").read_text()) / 1024 for rank in range(ranks)]


def memory(options):
    whole = peaks(options, options.memory, 1)[0] - peaks(options, 1000, 1)[0]
    print(f"one process: {whole:.1f} MB for {options.memory} particles, besides the program")
    for ranks in options.ranks:
        program = peaks(options, 1000, ranks)
        parts = [(peak - own) * ranks / whole for peak, own in zip(peaks(options, options.memory, ranks), program)]
        print(
            f"{ranks} ranks: the program {min(program):.1f} ... {max(program):.1f} MB; peak memory in shares "
            f"({whole / ranks:.1f} MB): " + " ".join(f"{share:.2f}" for share in parts),
            flush=True,
        )


def shares(trace, ranks):
    """of compute, exchange, wait: least and most of all ranks [%]; most processor time of computing [s]"""
    found = []
    for rank in range(ranks):
        with open(f"{trace}.{rank}", encoding="utf-8") as file:
            sums = [float(x) for x in file.readlines()[-1].split(",")[1:]]
        found.append([100 * x / sum(sums[:3]) for x in sums[:3]] + [sums[3]])
    *parts, work = zip(*found)
    return [(min(s), max(s)) for s in parts], max(work)


def published():
    """[A07]'s speed-ups on several machines by (particles, ranks)"""
    with open(PUBLISHED, encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {
            (int(r["particles"]), int(r["processes"])): float(r["speedup"]) for r in rows if r["machines"] == "several"
        }


def measure(options):
    """rows (particles, ranks, time, speed-up)"""
    theirs = published()
    rows = []
    print("particles  P     t [s]    tau    eta     nu   nu-1  [A07] tau  compute %    exchange %   wait %       work [s]")
    for particles in options.particles:
        file = options.out / f"scene-{particles}.json"
        file.write_text(json.dumps(scene(particles)))
        first = None
        for ranks in options.ranks:
            t = statistics.median(run(options, file, ranks) for _ in range(options.repeat))
            first = first or t
            tau = first / t
            rows.append((particles, ranks, t, tau))
            trace = options.out / f"trace-{particles}-{ranks}"
            run(options, file, ranks, trace)
            parts, work = shares(trace, ranks)
            text = "  ".join(f"{low:4.1f} … {high:4.1f}" for low, high in parts) + f"  {work:8.3f}"
            their = theirs.get((particles, ranks))
            print(
                f"{particles:9d} {ranks:2d} {t:9.3f} {tau:6.2f} {tau / ranks:6.2f} {ranks / tau:6.2f} "
                f"{ranks / tau - 1:6.2f}  {'' if their is None else their:>9}  {text}",
                flush=True,
            )
    return rows


def gnuplot(text):
    subprocess.run(["gnuplot"], input=text, text=True, check=True)


def draw_curves(options, rows):
    """Fig. 3.13 to 3.15: speed-up, efficiency and normalised cost over ranks"""
    data = options.out / "ranks.csv"
    with open(data, "w", encoding="utf-8") as file:
        for particles in options.particles:
            for n, ranks, _, tau in rows:
                if n == particles:
                    file.write(f"{ranks} {tau} {tau / ranks} {ranks / tau}\n")
            file.write("\n\n")
    for column, name, label, ideal in ((2, "speedup", "τ", "x"), (3, "efficiency", "η", "1"), (4, "cost", "ν", "1")):
        curves = [
            f"'{data}' index {k} using 1:{column} with linespoints title '{n} particles'"
            for k, n in enumerate(options.particles)
        ]
        gnuplot(
            f"set terminal svg size 640,480\nset output '{options.out / name}.svg'\nset key left top\n"
            f"set xlabel 'ranks P'\nset ylabel '{label}'\nset yrange [0:*]\n"
            f"plot [0:*] {ideal} dashtype 2 linecolor 'gray' title 'ideal', " + ", ".join(curves)
        )


def draw_trace(options, particles, ranks):
    """Fig. 3.16: what each rank does in a few steps in the middle of the run"""
    colors = {"compute": "0x2e8b57", "exchange": "0xe0b000", "wait": "0xf0f0f0"}
    bars = options.out / "bars.txt"
    rows = []
    for rank in range(ranks):
        with open(options.out / f"trace-{particles}-{ranks}.{rank}", encoding="utf-8") as file:
            rows.append([(float(b), float(e), w) for b, e, w in (line.split(",") for line in file.readlines()[1:-1])])
    middle = rows[0][len(rows[0]) // 2][0]
    length = rows[0][min(len(rows[0]) // 2 + 60, len(rows[0]) - 1)][1] - middle
    with open(bars, "w", encoding="utf-8") as file:
        for rank, spans in enumerate(rows):
            for begin, end, what in spans:
                if end > middle and begin < middle + length:
                    file.write(f"{begin - middle} {end - middle} {rank} {colors[what.strip()]}\n")
    gnuplot(
        f"set terminal svg size 900,{120 + 60 * ranks}\nset output '{options.out}/trace-{particles}.svg'\nunset key\n"
        f"set title '{particles} particles: computing (green), exchanging (yellow), waiting (white)'\n"
        f"set xlabel 'time [ms]'\nset ylabel 'rank'\nset ytics 1\nset yrange [{ranks - 0.5}:-0.5]\n"
        f"set xrange [0:{1e3 * length}]\n"
        f"plot '{bars}' using (1e3*$1):3:(1e3*$1):(1e3*$2):($3-0.4):($3+0.4):4 with boxxyerror "
        "fillstyle solid 1 border linecolor 'gray' linecolor rgb variable"
    )


def numbers(text):
    return [int(float(x)) for x in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default="build/release/bin")
    parser.add_argument("--out", type=pathlib.Path, default="ranks-out")
    parser.add_argument("--particles", type=numbers, default=[916, 9000, 14884, 144400])
    parser.add_argument("--ranks", type=numbers, default=[1, 2])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--memory", type=lambda text: int(float(text)))
    parser.add_argument("--steps", type=int, default=100)
    options = parser.parse_args()
    if not (options.bin / "tandem-dem-mpi").exists():
        sys.exit(f"{options.bin}/tandem-dem-mpi is not there: install libopenmpi-dev and build again")
    options.out.mkdir(parents=True, exist_ok=True)
    options.out = options.out.resolve()
    if options.memory:
        memory(options)
        return
    rows = measure(options)
    draw_curves(options, rows)
    most = max(options.ranks)
    for particles in options.particles if most > 1 else []:
        draw_trace(options, particles, most)


main()

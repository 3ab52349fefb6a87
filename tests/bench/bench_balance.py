#!/usr/bin/env python3
"""tandem-dem on ranks: a heap that moves from one end of a box to the other, with and without balance.

usage: tests/bench/bench_balance.py [--bin DIR] [--out DIR] [--particles N] [--ranks P,P,...] [--every STEPS]

A block of spheres at one end slides to the other end and piles up there. Prints by how much the busiest rank worked
longer than the mean (summary.json, ranks.imbalance), how often homes moved, and the time of the steps, for slices
across the box and for the curve; then whether all runs gave the same time histories.
"""
# SPDX-License-Identifier: GPL-3.0-or-later
import argparse
import json
import os
import pathlib
import subprocess
import sys

RADIUS, DT = 0.005, 8e-5  # [m], [s]
WIDTH, HEIGHT = 25, 40  # of the block, in particles
LONGER = 4  # the box, in lengths of the block
SPEED, PULL = 2.0, (8.0, 0.0, -6.0)  # at the start [m/s]; gravity [m/s2]


def scene(particles):
    spacing = 2.02 * RADIUS
    layer = WIDTH * HEIGHT
    length = -(-particles // layer) * spacing
    places = [
        [(k // layer + 0.5) * spacing, (k % WIDTH + 0.5) * spacing, (k // WIDTH % HEIGHT + 0.5) * spacing]
        for k in range(particles)
    ]
    size = [LONGER * length, WIDTH * spacing, 2 * HEIGHT * spacing]
    way, pull = size[0] - length, PULL[0] + 0.2 * PULL[2]
    time = (-SPEED + (SPEED**2 + 2 * pull * way) ** 0.5) / pull  # until the block's front would be at the far end
    steps = round(1.5 * time / DT)
    shape = {"type": "box", "side": "inside", "size": size, "center": [s / 2 for s in size], "open": ["+z"]}
    entry = {"type": "list", "material": "grain", "radius": RADIUS, "positions": places, "velocity": [SPEED, 0, 0]}
    dem = {
        "gravity": PULL,
        "materials": [{"name": "grain", "density": 2500, "young_modulus": 1e7, "poisson_ratio": 0.3}],
        "pairs": [{"materials": ["grain", "grain"], "restitution": 0.5, "friction": 0.2}],
        "bodies": [{"name": "box", "material": "grain", "shapes": [shape]}],
        "particles": [entry],
    }
    return {"time": {"end": steps * DT, "dt": DT}, "output": {"interval": steps * DT / 10}, "dem": dem}


def run(options, file, ranks, decomposition):
    """summary.json and the time histories of a run"""
    out = options.out / "run"
    command = [str(options.bin / "tandem-dem"), "run", str(file), "--out", str(out), "--force", "--no-plots"]
    command += ["--set", "dem.decomposition=" + json.dumps(decomposition)]
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    if ranks > 1:
        command = ["mpirun", "--oversubscribe", "-n", str(ranks)] + command
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    return json.loads((out / "summary.json").read_text()), (out / "channels.csv").read_bytes()


def main():
    root = pathlib.Path(__file__).resolve().parent.parent.parent
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--bin", type=pathlib.Path, default=root / "build/release/bin")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("bench-balance"))
    parser.add_argument("--particles", type=int, default=60000)
    parser.add_argument("--ranks", default="2")
    parser.add_argument("--every", type=int, default=500, help="steps between looks of the balance")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    file = options.out / "heap.json"
    file.write_text(json.dumps(scene(options.particles)))
    print(f"{options.particles} particles\nranks  order   balance  imbalance  moves  time [s]")
    same = True
    for order in ({"order": "slices", "axis": "x"}, {"order": "curve"}):
        first = None
        for ranks in [int(p) for p in options.ranks.split(",")]:
            for balance in (None, {"every": options.every, "tolerance": 0.05}):
                summary, histories = run(options, file, ranks, dict(order, **({"balance": balance} if balance else {})))
                first = first or histories
                same = same and histories == first
                of = summary["ranks"]
                print(
                    f"{ranks:5d}  {order['order']:6s}  {'yes' if balance else 'no':7s}  {100 * of['imbalance']:7.1f} %"
                    f"  {of['moves']:5d}  {summary['wall_s']['dem']:8.2f}",
                    flush=True,
                )
    print("the time histories of each order are the same" if same else "TIME HISTORIES DIFFER")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())

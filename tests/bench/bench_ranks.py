#!/usr/bin/env python3
"""tandem-dem on ranks: the tables and pictures of [A07] Chapter 3, and the same bed in LIGGGHTS.

usage: tests/bench/bench_ranks.py [--bin DIR] [--out DIR] [--particles N,N,...] [--million] [--ranks P,P,...]
                                  [--repeat K] [--liggghts [--bed FILE] [--steps N]]
       tests/bench/bench_ranks.py --memory N [--frames] [--ranks P,P,...] [--steps K] [--bin DIR] [--out DIR]

A lattice of spheres in a box, pressed a little, for so many steps that a run takes seconds. Prints for each number of
particles and ranks the time of the steps t, speed-up tau = t_1/t, efficiency eta = tau/P, normalised cost nu = P t/t_1
and overhead nu - 1 ([A07] Eq. 3.22 to 3.24), [A07]'s speed-up on several machines beside them, which share of its time
each rank computes, exchanges and waits (from one more run that measures that), and the largest processor time that any
rank computes, which other programs do not disturb: that of one rank divided by it is the speed-up without exchanges. 1
rank: tandem-dem without MPI. Times are medians. Draws time.svg, speedup.svg, efficiency.svg, cost.svg and sizes.svg
(Fig. 3.13 to 3.15) and, of the most ranks, trace-N.svg (Fig. 3.16) with gnuplot. --million: 1e6 particles, too.

--liggghts: instead of that, a settled bed (of FILE, lines "x y z r", or made and kept in the folder of results) on one
core and on two: one process, the MPI build on 1 rank, 2 threads, 2 ranks, LIGGGHTS on 1 and 2 ranks, one after the
other in each of K rounds, with what is compared in the words of the goals. Of 1e6 particles: ten beds of 100 000.

--memory N [--frames] [--ranks P,P,...] [--steps K]: instead, the peak memory of each rank with N particles that fall,
beside the share: what one process takes, divided by P. What a program takes with a thousand particles is subtracted
first. More than 1000 steps have a renewal of the order in them. --frames: with frames of the start, the middle and the
end.
"""
# SPDX-License-Identifier: GPL-3.0-or-later
import argparse
import csv
import pathlib
import statistics

from ranks import memory, peers, runs

PUBLISHED = pathlib.Path(__file__).parent.parent / "reference/dem/alkhaldi_2007_speedup.csv"
WORK = 6e6  # particle-steps of a run
WHAT = ("compute", "exchange", "wait")


def shares(trace, ranks):
    """of compute, exchange, wait: of each rank [%]; most processor time of computing [s]"""
    sums = runs.sums(trace, ranks)
    return [[100 * s[k] / sum(s[:3]) for s in sums] for k in range(3)], max(s[3] for s in sums)


def published():
    """[A07]'s speed-ups on several machines by (particles, ranks)"""
    with open(PUBLISHED, encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {
            (int(r["particles"]), int(r["processes"])): float(r["speedup"]) for r in rows if r["machines"] == "several"
        }


def print_row(particles, ranks, times, their, parts, work):
    t, tau = times
    text = "  ".join(f"{name} " + " ".join(f"{x:.1f}" for x in part) for name, part in zip(WHAT, parts))
    print(
        f"{particles:9d} {ranks:2d} {t:9.3f} {tau:6.2f} {tau / ranks:6.2f} {ranks / tau:6.2f} {ranks / tau - 1:6.2f}  "
        f"{'' if their is None else their:>9} {work:9.3f}  {text}",
        flush=True,
    )


def measure(options):
    """rows (particles, ranks, time, speed-up)"""
    theirs = published()
    rows = []
    print("particles  P     t [s]    tau    eta     nu   nu-1  [A07] tau  work [s]  shares of rank 0, 1, ... [%]")
    for particles in options.particles:
        steps = max(100, round(WORK / particles))
        file = runs.write(options, f"scene-{particles}.json", runs.scene("lattice", particles, steps))
        first = None
        for ranks in options.ranks:
            t = statistics.median(runs.run(options, file, ranks)["wall_s"]["dem"] for _ in range(options.repeat))
            first = first or t
            rows.append((particles, ranks, t, first / t))
            trace = options.out / f"trace-{particles}-{ranks}"
            runs.run(options, file, ranks, trace=trace)
            print_row(particles, ranks, rows[-1][2:], theirs.get((particles, ranks)), *shares(trace, ranks))
    return rows


def draw_curves(options, rows):
    """Fig. 3.13 to 3.15: time, speed-up, efficiency and normalised cost over ranks"""
    data = options.out / "ranks.csv"
    with open(data, "w", encoding="utf-8") as file:
        for particles in options.particles:
            for n, ranks, t, tau in rows:
                if n == particles:
                    file.write(f"{ranks} {t} {tau} {tau / ranks} {ranks / tau}\n")
            file.write("\n\n")
    names = (("time", "t [s]", None), ("speedup", "τ", "x"), ("efficiency", "η", "1"), ("cost", "ν", "1"))
    for column, (name, label, ideal) in enumerate(names, 2):
        curves = [f"{ideal} dashtype 2 linecolor 'gray' title 'ideal'"] if ideal else []
        curves += [
            f"'{data}' index {k} using 1:{column} with linespoints title '{n} particles'"
            for k, n in enumerate(options.particles)
        ]
        scale = "set yrange [0:*]" if ideal else "set logscale y"
        runs.gnuplot(
            f"set terminal svg size 640,480\nset output '{options.out / name}.svg'\nset key left top\n"
            f"set xtics 1\nset xlabel 'ranks P'\nset ylabel '{label}'\n{scale}\nplot [0:*] " + ", ".join(curves)
        )


def draw_sizes(options, rows):
    """Fig. 3.15a: speed-up over the number of particles"""
    data = options.out / "sizes.csv"
    with open(data, "w", encoding="utf-8") as file:
        for ranks in options.ranks:
            file.writelines(f"{n} {tau}\n" for n, p, _, tau in rows if p == ranks)
            file.write("\n\n")
    curves = [f"'{data}' index {k} with linespoints title 'P = {p}'" for k, p in enumerate(options.ranks)]
    runs.gnuplot(
        f"set terminal svg size 640,480\nset output '{options.out}/sizes.svg'\nset key left top\nset logscale x\n"
        "set xlabel 'particles N'\nset ylabel 'τ'\nset yrange [0:*]\nplot " + ", ".join(curves)
    )


def draw_trace(options, particles, ranks):
    """Fig. 3.16: what each rank does in a few steps in the middle of the run"""
    colors = {"compute": "0x2e8b57", "exchange": "0xe0b000", "wait": "0xf0f0f0"}
    bars = options.out / "bars.txt"
    rows = runs.spans(options.out / f"trace-{particles}-{ranks}", ranks)
    middle = rows[0][len(rows[0]) // 2][0]
    length = rows[0][min(len(rows[0]) // 2 + 60, len(rows[0]) - 1)][1] - middle
    with open(bars, "w", encoding="utf-8") as file:
        for rank, spans in enumerate(rows):
            for begin, end, what, _ in spans:
                if end > middle and begin < middle + length:
                    file.write(f"{begin - middle} {end - middle} {rank} {colors[what]}\n")
    runs.gnuplot(
        f"set terminal svg size 900,{120 + 60 * ranks}\nset output '{options.out}/trace-{particles}.svg'\nunset key\n"
        f"set title '{particles} particles: computing (green), exchanging (yellow), waiting (white)'\n"
        f"set xlabel 'time [ms]'\nset ylabel 'rank'\nset ytics 1\nset yrange [{ranks - 0.5}:-0.5]\n"
        f"set xrange [0:{1e3 * length}]\n"
        f"plot '{bars}' using (1e3*$1):3:(1e3*$1):(1e3*$2):($3-0.4):($3+0.4):4 with boxxyerror "
        "fillstyle solid 1 border linecolor 'gray' linecolor rgb variable"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default="build/release/bin")
    parser.add_argument("--out", type=pathlib.Path, default="ranks-out")
    parser.add_argument("--particles", type=runs.numbers)
    parser.add_argument("--million", action="store_true")
    parser.add_argument("--ranks", type=runs.numbers, default=[1, 2])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--liggghts", action="store_true")
    parser.add_argument("--bed", type=pathlib.Path)
    parser.add_argument("--steps", type=int)
    parser.add_argument("--memory", type=lambda text: int(float(text)))
    parser.add_argument("--frames", action="store_true")
    options = parser.parse_args()
    options.particles = options.particles or ([100000] if options.liggghts else [916, 9000, 14884, 144400])
    options.ranks = options.ranks if options.memory else sorted({1, *options.ranks})
    options.particles += [1000000] if options.million else []
    runs.prepare(options)
    if options.memory:
        memory.measure(options)
        return
    if options.liggghts:
        peers.compare(options)
        return
    rows = measure(options)
    draw_curves(options, rows)
    draw_sizes(options, rows)
    most = max(options.ranks)
    for particles in options.particles if most > 1 else []:
        draw_trace(options, particles, most)


main()

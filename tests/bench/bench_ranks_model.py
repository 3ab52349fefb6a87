#!/usr/bin/env python3
"""What a step of tandem-dem costs a rank, and on paper what it would take on many: docs/ranks-model.md.

usage: tests/bench/bench_ranks_model.py [--bin DIR] [--out DIR] [--particles N,N,...] [--ranks P,P,...] [--repeat K]
                                        [--points FILE,FILE,...] [--latency S] [--bandwidth BYTES/S]

Runs four scenes (a pressed lattice, the densest packing, spheres that drift or are thrown into a corner) of each number
of particles on each number of ranks, twice: the steps that the longer run has more are without the start, and have one
new order of the particles in the lattice, else none. Of each rank it takes the processor time outside of exchanges
(least of K runs), so that more ranks than cores do no harm, and the counted work (docs/ranks.md); one rank runs beside
another run, so that all cores are busy as with several. Costs are fitted to that by non-negative least squares; each
point is left out once, and predicted from the others. Then strong and weak scaling to 10 000 ranks, with a network that
is assumed, and pictures. --points: the points of earlier runs of the same build (points.json) instead of new ones, the
least processor times of all.
"""
# SPDX-License-Identifier: GPL-3.0-or-later
import argparse
import contextlib
import json
import pathlib
import statistics
import sys

from ranks import fit, predict, runs

STEPS = {"lattice": (200, 1200), "packed": (100, 500), "drifting": (100, 500), "thrown": (100, 500)}
ORDER = 1000  # steps after which particles come in a new order; as DEM_SORT_STEPS (dem/state/data.h)
RANKS = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 10000)
STRONG = (100_000, 1_000_000, 1_000_000_000)
SHARE = 100_000  # particles a rank of weak scaling
PARTS = ("work", "apart", "imbalance", "halo", "waits", "sums", "lists")


# ---- points ----


def once(options, file, ranks, steps):
    """sums over the steps of a run: lists built, and each rank's work with its processor time. One rank runs beside a
    second run, so that as on several ranks all cores are busy."""
    trace = options.out / "trace"
    with runs.beside(options, file) if ranks == 1 else contextlib.nullcontext():
        summary = runs.run(options, file, ranks, mpi=True, trace=trace)
    cpu = [s[3] for s in runs.sums(trace, ranks)]
    found = {"peak_bytes": summary["peak_bytes"], "lists": 0, "work": [{"cpu_s": t} for t in cpu]}
    found["clock_s"] = summary["wall_s"]["dem"]
    if ranks > 1:
        found["lists"] = summary["ranks"]["lists"]
        for own, work in zip(found["work"], summary["ranks"]["work"]):
            own.update({k: steps * x for k, x in work.items() if not k.endswith("_s")})
    return found


def least(options, file, ranks, steps):
    found = [once(options, file, ranks, steps) for _ in range(options.repeat)]
    for r in range(ranks):
        found[0]["work"][r]["cpu_s"] = min(f["work"][r]["cpu_s"] for f in found)
    found[0]["clock_s"] = min(f["clock_s"] for f in found)
    return found[0]


def measure_point(options, kind, particles, ranks):
    """a point as in ranks/fit.py; on one rank without what only several count"""
    short, long = (
        least(options, runs.write(options, "scene.json", runs.scene(kind, particles, n)), ranks, n) for n in STEPS[kind]
    )
    steps = STEPS[kind][1] - STEPS[kind][0]
    work = [{k: (b[k] - a[k]) / steps for k in b} for a, b in zip(short["work"], long["work"])]
    start = max(a["cpu_s"] - STEPS[kind][0] * w["cpu_s"] for a, w in zip(short["work"], work))
    return {
        "kind": kind,
        "ranks": ranks,
        "lists": (long["lists"] - short["lists"]) / steps,
        "work": work,
        "clock_s": (long["clock_s"] - short["clock_s"]) / steps,
        "start_s": start,
        "peak_bytes": long["peak_bytes"],
    }


def complete(points):
    """Particles, chunks, orders; one rank's counts are the sums of several, which have the same bits."""
    several = next(p for p in points if p["ranks"] > 1)
    n = round(sum(w["particles"] for w in several["work"]))
    for p in points:
        short, long = STEPS[p["kind"]]
        orders = (short < ORDER <= long) / (long - short) if n > predict.CHUNK else 0
        p.update(particles=n, chunks=-(-n // predict.CHUNK), orders=orders)
        if p["ranks"] == 1:
            p["lists"] = several["lists"]
            own = {k: sum(w[k] for w in several["work"]) for k in ("particles", "near", "contacts")}
            own.update(dict.fromkeys(("visitors", "messages", "message_bytes", "gathers", "gathered_bytes"), 0))
            p["work"][0].update(own, reductions=0)
    return points


def measure(options):
    points = []
    for kind in runs.KINDS:
        for particles in options.particles:
            found = []
            for ranks in options.ranks:
                found.append(measure_point(options, kind, particles, ranks))
                cpu = [1e6 * w["cpu_s"] for w in found[-1]["work"]]
                print(f"{kind} {particles} on {ranks}: {min(cpu):.1f} ... {max(cpu):.1f} us a step", file=sys.stderr)
            points += complete(found)
            file = {"build": runs.build(options), "points": points}
            (options.out / "points.json").write_text(json.dumps(file, indent=1))
    runs.run(options, runs.write(options, "scene.json", runs.scene("thrown", 40000, 300)), 2, trace=options.out / "two")
    return points


def read_points(names):
    """of several runs of one build, the least times of each rank at each point"""
    files = [json.loads(pathlib.Path(name).read_text()) for name in names]
    if len({file["build"]["program"] for file in files}) > 1:
        sys.exit(f"points of different builds: {', '.join(str(file['build']) for file in files)}; take those of one")
    print(f"build: {files[0]['build']}\n")
    found = {}
    for p in (p for file in files for p in file["points"]):
        first = found.setdefault((p["kind"], p["particles"], p["ranks"]), p)
        first["clock_s"] = min(first["clock_s"], p["clock_s"])
        for a, b in zip(first["work"], p["work"]):
            a["cpu_s"] = min(a["cpu_s"], b["cpu_s"])
    return list(found.values())


def exchanges(trace):
    """latency [s] and bandwidth [bytes/s] between two ranks here: of the exchanges of a trace"""
    some = [(n, end - begin) for s in runs.spans(trace, 2) for begin, end, what, n in s if what == "exchange" and n > 0]
    small = statistics.median(t for n, t in some if n < 256)
    large = [n / (t - small) for n, t in some if n > 2e5 and t > small]
    return small, statistics.median(large)


# ---- what is printed ----


def print_costs(points, costs):
    share = [0.0] * len(costs)
    for p in points:
        for w in p["work"]:
            for k, (c, x) in enumerate(zip(costs, fit.counts(p, w))):
                share[k] += c * x / w["cpu_s"] / sum(len(q["work"]) for q in points)
    print("| cost | of each | ns | share of a rank's time, mean |\n| --- | --- | --- | --- |")
    for (name, unit, _), c, s in zip(fit.TERMS, costs, share):
        print(f"| {name} | {unit} | {1e9 * c:.3g} | {100 * s:.1f} % |")


def print_errors(points):
    print("\nErrors of the busiest rank's processor time a step, each point predicted without itself [%]\n")
    ranks = sorted({p["ranks"] for p in points})
    print(f"| scene | particles | {' | '.join(f'P = {r}' for r in ranks)} |\n{'| --- ' * (2 + len(ranks))}|")
    found = {(p["kind"], p["particles"], p["ranks"]): e for p, e in fit.leave_out(points, id)}
    for kind, n in dict.fromkeys((p["kind"], p["particles"]) for p in points):
        print(f"| {kind} | {n} | " + " | ".join(f"{100 * found[kind, n, r]:+.1f}" for r in ranks) + " |")
    most, large = max(ranks), max(p["particles"] for p in points) // 2
    groups = (
        ("each point", lambda p: id(p), lambda p: True),
        (f"all of {most} ranks", lambda p: p["ranks"], lambda p: p["ranks"] == most),
        ("all of the most particles", lambda p: p["particles"] > large, lambda p: p["particles"] > large),
        ("all of a scene", lambda p: p["kind"], lambda p: True),
    )
    print("\n| left out | median error | largest |\n| --- | --- | --- |")
    for name, group, wanted in groups:
        errors = [abs(e) for p, e in fit.leave_out(points, group) if wanted(p)]
        print(f"| {name} | {100 * statistics.median(errors):.1f} % | {100 * max(errors):.1f} % |")


def print_traffic(points, model):
    each, lists, orders = model.traffic["calls"]
    print(f"\ncollective calls: {each:.2f} a step, {lists:.1f} a list, {orders:.1f} an order")
    of_place, of_visitor = model.traffic["bytes"]
    print(
        f"their bytes: {fit.OF_CHUNK} a chunk and {fit.OF_RANK} a rank each step; at a list {of_place:.1f} a particle of "
        f"all and {of_visitor:.0f} a visitor"
    )
    visit, at_list, at_order = model.traffic["messages"]
    print(
        f"bytes of messages, sent and received: {visit:.0f} a visitor each step, {at_list:.0f} a visitor at a list, "
        f"{at_order:.0f} a particle of all at an order"
    )
    process, of_all, of_home = model.memory
    print(
        f"memory of a rank: {process / 1e6:.0f} MB, {of_all:.0f} bytes a particle of all, {of_home:.0f} bytes a home "
        "particle"
    )
    most = max(p["particles"] for p in points if p["kind"] == "lattice")
    large = [p for p in points if p["particles"] == most and p["kind"] == "lattice"]
    start = statistics.median(p["start_s"] for p in large) / most
    print(f"start (a list of places in JSON): {1e6 * start:.1f} us a particle of all, on each rank")
    for p in large:
        if p["ranks"] > 2:
            counted = fit.visitors(p) / p["ranks"] / (p["particles"] / p["ranks"]) ** (2 / 3)
            print(
                f"visitors over (home particles)^(2/3), {p['ranks']} ranks: {counted:.2f}, "
                f"on paper {predict.surface(p['ranks'])[0]:.2f}"
            )
    skin, partners = predict.surface(predict.MANY)
    print(f"on {predict.MANY} ranks, on paper: {skin:.2f}, each with {partners:.1f} others")


def print_clock(points, model):
    """whole steps on 1 and 2 ranks, with the exchanges that were measured here"""
    print("\n| whole step | particles | P | clock [ms] | predicted [ms] | predicted/clock |")
    print("| --- | --- | --- | --- | --- | --- |")
    for p in points:
        if p["ranks"] <= 2:
            clock, paper = 1e3 * p["clock_s"], 1e3 * model.whole(p)
            texts = [f"{clock:.3g}", f"{paper:.3g}", f"{paper / clock:.2f}"]
            print(f"| {p['kind']} | {p['particles']} | {p['ranks']} | {' | '.join(texts)} |")


def first_below(model, particles, how, level):
    """ranks from which on the efficiency is below, and what takes most then besides the work"""
    for ranks in RANKS[1:]:
        if model.efficiency(particles, ranks, how) < level:
            parts = model.step(particles, ranks, how)
            return ranks, max((k for k in parts if k != "work"), key=lambda k: parts[k])
    return None, None


def print_prediction(model):
    cases = [(f"strong, {n:.0e}".replace("e+0", "e"), lambda p, n=n: n, False) for n in STRONG]
    cases.append((f"weak, {SHARE:.0e} a rank".replace("e+0", "e"), lambda p: SHARE * p, True))
    shown = [p for p in RANKS if p in (1, 8, 64, 512, 4096, 10000)]
    print(f"\n| efficiency | as | {' | '.join(f'P = {p}' for p in shown)} |\n{'| --- ' * (2 + len(shown))}|")
    for name, n, weak in cases:
        for how in predict.HOW:
            values = [f"{model.efficiency(n(p), p, how, weak):.2g}" if p > 1 else "1" for p in shown]
            print(f"| {name} | {how} | {' | '.join(values)} |")
    print("\n| milliseconds of a step, now | P | " + " | ".join(PARTS) + " | all | limits |")
    print("| --- " * (len(PARTS) + 4) + "|")
    for name, n, _ in cases:
        for p in (8, 512, 10000):
            parts = model.step(n(p), p)
            texts = [f"{1e3 * parts.get(k, 0):.2g}" for k in PARTS] + [f"{1e3 * sum(parts.values()):.3g}"]
            print(f"| {name} | {p} | {' | '.join(texts)} | {'; '.join(model.limits(n(p), p))} |")
    print()
    for n in STRONG:
        for how in predict.HOW:
            ranks, what = first_below(model, n, how, 0.5)
            text = f"from {ranks} ranks on, by \"{what}\"" if ranks else "nowhere"
            print(f"{n:.0e} particles, {how}: efficiency below 0.5 {text}".replace("e+0", "e"))


# ---- pictures ----


def draw_fit(options, points):
    """predicted over measured processor time, each point without itself"""
    data = options.out / "fit.txt"
    with open(data, "w", encoding="utf-8") as file:
        errors = fit.leave_out(points, id)
        for kind in runs.KINDS:
            for p, e in errors:
                if p["kind"] == kind:
                    t = 1e3 * max(w["cpu_s"] for w in p["work"])
                    file.write(f"{t} {t * (1 + e)}\n")
            file.write("\n\n")
    curves = [f"'{data}' index {k} with points title '{kind}'" for k, kind in enumerate(runs.KINDS)]
    runs.gnuplot(
        f"set terminal svg size 640,480\nset output '{options.out}/fit.svg'\nset logscale xy\nset key left top\n"
        "set xlabel 'measured [ms a step]'\nset ylabel 'predicted by the other points [ms a step]'\n"
        "plot x dashtype 2 linecolor 'gray' notitle, " + ", ".join(curves)
    )


def draw_scaling(options, model):
    """efficiency over ranks, of all ways to tell each other"""
    data, curves = options.out / "scaling.txt", []
    with open(data, "w", encoding="utf-8") as file:
        cases = [(n, False) for n in STRONG] + [(SHARE, True)]
        for k, (n, weak) in enumerate(cases):
            for m, how in enumerate(predict.HOW):
                for p in RANKS:
                    file.write(f"{p} {model.efficiency(n * p if weak else n, p, how, weak) if p > 1 else 1}\n")
                file.write("\n\n")
                title = f"{n:.0e} particles{' a rank' if weak else ''}".replace("e+0", "e") + f", {how}"
                curves.append(
                    f"'{data}' index {len(curves)} with lines linewidth 2 linecolor {k + 1} dashtype {m + 1} "
                    f"title '{title}'"
                )
    for terminal in ("svg size 800,560", "pngcairo size 1000,700"):
        runs.gnuplot(
            f"set terminal {terminal}\nset output '{options.out}/scaling.{terminal[:3]}'\nset logscale x\n"
            "set key outside right\nset xlabel 'ranks P'\nset ylabel 'efficiency η'\nset yrange [0:1.05]\n"
            "plot [1:10000] " + ", ".join(curves)
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default="build/release/bin")
    parser.add_argument("--out", type=pathlib.Path, default="ranks-model-out")
    parser.add_argument("--particles", type=runs.numbers, default=[10000, 40000, 150000])
    parser.add_argument("--ranks", type=runs.numbers, default=[1, 2, 3, 5, 8])
    parser.add_argument("--repeat", type=int, default=2)
    parser.add_argument("--points", type=lambda text: text.split(","))
    parser.add_argument("--latency", type=float, default=2e-6)
    parser.add_argument("--bandwidth", type=float, default=1e10)
    options = parser.parse_args()
    runs.prepare(options)
    options.ranks = sorted({1, 2, *options.ranks})
    points = read_points(options.points) if options.points else measure(options)
    model = predict.Model(points, options.latency, options.bandwidth)
    print_costs(points, list(model.cost.values()))
    print_errors(points)
    print_traffic(points, model)
    if (options.out / "two.0").exists():
        here = predict.Model(points, *exchanges(options.out / "two"))
        print(f"exchanges between two ranks here: {1e6 * here.latency:.1f} us, {1e-9 * here.bandwidth:.2g} GB/s")
        print_clock(points, here)
    print(f"\nassumed of a network: {1e6 * options.latency:g} us, {1e-9 * options.bandwidth:g} GB/s")
    print_prediction(model)
    draw_fit(options, points)
    draw_scaling(options, model)


main()

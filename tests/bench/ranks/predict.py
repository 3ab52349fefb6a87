"""A step's time on many ranks from measured costs (fit.py) and assumed ones of a network, for bench_ranks_model.py."""
# SPDX-License-Identifier: GPL-3.0-or-later
import functools
import math

from ranks import fit

CHUNK = 2048  # particles; as DEM_CHUNK (dem/state/data.h)
RANKS_MAX, INT_MAX = 4096, 2**31 - 1
CORES = 2  # ranks of a machine, which share its caches
MANY = 500  # ranks from which on their surfaces are alike

# what is assumed of the bed: near pairs and contacts a particle, steps between lists and between orders
BED = {"near": 3.5, "contacts": 2.5, "lists": 1 / 40, "orders": 1 / 1000}
SUM = 3e-8  # of the loads and energies of a chunk, estimated: too little to be seen in the fit [s]
IMBALANCE = 0.05  # the busiest rank's work beyond the mean, whole chunks apart
# What everybody tells everybody: whole arrays go to all ranks; places and states go where they are near or at home;
# besides that each rank looks at its home for the guard; and loads are summed along a tree over the chunks.
HOW = ("whole", "near", "looks", "tree")


def morton(x, y, z):
    """place along the curve of a cell of a lattice"""
    return sum(((x >> b & 1) << 3 * b) | ((y >> b & 1) << 3 * b + 1) | ((z >> b & 1) << 3 * b + 2) for b in range(10))


@functools.lru_cache
def surface(ranks, side=32):
    """Of runs of the curve through a lattice of spheres that touch six others: visitors of a rank over (home
    particles)^(2/3), and ranks that it tells something; means over the ranks."""
    cells = side**3
    rank = [[[morton(x, y, z) * ranks // cells for z in range(side)] for y in range(side)] for x in range(side)]
    visits, meets = set(), set()
    for x in range(side):
        for y in range(side):
            for z in range(side):
                a = rank[x][y][z]
                for u, v, w in ((x + 1, y, z), (x, y + 1, z), (x, y, z + 1)):
                    if u == side or v == side or w == side or rank[u][v][w] == a:
                        continue
                    b = rank[u][v][w]
                    visits.add((min(a, b), (u, v, w) if b > a else (x, y, z)))
                    meets.add((min(a, b), max(a, b)))
    home = (cells / ranks) ** (2 / 3)
    return len(visits) / ranks / home, 2 * len(meets) / ranks


class Model:
    """Costs of a rank [s], laws of traffic and memory (fit.py), and a network: latency [s], bandwidth [bytes/s]."""

    def __init__(self, points, latency, bandwidth):
        self.cost = dict(zip(fit.NAMES, fit.fit(points)))
        self.traffic = fit.traffic(points)
        self.memory = fit.memory(points)
        self.latency, self.bandwidth = latency, bandwidth

    def collective(self, calls, bytes_, ranks):
        """calls among all ranks, along a tree, with so many bytes that reach each rank"""
        return calls * math.ceil(math.log2(ranks)) * self.latency + bytes_ / self.bandwidth

    def step(self, particles, ranks, how="whole"):
        """seconds of a step by what takes them"""
        c, chunks = self.cost, max(1, math.ceil(particles / CHUNK))
        mean = particles / ranks
        most = min(particles, math.ceil(chunks / ranks) * CHUNK)
        far = fit.beyond(min(particles, CORES * most)) * c["far"]
        work = c["particle"] + (c["near"] + far) * BED["near"] + c["contact"] * BED["contacts"]
        work += c["list"] * BED["lists"]
        found = {"work": work * mean + c["step"], "order": c["order"] * BED["orders"] * particles}
        found["looks"] = fit.LOOKS * c["look"] * particles
        if ranks == 1:
            return found
        found["apart"] = c["apart"] * mean
        found["imbalance"] = (work + c["apart"]) * (most * (1 + IMBALANCE) - mean)
        busy = min(ranks, chunks)
        found["halo"] = self.halo(most, busy) if busy > 1 else 0
        found.update(self.told_to_all(particles, ranks, chunks, most, how))
        return found

    def halo(self, home, ranks):
        """places go, reactions return"""
        skin, partners = surface(min(ranks, MANY))
        bytes_ = skin * home ** (2 / 3) * self.traffic["halo_bytes"]
        processor = self.cost["halo"] * bytes_ + self.cost["message"] * 2 * partners
        return processor + 2 * self.latency + bytes_ / self.bandwidth

    def told_to_all(self, particles, ranks, chunks, home, how):
        """waits and sums of each step, the guard's looks, places at each list, whole states at each order"""
        each, at_list, at_order = self.traffic["calls"]
        of_look, of_entry, of_place, of_visitor, of_state = self.traffic["bytes"]
        lists, orders, c = BED["lists"], BED["orders"], self.cost
        crossings = of_visitor * surface(min(ranks, MANY))[0] * home ** (2 / 3)
        edge = CHUNK ** (1 / 3)
        near = min(particles, (home ** (1 / 3) + 2 * edge) ** 3)  # of home chunks and those beside them
        listed, ordered = (particles, particles) if how == "whole" else (near, home)
        looked = home if how in ("looks", "tree") else particles
        sums = math.log2(chunks + 1) if how == "tree" else chunks
        crossing = crossings * ranks if how == "whole" else crossings
        found = {
            "waits": self.collective(each, fit.OF_RANK * ranks, ranks),
            "sums": (SUM + fit.OF_CHUNK / self.bandwidth) * sums,
            "looks": (fit.LOOKS * c["look"] + (of_look + BED["near"] * of_entry) / self.bandwidth) * looked,
            "places": lists
            * (c["list_all"] * listed + self.collective(at_list, of_place * listed + crossing, ranks)),
            "order": orders * (c["order"] * ordered + self.collective(at_order, of_state * ordered, ranks)),
        }
        return found

    def whole(self, point):
        """seconds of a step of a point that was measured, with its counted work and exchanges"""
        works = [fit.predicted(self.cost.values(), point, w) for w in point["work"]]
        w, ranks = point["work"][0], point["ranks"]
        bytes_ = w["gathered_bytes"] * (1 - 1 / ranks) + 0.5 * max(w["message_bytes"] for w in point["work"])
        letters = 2 * self.latency if ranks > 1 else 0
        return max(works) + self.collective(w["gathers"] + w["reductions"], bytes_, ranks) + letters

    def time(self, particles, ranks, how="whole"):
        return sum(self.step(particles, ranks, how).values())

    def efficiency(self, particles, ranks, how="whole", weak=False):
        """weak: against one rank with its share of the particles"""
        alone = self.time(particles / ranks, 1) if weak else self.time(particles, 1) / ranks
        return alone / self.time(particles, ranks, how)

    def limits(self, particles, ranks):
        """what the program refuses or cannot hold, today"""
        process, of_all, of_home = self.memory
        home = min(particles, math.ceil(math.ceil(particles / CHUNK) / ranks) * CHUNK)
        found = [f"{(process + of_all * particles + of_home * home) / 1e9:.3g} GB a rank"]
        if ranks > RANKS_MAX:
            found.append("more than 4096 ranks")
        if ranks > math.ceil(particles / CHUNK):
            found.append("ranks without a chunk")
        if particles * BED["near"] > INT_MAX / 2:
            found.append("entries of all lists beyond 2^30")
        return found

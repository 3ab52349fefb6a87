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
# What everybody tells everybody: loads of all chunks each step and all crossings at each list, as it is; loads along a
# tree over the chunks, crossings to those that they concern.
HOW = ("now", "tree")


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

    def step(self, particles, ranks, how="now"):
        """seconds of a step by what takes them"""
        c, chunks = self.cost, max(1, math.ceil(particles / CHUNK))
        mean = particles / ranks
        most = min(particles, math.ceil(chunks / ranks) * CHUNK)
        far = fit.beyond(min(particles, CORES * most)) * c["far"]
        work = c["particle"] + (c["near"] + far) * BED["near"] + c["contact"] * BED["contacts"]
        work += c["list"] * BED["lists"] + c["order"] * BED["orders"]
        found = {"work": work * mean + c["step"]}
        if ranks == 1:
            return found
        found["apart"] = c["apart"] * mean
        found["imbalance"] = (work + c["apart"]) * (most * (1 + IMBALANCE) - mean)
        busy = min(ranks, chunks)
        found["halo"] = self.halo(most, busy) if busy > 1 else 0
        found.update(self.told_to_all(particles, ranks, chunks, most, how))
        return found

    def halo(self, home, ranks):
        """places go, reactions return; at lists places of what is near, at orders the particles themselves"""
        skin, partners = surface(min(ranks, MANY))
        visit, at_list, at_order = self.traffic["messages"]
        bytes_ = skin * home ** (2 / 3) * (visit + BED["lists"] * at_list) + home * BED["orders"] * at_order
        processor = self.cost["halo"] * bytes_ + self.cost["message"] * 2 * partners
        return processor + 2 * self.latency + bytes_ / self.bandwidth

    def told_to_all(self, particles, ranks, chunks, home, how):
        """waits and sums of each step; at each list boxes of all chunks, and crossings"""
        each, at_list, at_order = self.traffic["calls"]
        of_place, of_visitor = self.traffic["bytes"]
        lists, orders, c = BED["lists"], BED["orders"], self.cost
        crossings = of_visitor * surface(min(ranks, MANY))[0] * home ** (2 / 3)
        edge = CHUNK ** (1 / 3)
        near = min(particles, (home ** (1 / 3) + 2 * edge) ** 3)  # of home chunks and those beside them
        tree = how == "tree"
        listed, crossing = (near, crossings) if tree else (particles, crossings * ranks)
        return {
            "waits": self.collective(each + orders * at_order, fit.OF_RANK * ranks, ranks),
            "sums": (SUM + fit.OF_CHUNK / self.bandwidth) * (math.log2(chunks + 1) if tree else chunks),
            "lists": lists
            * (c["list_all"] * listed + self.collective(at_list, of_place * listed + crossing, ranks)),
        }

    def whole(self, point):
        """seconds of a step of a point that was measured, with its counted work and exchanges"""
        works = [fit.predicted(self.cost.values(), point, w) for w in point["work"]]
        w, ranks = point["work"][0], point["ranks"]
        bytes_ = w["gathered_bytes"] * (1 - 1 / ranks) + 0.5 * max(w["message_bytes"] for w in point["work"])
        letters = 2 * self.latency if ranks > 1 else 0
        return max(works) + self.collective(w["gathers"] + w["reductions"], bytes_, ranks) + letters

    def time(self, particles, ranks, how="now"):
        return sum(self.step(particles, ranks, how).values())

    def efficiency(self, particles, ranks, how="now", weak=False):
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

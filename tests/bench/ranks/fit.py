"""What a step costs a rank: non-negative least squares over counted work, for bench_ranks_model.py.

A point is a run of a scene on some ranks: {"kind", "particles", "ranks", "chunks", "lists" (list buildings a step),
"orders" (new orders of the particles a step), "work": a dictionary a rank, each number a step}. In "work" cpu_s is the
processor time outside of exchanges; the others are those of summary.json (docs/ranks.md).
"""
# SPDX-License-Identifier: GPL-3.0-or-later

CACHE = 20000  # particles of a machine that its caches hold; chosen so that points left out are predicted best


def beyond(particles):
    """share of a machine's particles that its caches do not hold"""
    return max(0, 1 - CACHE / particles)


# name, unit of what is counted, how often it comes a step on a rank
TERMS = (
    ("particle", "home particle", lambda p, w: w["particles"]),
    ("apart", "home particle on several ranks", lambda p, w: w["particles"] if p["ranks"] > 1 else 0),
    ("near", "entry of its lists", lambda p, w: w["near"]),
    ("far", "entry of the lists, beyond the caches", lambda p, w: w["near"] * beyond(p["particles"])),
    ("contact", "contact that touches", lambda p, w: w["contacts"]),
    ("halo", "byte sent or received", lambda p, w: w["message_bytes"]),
    ("message", "message sent or received", lambda p, w: w["messages"]),
    ("list", "home particle, a list", lambda p, w: p["lists"] * w["particles"]),
    ("list_all", "particle of all, a list", lambda p, w: p["lists"] * p["particles"] if p["ranks"] > 1 else 0),
    ("order", "home particle, an order", lambda p, w: p["orders"] * w["particles"]),
    ("step", "step", lambda p, w: 1),
)
NAMES = [name for name, _, _ in TERMS]

# what ranks tell all others of themselves and of each chunk each step, with one body [bytes] (dem_sums_of_step)
OF_RANK, OF_CHUNK = 24, 48


def _solve(a, b):
    """a x = b by elimination with pivots, None where a is singular"""
    n = len(b)
    rows = [list(a[i]) + [b[i]] for i in range(n)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        if abs(rows[pivot][k]) < 1e-12:
            return None
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, n):
            f = rows[i][k] / rows[k][k]
            rows[i] = [x - f * y for x, y in zip(rows[i], rows[k])]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def least_squares(rows, right):
    """x >= 0 that makes |rows x - right| least: the method of active sets of Lawson and Hanson (1974), Chapter 23"""
    n = len(rows[0])
    scale = [max(sum(r[k] ** 2 for r in rows) ** 0.5, 1e-300) for k in range(n)]
    scaled = [[r[k] / scale[k] for k in range(n)] for r in rows]
    a = [[sum(r[i] * r[j] for r in scaled) for j in range(n)] for i in range(n)]
    b = [sum(r[i] * y for r, y in zip(scaled, right)) for i in range(n)]
    x, free = [0.0] * n, []
    for _ in range(10 * n):
        slope = [b[i] - sum(a[i][j] * x[j] for j in range(n)) for i in range(n)]
        held = [i for i in range(n) if i not in free and slope[i] > 1e-9]
        if not held:
            break
        free.append(max(held, key=lambda i: slope[i]))
        while True:
            found = _solve([[a[i][j] for j in free] for i in free], [b[i] for i in free])
            if found is None:  # the newest says what others say already
                x[free.pop()] = 0.0
                break
            if min(found) > 0:
                for i, y in zip(free, found):
                    x[i] = y
                break
            share = min(x[i] / (x[i] - y) for i, y in zip(free, found) if y <= 0)
            for i, y in zip(free, found):
                x[i] += share * (y - x[i])
            for i in [i for i in free if x[i] <= 1e-14]:
                x[i] = 0.0
                free.remove(i)
    return [y / s for y, s in zip(x, scale)]


def counts(point, work):
    return [count(point, work) for _, _, count in TERMS]


def fit(points):
    """cost of each term [s]; relative errors count"""
    rows, right = [], []
    for p in points:
        for w in p["work"]:
            rows.append([x / w["cpu_s"] for x in counts(p, w)])
            right.append(1.0)
    return least_squares(rows, right)


def predicted(costs, point, work):
    return sum(c * x for c, x in zip(costs, counts(point, work)))


def error(costs, point):
    """of the busiest rank's processor time, as a share of it"""
    measured = max(w["cpu_s"] for w in point["work"])
    return max(predicted(costs, point, w) for w in point["work"]) / measured - 1


def leave_out(points, group):
    """for each value of group(point): errors of its points by costs that the other points gave"""
    found = []
    for value in sorted({group(p) for p in points}):
        rest = [p for p in points if group(p) != value]
        if rest:
            costs = fit(rest)
            found += [(p, error(costs, p)) for p in points if group(p) == value]
    return found


def traffic(points):
    """Collective calls by what asks for them: of each step, list and order. Their bytes, besides those that are known:
    of a particle of all and of a visitor at a list. Bytes of messages, sent and received: of a visitor each step, of a
    visitor at a list, of a particle of all at an order."""
    several = [p for p in points if p["ranks"] > 1]

    def law(rows, what, known=lambda p: 0):
        right = [what(p) - known(p) for p in several]
        return least_squares([[x / y for x in r] for r, y in zip(rows, right)], [1.0] * len(right))

    return {
        "calls": law(
            [[1, p["lists"], p["orders"]] for p in several],
            lambda p: sum(p["work"][0][key] for key in ("gathers", "reductions")),
        ),
        "bytes": law(
            [[p["lists"] * p["particles"], p["lists"] * visitors(p)] for p in several],
            lambda p: p["work"][0]["gathered_bytes"],
            lambda p: OF_CHUNK * p["chunks"] + OF_RANK * p["ranks"],
        ),
        "messages": law(
            [[visitors(p), p["lists"] * visitors(p), p["orders"] * p["particles"]] for p in several],
            lambda p: sum(w["message_bytes"] for w in p["work"]),
        ),
    }


def visitors(point):
    return sum(w["visitors"] for w in point["work"])


def memory(points):
    """peak memory of a rank [bytes]: of a process, of a particle of all, of a home particle"""
    rows = [[1, p["particles"], max(w["particles"] for w in p["work"])] for p in points]
    return least_squares([[x / p["peak_bytes"] for x in r] for r, p in zip(rows, points)], [1.0] * len(points))

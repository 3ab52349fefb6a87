# SPDX-License-Identifier: GPL-3.0-or-later
"""The helpers of tandem_participant for poses, against what they mean."""
import math
import random

from tandem_participant import (degrees, euler313_to_matrix, matrix_to_euler313, matrix_to_quaternion,
                                quaternion_to_matrix, slerp, translation)


def near(a, b, tolerance=1e-12):
    flat = lambda x: [z for y in x for z in (y if isinstance(y, (list, tuple)) else [y])]
    assert all(abs(x - y) < tolerance for x, y in zip(flat(a), flat(b))), (a, b)


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def about(axis, angle):
    c, s = math.cos(angle), math.sin(angle)
    return [[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == "z" else [[1, 0, 0], [0, c, -s], [0, s, c]]


random.seed(1)
for _ in range(200):
    q = [random.gauss(0, 1) for _ in range(4)]
    norm = math.sqrt(sum(c * c for c in q))
    q = [c / norm * (1 if q[0] > 0 else -1) for c in q]
    near(matrix_to_quaternion(quaternion_to_matrix(q)), q)
    angles = random.uniform(-3, 3), random.uniform(0.1, 3), random.uniform(-3, 3)
    m = euler313_to_matrix(*angles)
    near(m, product(product(about("z", angles[0]), about("x", angles[1])), about("z", angles[2])))
    near(matrix_to_euler313(m), angles, 1e-9)
    near(quaternion_to_matrix(matrix_to_quaternion(m)), m)
m = euler313_to_matrix(0.4, 0.0, 0.3)  # only the sum of phi and psi can be told
near(euler313_to_matrix(*matrix_to_euler313(m)), m)
quarter, half = [math.cos(math.pi / 8), 0, 0, math.sin(math.pi / 8)], [math.cos(math.pi / 4), 0, 0, math.sin(math.pi / 4)]
near(slerp([1, 0, 0, 0], half, 0.5), quarter)
near(slerp([1, 0, 0, 0], [-c for c in half], 0.5), quarter)
near(degrees([math.pi, math.pi / 2]), [180, 90])
near(translation([3, 2, 1], [1, 1, 1]), [2, 1, 0])
print("poses: good")

#!/usr/bin/env bash
# An open box as an STL file of 10 M^2 triangles, on standard output.
#
#   mesh_box.sh M SIDE HEIGHT
# SPDX-License-Identifier: GPL-3.0-or-later
awk -v m="$1" -v side="$2" -v height="$3" '
function vertex(i, j) {
  printf "   vertex %.9g %.9g %.9g\n", o[1] + a[1] * i / m + b[1] * j / m, o[2] + a[2] * i / m + b[2] * j / m,
         o[3] + a[3] * i / m + b[3] * j / m
}
function triangle(i0, j0, i1, j1, i2, j2) {
  print " facet normal 0 0 0\n  outer loop"
  vertex(i0, j0); vertex(i1, j1); vertex(i2, j2)
  print "  endloop\n endfacet"
}
function face(origin, first, second,   i, j) { # a parallelogram, in m x m squares
  split(origin, o); split(first, a); split(second, b)
  for (i = 0; i < m; i++)
    for (j = 0; j < m; j++) {
      triangle(i, j, i + 1, j, i + 1, j + 1)
      triangle(i, j, i + 1, j + 1, i, j + 1)
    }
}
BEGIN {
  x = side " 0 0"; y = "0 " side " 0"; z = "0 0 " height
  print "solid box"
  face("0 0 0", x, y); face("0 0 0", y, z); face(x, z, y); face("0 0 0", z, x); face(y, x, z)
  print "endsolid box"
}'

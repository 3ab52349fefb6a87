#!/usr/bin/env bash
# What frames cost: a coupled run of 20 000 grains in a box on a spring, with frames every 10 ms against the same
# without, in alternating pairs. Prints the wall time of the loop, and the processor time of all processes in brackets.
#   tests/bench/bench_frames.sh [BIN [PAIRS [OPTIONS OF tandem run ...]]]
# LOOK in the environment: what is measured in place of frames, as PATH=VALUE.
# SPDX-License-Identifier: GPL-3.0-or-later
set -eu
bin=${1:-build/release/bin}
pairs=${2:-5}
shift $(($# < 2 ? $# : 2))
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cat >"$dir/scene.json" <<'SCENE'
{"time": {"end": 0.2, "dt": 1e-4},
 "output": {"interval": 1e-3},
 "coupling": {"n": 10, "bodies": [{"mbd": "box", "dem": "box"}]},
 "mbd": {"gravity": [0, 0, -9.81],
  "bodies": [{"name": "box", "mass": 20, "inertia": [1, 1, 1], "position": [0, 0, 0]}],
  "joints": [{"name": "slide", "type": "prismatic", "bodies": ["ground", "box"], "point": [0, 0, 0], "axis": [0, 0, 1]}],
  "forces": [{"name": "spring", "type": "spring_damper", "bodies": ["ground", "box"],
   "points": [[0, 0, -1], [0, 0, 0]], "stiffness": 1e5, "damping": 500}]},
 "dem": {"gravity": [0, 0, -9.81],
  "materials": [{"name": "grain", "density": 1000, "young_modulus": 1e7, "poisson_ratio": 0.3}],
  "pairs": [{"materials": ["grain", "grain"], "restitution": 0.5, "friction": 0.4}],
  "bodies": [{"name": "box", "material": "grain", "shapes": [{"type": "box", "side": "inside", "size": [0.5, 0.5, 1.2],
   "center": [0, 0, 0.6], "open": ["+z"]}]}],
  "particles": [{"type": "block", "material": "grain", "radius": 0.01, "spacing": 0.02, "count": [25, 25, 32],
   "corner": [-0.24, -0.24, 0.0101]}]}}
SCENE

# wall time of the loop and processor time of a run with these options [s]
run() {
  TIMEFORMAT='%U %S'
  { time "$bin/tandem" run "$dir/scene.json" --out "$dir/out" --force "$@" >"$dir/log" 2>&1; } 2>"$dir/time" ||
    { cat "$dir/log" >&2; return 1; }
  awk -F'[:,]' '/"all":/ { all = $2 } /"setup":/ { setup = $2 } END { printf "%f ", all - setup }' "$dir/out/summary.json"
  awk '{ print $1 + $2 }' "$dir/time"
}

for ((i = 0; i < pairs; i++)); do
  without=$(run "$@")
  with=$(run "$@" --set "${LOOK:-output.particles_interval=0.01}")
  echo "$without $with"
done | tee "$dir/pairs" |
  awk '{ printf "without %.3f s (%.2f s), with %.3f s (%.2f s): %.3f (%.3f)\n", $1, $2, $3, $4, $3 / $1, $4 / $2 }'
middle() { awk "{ print $1 }" "$dir/pairs" | sort -n | awk '{ r[NR] = $1 } END { printf "%.3f", r[int((NR + 1) / 2)] }'; }
echo "median: $(middle '$3 / $1') ($(middle '$4 / $2'))"

#!/usr/bin/env bash
# What pictures cost: a picture in space of 100 000 particles, alone and as one of several; and a coupled run of 20 000
# grains with a flat picture every 10 ms against the same without (bench_frames.sh says how that is measured).
#   tests/bench/bench_pictures.sh [BIN [PAIRS]]
# SPDX-License-Identifier: GPL-3.0-or-later
set -eu
bin=${1:-build/release/bin}
pairs=${2:-3}
here=$(dirname "$0")
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
unset DISPLAY WAYLAND_DISPLAY
cat >"$dir/scene.json" <<'SCENE'
{"time": {"end": 1e-4, "dt": 1e-5}, "output": {"interval": 1e-4, "particles_interval": 1e-5},
 "dem": {"materials": [{"name": "grain", "density": 1000, "young_modulus": 1e6, "poisson_ratio": 0.3}],
  "pairs": [{"materials": ["grain", "grain"], "restitution": 0.5, "friction": 0.4}],
  "bodies": [{"name": "box", "material": "grain", "shapes": [{"type": "box", "side": "inside", "size": [1, 1, 2],
   "center": [0, 0, 1], "open": ["+z"]}]}],
  "particles": [{"type": "block", "material": "grain", "radius": 0.0099, "spacing": 0.02, "count": [50, 50, 40],
   "corner": [-0.49, -0.49, 0.01]}]}}
SCENE
"$bin/tandem-dem" run "$dir/scene.json" --out "$dir/out" --no-plots >"$dir/log" 2>&1 || { cat "$dir/log" >&2; exit 1; }
TIMEFORMAT='%R s (%U s of processor time)'
echo "100 000 particles in space, one picture:"
time "$bin/tandem" draw "$dir/out" --view space --out "$dir/one" >"$dir/log"
echo "11 of them:"
time "$bin/tandem" draw "$dir/out" --view space --all --out "$dir/all" >"$dir/log"
echo "20 000 grains, a flat picture every 10 ms:"
LOOK='output.pictures={"interval": 0.01}' "$here/bench_frames.sh" "$bin" "$pairs"

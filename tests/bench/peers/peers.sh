#!/usr/bin/env bash
# The engine beside LIGGGHTS and LAMMPS (Debian packages liggghts, lammps, time) on the same settled bed, in one run:
# alternating, on one core, medians.
#
#   peers.sh TANDEM_DEM [mono|poly] [N] [REPEATS] [BED]
#
# TANDEM_DEM: the executable. mono: r = 5 mm, dt = 8.6e-5 s; poly: 3-7 mm, dt = 5.2e-5 s. BED: lines "x y z r"; without
# it tandem-dem settles one. rho = 2500 kg/m3, E = 1e7 Pa, nu = 0.3, e = 0.5, mu = 0.5; floor and four walls, open top.
# LAMMPS runs twice: "granular" with Mindlin's force and gran/hertz/history, the fastest equivalent; what is not
# installed is left out. In the environment: STEPS and SKIN override the number of steps and the skin [m] of the others
# (tandem chooses its own); MESH=M adds tandem and LIGGGHTS in the same box made of 10 M^2 triangles; THREADS=2 gives
# tandem two threads, LIGGGHTS two ranks, and LAMMPS is left out; CPU names the cores (default: the first ones).
# SPDX-License-Identifier: GPL-3.0-or-later
set -eu
here=$(dirname "$(readlink -f "$0")")
tandem=$(readlink -f "$1"); kind=${2:-mono}; n=${3:-10000}; repeats=${4:-3}; bed=${5:-}
[ "$kind" = mono ] && { dt=8.6e-5; radius=0.005; } || { dt=5.2e-5; radius=0.003,0.007; }
steps=${STEPS:-$((n < 20000 ? 20000000 / n : 400))}; skin=${SKIN:-0.0005}
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT; cd "$work"

if [ -z "$bed" ]; then
  export XDG_CACHE_HOME=$work
  "$tandem" bench --particles "$n" --radius "$radius" --steps 1 > made
  bed=$(ls "$work"/tandem/*.txt)
fi
L=$(awk '!/^#/ {m = $1 > $2 ? $1 : $2; if (m + $4 > L) L = m + $4} END {printf "%.4g", L}' "$bed")
[ -n "${BOX:-}" ] && L=$BOX
mesh=${MESH:-} threads=${THREADS:-1}
awk -v L="$L" '!/^#/ {x[++n] = $1; y[n] = $2; z[n] = $3; r[n] = $4; if ($3 > h) h = $3}
  END {printf "bed\n\n%d atoms\n1 atom types\n\n0 %s xlo xhi\n0 %s ylo yhi\n0 %.6f zlo zhi\n\nAtoms\n\n", n, L, L, h + 0.03
       for (i = 1; i <= n; i++) printf "%d 1 %.9g 2500 %.9g %.9g %.9g\n", i, 2 * r[i], x[i], y[i], z[i]}' "$bed" > bed.data
if [ -n "$mesh" ]; then # the box of the mesh's particles is larger than the mesh
  H=$(awk '/zhi/ {print $2}' bed.data)
  "$here/mesh_box.sh" "$mesh" "$L" "$H" > box.stl
  awk -v L="$L" -v H="$H" '/[xyz]hi/ {$1 = -0.01; $2 = (/zhi/ ? H : L) + 0.01} {print}' bed.data > bed_mesh.data
fi

one() { # NAME COMMAND...: appends particle-steps a second to NAME.speed, peak memory [kB] to NAME.memory
  local name=$1; shift
  taskset -c "${CPU:-0-$((threads - 1))}" /usr/bin/env time -f %M -o memory "$@" > out 2>&1 || { cat out; exit 1; }
  if [ -f "$name.log" ]; then
    awk -v n="$n" -v s="$steps" '/^Loop time/ {t = $4} END {printf "%.0f\n", n * s / t}' "$name.log" >> "$name.speed"
  else
    awk -F'[:,]' '/particle_steps_per_s/ {printf "%.0f\n", $2}' out >> "$name.speed"
  fi
  tail -1 memory >> "$name.memory"
}
ranks=()
[ "$threads" -gt 1 ] && ranks=(mpirun --allow-run-as-root --oversubscribe -n "$threads")
names=(tandem)
tandem_on() { one "$1" "$tandem" bench --bed "$bed" --box "$L" --dt "$dt" --steps "$steps" --threads "$threads" "${@:2}"; }
peer() { # NAME PROGRAM INPUT BED
  command -v "$2" > /dev/null || return 0
  one "$1" "${ranks[@]}" "$2" -in "$here/$3" -log "$1.log" -screen screen -var bed "$4" -var dt "$dt" -var steps "$steps" \
    -var warm "$((steps / 10))" -var skin "$skin" -var L "$L"
  [[ " ${names[*]} " == *" $1 "* ]] || names+=("$1")
}
[ -n "$mesh" ] && names+=(tandem_mesh)
for _ in $(seq "$repeats"); do
  tandem_on tandem
  [ -n "$mesh" ] && tandem_on tandem_mesh --mesh box.stl
  peer liggghts liggghts liggghts.in bed.data
  [ -n "$mesh" ] && peer liggghts_mesh liggghts liggghts_mesh.in bed_mesh.data
  [ "$threads" -gt 1 ] && continue
  peer lammps lmp lammps.in bed.data
  peer lammps_history lmp lammps_history.in bed.data
done

median() { sort -n "$1" | awk '{a[NR] = $1} END {print a[int((NR + 1) / 2)]}'; }
echo "$kind, $n particles, $steps steps, threads or ranks $threads, skin $skin m, dt $dt s: medians of $repeats"
for name in "${names[@]}"; do
  of=tandem${name#*"${name%_mesh}"} # beside tandem in the same walls
  ours=$(median "$of.speed"); memory=$(median "$of.memory")
  awk -v name="$name" -v s="$(median $name.speed)" -v m="$(median $name.memory)" -v ours="$ours" -v mine="$memory" \
    'BEGIN {printf "%-15s %7.3f million particle-steps/s  peak %7.1f MB  tandem is %.2f x as fast, with %.2f x the memory\n",
            name, s / 1e6, m / 1024, ours / s, mine / m}'
done

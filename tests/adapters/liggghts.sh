#!/usr/bin/env bash
# tandem-liggghts with LIGGGHTS: rules, numbers, faults. CMake makes the program test_liggghts of it, which adapters.sh
# runs. See dem/foreign/liggghts/README.md.
# SPDX-License-Identifier: GPL-3.0-or-later
set -euo pipefail
cd "@PROJECT_SOURCE_DIR@"
PATH=@CMAKE_RUNTIME_OUTPUT_DIRECTORY@:@PROJECT_BINARY_DIR@/tests:$PATH
scenes=dem/foreign/liggghts/scenes
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
two_ranks=(--set 'dem.solver=mpirun --oversubscribe -n 2 tandem-liggghts')
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

# conform OPTIONS…: `tandem conform`; no rule may be broken
conform() {
  tandem conform "$@" -- tandem-liggghts >"$out/conform.txt" 2>&1 || { cat "$out/conform.txt"; return 1; }
  tail -1 "$out/conform.txt"
}

# run SCENE NAME OPTIONS…: `tandem run` with results in $out/NAME
run() {
  local scene=$1 name=$2
  shift 2
  tandem run "$scene" --out "$out/$name" "$@" >"$out/$name.txt" 2>&1 || { cat "$out/$name.txt"; return 1; }
}

# refused TEXT OPTIONS…: `tandem run` with these ends with an error that has TEXT, in time
refused() {
  local text=$1 status=0
  shift
  timeout 300 tandem run "$@" --out "$out/refused" --force >"$out/refused.txt" 2>&1 || status=$?
  [ "$status" = 1 ] && grep -qF -- "$text" "$out/refused.txt" && return
  echo "exit status $status, no \"$text\" in:"
  cat "$out/refused.txt"
  return 1
}

# judge NAME VALUE SIGN LIMIT: a number, and what it must be (SIGN: >= or <=)
judge() {
  awk -v name="$1" -v x="$2" -v sign="$3" -v y="$4" 'BEGIN {
    print "  " name, x, "(" sign, y ")"
    exit !(x ~ /^-?[0-9.]+(e[-+]?[0-9]+)?$/ && (sign == ">=" ? x + 0 >= y : x + 0 <= y))
  }'
}

# nse NAME DIR: of position and velocity of the box of [L18] Section 3.3, at least 0.999 each
nse() {
  local x v
  read -r x v < <(measure spring_damper "$2")
  judge "spring_damper, $1: nse of x" "$x" ">=" 0.999
  judge "spring_damper, $1: nse of v" "$v" ">=" 0.999
}

# errors of the velocities at a mass ratio; the restitution, 0.5 in theory, tells what the infinite wall mass does
collision() {
  local mass=$1 particle body e momentum
  run "$scenes/collision.json" "m_p=$mass" --set "parameters.mass=$mass"
  read -r particle body e momentum < <(measure collision "$out/m_p=$mass" "$mass")
  judge "collision, m_c/m_p = $(awk "BEGIN {print 10/$mass}"): |error| of the particle's velocity [%]" "${particle#-}" "<=" 1
  judge "the same of the cube's" "${body#-}" "<=" 1
  echo "  restitution $e, momentum $momentum"
}

# what a window costs beside LIGGGHTS' own "run"; printed, as no test is judged by its time
overhead() {
  awk '/event=cost/ {sub(/.*beside_run_us=/, ""); print "  beside LIGGGHTS\x27 steps:", $0, "us a window"}' "$1/dem.log"
}

faults() {
  local box=$scenes/spring_damper.json
  printf 'units si\natom_style granular\nfrobnicate 3\n' >"$out/wrong.in"
  refused 'Unknown command: frobnicate' "$box" --set "dem.script.file=$out/wrong.in"
  sed 's/^fix  *box .*//' "$scenes/spring_damper.in" >"$out/no_mesh.in"
  refused 'dem.script' "$box" --set "dem.script.file=$out/no_mesh.in"
  sed 's/^fix  *wall .*//; s/^fix  *box .*//' "$scenes/spring_damper.in" >"$out/no_wall.in"
  refused 'makes no mesh "box"' "$box" --set "dem.script.file=$out/no_wall.in" --set dem.script.variables.settle=1
  printf 'quit\n' >"$out/quit.in"
  refused 'LIGGGHTS ended the process' "$box" --set "dem.script.file=$out/quit.in"
  printf 'shell sleep 30\n' >"$out/hangs.in"
  refused 'no answer for 2 s' "$box" --set "dem.script.file=$out/hangs.in" --set coupling.timeout=2
  sed 's/^units .*/units lj/' "$scenes/spring_damper.in" >"$out/units.in"
  refused 'other units than si' "$box" --set "dem.script.file=$out/units.in" --set dem.script.variables.settle=1
  sed 's/^fix  *wall .*//' "$scenes/spring_damper.in" >"$out/no_wall.in"
  refused 'particles pass through it' "$box" --set "dem.script.file=$out/no_wall.in" --strict \
    --set dem.script.variables.settle=1
  sed 's/^fix  *gravity .*//' "$scenes/spring_damper.in" >"$out/no_gravity.in"
  refused "does not take the scene's gravity" "$box" --set "dem.script.file=$out/no_gravity.in" --strict \
    --set dem.script.variables.settle=1
  refused 'take another name' "$box" --set dem.script.variables.dt=1
  refused 'Unknown command: frobnicate' "$box" --set "dem.script.file=$out/wrong.in" "${two_ranks[@]}"
  refused 'no_such.stl' "$box" --set 'dem.bodies[0].mesh.file=no_such.stl'
  refused 'no_such.in' "$box" --set dem.script.file=no_such.in
  refused 'unknown key "scripts"' "$box" --set 'dem.scripts={}'
  refused 'is not coupled' "$box" --set 'dem.bodies[0].name=crate'
  refused 'dem.channels: ' "$box" --set 'dem.channels[0].variable=nothing' --set dem.script.variables.settle=1
  refused 'capability "interface"' "$box" --set coupling.fallback=proxy
}

# A sphere in a box that turns about all axes, and moves: after some impacts both are where tandem-dem has them.
turning() {
  local own='{"materials": [{"name": "a", "density": 1000, "young_modulus": 1e7, "poisson_ratio": 0.25}],
    "pairs": [{"materials": ["a", "a"], "restitution": 0.9, "friction": 0.3}],
    "contact": {"wall_mass": 1e8, "tail": "keep"},
    "bodies": [{"name": "box", "material": "a",
      "shapes": [{"type": "box", "size": [0.4, 0.3, 0.32], "side": "inside"}]}],
    "particles": [{"type": "list", "material": "a", "radius": 0.05, "positions": [[1.02, 0.49, -0.21]],
      "velocity": [0.9, 0.6, -0.7]}]}'
  run "$scenes/turning.json" turning
  run "$scenes/turning.json" turning_own --set "dem=$own"
  judge "turning box: largest difference from tandem-dem of position [m] and quaternion" \
    "$(paste -d, "$out/turning/body_box.csv" "$out/turning_own/body_box.csv" |
      awk -F, 'NR > 1 {for (i = 2; i <= 8; i++) {d = $i - $(i + NF/2); d = d < 0 ? -d : d; if (d > most) most = d}}
        END {print most + 0}')" "<=" 2e-3
  judge "and as much must it have turned" "$(tail -1 "$out/turning/body_box.csv" | cut -d, -f8)" ">=" 0.5
}

# ended PID: a process ends within ten seconds; nobody may have asked how
ended() {
  for _ in $(seq 100); do
    case $(ps -o stat= -p "$1") in
    "" | Z*) return 0 ;;
    esac
    sleep 0.1
  done
  return 1
}

# hit SIGNAL RANK TEXT OPTIONS…: a signal to a rank while LIGGGHTS works ends the run in time, with an error that has
# TEXT, and leaves no process
hit() {
  local signal=$1 rank=$2 text=$3 status=0 pid tandem children ranks=()
  shift 3
  timeout 120 tandem run "$scenes/spring_damper.json" --set dem.script.variables.settle=100000000 --out "$out/hit" \
    --force "$@" >"$out/hit.txt" 2>&1 &
  pid=$!
  until [ "${#ranks[@]}" -gt "$rank" ] || ! kill -0 $pid; do
    sleep 0.1
    tandem=$(pgrep -P $pid) && children=$(pgrep -d, -P "$tandem") || continue
    mapfile -t ranks < <(pgrep -x tandem-liggghts -P "$children" || pgrep -x tandem-liggghts -P "$tandem")
  done
  sleep 2
  kill "-$signal" "${ranks[$rank]}"
  wait $pid || status=$?
  [ "$status" = 1 ] && grep -q -- "$text" "$out/hit.txt" || { cat "$out/hit.txt"; return 1; }
  for pid in "${ranks[@]}" ${children//,/ }; do
    ended "$pid" || { echo "process $pid is left" && return 1; }
  done
}

# An error of LIGGGHTS on a rank that is not 0: only there are particles, with more neighbours than the lists take
faulty_rank() {
  {
    printf '%s\n' 'units si' 'atom_style granular' 'atom_modify map array' 'boundary f f f' 'newton off' \
      'communicate single vel yes' 'processors 1 1 2' 'region domain block -1 1 -1 1 -1 1 units box' \
      'create_box 1 domain' 'neighbor 0.01 bin' 'neigh_modify delay 0 one 2 page 20' \
      'fix young all property/global youngsModulus peratomtype 1e7' \
      'fix poisson all property/global poissonsRatio peratomtype 0.2' \
      'fix restitution all property/global coefficientRestitution peratomtypepair 1 0.5' \
      'fix friction all property/global coefficientFriction peratomtypepair 1 0.5' \
      'pair_style gran model hertz tangential history' 'pair_coeff * *' 'timestep ${dt}'
    for place in '0 0' '0.05 0' '0 0.05' '0.05 0.05' '-0.05 0' '0 -0.05'; do
      echo "create_atoms 1 single $place 0.5 units box"
    done
    printf '%s\n' 'set group all diameter 0.1 density 1000' 'fix integrate all nve/sphere' 'run 10'
  } >"$out/crowded.in"
  refused 'LIGGGHTS: ERROR on proc 1: Neighbor list overflow' "$scenes/spring_damper.json" \
    --set "dem.script.file=$out/crowded.in" "${two_ranks[@]}"
}

conform "$scenes/spring_damper.json" --set dem.script.variables.settle=3000
faults
faulty_rank
hit KILL 0 'dem.*killed by signal 9'
hit KILL 0 'dem.*ended before the run did' "${two_ranks[@]}"
hit KILL 1 'dem.*ended before the run did' "${two_ranks[@]}"
hit STOP 1 'dem.*no answer for 5 s' "${two_ranks[@]}" --set coupling.timeout=5
turning
for scheme in lommen dem-first; do
  run "$scenes/spring_damper.json" "$scheme" --set "coupling.scheme=$scheme"
  nse "$scheme" "$out/$scheme"
  overhead "$out/$scheme"
done
for mass in 0.01 0.02 0.1; do
  collision $mass
done
run "$scenes/spring_damper.json" two_ranks "${two_ranks[@]}" --set coupling.scheme=dem-first --set time.end=1
nse "dem-first, two ranks, 1 s" "$out/two_ranks"

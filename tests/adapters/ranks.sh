#!/usr/bin/env bash
# tandem-dem on the processes of MPI: the same files as of one process, alone and coupled; faults. CMake makes the
# program test_ranks of it, which adapters.sh runs. test_dem_ranks has more scenes, with ranks that are threads.
# See docs/ranks.md.
# SPDX-License-Identifier: GPL-3.0-or-later
set -euo pipefail
PATH=@CMAKE_RUNTIME_OUTPUT_DIRECTORY@:$PATH
out=$(mktemp -d)
pid=
trap 'kill $pid 2>/dev/null || true; rm -rf "$out"' EXIT
cd "$out"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_WAIT_POLICY=passive
mpi=(mpirun --oversubscribe -n)

# ranks P NAME WORDS…: tandem-dem on P ranks, 0: without mpirun; what it says goes to NAME.txt. Its exit status
ranks() {
  local p=$1 name=$2 status=0
  shift 2
  if [ "$p" = 0 ]; then
    timeout 300 tandem-dem "$@" >"$name.txt" 2>&1 || status=$?
  else
    timeout 300 "${mpi[@]}" "$p" tandem-dem "$@" >"$name.txt" 2>&1 </dev/null || status=$?
  fi
  return $status
}

# the same files in two folders of results
same() {
  diff -rq "$1" "$2" -x '*.log' -x summary.json -x scene.json -x .tandem && return
  cat "$2.txt"
  return 1
}

# the ranks that a process has started, directly or through another one
ranks_of() {
  local child
  pgrep -x tandem-dem-mpi -P "$1" && return
  for child in $(pgrep -P "$1"); do
    pgrep -x tandem-dem-mpi -P "$child" || true
  done
}

# started FILE: the program in the background has written to FILE; its ranks are `left`
started() {
  until [ -s "$1" ]; do
    kill -0 "$pid" || return 1
    sleep 0.1
  done
  mapfile -t left < <(ranks_of "$pid")
  [ "${#left[@]}" -gt 1 ]
}

# none of `left` is left after ten seconds; nobody may have asked how they ended
nothing_left() {
  local rank
  for rank in "${left[@]}"; do
    for _ in $(seq 100); do
      case $(ps -o stat= -p "$rank") in
      "" | Z*) continue 2 ;;
      esac
      sleep 0.1
    done
    echo "process $rank is left"
    return 1
  done
}

cat >heap.json <<'END'
{"time": {"end": 0.022, "dt": 2e-5},
 "output": {"interval": 2e-3, "particles_interval": 1e-2},
 "dem": {
   "materials": [{"name": "a", "density": 1000, "young_modulus": 1e7, "poisson_ratio": 0.25}],
   "pairs": [{"materials": ["a", "a"], "restitution": 0.5, "friction": 0.4}], "energy": true,
   "bodies": [
     {"name": "box", "material": "a",
       "shapes": [{"type": "box", "side": "inside", "size": [0.2, 0.2, 1], "open": ["+z"]}]},
     {"name": "paddle", "material": "a", "shapes": [{"type": "box", "side": "outside", "size": [0.15, 0.01, 0.06]}],
       "position": [0, 0, -0.45], "motion": {"angular_velocity": [0, 0, 40]}}],
   "particles": [{"type": "random", "material": "a", "count": 9000, "radius": [0.0035, 0.005],
     "region": {"min": [-0.099, -0.099, -0.4], "max": [0.099, 0.099, 0.2]}, "velocity": [0, 0, -1]}],
   "sources": [{"name": "tap", "material": "a", "radius": 0.004, "rate": 30000, "velocity": [0, 0, -2],
     "region": {"min": [-0.09, -0.09, 0.3], "max": [0.09, 0.09, 0.35]}}],
   "sinks": [{"name": "hole", "type": "box", "min": [-0.02, -0.1, -0.5], "max": [0.02, 0.1, -0.47]}]}}
END

alone() {
  ranks 0 one run heap.json --out one --no-plots
  while read -r p threads; do # 8: more than chunks
    ranks "$p" on run heap.json --out on --force --no-plots --set "dem.threads=$threads" || { cat on.txt; return 1; }
    same one on
    echo "  particles alone, $p ranks of $threads threads: the same bits"
  done <<<$'1 1\n2 1\n2 2\n3 1\n5 2\n8 1'
}

# a bed of several chunks, in the box of [L18] Section 3.3
coupled() {
  local many=(--set 'dem.particles[0].count=4500' --set 'dem.particles[0].radius=0.024' --set time.dt=5e-5
    --set dem.settle.max_time=0.01 --set time.end=0.02)
  for scheme in proxy lommen; do
    tandem run spring_damper "${many[@]}" --set "coupling.scheme=$scheme" --out plain --force >plain.txt 2>&1 ||
      { cat plain.txt; return 1; }
    for p in 2 3; do
      tandem run spring_damper "${many[@]}" --set "coupling.scheme=$scheme" --out on --force \
        --set "coupling.solvers.dem=${mpi[*]} $p tandem-dem" >on.txt 2>&1 || { cat on.txt; return 1; }
      for file in body_box.csv; do
        cmp "plain/$file" "on/$file"
      done
      echo "  spring_damper, $scheme, $p ranks: the same bits"
    done
  done
}

faults() {
  local status=0 left=()
  ranks 3 refused run heap.json --out refused --set dem.no_such=1 || status=$?
  [ $status = 1 ] && grep -q 'no_such' refused.txt || { cat refused.txt; return 1; }
  status=0
  ranks 2 refused run heap.json --out refused --set 'dem.contact={"multi_contact": "mc-strain"}' \
    --set 'dem.pairs[0].gamma=0.1' --set dem.energy=false || status=$?
  [ $status = 1 ] && grep -q 'cannot be shared among ranks' refused.txt || { cat refused.txt; return 1; }
  status=0
  ranks 2 refused bench || status=$?
  [ $status = 2 ] && grep -q 'bench works on one process' refused.txt || { cat refused.txt; return 1; }

  # what was computed is kept when the run is stopped
  "${mpi[@]}" 2 tandem-dem run "$out/heap.json" --out stopped --no-plots --set time.end=1000 >stopped.txt 2>&1 &
  pid=$!
  started stopped/channels.csv
  kill -TERM $pid
  wait $pid && return 1
  nothing_left
  grep -q interrupted stopped/summary.json || { cat stopped.txt; return 1; }

  # a rank dies, alone and coupled: a named error, nothing left
  "${mpi[@]}" 3 tandem-dem run "$out/heap.json" --out died --no-plots --set time.end=1000 >died.txt 2>&1 &
  pid=$!
  started died/channels.csv
  kill -KILL "${left[1]}"
  wait $pid && return 1
  grep -q 'signal 9' died.txt || { cat died.txt; return 1; }
  nothing_left
  status=0
  tandem run spring_damper --set time.end=1000 --set coupling.timeout=10 --out "$out/lost" \
    --set "coupling.solvers.dem=${mpi[*]} 2 tandem-dem" >lost.txt 2>&1 &
  pid=$!
  started lost/body_box.csv
  kill -KILL "${left[1]}"
  wait $pid || status=$?
  [ $status = 1 ] && grep -q 'the solver "dem"\|dem: ' lost.txt || { cat lost.txt; return 1; }
  nothing_left
  echo "  errors, a run that is stopped, a rank that dies: named, nothing left"
}

alone
coupled
faults

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

# work P DIR: the summary has what each of P ranks did, and their homes add up
work() {
  python3 - "$1" "$2/summary.json" <<'END'
import json, sys
summary = json.load(open(sys.argv[2]))
ranks, size = summary["ranks"], int(sys.argv[1])
work = ranks["work"]
assert ranks["number"] == len(work) == size and ranks["lists"] > 1, ranks
particles = sum(w["particles"] for w in work) * summary["steps"]
assert abs(particles / summary["particle_steps"] - 1) < 0.01, (particles, summary["particle_steps"])
messages = sum(w["messages"] for w in work) * summary["steps"]
assert messages > 0 and abs(messages / 2 - round(messages / 2)) < 1e-3, messages
assert all(w["compute_s"] >= 0 and w["exchange_s"] > 0 for w in work), work
END
}

alone() {
  ranks 0 one run heap.json --out one --no-plots
  while read -r p threads; do # 8: more than chunks
    ranks "$p" on run heap.json --out on --force --no-plots --set "dem.threads=$threads" || { cat on.txt; return 1; }
    same one on
    [ "$p" = 1 ] || work "$p" on
    echo "  particles alone, $p ranks of $threads threads: the same bits"
  done <<<$'1 1\n2 1\n2 2\n3 1\n5 2\n8 1'
}

# started by dem.ranks, which needs no permission from Open MPI; in slices, with a law of contacts among others, which
# are seen, too, and pictures, for which rank 0 has all particles
asked() {
  local soft=(--set 'dem.contact={"multi_contact": "mc-strain", "iterations": 2}' --set 'dem.pairs[0].gamma=0.5'
    --set dem.decomposition.order=slices --set time.end=0.005
    --set output.contacts=true --set 'output.pictures={"times": [0, 0.002]}')
  ranks 0 one run heap.json --out one --force --no-plots "${soft[@]}"
  (
    unset OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM
    ranks 0 on run heap.json --out on --force --no-plots "${soft[@]}" --set dem.ranks=3 || { cat on.txt; return 1; }
  )
  same one on
  grep -q '"number": 3' on/summary.json
  printf '1\n2\n' | { # mpirun leaves the standard input to others
    read -r
    tandem-dem run heap.json --out on --force --no-plots --set time.end=4e-5 --set dem.ranks=2 >on.txt 2>&1
    read -r number && [ "$number" = 2 ]
  }
  echo "  dem.ranks, contacts among others: the same bits"
}

# runs NAME WORDS…: a coupled run whose results go to NAME
runs() {
  local name=$1
  shift
  tandem run "$@" --out "$name" --force >"$name.txt" 2>&1 || { cat "$name.txt"; return 1; }
}

# beds of several chunks, in the boxes of [L18] Section 3.3 and 3.4
coupled() {
  local many=(--set 'dem.particles[0].count=4500' --set 'dem.particles[0].radius=0.024' --set time.dt=5e-5
    --set dem.settle.max_time=0.01 --set time.end=0.02) p
  runs plain spring_damper "${many[@]}" --set coupling.scheme=lommen
  runs on spring_damper "${many[@]}" --set coupling.scheme=lommen --set "dem.solver=${mpi[*]} 2 tandem-dem"
  cmp plain/body_box.csv on/body_box.csv
  echo "  spring_damper, lommen, 2 ranks: the same bits"
  runs plain torsional "${many[@]}"
  for p in 2 3; do
    runs on torsional "${many[@]}" --set "dem.ranks=$p"
    cmp plain/body_box.csv on/body_box.csv
    cmp plain/dem.csv on/dem.csv
    echo "  torsional, proxy, $p ranks: the same bits"
  done
}

# refused STATUS TEXT COMMAND…: ends with the status and says the text
refused() {
  local wanted=$1 text=$2 status=0
  shift 2
  timeout 60 "$@" >refused.txt 2>&1 </dev/null || status=$?
  [ $status = "$wanted" ] && grep -q "$text" refused.txt || { cat refused.txt; echo "status $status"; return 1; }
}

errors() {
  local alone=(tandem-dem run heap.json --out refused) together=(tandem run spring_damper --out refused)
  refused 1 'no_such' "${mpi[@]}" 3 "${alone[@]}" --set dem.no_such=1
  refused 2 'bench works on one process' "${mpi[@]}" 2 tandem-dem bench
  refused 1 'dem.ranks: is 3, but this solver was started as 2' "${mpi[@]}" 2 "${alone[@]}" --set dem.ranks=3
  refused 2 '3 processes are wanted.* has started 2' "${mpi[@]}" 2 "${alone[@]}" --ranks 3
  refused 2 '3 processes are wanted.* has started 1' env PMI_SIZE=1 "${alone[@]}" --ranks 3
  refused 1 'dem.ranks: is 4, but this solver was started as 1' "${alone[@]}" --set dem.ranks=4 --ranks 1
  refused 1 'dem.ranks: is 4, but this solver was started as 1' tandem-dem-mpi "${alone[@]:1}" --set dem.ranks=4
  refused 2 'ranks is there twice' "${alone[@]}" --ranks 2 --ranks 2
  refused 2 '/dev/stdin can be read only once' tandem-dem run /dev/stdin --out refused --ranks 2
  refused 1 'dem.ranks.* is 3, but this solver was started as 2' "${together[@]}" --set dem.ranks=3 \
    --set "dem.solver=${mpi[*]} 2 tandem-dem"
  refused 1 'dem.ranks: is 2, but with coupling.transport' "${together[@]}" --set dem.ranks=2 \
    --set coupling.transport=inproc
  refused 1 'dem.ranks: is 5000 but must be at most' "${alone[@]}" --set dem.ranks=5000
  refused 1 'dem.ranks.* is 5000 but must be at most' "${together[@]}" --set dem.ranks=5000
  refused 2 'ranks needs a number of processes' "${alone[@]}" --ranks two
  # a rank that does not see the result directory, as on another machine
  refused 1 'rank 1 of 2: refused/particles_000000.vtp.part: cannot be written: No such file.*on other machines' \
    "${mpi[@]}" 1 tandem-dem-mpi "${alone[@]:1}" : -n 1 --wdir / tandem-dem-mpi
  grep -q '"error": "rank 1 of 2: .*No such file' refused/summary.json
  [ ! -e refused/particles_000000.vtp ]
  [ ! -e refused/particles_000000.vtp.part ]
  mkdir bin
  cp "$(command -v tandem-dem)" bin
  refused 1 'dem.ranks: .*tandem-dem-mpi.* install libopenmpi-dev' env PATH=/usr/bin:/bin bin/"${alone[@]}" \
    --set dem.ranks=2
  cp "$(command -v tandem-dem-mpi)" bin
  refused 1 'dem.ranks: .*mpirun.* install openmpi-bin' env PATH=/nowhere bin/"${alone[@]}" --set dem.ranks=2
  printf 'another build' >>bin/tandem-dem-mpi
  refused 1 'the ranks run different builds of tandem' "${mpi[@]}" 1 tandem-dem-mpi "${alone[@]:1}" : \
    -n 1 bin/tandem-dem-mpi "${alone[@]:1}"
  echo "  errors: named"
}

# victim WHO: mpirun, one of its ranks, by number, or all that a terminal's Ctrl-C goes to
victim() {
  case $1 in
  mpirun) echo "$launcher" ;;
  all) echo "-$pid" ;;
  *) echo "${left[$1]}" ;;
  esac
}

# hit SIGNAL WHO STATUS TEXT FILE COMMAND…: that ends a program that has written to FILE, with the status and the text,
# and nothing is left
hit() {
  local signal=$1 who=$2 wanted=$3 text=$4 file=$5 status=0 left=() launcher
  shift 5
  rm -rf "$(dirname "$file")"
  "$@" --set time.end=1000 >hit.txt 2>&1 </dev/null &
  pid=$!
  started "$file"
  launcher=$(ps -o ppid= -p "${left[0]}" | tr -d ' ')
  kill "-$signal" -- "$(victim "$who")"
  wait $pid || status=$?
  nothing_left
  [ $status = "$wanted" ] && grep -q "$text" hit.txt "$(dirname "$file")/summary.json" ||
    { cat hit.txt; echo "$signal $who: status $status"; return 1; }
  echo "  $signal to $who of $1 …: named, nothing left"
}

faults() {
  local alone=(tandem-dem run heap.json --out hit --no-plots)
  local together=(tandem run spring_damper --out hit --set coupling.timeout=5)
  # what was computed is kept when the run is stopped
  hit TERM mpirun 1 '"status": "TDM_ERR_INTERRUPTED"' hit/channels.csv "${mpi[@]}" 2 "${alone[@]}"
  hit INT mpirun 1 '"status": "TDM_ERR_INTERRUPTED"' hit/channels.csv "${alone[@]}" --set dem.ranks=2
  hit KILL 1 137 'rank 1 .* signal 9' hit/channels.csv "${mpi[@]}" 3 "${alone[@]}"
  hit KILL 0 137 'rank 0 .* signal 9' hit/channels.csv "${alone[@]}" --set dem.ranks=2
  hit KILL mpirun 137 'unfinished\|INTERRUPTED' hit/channels.csv "${alone[@]}" --set dem.ranks=2
  hit KILL 1 1 'dem.* ended before the run did (exit status 137)' hit/body_box.csv "${together[@]}" \
    --set "coupling.solvers.dem=${mpi[*]} 2 tandem-dem"
  hit KILL 0 1 'dem.* ended before the run did (exit status 137)' hit/body_box.csv "${together[@]}" --set dem.ranks=2
  hit KILL mpirun 1 'dem.* ended before the run did.*signal 9' hit/body_box.csv "${together[@]}" --set dem.ranks=2
  hit INT all 130 '"status": "TDM_ERR_INTERRUPTED"' hit/body_box.csv setsid "${together[@]}" --set dem.ranks=2
  hit STOP 1 1 'dem.* no answer for 5 s' hit/body_box.csv "${together[@]}" --set dem.ranks=2
}

# a rank has memory for its share, and for what is near to it: bench_ranks.py prints how many shares that are
memory() {
  local shares
  python3 @PROJECT_SOURCE_DIR@/tests/bench/bench_ranks.py --bin @CMAKE_RUNTIME_OUTPUT_DIRECTORY@ --out memory \
    --memory 200000 --ranks 4 --steps 20 >memory.txt || { cat memory.txt; return 1; }
  shares=$(sed -n 's/^4 ranks: .*: //p' memory.txt)
  awk '{for (k = 1; k <= NF; k++) most = $k > most ? $k : most} END {exit !(NF == 4 && most > 0.5 && most < 1.3)}' \
    <<<"$shares" || { cat memory.txt; return 1; }
  echo "  memory of 4 ranks, in shares of one process: $shares"
}

alone
asked
coupled
memory
errors
faults

#!/usr/bin/env bash
# Adapters for solvers that others wrote, and tandem-dem on MPI, each with the Debian package that it needs: what is not
# installed is named and left out. usage: tests/adapters.sh [BUILD]
# SPDX-License-Identifier: GPL-3.0-or-later
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/release}
logs=$(mktemp -d)
trap 'rm -rf "$logs"' EXIT
declare -A package=([test_liggghts]=libliggghts-dev [test_yade]=yade
  [test_ranks]="libopenmpi-dev (with openmpi-bin)")

# together TEST…: those that are built, at the same time; what they say comes one after the other
together() {
  local test k status=0 built=() pids=()
  for test in "$@"; do
    if [ -e "$build/tests/$test" ]; then
      "$build/tests/$test" >"$logs/$test" 2>&1 &
      pids+=($!)
      built+=("$test")
    else
      echo "-- $test: skipped; it needs the package ${package[$test]}, installed before CMake runs"
    fi
  done
  for k in "${!pids[@]}"; do
    wait "${pids[k]}" || status=$?
    echo "-- ${built[k]}"
    cat "$logs/${built[k]}"
  done
  return $status
}

together test_liggghts test_yade test_ranks # the first two keep a core busy each, the third mostly waits

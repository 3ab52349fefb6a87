#!/usr/bin/env bash
# Adapters for solvers that others wrote, and tandem-dem on MPI, each with the Debian package that it needs: what is not
# installed is named and left out. usage: tests/adapters.sh [BUILD]
# SPDX-License-Identifier: GPL-3.0-or-later
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/release}

while read -r test package; do
  if [ -e "$build/tests/$test" ]; then
    echo "-- $test"
    "$build/tests/$test"
  else
    echo "-- $test: skipped; it needs the package $package, installed before CMake runs"
  fi
done <<END
test_liggghts libliggghts-dev
test_yade yade
test_ranks libopenmpi-dev (with openmpi-bin)
END

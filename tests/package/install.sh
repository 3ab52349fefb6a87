#!/bin/sh
# Install tandem into a folder of its own, build a solver against that with CMake and with pkg-config, and run it.
# usage: install.sh BUILD SOURCE SCRATCH, with CC, CMAKE and (may be empty) CXX in the environment
# SPDX-License-Identifier: GPL-3.0-or-later
set -eu
build=$1 source=$2 scratch=$3
here=$source/tests/package
prefix=$scratch/prefix

fail() {
  echo "install.sh: $*" >&2
  exit 1
}

rm -rf "$scratch"
mkdir -p "$scratch"
"$CMAKE" --install "$build" --prefix "$prefix" >"$scratch/install.log"

# nothing that is installed names the folder that it was built from
if grep -rlaF "$source" "$prefix"; then
  fail "the files above hold the path of the source"
fi

# found by CMake; by pkg-config with warnings as errors
"$CMAKE" -S "$here" -B "$scratch/cmake" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$CC" >"$scratch/cmake.log"
"$CMAKE" --build "$scratch/cmake" >>"$scratch/cmake.log"
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name tandem-participant.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046 # a list of words
"$CC" -std=c11 -Wall -Wextra -pedantic -Werror -o "$scratch/spring_solver" "$here/spring_solver.c" \
  $(pkg-config --cflags --libs tandem-participant)

# what is linked is libzmq and jansson (with what these need themselves): no GSL, and no gnuplot is called
for library in gsl sundials klu gomp; do
  if ldd "$scratch/spring_solver" | grep -q "lib$library"; then
    fail "the participant library brings lib$library"
  fi
done
if grep -qa gnuplot "$scratch/spring_solver"; then
  fail "the participant library knows gnuplot"
fi

# every installed header, alone and from C++, in any order
for header in $(cd "$prefix/include/tandem" && find . -name '*.h' | sort); do
  printf '#include "%s"\n' "$header" | tee -a "$scratch/headers.cc" >"$scratch/header.c"
  echo 'int main(void) { return 0; }' >>"$scratch/header.c"
  "$CC" -std=c11 -Wall -Wextra -pedantic -Werror -fsyntax-only -I"$prefix/include/tandem" "$scratch/header.c" ||
    fail "$header does not compile by itself"
done
if [ -n "${CXX:-}" ]; then
  echo 'int main() { return tdm_nearest("a", nullptr, 0) != nullptr; }' >>"$scratch/headers.cc"
  # shellcheck disable=SC2046 # a list of words
  "$CXX" -std=c++11 -Wall -Wextra -pedantic -Werror -o "$scratch/headers" "$scratch/headers.cc" \
    $(pkg-config --cflags --libs tandem-participant)
  "$scratch/headers"
fi

# both take part, and come out at x = 0.1 m sin(10/s 0.2 s)
for solver in "$scratch/cmake/spring_solver" "$scratch/spring_solver"; do
  "$prefix/bin/tandem" run "$here/scene.json" --out "$scratch/out" --force \
    --set coupling.solvers.dem="$solver" >"$scratch/run.log" 2>&1 || {
    cat "$scratch/run.log"
    fail "the run with $solver failed"
  }
  tail -n 1 "$scratch/out/body_mass.csv" | awk -F, '{ off = $2 - 0.1 * sin(2); exit !($1 == 0.2 && off * off < 1e-6) }' ||
    fail "with $solver the body is not at 0.0909297 m at 0.2 s: see $scratch/out/body_mass.csv"
done
# scenarios are found beside the programs, wherever the installation is moved
mv "$prefix" "$scratch/moved"
(cd "$scratch" && "$scratch/moved/bin/tandem" check spring_damper >/dev/null) || fail "no scenarios in the installation"

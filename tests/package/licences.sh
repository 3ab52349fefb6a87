#!/bin/sh
# Every source and build file has one line with its licence, and the participant library is MIT throughout.
# Data and prose, which have no such line, are under LICENSE, or under the one in their own folder.
# usage: licences.sh SOURCE FILE..., the files of the participant library, from SOURCE/protocol
# SPDX-License-Identifier: GPL-3.0-or-later
set -eu
cd "$1"
shift

fail() {
  echo "licences.sh: $*" >&2
  failed=1
}
failed=

# the licence that the line of a file names; the word is put together so that this file has one such line only
licence_of() {
  sed -n "s,^[/#* ]*SPDX-License""-Identifier: \([A-Za-z0-9.-]*\).*,\1,p" "$1"
}

sources() {
  find CMakeLists.txt .clang-format .ci protocol dem mbd coupler scenarios tests docs -type f 2>/dev/null |
    grep -E '(\.([ch]|sh|in|py|awk|cmake|js|css|html)|Doxyfile|/CMakeLists\.txt|^CMakeLists\.txt|\.ci/.*|\.clang-format)$'
}

# all files at once: those with another number of lines than one, and those whose line names another licence
line="^[/#* ]*SPDX-License""-Identifier: "
for file in $({ sources | xargs grep -HcE "$line" | sed -n '/:1$/!s/:[0-9]*$//p'
    sources | xargs grep -LE "$line(MIT|GPL-3\.0-or-later)([^A-Za-z0-9.-]|\$)"; } | sort -u); do
  fail "$file: give it one line with SPDX-License""-Identifier: MIT or GPL-3.0-or-later"
done

# the library's sources, and all headers of ours that these include, and so on
waiting=
for file in "$@"; do
  waiting="$waiting protocol/$file"
done
seen=" "
while [ -n "$waiting" ]; do
  included=
  for file in $waiting; do
    case $seen in *" $file "*) continue ;; esac
    seen="$seen$file "
    [ "$file" != protocol/version.h ] || file=protocol/package/version.h.in
    [ "$(licence_of "$file")" = MIT ] || fail "$file: is part of the participant library, so it must be MIT"
    included="$included $(sed -n 's/^#include "\(.*\)".*/\1/p' "$file")"
  done
  waiting=$(echo $included)
done
case $seen in
  *" protocol/wire/participant.h "*" protocol/math/vec3.h "* | *" protocol/math/vec3.h "*" protocol/wire/participant.h "*) ;;
  *) fail "the participant library was not read: $seen" ;;
esac
[ -z "$failed" ]

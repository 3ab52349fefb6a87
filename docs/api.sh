#!/bin/sh
# API documentation of public headers with Doxygen; fails when something in them is not documented, or wrongly.
# usage: api.sh FOLDER VERSION HEADER..., headers from the root of the source
# SPDX-License-Identifier: GPL-3.0-or-later
set -eu
TANDEM_API_DIR=$1 TANDEM_VERSION=$2
shift 2
TANDEM_API_HEADERS=$*
export TANDEM_API_DIR TANDEM_VERSION TANDEM_API_HEADERS
cd "$(dirname "$0")/.."
mkdir -p "$TANDEM_API_DIR"
doxygen docs/Doxyfile 2>"$TANDEM_API_DIR/warnings" || {
  cat "$TANDEM_API_DIR/warnings" >&2
  exit 1
}
if [ -s "$TANDEM_API_DIR/warnings" ]; then
  cat "$TANDEM_API_DIR/warnings" >&2
  exit 1
fi

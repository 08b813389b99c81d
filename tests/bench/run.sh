#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds the benchmarks, and runs those that are named, or all.
#   run.sh [NAME...]
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
build=${CALVIN_BENCH_BUILD:-$source/build-bench}
"$source/examples/install-packages.sh" build test bench
[ -f "$build/build.ninja" ] ||
  meson setup "$build" "$source" --buildtype=release -Dbenchmarks=enabled
ninja -C "$build"
[ $# -gt 0 ] || set -- $(ls "$source/tests/bench" | sed -n 's/^bench_\(.*\)\.cpp$/\1/p')
export GST_PLUGIN_PATH_1_0="$build/gst"
for name in "$@"; do
  echo "== $name"
  "$build/tests/bench/bench_$name"
done

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds the benchmarks, and runs those that are named, or all.
#   run.sh [--smallest] [NAME...]
# --smallest: the smallest case of each, once, to see that it runs; its times say nothing.
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
build=${CALVIN_BENCH_BUILD:-$source/build-bench}
smallest=""
case "${1:-}" in
  --smallest)
    smallest=1
    shift
    ;;
  -*) sed -n '3,5s/^# *//p' "$0" >&2; exit 2 ;;
esac
"$source/examples/install-packages.sh" build test bench
[ -f "$build/build.ninja" ] || meson setup "$build" "$source" -Dbenchmarks=enabled
[ $# -gt 0 ] || set -- $(ls "$source/tests/bench" | sed -n 's/^bench_\(.*\)\.cpp$/\1/p')
# shellcheck disable=SC2046 # one word per program
ninja -C "$build" gst/libgstcalvin.so examples/calvin-rig tests/v4l2shim/libv4l2shim.so \
  $(printf 'tests/bench/bench_%s\n' "$@")
export GST_PLUGIN_PATH_1_0="$build/gst"

# The arguments of a program's smallest case.
smallest_case() {
  case "$1" in
    circles | codes | light) echo 1 640 480 ;;
    detect) echo 1 1 640 480 ;;
    elements) echo --benchmark_filter=[^a]sync.*GRAY8 ;;
    live) echo 1 ;;
    overlay) echo '--benchmark_filter=^NV12.720p[|]' ;;
    light_rig) echo '--benchmark_filter=^4.cameras..300' ;;
    rig) echo '--benchmark_filter=^4.cameras..50' ;;
    rig_pictures) echo 4 60 ;;
    scores) echo '--benchmark_filter=calvin' ;;
    solve) echo '--benchmark_filter=brown5.10.views' ;;
    undistort) echo '--benchmark_filter=^GRAY8.1080p[|]' ;;
    views) echo '--benchmark_filter=^480x270' ;;
  esac
  case "$1" in
    circles | codes | detect | light | live | rig_pictures) ;;
    *) echo --benchmark_repetitions=1 --benchmark_min_time=0.001 ;;
  esac
}
# The emulated camera, for those that need one.
preloaded() {
  case "$1" in
    live) echo "$build/tests/v4l2shim/libv4l2shim.so" ;;
  esac
}
for name in "$@"; do
  echo "== $name"
  # shellcheck disable=SC2046 # several words
  LD_PRELOAD=$(preloaded "$name") \
    "$build/tests/bench/bench_$name" $([ -z "$smallest" ] || smallest_case "$name")
done

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the plugin and its tests under a sanitizer, and runs them.
#   run.sh address BUILD   address and undefined behaviour: the suite `memory`
#   run.sh thread BUILD    data races: the suite `threads`
# CALVIN_BUILD_ONLY=1 does not run them. CALVIN_ARCHIVE is the libcalvin_internal.a of another build
# of this source: what is looked for is then looked for in the plugin, where threads and frames are,
# and in the tests. CALVIN_FULL=1 looks for it everywhere, also checks what takes as long to compile
# as all the rest, pointers that are null or not aligned, and runs all of tests/check for the first.
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
build=$2
args=""
archive=${CALVIN_ARCHIVE:-}
patience=2 # times as long as a test may take
[ -z "${CALVIN_FULL:-}" ] || patience=240 archive=""
case "$1" in
  address)
    sanitize=address,undefined suite=check
    if [ -z "${CALVIN_FULL:-}" ]; then
      args="$args -fno-sanitize=null -fno-sanitize=alignment -fno-sanitize=object-size"
      args="$args -fno-sanitize=vptr -fno-sanitize=nonnull-attribute"
      suite=memory
    fi
    ;;
  thread) sanitize=thread suite=threads ;;
  *) sed -n '4,5s/^# *//p' "$0" >&2; exit 2 ;;
esac
# Eigen takes memory in another way under a sanitizer, and so would free what the archive took.
[ -z "$archive" ] || args="$args -DEIGEN_MALLOC_ALREADY_ALIGNED=1"

if [ ! -f "$build/build.ninja" ]; then
  # gcc sees ghosts in instrumented code: its warnings count in the other builds alone.
  # With b_lundef a sanitized library does not link: its run-time is in the program.
  meson setup "$build" "$source" --buildtype=plain -Doptimization=1 -Dcpp_args="$args" \
    -Dwerror=false \
    -Db_sanitize=$sanitize -Db_lundef=false -Dexamples=false -Darchive="$archive"
fi
ninja -C "$build" "$suite-programs"
[ -z "${CALVIN_BUILD_ONLY:-}" ] || exit 0
run() {
  meson test -C "$build" --no-rebuild --num-processes 2 --print-errorlogs --suite "$suite" \
    --timeout-multiplier $patience
}
run && exit 0
status=$?
# Now and then LeakSanitizer's own tracer crashes where a thread of GLib's ends together with the
# program, whose tests have passed (github.com/google/sanitizers/issues/1353).
grep -q 'Tracer caught signal' "$build/meson-logs/testlog.txt" || exit $status
echo 'The tracer of LeakSanitizer has crashed: once more.'
run

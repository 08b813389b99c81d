#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds, and runs every test.
#   run.sh           every claim at a reduced count
#   run.sh --full    the counts that docs and issues name, and every other build (tests/builds/run.sh)
# CALVIN_WERROR=true makes warnings errors, as .ci/run does.
# Real pictures are taken from the folder that CALVIN_DATA names, ../shared/data where it is there.
set -eu

source=$(cd "$(dirname "$0")/.." && pwd)
build=${CALVIN_BUILD:-$source/build-tests}
patience=1 # times as long as a test may take
case "${1:-}" in
  "") ;;
  --full) export CALVIN_FULL=1 patience=60 ;;
  *) sed -n '3,7s/^# *//p' "$0" >&2; exit 2 ;;
esac

"$source/examples/install-packages.sh" build test
if [ -z "${CALVIN_DATA:-}" ] && [ -d "$source/../shared/data" ]; then
  CALVIN_DATA=$(cd "$source/../shared/data" && pwd)
fi
export CALVIN_DATA="${CALVIN_DATA:-}"
export CCACHE_SLOPPINESS=pch_defines,time_macros # precompiled headers, where there is ccache

[ -f "$build/build.ninja" ] || meson setup "$build" "$source" --unity=on -Dunity_size=8 \
  -Dwerror="${CALVIN_WERROR:-false}"
ninja -C "$build"

# A language whose numbers have commas, without touching the system.
if [ ! -d "$build/locale/de_DE.UTF-8" ]; then
  mkdir -p "$build/locale"
  localedef -i de_DE -f UTF-8 "$build/locale/de_DE.UTF-8"
fi
export LOCPATH="$build/locale"

# A sanitizer cannot be mixed into another build: these have folders of their own. They are built
# in the gaps that tests leave, which often wait for the clock.
status=0
export CALVIN_ARCHIVE="$build/lib/libcalvin_internal.a"
for sanitizer in address thread; do
  CALVIN_BUILD_ONLY=1 nice -n 19 "$source/tests/sanitizers/run.sh" $sanitizer "$build-$sanitizer" ||
    break
done >"$build/sanitizers.log" 2>&1 &
builder=$!
meson test -C "$build" --no-rebuild --num-processes 2 --print-errorlogs \
  --timeout-multiplier $patience || status=$?
wait "$builder" || true # what went wrong shows below
for sanitizer in address thread; do
  "$source/tests/sanitizers/run.sh" $sanitizer "$build-$sanitizer" || status=$?
done

# The other build types, compilers and systems, one after the other; each is counted as a test.
others=""
if [ -n "${CALVIN_FULL:-}" ]; then
  others=$build-others
  "$source/tests/builds/run.sh" "$others" || status=$?
fi

# The closing line, counted from meson's own lists. A build that failed has none and is a failure.
python3 - "$build" "$build-address" "$build-thread" ${others:+"$others"} <<'END'
import json
import os
import sys

results = []
for build in sys.argv[1:]:
    logs = [os.path.join(build, name) for name in ("meson-logs/testlog.json", "results.json")]
    path = next(filter(os.path.exists, logs), None)
    if path is None:
        results.append({"name": build, "result": "ERROR"})
        continue
    with open(path) as log:
        results += [json.loads(line) for line in log if line.strip()]
passed, skipped = ([r for r in results if r["result"] == word] for word in ("OK", "SKIP"))
failed = [r for r in results if r["result"] not in ("OK", "SKIP")]
for result in failed:
    print(f"{result['name']}: {result['result']}")
    printed = result.get("stdout", "") + result.get("stderr", "")
    print("\n".join("  " + line for line in printed.splitlines()[-15:]))
print(f"{len(passed)} passed, {len(failed)} failed, {len(skipped)} skipped")
END

# Whether the tests would notice mistakes.
if [ -n "${CALVIN_FULL:-}" ]; then
  "$source/tests/mutants/run.py" --dir "$build-mutants" --jobs 2 || status=$?
fi
exit "$status"

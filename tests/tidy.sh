#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# clang-tidy over a configured build folder; CALVIN_FULL=1: every file and every check.
#   tidy.sh BUILD
# The release's own version, whichever it is; skipped where there is none.
# The reduced run leaves out what takes longest: the static analyzer, and all but the elements with
# the most threads and their worker.
set -eu

source=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "$1" && pwd)
cd "$source"
tidy=$(command -v clang-tidy || command -v clang-tidy-14) || {
  echo "clang-tidy is not here: skipped."
  exit 77
}
if [ -n "${CALVIN_FULL:-}" ]; then
  files=$(find lib gst tests examples -name '*.cpp') checks=
else
  files="gst/detect/gstcalibdetect.cpp gst/solve/gstcalibsolve.cpp gst/rig/gstcalibrig.cpp"
  files="$files gst/common/worker.cpp lib/calvin/core/text.cpp"
  checks=-clang-analyzer-*
fi
# What was compiled beforehand is in gcc's own format: each file goes by what it includes itself. And
# where --unity=on joined files, each goes by the command of what it was joined to.
mkdir -p "$build/tidy"
python3 - "$build" <<'END'
import json
import os
import re
import sys

build = sys.argv[1]
with open(f"{build}/compile_commands.json") as given:
    commands = json.load(given)
each = []
for command in commands:
    command["command"] = re.sub(r"-include [a-z_]*_pch\.hpp", "", command["command"])
    name = command["file"]
    files = [name]
    if re.search(r"-unity\d+\.cpp$", name):
        with open(os.path.join(build, name)) as joined:
            included = re.findall(r"^#include *[<\"](.*)[>\"]", joined.read(), re.MULTILINE)
        files = [os.path.normpath(file) for file in included]
    for file in files:
        each.append(command | {"command": command["command"].replace(name, file), "file": file})
with open(f"{build}/tidy/compile_commands.json", "w") as made:
    json.dump(each, made, indent=2)
END
# Files that this build leaves out have no command.
for file in $files; do
  if grep -q "\"file\": \".*/$file\"" "$build/tidy/compile_commands.json"; then echo "$file"; fi
done | xargs -n 4 -P 2 "$tidy" --quiet -p "$build/tidy" --checks="$checks" \
  --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-unused-command-line-argument 2>/dev/null

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# What the example programs print is lost where it goes to a full disk, and they say so. Arguments:
# the programs.
# shellcheck disable=SC2016  # the inner shell expands
set -eu
start=$PWD
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

for program in "$@"; do
  program=$(cd "$start" && realpath "$program")
  expect 0 'calvin-' "$program" --help
  name=$(basename "$program")
  expect 1 "^$name: Cannot write what it prints: No space left" sh -c '"$0" --help >/dev/full' "$program"
done

# More than a buffer holds, of the one that prints as much.
cat >a.json <<END
{"format": "calvin-calibration", "version": 1, "image_size": [640, 480], "model": "pinhole",
 "parameters": {"fx": 500, "fy": 500, "cx": 320, "cy": 240}}
END
for program in "$@"; do
  [ "$(basename "$program")" = calvin-compare ] || continue
  program=$(cd "$start" && realpath "$program")
  "$program" --table 65 a.json a.json >out
  [ "$(wc -c <out)" -gt 8192 ] || fail 'a buffer holds it'
  expect 1 'Cannot write what it prints: No space left' sh -c '"$0" --table 65 a.json a.json >/dev/full' "$program"
  # A status of its own stays.
  sed 's/500/600/g' a.json >b.json
  expect 3 'Cannot write what it prints' sh -c '"$0" --limit 1 a.json b.json >/dev/full' "$program"
done

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# Which views calvin-solve takes, and of which board. Argument: the program.
set -eu
solve=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# Eight views of a board by a pinhole of 500 px, a second apart.
awk 'BEGIN {
  print "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"checkerboard:9x6:25mm\"}"
  for (n = 0; n < 8; ++n) {
    a = 0.5 * sin(2.4 * n); b = 0.5 * cos(2.4 * n); points = ""
    for (i = 0; i < 54; ++i) {
      x = 0.025 * (i % 9 - 4); y = 0.025 * (int(i / 9) - 2.5)
      z = 0.45 + x * sin(a) + y * cos(a) * sin(b)
      u = 320 + 500 * (x * cos(a) - y * sin(a) * sin(b) + 0.05 * sin(n)) / z
      v = 240 + 500 * (y * cos(b) + 0.02 * cos(3 * n)) / z
      points = points sprintf("%s[%d,%.4f,%.4f,0.05]", i ? "," : "", i, u + 0.05 * sin(99 * n + 7 * i * i), v + 0.05 * cos(77 * n + 5 * i * i))
    }
    printf "{\"timestamp\":%d000000000,\"image_size\":[640,480],\"points\":[%s]}\n", n + 1, points
  }
}' >views.jsonl

# The board that a file of observations has, or that of --board, if it is the same of another size.
expect 0 'view 0, 1.000 s: 54 points' "$solve" camera.json views.jsonl
grep -q '"board": "checkerboard:9x6:25mm"' camera.json || fail "another board: $(cat camera.json)"
expect 0 "views of the board 'checkerboard:9x6:25mm', which is taken as 'checkerboard:9x6:30mm'" "$solve" \
  --board checkerboard:9x6:30mm camera.json views.jsonl
grep -q '"board": "checkerboard:9x6:30mm"' camera.json || fail "not the board of --board: $(cat camera.json)"
cp camera.json before.json
expect 1 "and --board is 'circles:7x6:25mm'" "$solve" --board circles:7x6:25mm camera.json views.jsonl
cmp -s camera.json before.json || fail 'a failure has touched the file'

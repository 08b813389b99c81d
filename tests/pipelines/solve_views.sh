#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# Which views calvin-solve takes, and of which board. Argument: the program.
set -eu
solve=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

pinhole_views 8 >views.jsonl

# The board that a file of observations has, or that of --board, if it is the same of another size.
expect 0 'view 0, 1.000 s: 54 points' "$solve" camera.json views.jsonl
grep -q '"board": "checkerboard:9x6:25mm"' camera.json || fail "another board: $(cat camera.json)"
expect 0 "views of the board 'checkerboard:9x6:25mm', which is taken as 'checkerboard:9x6:30mm'" "$solve" \
  --board checkerboard:9x6:30mm camera.json views.jsonl
grep -q '"board": "checkerboard:9x6:30mm"' camera.json || fail "not the board of --board: $(cat camera.json)"
cp camera.json before.json
expect 1 "and --board is 'circles:7x6:25mm'" "$solve" --board circles:7x6:25mm camera.json views.jsonl
cmp -s camera.json before.json || fail 'a failure has touched the file'

# Files of observations say how large their pictures are.
expect 1 "of images of 640x480 px, and --size is 1280x960" "$solve" --size 1280x960 camera.json views.jsonl
cmp -s camera.json before.json || fail 'a failure has touched the file'
expect 0 'view 0, 1.000 s: 54 points' "$solve" --size 640x480 camera.json views.jsonl

# A view that is given twice is no other one: the camera and its sigmas stay as they are.
expect 0 'view 7, 8.000 s: 54 points' "$solve" camera.json views.jsonl
cp camera.json once.json
cp views.jsonl copy.jsonl
expect 0 'view 8, 1.000 s is the same as view 0, 1.000 s, and counts once' "$solve" camera.json views.jsonl copy.jsonl
[ "$(grep -c 'counts once' out)" = 8 ] || fail "not all copies are said: $(cat out)"
cmp -s camera.json once.json || fail "copies count: $(diff camera.json once.json)"
# What is dropped is dropped with its copies, and has to be there.
expect 0 'view 0, 1.000 s' "$solve" --drop 2,7 camera.json views.jsonl
cp camera.json dropped.json
expect 0 'view 10, 3.000 s is the same as view 2' "$solve" --drop 2,7 camera.json views.jsonl copy.jsonl
cmp -s camera.json dropped.json || fail "copies of what was dropped count: $(diff camera.json dropped.json)"
expect 1 'no view 77 to --drop: there are 8, numbered from 0 to 7' "$solve" --drop 2,77 camera.json views.jsonl
expect 1 'no view 8 to --drop' "$solve" --drop 8 camera.json views.jsonl
expect 1 'leaves no view' "$solve" --drop 0,1,2,3,4,5,6,7 camera.json views.jsonl
head -1 views.jsonl >none.jsonl
expect 1 'There is no view of a board' "$solve" camera.json none.jsonl
expect 1 'There is no view of a board' "$solve" --drop 0 camera.json none.jsonl

# Rows of points, in a file of another name.
awk 'BEGIN {
  for (i = 0; i < 60; ++i) {
    x = 0.1 * sin(7 * i); y = 0.1 * cos(5 * i); z = 0.1 * sin(3 * i + 1)
    printf "%.9f %.9f %.9f %.4f %.4f\n", x, y, z, 320 + 500 * x / (z + 0.6) + 0.05 * sin(99 * i), 240 + 500 * y / (z + 0.6) + 0.05 * cos(77 * i)
  }
}' >box.txt
cp box.txt copied.txt
expect 0 'view 0, box.txt' "$solve" --unit m --size 640x480 --model pinhole camera.json box.txt
cp camera.json once.json
expect 0 'view 1, copied.txt is the same as view 0, box.txt' "$solve" --unit m --size 640x480 --model pinhole camera.json box.txt copied.txt
cmp -s camera.json once.json || fail "copies count: $(diff camera.json once.json)"

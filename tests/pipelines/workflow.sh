#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs examples/workflow.sh on a build that is there already.
#   workflow.sh SOURCE BUILD
set -eu
source=$1
export CALVIN_BUILD="$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fails() { echo "FAILED: $1"; exit 1; }

pictures=${CALVIN_DATA:-}/opencv-samples
set --
if [ -d "$pictures" ]; then
  for camera in left right; do
    mkdir "$folder/$camera"
    cp "$pictures/$camera"[0-9]*.jpg "$folder/$camera"
  done
  set -- checkerboard:9x6:30mm "$folder/left" "$folder/right"
fi # else Debian's package is fetched, as on any machine
CALVIN_OUTPUT=$folder/out "$source/examples/workflow.sh" "$@" >"$folder/log" || {
  cat "$folder/log"; fails "workflow.sh"; }
cat "$folder/log"
# Bouguet has published 99.8 mm for the pair; one picture of each camera tells it less exactly.
grep -Eq "'left' and 'right': (9[89]|10[01])\.[0-9] mm apart" "$folder/log" || fails "another distance"
for camera in left right; do
  [ -s "$folder/out/$camera/camera.json" ] || fails "no calibration of $camera"
  [ "$(find "$folder/out/$camera" -name 'undistorted-*.png' | wc -l)" = 13 ] || fails "not all pictures of $camera"
done
grep -q '"world": "board"' "$folder/out/rig.json" || fails "the board is not the world"
[ -s "$folder/out/cameras.png" ] || fails "no view of the cameras"
"$source/examples/workflow.sh" checkerboard:9x6:30mm >"$folder/log" 2>&1 && fails "a board alone is taken"
grep -q "BOARD FOLDER" "$folder/log" || fails "wrong usage is not told"

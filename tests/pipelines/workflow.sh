#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs examples/workflow.sh on a build that is there already.
#   workflow.sh SOURCE BUILD
set -eu
source=$1
export CALVIN_BUILD="$2"
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

set --
if copy_pair; then set -- checkerboard:9x6:30mm "$folder/left" "$folder/right"; fi
export CALVIN_OUTPUT="$folder/result"
# Bouguet has published 99.8 mm for the pair; one picture of each camera tells it less exactly.
expect 0 "'left' and 'right': \(9[89]\|10[01]\)\.[0-9] mm apart" "$source/examples/workflow.sh" "$@"
cat out
for camera in left right; do
  [ -s "result/$camera/camera.json" ] || fail "no calibration of $camera"
  [ "$(find "result/$camera" -name 'undistorted-*.png' | wc -l)" = 13 ] || fail "not all pictures of $camera"
done
grep -q '"world": "board"' result/rig.json || fail "the board is not the world"
[ -s result/cameras.png ] || fail "no view of the cameras"
expect 2 'BOARD FOLDER' "$source/examples/workflow.sh" checkerboard:9x6:30mm

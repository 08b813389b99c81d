#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Two cameras side by side, from pictures of a board to pictures whose rows are the same.
#   stereo.sh [LEFT RIGHT [BOARD]]   a folder of pictures each, taken together in the order of their
#                                    names (none: those of Debian's opencv-doc)
# Files are left in the folder calvin-stereo, or the one that CALVIN_OUTPUT names.
set -eu

source=$(cd "$(dirname "$0")/.." && pwd)
build=${CALVIN_BUILD:-$source/build}
output=${CALVIN_OUTPUT:-$PWD/calvin-stereo}
start=$PWD
. "$source/examples/prepare.sh"

usage() {
  sed -n '4,6s/^# *//p' "$0" >&2
  exit 2
}

# A pair of pictures, rectified, one beside the other.
draw_pair() {
  gst-launch-1.0 -q compositor name=both sink_1::xpos="$width" ! videoconvert ! pngenc ! \
    filesink location="$3" \
    filesrc location="$1" ! decodebin ! videoconvert ! \
    calibundistort calibration=rig.json rectify=left ! both.sink_0 \
    filesrc location="$2" ! decodebin ! videoconvert ! \
    calibundistort calibration=rig.json rectify=right ! both.sink_1
}

case $# in 0 | 2 | 3) ;; *) usage ;; esac
board=${3:-checkerboard:9x6:30mm}
prepare calvin-calibrate-images calvin-rig calvin-show
if [ $# -eq 0 ]; then
  left=$output/opencv-doc/left
  right=$output/opencv-doc/right
  mkdir -p "$output/opencv-doc"
  fetch_pictures left "$left"
  fetch_pictures right "$right"
  rm -rf "$output/package"
else
  left=$(absolute "$1")
  right=$(absolute "$2")
fi

for camera in left right; do
  eval "pictures=\$$camera"
  # shellcheck disable=SC2154 # set by eval
  "$build/examples/calvin-calibrate-images" --board "$board" --output "$output/$camera" "$pictures"
done
"$build/examples/calvin-rig" --board "$board" rig.json left/camera.json "$left" \
  right/camera.json "$right"

width=$(sed -n 's/.*"image_size": *\[\([0-9]*\),.*/\1/p' left/camera.json | head -n 1)
number=1
for picture in "$left"/*; do
  other=$(find "$right" -type f | sort | sed -n "${number}p")
  [ -n "$other" ] || break
  draw_pair "$picture" "$other" "pair$(printf %02d "$number").png"
  number=$((number + 1))
done
echo "In $output: rig.json, and pair01.png and others, whose rows are the same left and right."

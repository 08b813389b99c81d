#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Cameras from pictures, in the steps of the semi-automatic tools: the intrinsic step for each
# camera, the extrinsic step for all of them by one board that lies still, undistorted pictures, and
# a look at where the cameras are.
#   workflow.sh [BOARD FOLDER...]    a folder of pictures for each camera; the first picture of each
#                                    shows the board where it lies (none: those of Debian's
#                                    opencv-doc, two cameras)
# Files are left in the folder calvin-workflow, or the one that CALVIN_OUTPUT names: FOLDER/camera.json
# and FOLDER/undistorted-*.png for each camera, rig.json and cameras.png.
set -eu

source=$(cd "$(dirname "$0")/.." && pwd)
build=${CALVIN_BUILD:-$source/build}
output=${CALVIN_OUTPUT:-$PWD/calvin-workflow}
start=$PWD
. "$source/examples/prepare.sh"

usage() {
  sed -n '6,8s/^# *//p' "$0" >&2
  exit 2
}

undistort() {
  gst-launch-1.0 -q filesrc location="$2" ! decodebin ! videoconvert ! \
    calibundistort calibration="$1" ! videoconvert ! pngenc ! filesink location="$3"
}

[ $# -ne 1 ] || usage
board=${1:-checkerboard:9x6:30mm}
prepare calvin-calibrate-images calvin-rig
if [ $# -eq 0 ]; then
  mkdir -p "$output/opencv-doc"
  for camera in left right; do
    fetch_pictures "$camera" "$output/opencv-doc/$camera"
  done
  rm -rf "$output/package"
  set -- "$output/opencv-doc/left" "$output/opencv-doc/right"
else
  shift
fi

# The intrinsic step; what the extrinsic one takes, a calibration and a picture for each camera, is
# put behind the folders, which are then shifted away.
folders=$#
for folder in "$@"; do
  folder=$(absolute "$folder")
  camera=$(basename "$folder")
  "$build/examples/calvin-calibrate-images" --board "$board" --output "$output/$camera" "$folder"
  first=$(find "$folder" -type f | sort | head -n 1)
  set -- "$@" "$camera/camera.json" "$first*"
  for picture in "$folder"/*; do
    name=$(basename "$picture")
    undistort "$camera/camera.json" "$picture" "$camera/undistorted-${name%.*}.png"
  done
done
shift "$folders"

# The extrinsic step: the frame of the board is the world.
"$build/examples/calvin-rig" --floor --board "$board" rig.json "$@"
gst-launch-1.0 -q calibview rig=rig.json orbit=0 num-buffers=1 ! videoconvert ! pngenc ! \
  filesink location=cameras.png
echo "In $output: the calibrations, rig.json, and cameras.png, which shows where they are."

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs what is missing, builds, and calibrates a camera.
#   quickstart.sh                          a camera that does not exist, beside its ground truth
#   quickstart.sh --images [DIR [BOARD]]   a folder of pictures (none: those of Debian's opencv-doc)
#   quickstart.sh --camera [DEVICE [BOARD]]  a camera, live, until Ctrl-C
# Files are left in the folder calvin-quickstart, or the one that CALVIN_OUTPUT names.
set -eu

source=$(cd "$(dirname "$0")/.." && pwd)
build=${CALVIN_BUILD:-$source/build}
output=${CALVIN_OUTPUT:-$PWD/calvin-quickstart}

usage() {
  sed -n '4,7s/^# *//p' "$0" >&2
  exit 2
}

. "$source/examples/prepare.sh"

# One picture of the synthetic camera as it is, and one undistorted.
draw_pair() {
  for name in before after; do
    undistort=""
    [ "$name" = before ] || undistort="! calibundistort calibration=camera.json"
    # shellcheck disable=SC2086 # several words
    gst-launch-1.0 -q calibtestsrc num-buffers=1 $undistort ! videoconvert ! pngenc ! \
      filesink location="$name.png"
  done
}

run_synthetic() {
  gst-launch-1.0 -q calibtestsrc num-buffers=60 ground-truth=truth.json ! \
    calibrate location=camera.json export=ros:camera_info.yaml,opencv-yaml:camera.yml ! fakesink
  draw_pair
  "$build/examples/calvin-show" camera.json truth.json
  echo
  echo "In $output:"
  ls -1
}

run_images() {
  board=${2:-checkerboard:9x6:25mm}
  if [ -n "${1:-}" ]; then
    pictures=$(absolute "$1")
  else
    pictures=$output/opencv-doc
    fetch_pictures left "$pictures"
    rm -rf "$output/package"
    board=checkerboard:9x6:30mm
  fi
  # calvin-calibrate-images does not replace the pair that the synthetic camera left here.
  [ ! -e truth.json ] || rm -f before.png after.png
  "$build/examples/calvin-calibrate-images" --board "$board" --output "$output" "$pictures"
}

# What a camera sends, for a pipeline: raw video where it has any, JPEG pictures otherwise.
frames_of() {
  if gst-launch-1.0 -q v4l2src device="$1" num-buffers=1 ! video/x-raw ! fakesink >/dev/null 2>&1; then
    echo video/x-raw
  else
    echo image/jpeg ! jpegdec
  fi
}

run_camera() {
  device=${1:-/dev/video0}
  board=${2:-checkerboard:9x6:25mm}
  sink="videoconvert ! autovideosink"
  [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || sink="fakesink sync=true"
  echo "Show the board ($board) to $device; Ctrl-C ends. The result goes to $output/camera.json."
  frames=$(frames_of "$device")
  trap : INT # Ctrl-C ends the pipeline, not this script
  # shellcheck disable=SC2086 # several words
  gst-launch-1.0 -e -m v4l2src device="$device" ! $frames ! \
    calibrate board="$board" location=camera.json ! $sink
  "$build/examples/calvin-show" camera.json
}

# shellcheck disable=SC2086 # several words
programs="calvin-board calvin-show calvin-calibrate-images"
start=$PWD
case "${1:-}" in
  "") [ $# -eq 0 ] || usage; prepare $programs; run_synthetic ;;
  --images) [ $# -le 3 ] || usage; shift; prepare $programs; run_images "$@" ;;
  --camera) [ $# -le 3 ] || usage; shift; prepare $programs; run_camera "$@" ;;
  *) usage ;;
esac

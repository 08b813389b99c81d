#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Draws the pictures of docs/images into a folder: run it in `meson devenv -C build`.
#   draw-picture.sh FOLDER
set -eu
out=$1
queue="queue max-size-buffers=0 max-size-time=0 max-size-bytes=0"
camera="fx=400,fy=400,cx=319,cy=241,k1=-0.32,k2=0.11,k3=-0.018,width=640,height=480"
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# A frame with the corners that were found beside the same frame undistorted.
# shellcheck disable=SC2086 # several words
gst-launch-1.0 -q \
  compositor name=mix background=white sink_1::xpos=650 ! video/x-raw,width=1290,height=480 ! \
  videoconvert ! pngenc snapshot=false ! multifilesink location="$folder/%02d.png" \
  calibtestsrc num-buffers=28 calibration="$camera" ! video/x-raw,format=I420,width=640,height=480 ! \
  calibrate overlay=false ! tee name=t ! $queue ! caliboverlay ! videoconvert ! mix.sink_0 \
  t. ! $queue ! calibundistort ! videoconvert ! mix.sink_1
mv "$folder/27.png" "$out/before-after.png"

# What whoever holds the board sees: the last of so many frames.
#   draw_session FRAMES FORMAT WIDTH HEIGHT FILE PROPERTY=VALUE...
draw_session() {
  frames=$1 format=$2 width=$3 height=$4 file=$5
  shift 5
  case $file in *.jpg) encoder="jpegenc quality=90" ;; *) encoder="pngenc snapshot=false" ;; esac
  # shellcheck disable=SC2086 # an element and its properties
  gst-launch-1.0 -q calibtestsrc motion=hand num-buffers="$frames" seed=3 ! \
    "video/x-raw,format=$format,width=$width,height=$height" ! \
    calibrate capture-mode=auto mode=sync "$@" ! videoconvert ! $encoder ! \
    multifilesink max-files=1 location="$folder/last%05d"
  mv "$folder"/last* "$out/$file"
}

# A session that is under way, at three sizes, and one that is done.
draw_session 420 NV12 640 480 guide.png
draw_session 420 BGRx 1920 1080 guide-1080.jpg
draw_session 420 NV12 3840 2160 guide-2160.jpg
draw_session 420 BGRx 640 480 done.png target-error=0.4

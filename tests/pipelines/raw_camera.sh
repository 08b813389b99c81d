#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# A camera with raw video in all the ways in which pipelines are typed. From GStreamer 1.24 on
# v4l2src offers its frames as DMA memory first, and decodebin takes what comes first.
#   raw_camera.sh SHIM
set -eu
shim=$1

for element in calibdetect calibsolve caliboverlay calibrate calibundistort \
  "calibundistort calibration=fx=480,fy=478,cx=325,cy=236,k1=-0.28,k2=0.09,width=640,height=480"; do
  for line in "$element" "decodebin ! $element ! videoconvert" \
    "decodebin ! videoconvert ! $element"; do
    output=$(CALVIN_V4L2_FORMATS=YUYV CALVIN_V4L2_FPS=120 LD_PRELOAD="$shim" timeout 60 \
      gst-launch-1.0 v4l2src num-buffers=3 ! $line ! fakesink 2>&1) && status=0 || status=$?
    if [ $status -ne 0 ] || echo "$output" | grep -q "linking failed"; then
      echo "FAILED: v4l2src ! $line"
      echo "$output"
      exit 1
    fi
  done
done

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# A camera that has nothing but JPEG pictures, as gst-launch-1.0 shows it to a user: every element
# says what to insert, and with that inserted it works.
#   refused_caps.sh SHIM
set -eu
shim=$1

camera() {
  CALVIN_V4L2_FORMATS=MJPG LD_PRELOAD="$shim" timeout 60 \
    gst-launch-1.0 v4l2src num-buffers=3 ! $* ! fakesink 2>&1 || true
}
for element in calibdetect calibsolve caliboverlay calibrate calibundistort "queue ! calibdetect"; do
  camera "$element" | grep -q "^ERROR: .*image/jpeg cannot be used here: insert jpegdec" || {
    echo "FAILED: $element does not say what to insert"
    exit 1
  }
  if camera "jpegdec ! $element" | grep "^ERROR"; then
    echo "FAILED: $element does not work behind jpegdec"
    exit 1
  fi
done

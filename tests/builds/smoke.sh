#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Tries a build: the page of every element, a pipeline that calibrates and undistorts, and tests of
# the library.
#   smoke.sh BUILD [TEST...]
# CALVIN_SYSROOT: the folder of sysroot.sh that a build for 64-bit ARM was made against.
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
shift
plugins=/usr/lib/aarch64-linux-gnu/gstreamer-1.0 # as a program under qemu sees them
patience=10                                      # times as long as a test may take
if [ -z "${CALVIN_SYSROOT:-}" ]; then
  plugins=$(pkg-config --variable=pluginsdir gstreamer-1.0)
else
  patience=60
fi

# A tool of GStreamer's, of the architecture of the build.
tool() {
  name=$1
  shift
  if [ -z "${CALVIN_SYSROOT:-}" ]; then
    "$name" "$@"
  else
    qemu-aarch64 -L "$CALVIN_SYSROOT" "$CALVIN_SYSROOT/usr/bin/$name" "$@"
  fi
}

export GST_PLUGIN_PATH_1_0="$build/gst" GST_PLUGIN_SYSTEM_PATH_1_0="$plugins"
export GST_REGISTRY="$build/smoke.registry" GST_REGISTRY_FORK=no
export GST_PLUGIN_LOADING_WHITELIST=gstreamer:gst-plugins-base:gst-calvin
for page in "$source"/docs/elements/*.md; do
  tool gst-inspect-1.0 "$(basename "$page" .md)" >"$build/smoke.txt"
  grep -q 'Element Properties' "$build/smoke.txt"
done
rm -f "$build/smoke.json"
tool gst-launch-1.0 -q calibtestsrc num-buffers=12 ! calibrate location="$build/smoke.json" ! \
  calibundistort ! fakesink
grep -q '"expected_error"' "$build/smoke.json"
unset GST_PLUGIN_SYSTEM_PATH_1_0 GST_PLUGIN_PATH_1_0 GST_REGISTRY

export CK_TIMEOUT_MULTIPLIER=$patience # of what gst-check gives a test, which meson's leaves alone
[ $# -gt 0 ] || set -- geometry camera board io remap undistorter detect_boards session
meson test -C "$build" --no-rebuild --num-processes 2 --print-errorlogs \
  --timeout-multiplier $patience "$@"

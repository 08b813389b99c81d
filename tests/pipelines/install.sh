#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# What `meson install` leaves: a plugin that works where it lies, and a library to build against.
#   install.sh BUILD PREFIX LIBDIR
set -eu
build=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
meson install -C "$build" --no-rebuild --quiet --destdir "$folder"
libdir=$folder$2/$3

export GST_PLUGIN_PATH_1_0="$libdir/gstreamer-1.0" GST_REGISTRY="$folder/registry"
gst-inspect-1.0 calibrate | grep -q "Filename *$libdir/gstreamer-1.0/libgstcalvin.so"
gst-launch-1.0 -q calibtestsrc num-buffers=2 ! fakesink

export GST_PRESET_PATH="$folder$2/share/gstreamer-1.0/presets"
for finder in calibdetect calibrate; do
  gst-launch-1.0 -m calibtestsrc num-buffers=1 ! \
    $finder post-messages=true '@preset=ROS 8x6 108mm' ! fakesink |
    grep -q 'calib-detection.*checkerboard:8x6:108mm'
done

cat >"$folder/use.cpp" <<'END'
#include <cstdio>

#include <calvin/camera/camera.hpp>
#include <calvin/detect/detector.hpp>
#include <calvin/draw/board_drawing.hpp>
#include <calvin/io/calibration_io.hpp>
#include <calvin/remap/undistorter.hpp>
#include <calvin/session/session.hpp>
#include <calvin/solve/solve.hpp>
#include <calvin/synth/render.hpp>
#include <calvin/target/board_names.hpp>

int main() {
  const auto camera = calvin::Camera::make("pinhole", {640, 480}, {500, 500, 320, 240});
  const auto pixel = camera->project({0, 0, 1});
  std::printf("%g %g\n", pixel->u, pixel->v);
  return calvin::read_calibration("/nowhere").has_value();
}
END
export PKG_CONFIG_PATH="$libdir/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$folder"
# shellcheck disable=SC2046 # several words
c++ -std=c++20 -Wall -Werror "$folder/use.cpp" -o "$folder/use" \
  "-I$folder$2/include" $(PKG_CONFIG_SYSROOT_DIR='' pkg-config --cflags eigen3) \
  "-L$libdir" $(pkg-config --libs-only-l calvin)
[ "$(LD_LIBRARY_PATH="$libdir" "$folder/use")" = "320 240" ]

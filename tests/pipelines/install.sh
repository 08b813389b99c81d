#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# What `meson install` leaves: a plugin that works where it lies or is linked into a program, and a
# library to build against.
#   install.sh BUILD PREFIX LIBDIR STATIC_PLUGIN.c
set -eu
build=$1
prefix=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
meson install -C "$build" --no-rebuild --quiet --destdir "$folder"
libdir=$folder$prefix/$3
plugin=$libdir/gstreamer-1.0/libgstcalvin
export GST_REGISTRY="$folder/registry" GST_PRESET_PATH="$folder$prefix/share/gstreamer-1.0/presets"

try_plugin() {
  export GST_PLUGIN_PATH_1_0="$libdir/gstreamer-1.0"
  gst-inspect-1.0 calibrate | grep -q "Filename *$plugin.so"
  gst-launch-1.0 -q calibtestsrc num-buffers=2 ! fakesink
  for finder in calibdetect calibrate; do
    gst-launch-1.0 -m calibtestsrc num-buffers=1 ! \
      $finder post-messages=true '@preset=ROS 8x6 108mm' ! fakesink |
      grep -q 'calib-detection.*checkerboard:8x6:108mm'
  done
}

# The libraries that packages name, without the folders, which are not yet where it says.
libraries() {
  PKG_CONFIG_PATH="$libdir/pkgconfig:$libdir/gstreamer-1.0/pkgconfig" \
    pkg-config --libs-only-l "$@"
}

try_static_plugin() {
  # shellcheck disable=SC2046 # several words
  cc -Wall -Werror "$1" -o "$folder/static" $(pkg-config --cflags gstreamer-1.0) \
    "-L$libdir/gstreamer-1.0" "-L$libdir" $(libraries --static gstcalvin)
  LD_LIBRARY_PATH="$libdir" GST_PLUGIN_PATH_1_0="" "$folder/static"
}

try_library() {
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
#include <calvin/io/board_names.hpp>

int main() {
  const auto camera = calvin::Camera::make("pinhole", {640, 480}, {500, 500, 320, 240});
  const auto pixel = camera->project({0, 0, 1});
  std::printf("%g %g\n", pixel->u, pixel->v);
  return calvin::read_calibration("/nowhere").has_value();
}
END
  # shellcheck disable=SC2046 # several words
  c++ -std=c++20 -Wall -Werror "$folder/use.cpp" -o "$folder/use" \
    "-I$folder$prefix/include" $(pkg-config --cflags eigen3) "-L$libdir" $(libraries $static calvin)
  [ "$(LD_LIBRARY_PATH="$libdir" "$folder/use")" = "320 240" ]
}

static=""
[ -e "$libdir/libcalvin.so" ] || static=--static
[ ! -e "$plugin.so" ] || try_plugin
[ ! -e "$plugin.a" ] || try_static_plugin "$4"
[ -e "$plugin.so" ] || [ -e "$plugin.a" ]
try_library

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# What `meson install` leaves: a plugin that works where it lies or is linked into a program, and a
# library to build against.
#   install.sh SOURCE BUILD PREFIX LIBDIR
set -eu
source=$1
build=$2
prefix=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
meson install -C "$build" --no-rebuild --quiet --destdir "$folder"
libdir=$folder$prefix/$4
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

# What pkg-config says of the library where it lies now, as if it had been configured for that.
flags() {
  mkdir -p "$folder/pkgconfig"
  sed "s|^prefix=.*|prefix=$folder$prefix|" "$libdir/pkgconfig/calvin.pc" \
    >"$folder/pkgconfig/calvin.pc"
  PKG_CONFIG_PATH="$folder/pkgconfig" pkg-config --cflags --libs $static "$@"
}

# try_compiler "CXX..." SOURCE PROGRAM PACKAGE...: with nothing but what pkg-config says.
try_compiler() {
  compiler=$1 code=$2 program=$3
  shift 3
  # shellcheck disable=SC2046,SC2086 # several words
  $compiler -std=c++20 "$code" -o "$program" $(flags "$@")
}

# Each public header alone, and a program of all of them.
try_library() {
  for header in $(cd "$folder$prefix/include" && find calvin -name '*.hpp' ! -name opencv.hpp); do
    echo "#include <$header>"
  done >"$folder/use.cpp"
  cat >>"$folder/use.cpp" <<'END'
#include <cstdio>
int main() {
  const auto camera = calvin::Camera::make("pinhole", {640, 480}, {500, 500, 320, 240});
  const auto pixel = camera->project({0, 0, 1});
  std::printf("%g %g\n", pixel->u, pixel->v);
  return calvin::read_calibration("/nowhere").has_value();
}
END
  try_compiler "$1 -Wall -Werror" "$folder/use.cpp" "$folder/use" calvin
  [ "$(LD_LIBRARY_PATH="$libdir" "$folder/use")" = "320 240" ]
}

# The example of docs/library.md, with pictures of a camera whose truth is known.
try_example() {
  gst-launch-1.0 -q calibtestsrc num-buffers=15 ground-truth="$folder/truth.json" ! \
    video/x-raw,width=640,height=480 ! videoconvert ! pngenc ! \
    multifilesink location="$folder/pictures/%02d.png"
  # OpenCV's own headers are not free of warnings in C++20.
  try_compiler "$1 -w" "$source/examples/calibrate.cpp" "$folder/calibrate" calvin opencv4
  LD_LIBRARY_PATH="$libdir" "$folder/calibrate" "$folder/pictures" checkerboard:9x6:25mm \
    "$folder/camera.json"
  "$source/tests/pipelines/same_camera.py" "$folder/camera.json" "$folder/truth.json" 0.5
}

static=""
[ -e "$libdir/libcalvin.so" ] || static=--static
[ ! -e "$plugin.so" ] || try_plugin
[ ! -e "$plugin.a" ] || try_static_plugin "$source/tests/builds/static_plugin.c"
[ -e "$plugin.so" ] || [ -e "$plugin.a" ]
shared=""
[ -n "$static" ] || shared="$libdir/libcalvin.so $source/.ci/debian/libcalvin0.symbols"
# shellcheck disable=SC2086 # two words, or none
"$source/tests/pipelines/public_names.py" "$source/docs/library.md" "$folder$prefix/include" $shared
mkdir "$folder/pictures"
for compiler in g++ clang++; do
  command -v "$compiler" >/dev/null || continue
  try_library "$compiler"
  # OpenCV decodes the pictures; a machine without it goes without the example.
  if [ -z "$static" ] && pkg-config --exists opencv4; then try_example "$compiler"; fi
done

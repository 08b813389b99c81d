#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs the Debian packages that are missing, and says nothing when none is.
#   install-packages.sh [build] [test] [bench]
set -eu

build="gcc g++ meson ninja-build pkg-config
  libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev
  gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good
  libeigen3-dev libhwy-dev libfmt-dev nlohmann-json3-dev libexpected-dev
  libopencv-dev libcairo2-dev libpango1.0-dev libyaml-cpp-dev libpugixml-dev"
test="libgtest-dev libceres-dev libjpeg-dev locales ffmpeg python3 python3-gst-1.0
  gir1.2-gst-rtsp-server-1.0
  fonts-dejavu-core poppler-utils clang-tidy"
# The tree is formatted by this version alone; tests/format.sh goes without where there is none.
optional="clang-format-14"
bench="libbenchmark-dev libmrcal-dev libmrgingham-dev
  gstreamer1.0-opencv ffmpeg opencv-doc"

wanted=""
for set in "${@:-build}"; do
  case "$set" in
    build) wanted="$wanted $build" ;;
    test) wanted="$wanted $test" ;;
    bench) wanted="$wanted $bench" ;;
    *) echo "$0: there is no set of packages called '$set' (build, test, bench)" >&2; exit 2 ;;
  esac
done

installed() {
  case "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" in
    installed*) ;; # once for each architecture
    *) return 1 ;;
  esac
}

missing=""
for package in $wanted; do
  installed "$package" || missing="$missing $package"
done
case " $* " in
  *" test "*) packaged() { apt-cache show "$1" >/dev/null 2>&1; } ;;
  *) packaged() { false; } ;;
esac
for package in $optional; do
  if ! installed "$package" && packaged "$package"; then missing="$missing $package"; fi
done
[ -n "$missing" ] || exit 0

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  as_root="sudo"
  command -v sudo >/dev/null || {
    echo "These packages are missing; install them as root:$missing" >&2
    exit 1
  }
fi
echo "Installing:$missing"
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -q
# shellcheck disable=SC2086 # one word per package
$as_root apt-get install -y -q --no-install-recommends $missing

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Installs the Debian packages that are missing, and says nothing when none is.
#   install-packages.sh [--print] [build] [test] [bench] [builds] [package]
# --print: the names of the packages, and nothing is done.
set -euf

# Those with a question mark are left out where the release has none: only one version formats this
# tree, and benchmarks do without a peer.
build="gcc g++ meson ninja-build pkg-config
  libgstreamer1.0-dev libgstreamer-plugins-base1.0-dev
  gstreamer1.0-tools gstreamer1.0-plugins-base gstreamer1.0-plugins-good
  libeigen3-dev libhwy-dev libfmt-dev nlohmann-json3-dev libexpected-dev
  libopencv-dev libapriltag-dev libcairo2-dev libpango1.0-dev libyaml-cpp-dev libpugixml-dev libtomlplusplus-dev"
test="libgtest-dev libceres-dev libjpeg-dev locales ffmpeg python3 python3-gst-1.0
  gir1.2-gst-rtsp-server-1.0
  fonts-dejavu-core poppler-utils clang-tidy clang-format-14?"
bench="libbenchmark-dev libmrcal-dev? libmrgingham-dev?
  gstreamer1.0-opencv ffmpeg opencv-doc"
# What tests/builds/run.sh needs for its other builds.
builds="clang g++-aarch64-linux-gnu qemu-user debootstrap"
# For .ci/package, which asks .ci/debian/control for the others.
package="build-essential lintian git"

print=""
if [ "${1:-}" = --print ]; then
  print=1
  shift
fi
wanted=""
for set in "${@:-build}"; do
  case "$set" in
    build) wanted="$wanted $build" ;;
    test) wanted="$wanted $test" ;;
    bench) wanted="$wanted $bench" ;;
    builds) wanted="$wanted $builds" ;;
    package) wanted="$wanted $package" ;;
    *)
      echo "$0: there is no set of packages called '$set' (build, test, bench, builds, package)" >&2
      exit 2
      ;;
  esac
done

if [ -n "$print" ]; then
  # shellcheck disable=SC2086 # one word per package
  printf '%s\n' $wanted | tr -d '?'
  exit 0
fi

# Those of the names whose mark is $1 and that are not installed.
missing() {
  for name in $wanted; do
    package=${name%[?]}
    [ "$package$1" = "$name" ] || continue
    case "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" in
      installed*) ;; # once for each architecture
      *) echo "$package" ;;
    esac
  done
}
as_root=""
[ "$(id -u)" -eq 0 ] || as_root="sudo"
needed=$(missing "" | tr '\n' ' ')
if [ -n "$needed" ]; then
  [ -z "$as_root" ] || command -v sudo >/dev/null || {
    echo "These packages are missing; install them as root: $needed" >&2
    exit 1
  }
  $as_root apt-get update -q
fi
for package in $(missing "?"); do
  if apt-cache show "$package" >/dev/null 2>&1; then needed="$needed$package "; fi
done
[ -n "$needed" ] || exit 0

echo "Installing: $needed"
# shellcheck disable=SC2086 # one word per package
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $needed

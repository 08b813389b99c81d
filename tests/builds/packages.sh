#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# The Debian packages, in a system that may be changed: builds them, installs them, runs the lines of the
# README that need no camera, builds the example of docs/library.md, and purges them. Run by debian.sh.
set -eu

source=$(cd "$(dirname "$0")/../.." && pwd)
cd "$source"
names="libcalvin0 libcalvin-dev gstreamer1.0-calvin calvin-tools"

# All that is called as we are, but for this tree, what dpkg keeps of packages that were built, and
# OpenCV, which is installed here and has a part with such a name.
ours() {
  find / -xdev \( -path "$source" -o -path /proc -o -path /calvin-data -o -path /tmp \) -prune -o \
    \( -iname '*calvin*' -o -iname '*calib*' \) ! -path '*opencv*' -print | sort
}

apt-get update -q
export DEBIAN_FRONTEND=noninteractive
apt-get install -y -q --no-install-recommends git
rm -rf out
.ci/package
ours >/tmp/before

apt-get install -y -q ./out/*.deb
if readelf -d /usr/lib/*/libcalvin.so /usr/lib/*/gstreamer-1.0/libgstcalvin.so /usr/bin/calvin-* |
  grep -iE 'rpath|runpath'; then
  exit 1
fi
apt-get install -y -q python3 python3-gst-1.0 libopencv-dev g++
python3 tests/pipelines/doc_lines.py README.md "$source" /nowhere
python3 tests/pipelines/doc_lines.py docs/how-to-calibrate.md "$source" /nowhere
# shellcheck disable=SC2046 # several words
c++ -std=c++20 /usr/share/doc/libcalvin-dev/examples/calibrate.cpp -o /tmp/calibrate \
  $(pkg-config --cflags --libs calvin opencv4)
for page in /usr/share/man/man1/calvin-*; do test -s "$page"; done
for element in calibrate calibdetect calibsolve caliboverlay calibundistort calibrig calibview \
  calibtestsrc; do
  gst-inspect-1.0 "$element" >/dev/null
done

# shellcheck disable=SC2086 # several words
apt-get purge -y -q $names
ours >/tmp/after
diff /tmp/before /tmp/after

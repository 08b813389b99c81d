#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# The undistorter's kernels on 64-bit ARM: cross-compiles them with their tests and runs it under qemu.
#   run.sh BUILD [ARGUMENTS OF THE TESTS...]
# Needs g++-aarch64-linux-gnu qemu-user libhwy-dev:arm64 libfmt-dev:arm64 googletest, after
# dpkg --add-architecture arm64.
set -eu

[ $# -ge 1 ] || { sed -n '3,6s/^# *//p' "$0" >&2; exit 2; }
source=$(cd "$(dirname "$0")/../.." && pwd)
build=$1
shift
gtest=/usr/src/googletest/googletest
mkdir -p "$build"
# Highway's NEON is compiled with +crypto, and what is always inlined has to agree.
flags="-std=c++20 -O2 -march=armv8-a+crypto -I$source/lib -I$source/tests/lib
  -isystem /usr/include/eigen3 -isystem $gtest/include -I$gtest"
for file in "$source"/lib/calvin/core/*.cpp "$source"/lib/calvin/geometry/*.cpp \
  "$source"/lib/calvin/camera/*.cpp "$source"/lib/calvin/remap/*.cpp \
  "$source/tests/lib/test_remap.cpp" "$source/tests/lib/test_remap_random.cpp" \
  "$source/tests/lib/test_remap_steep.cpp" \
  "$gtest/src/gtest-all.cc" "$gtest/src/gtest_main.cc"; do
  object=$build/$(basename "$(dirname "$file")")-$(basename "$file").o
  [ "$object" -nt "$file" ] || echo "-c $file -o $object"
done | xargs -r -P "$(nproc)" -L 1 aarch64-linux-gnu-g++ $flags
aarch64-linux-gnu-g++ -o "$build/test_remap" "$build"/*.o -lhwy -lfmt -lpthread
exec qemu-aarch64 -L /usr/aarch64-linux-gnu "$build/test_remap" "$@"

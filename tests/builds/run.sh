#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Builds the project in other ways than tests/run.sh does, and tries what comes out: a line for each.
#   run.sh [NAME...] DIR
# A NAME is one of these; without any it does all:
#   debug debugoptimized plain minsize   gcc, the build types but release
#   clang       release, by clang++
#   nofeatures  without OpenCV, libapriltag, Cairo, Pango, YAML, XML and V4L2, with all tests
#   static      archives, and a program in C that holds the plugin
#   aarch64     64-bit ARM: the library's tests, the plugin and a pipeline under qemu
#   benches     each benchmark at its smallest size
#   debian12 debian13   examples/quickstart.sh and tests/run.sh in a fresh system (needs root)
#   packages12 packages13   .ci/package in a fresh system, and what it installs (needs root)
# DIR/NAME.log holds what a build says, DIR/NAME what it leaves. With CALVIN_WERROR=true warnings are
# errors.
set -eu

usage() {
  sed -n '3,15s/^# *//p' "$0" >&2
  exit 2
}

source=$(cd "$(dirname "$0")/../.." && pwd)
all="debug debugoptimized plain minsize clang nofeatures static aarch64 benches debian12 debian13"
all="$all packages12 packages13"
names=""
while [ $# -gt 1 ]; do
  case " $all " in
    *" $1 "*) names="$names $1" ;;
    *) usage ;;
  esac
  shift
done
[ $# -eq 1 ] || usage
mkdir -p "$1"
dir=$(cd "$1" && pwd)
unset CALVIN_FULL # builds are what is tried here

# build NAME [OPTION OF MESON...]: everything, tests and examples included.
build() {
  folder=$dir/$1
  shift
  [ -f "$folder/build.ninja" ] ||
    meson setup "$folder" "$source" --unity=on -Dunity_size=8 \
      -Dwerror="${CALVIN_WERROR:-false}" "$@"
  ninja -C "$folder"
}

smoke() { "$source/tests/builds/smoke.sh" "$@"; }

# debian SUITE COMMAND...: in a system that is $dir/NAME.
debian() {
  suite=$1
  shift
  "$source/tests/builds/debian.sh" "$suite" "$dir/$name" "$@"
}

# Whether these files have no instruction for AES and the like, which a Raspberry Pi 4 lacks and every
# processor of qemu has.
without_crypto() {
  for file in "$@"; do
    if aarch64-linux-gnu-objdump -d "$file" |
      grep -E '[[:space:]](aes|sha(1|256|512)|pmull2?[[:space:]]+v[0-9]+\.1q)'; then
      echo "$file has instructions that not every 64-bit ARM has." >&2
      return 1
    fi
  done
}

build_aarch64() {
  # What the library and the plugin are compiled against, and what the tests need besides.
  # shellcheck disable=SC2046 # several words
  "$source/tests/builds/sysroot.sh" arm64 "$dir/sysroot" \
    $("$source/examples/install-packages.sh" --print build test | grep -e '-dev$' |
      grep -v opencv) gstreamer1.0-tools gstreamer1.0-plugins-base libblas3 liblapack3 \
    "libstdc++-$(aarch64-linux-gnu-g++ -dumpversion)-dev"
  printf "[constants]\nsysroot = '%s'\n" "$dir/sysroot" >"$dir/sysroot.ini"
  build aarch64 --cross-file "$dir/sysroot.ini" --cross-file "$source/tests/builds/aarch64.ini" \
    -Dopencv=disabled
  without_crypto "$dir/aarch64/lib/libcalvin.so" "$dir/aarch64/gst/libgstcalvin.so"
  CALVIN_SYSROOT="$dir/sysroot" smoke "$dir/aarch64" --suite lib
}

build_named() {
  case "$1" in
    clang)
      export CC=clang CXX=clang++
      build clang --unity=off -Db_pch=false # shows a file that does not include what it uses
      smoke "$dir/clang"
      ;;
    nofeatures)
      build nofeatures -Dopencv=disabled -Dapriltag=disabled -Ddraw=disabled -Dtext=disabled \
        -Dformats=disabled -Dv4l2=disabled
      smoke "$dir/nofeatures" --no-suite style
      ;;
    static)
      build static -Ddefault_library=static
      smoke "$dir/static" install geometry board io
      ;;
    aarch64) build_aarch64 ;;
    benches)
      export CALVIN_BENCH_BUILD="$dir/benches"
      "$source/tests/bench/run.sh" --smallest
      ;;
    debian12) debian bookworm examples/quickstart.sh tests/run.sh ;;
    debian13) debian trixie examples/quickstart.sh tests/run.sh ;;
    packages12) debian bookworm tests/builds/packages.sh ;;
    packages13) debian trixie tests/builds/packages.sh ;;
    *)
      build "$1" --buildtype="$1"
      smoke "$dir/$1"
      ;;
  esac
}

status=0
: >"$dir/results.json" # one line each, as in meson's testlog.json
"$source/examples/install-packages.sh" build test builds
for name in ${names:-$all}; do
  begin=$(date +%s)
  # Not in a condition, in which the shell would go on after an error.
  set +e
  (set -e; build_named "$name") >"$dir/$name.log" 2>&1
  code=$?
  set -e
  case $code in
    0) result=OK ;;
    77) result=SKIP ;; # as meson has it
    *) result=FAIL ;;
  esac
  echo "{\"name\": \"$name\", \"result\": \"$result\"}" >>"$dir/results.json"
  printf '%-15s %-5s %5d s\n' "$name" "$result" $(($(date +%s) - begin))
  [ $result != SKIP ] || tail -n 1 "$dir/$name.log"
  [ $result != FAIL ] || { status=1; echo "  see $dir/$name.log"; }
done
exit $status

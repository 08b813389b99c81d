# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# For tests of programs as users type them, which source this file first: a folder that is gone when
# the test ends, in which it goes on, and what it says of a program. Paths that a test was given
# have to be absolute, or made so before.
# shellcheck shell=sh
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit

fail() {
  echo "FAIL: $*" >&2
  exit 1
}

# expect STATUS WORDS COMMAND...: the exit status, and words among what it prints, which is in `out`.
expect() {
  status=$1
  words=$2
  shift 2
  got=0
  "$@" >out 2>&1 || got=$?
  [ "$got" = "$status" ] || fail "$* left with $got, not $status: $(cat out)"
  grep -q -- "$words" out || fail "$* did not say '$words': $(cat out)"
}

# copy_pair: OpenCV's pictures of a stereo pair, into the folders left and right. False where
# CALVIN_DATA has none: programs fetch Debian's package then, as on any machine.
copy_pair() {
  pictures=${CALVIN_DATA:-}/opencv-samples
  [ -d "$pictures" ] || return 1
  for camera in left right; do
    mkdir "$camera"
    cp "$pictures/$camera"[0-9]*.jpg "$camera"
  done
}

# pinhole_views N: observations of so many views of a board through a pinhole of 500 px, a second
# apart and each tilted in its own way.
pinhole_views() {
  awk -v views="$1" 'BEGIN {
    print "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"checkerboard:9x6:25mm\"}"
    for (n = 0; n < views; ++n) {
      a = 0.5 * sin(2.4 * n); b = 0.5 * cos(2.4 * n); points = ""
      for (i = 0; i < 54; ++i) {
        x = 0.025 * (i % 9 - 4); y = 0.025 * (int(i / 9) - 2.5)
        z = 0.45 + x * sin(a) + y * cos(a) * sin(b)
        u = 320 + 500 * (x * cos(a) - y * sin(a) * sin(b) + 0.05 * sin(n)) / z
        v = 240 + 500 * (y * cos(b) + 0.02 * cos(3 * n)) / z
        points = points sprintf("%s[%d,%.4f,%.4f,0.05]", i ? "," : "", i, u + 0.05 * sin(99 * n + 7 * i * i), v + 0.05 * cos(77 * n + 5 * i * i))
      }
      printf "{\"timestamp\":%d000000000,\"image_size\":[640,480],\"points\":[%s]}\n", n + 1, points
    }
  }'
}

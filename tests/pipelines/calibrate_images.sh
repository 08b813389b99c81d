#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `calibrate-images` as users type it. Argument: the program.
set -eu
images=$(realpath "$1")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

fail() {
  echo "FAIL: $*" >&2
  exit 1
}

# refused WORDS OUTPUT: says so before any picture has been looked at.
refused() {
  words=$1
  got=0
  "$images" --output "$2" pictures >out 2>&1 || got=$?
  [ "$got" = 1 ] || fail "--output $2 left with $got: $(cat out)"
  grep -q -- "$words" out || fail "--output $2 did not say '$words': $(cat out)"
  ! grep -q 'corners' out || fail "--output $2 is refused after the work: $(cat out)"
}

mkdir pictures
gst-launch-1.0 -q calibtestsrc num-buffers=5 ! video/x-raw,width=640,height=480 ! pngenc ! \
  multifilesink location=pictures/%02d.png

echo file >file
refused "There is no folder none/new" none/new
refused "There is no folder file" file
refused "There is no folder file/new" file/new

# A folder that is not there is made, and one that is there is used.
for n in 1 2; do
  "$images" --output new pictures >out 2>&1 || fail "run $n: $(cat out)"
  for name in camera.json before.png after.png; do
    [ -s "new/$name" ] || fail "run $n made no new/$name: $(cat out)"
  done
done
[ ! -e camera.json ] || fail "a file is outside of the folder"

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
grep -q '^5 of 5 pictures used' out || fail "no count: $(cat out)"

# used WORDS: what is said to the user of a folder with more in it; the calibration is made anyway.
used() {
  rm -rf new
  "$images" --output new pictures >out 2>err || fail "$1: $(cat out err)"
  grep -q -- "$1" err || fail "stderr does not say '$1': $(cat err)"
  [ -s new/camera.json ] || fail "$1: no calibration"
}

# What is no whole picture is named, with what to do.
head -c 3000 pictures/00.png >pictures/cut.png
used 'cut.png: left out, .*: save it again as PNG or JPEG'
: >pictures/empty.png
used 'empty.png: left out, .*: save it again as PNG or JPEG'
echo notes >pictures/notes.txt
used 'notes.txt: left out, '
ln -s nowhere pictures/link.png
used 'link.png: left out, it cannot be opened'
gst-launch-1.0 -q videotestsrc num-buffers=1 ! video/x-raw,width=320,height=240 ! pngenc ! \
  filesink location=pictures/small.png
used 'small.png: left out, it is 320x240 and most are 640x480'
gst-launch-1.0 -q videotestsrc num-buffers=1 ! video/x-raw,width=640,height=480 ! pngenc ! \
  filesink location=pictures/blank.png
used 'small.png: left out'
mkfifo pictures/pipe.png
used 'pipe.png: left out, it is a device or a FIFO'
grep -q '^5 of 12 pictures used: 6 left out, 1 without a board' out || fail "counts: $(cat out)"
[ "$(grep -c ': left out' err)" = 6 ] || fail "not each once: $(cat err)"

# Where none is left, the program says so and fails.
mkdir broken
cp pictures/cut.png broken
got=0
"$images" --output new broken >out 2>err || got=$?
[ "$got" = 1 ] || fail "a folder of broken pictures left with $got: $(cat out err)"
grep -q 'cut.png: left out' err || fail "the broken picture is not named: $(cat err)"

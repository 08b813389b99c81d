#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs examples/stereo.sh on a build that is there already.
#   stereo.sh SOURCE BUILD
set -eu
source=$1
export CALVIN_BUILD="$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fails() { echo "FAILED: $1"; exit 1; }

pictures=${CALVIN_DATA:-}/opencv-samples
set --
if [ -d "$pictures" ]; then
  for camera in left right; do
    mkdir "$folder/$camera"
    cp "$pictures/$camera"[0-9]*.jpg "$folder/$camera"
  done
  set -- "$folder/left" "$folder/right"
fi # else Debian's package is fetched, as on any machine
CALVIN_OUTPUT=$folder/out "$source/examples/stereo.sh" "$@" >"$folder/log" || {
  cat "$folder/log"; fails "stereo.sh"; }
cat "$folder/log"
# Bouguet has published 99.8 mm.
grep -Eq "'left' and 'right': (99|100)\.[0-9] mm apart" "$folder/log" || fails "another distance"
grep -Eq "corners within 0\.[0-3][0-9]* px of the rows of each other" "$folder/log" ||
  fails "rows of the pair are not the same"
[ "$(find "$folder/out" -maxdepth 1 -name 'pair*.png' | wc -l)" = 13 ] || fails "not all pairs"
# Width and height of a PNG.
size=$(od -An -j16 -N8 -tu1 "$folder/out/pair01.png" | tr -s ' ')
[ "$size" = " 0 0 5 0 0 0 1 224" ] || fails "a pair is not of 1280x480 but$size"
"$source/examples/stereo.sh" one >"$folder/log" 2>&1 && fails "one argument is taken"
grep -q "LEFT RIGHT" "$folder/log" || fails "wrong usage is not told"

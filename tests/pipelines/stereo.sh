#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs examples/stereo.sh on a build that is there already.
#   stereo.sh SOURCE BUILD
set -eu
source=$1
export CALVIN_BUILD="$2"
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

set --
if copy_pair; then set -- "$folder/left" "$folder/right"; fi
export CALVIN_OUTPUT="$folder/result"
# Bouguet has published 99.8 mm.
expect 0 "'left' and 'right': \(99\|100\)\.[0-9] mm apart" "$source/examples/stereo.sh" "$@"
cat out
grep -Eq "corners within 0\.[0-3][0-9]* px of the rows of each other" out ||
  fail "rows of the pair are not the same"
[ "$(find result -maxdepth 1 -name 'pair*.png' | wc -l)" = 13 ] || fail "not all pairs"
# Width and height of a PNG.
size=$(od -An -j16 -N8 -tu1 result/pair01.png | tr -s ' ')
[ "$size" = " 0 0 5 0 0 0 1 224" ] || fail "a pair is not of 1280x480 but$size"
expect 2 'LEFT RIGHT' "$source/examples/stereo.sh" one

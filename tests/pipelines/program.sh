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

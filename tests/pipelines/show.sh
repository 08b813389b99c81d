#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `show` as users type it. Argument: the program.
set -eu
show=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# camera FILE WIDTH HEIGHT MODEL F [COEFFICIENTS]: a native file.
camera() {
  more=${6:-'"p1": 0, "p2": 0'}
  cat >"$1" <<END
{"format": "calvin-calibration", "version": 1, "camera": "${1%.json}", "image_size": [$2, $3], "model": "$4",
 "parameters": {"fx": $5, "fy": $5, "cx": 320, "cy": 240, "k1": 0.1, "k2": 0, $more},
 "sigma": {"fx": 0.5, "fy": 0.5}}
END
}
camera a.json 640 480 brown4 500
camera b.json 640 480 brown4 501
camera fish.json 640 480 fisheye 500 '"k3": 0, "k4": 0'
camera big.json 1280 960 brown4 1000

expect 0 '^a 640x480, model brown4$' "$show" a.json
expect 0 '^fx  *500  *0.5$' "$show" a.json
expect 0 '^fx  *500  *0.5  *501  *-1.41$' "$show" a.json b.json
grep -q '^beside b 640x480, model brown4$' out || fail "nothing says what is beside it: $(cat out)"
! grep -q 'two models' out || fail 'the models are one'
expect 0 '^beside fish 640x480, model fisheye$' "$show" a.json fish.json
grep -q '^Parameters of two models' out || fail "nothing says that k1 is another one: $(cat out)"
expect 1 '^calvin-show: The calibrations are for images of 640x480 and 1280x960 px' "$show" a.json big.json
grep -q 'calvin-compare --scale' out || fail "nothing says what to do: $(cat out)"
expect 1 'none.json' "$show" a.json none.json
expect 1 'none.json' "$show" none.json
expect 2 'usage' "$show"
expect 0 'usage' "$show" --help
expect 2 "'--bogus' is no option" "$show" --bogus
expect 2 "'--bogus' is no option" "$show" a.json --bogus

# A file of OpenCV need not say the size of its images.
cat >opencv.json <<'END'
{"camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
  "data": [500, 0, 320, 0, 500, 240, 0, 0, 1]},
 "distortion_coefficients": {"type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d",
  "data": [0, 0, 0, 0, 0]}}
END
expect 0 'model brown5' "$show" a.json opencv.json

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `compare` as users type it. Argument: the program.
set -eu
compare=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# camera FILE WIDTH HEIGHT F CX CY [COVERED]: a native file of a pinhole.
camera() {
  covered=${7:-[]}
  cat >"$1" <<END
{"format": "calvin-calibration", "version": 1, "image_size": [$2, $3], "model": "pinhole",
 "parameters": {"fx": $4, "fy": $4, "cx": $5, "cy": $6}, "covered": $covered}
END
}
camera a.json 641 481 500 320 240
camera longer.json 641 481 502.5 320 240
camera double.json 1282 962 1000 640.5 480.5
camera wide.json 1282 721 1000 640.5 360
camera middle.json 641 481 502.5 320 240 '[[220, 140], [420, 140], [420, 340], [220, 340]]'

expect 0 'max 0.0000 px' "$compare" a.json a.json
# Half a per cent of the way from the centre to the corner: .005 * 400 px.
expect 0 '^image *max 2.0000 px at (0, 0), rms' "$compare" a.json longer.json
expect 0 '^rotation 0.00000 degrees' "$compare" a.json longer.json
expect 0 '^      0   2.0000 .* 2.0000$' "$compare" a.json longer.json --table 5
grep -q '^    240   1.6000   0.8000   0.0000   0.8000   1.6000$' out || fail "the middle row of $(cat out)"
expect 3 'max 2.0000 px' "$compare" --limit 1.99 a.json longer.json
expect 0 'max 2.0000 px' "$compare" --limit 2.01 a.json longer.json
expect 0 '^covered *max 0.7' "$compare" --limit 1.9 a.json middle.json
expect 3 'max 2.0000 px' "$compare" --limit 1.9 --whole a.json middle.json

expect 1 'scale one of them' "$compare" a.json double.json
expect 0 'max 0.0000 px' "$compare" --scale a.json double.json
expect 1 'another ratio' "$compare" --scale a.json wide.json
expect 1 'none.json' "$compare" a.json none.json
expect 2 'Usage' "$compare" a.json
expect 2 'Usage' "$compare" a.json a.json a.json
expect 2 'no option' "$compare" a.json a.json --fast
expect 2 'needs a number' "$compare" a.json a.json --limit
expect 0 'Usage' "$compare" --help

# A file of OpenCV, which need not say the size of its images.
cat >opencv.json <<'END'
{"camera_matrix": {"type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
  "data": [500, 0, 320, 0, 500, 240, 0, 0, 1]},
 "distortion_coefficients": {"type_id": "opencv-matrix", "rows": 1, "cols": 5, "dt": "d",
  "data": [0, 0, 0, 0, 0]}}
END
expect 0 'max 0.0000 px' "$compare" a.json opencv.json

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `zoom` as users type it. Argument: the program.
set -eu
zoom=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# FILE F K1 [MORE]: a brown4 whose focal length is F.
camera() {
  cat >"$1" <<END
{"format": "calvin-calibration", "version": 1, "camera": "${5:-box}", "image_size": [640, 480], "model": "brown4",
 "parameters": {"fx": $2, "fy": $2, "cx": 320, "cy": 240, "k1": $3, "k2": 0, "p1": 0, "p2": 0},
 "sigma": {"fx": 0.5, "fy": 0.5}${4:-}}
END
}
camera wide.json 500 -0.2
camera quarter.json 707.1 -0.1
camera middle.json 1000 0.1
camera tele.json 2000 0.5 ', "zoom": 400'

expect 0 '^zoom 200: f 1000.00 1000.00 px.*without it is' "$zoom" zoom.json 200=middle.json 100=wide.json tele.json
expect 0 'Between its settings the table is off by about' "$zoom" zoom.json 200=middle.json 141.4=quarter.json 100=wide.json tele.json
grep -q '"format": "calvin-zoom"' zoom.json || fail 'zoom.json is no table'
[ "$(grep -c '"left_out"' zoom.json)" = 2 ] || fail 'the middle settings do not say how far the others are off'
cp zoom.json before.json

# f = 5 zoom: the logarithm of the control.
expect 0 '^zoom 150: f 7[45]' "$zoom" --at 150 zoom.json at.json
grep -q '"zoom": 150' at.json || fail 'the position is not in the calibration'
grep -q '"expected_error"' at.json || fail 'nothing says how well it is known'
expect 0 'f 2000.00' "$zoom" --at 900 zoom.json at.json
grep -q 'knows 100 to 400 alone' at.json || fail 'nothing says that the table ends'
expect 0 'f 1000.00' "$zoom" --at 200,5 --camera other zoom.json at.json
grep -q '"camera": "other"' at.json || fail 'the name is another one'

expect 0 'calibrate at least one more' "$zoom" two.json 1=wide.json 2=tele.json
expect 0 'zoom 1, focus 20' "$zoom" focus.json 1,10=wide.json 1,20=wide.json 2,10=tele.json
expect 1 'where the focus stands' "$zoom" --at 1.5 focus.json at.json
expect 1 'give it as ZOOM=wide.json' "$zoom" zoom.json wide.json tele.json
expect 1 'zoom 5 twice' "$zoom" zoom.json 5=wide.json 5=tele.json
expect 1 'give the focus of all' "$zoom" zoom.json 5,1=wide.json 6=tele.json
expect 1 'two settings' "$zoom" zoom.json tele.json
expect 1 'none.json' "$zoom" zoom.json 1=none.json 2=tele.json
expect 1 'zoom.json' "$zoom" zoom.json 1=zoom.json 2=tele.json
expect 1 'wide.json' "$zoom" --at 5 wide.json at.json
camera other.json 800 0 '' dome
expect 1 '--camera' "$zoom" zoom.json 1=wide.json 2=other.json
expect 0 'zoom 2' "$zoom" --camera box named.json 1=wide.json 2=other.json
sed 's/brown4/brown5/; s/"p2": 0/"p2": 0, "k3": 0/' wide.json >five.json
expect 1 'one camera model' "$zoom" zoom.json 1=five.json 2=tele.json
expect 1 'Cannot write' "$zoom" none/zoom.json 1=wide.json 2=tele.json
cmp -s zoom.json before.json || fail 'a failure has touched the file'

expect 2 'Usage' "$zoom"
expect 2 'Usage' "$zoom" zoom.json
expect 2 'a number' "$zoom" --at soon zoom.json at.json
expect 2 'a file to write' "$zoom" --at 1 zoom.json
expect 2 'no option' "$zoom" --far zoom.json 1=wide.json 2=tele.json
expect 0 'Usage' "$zoom" --help

# A forgotten output takes no input's place, whatever its name.
expect 2 'is a setting, and the table to write comes first' "$zoom" 100=wide.json 200=middle.json 400=tele.json
[ ! -e 100=wide.json ] || fail 'a file has the name of a setting'
expect 1 "'wide.json' holds a calibration, and a zoom table would take its place" "$zoom" wide.json 200=middle.json tele.json
grep -q 'The order is: calvin-zoom .OPTIONS. TABLE.json' out || fail "nothing says what comes first: $(cat out)"
expect 1 "'./tele.json' is one of the files to read" "$zoom" ./tele.json 200=middle.json tele.json
expect 1 "'zoom.json' is one of the files to read" "$zoom" --at 150 zoom.json zoom.json
expect 1 "'before.json' holds a zoom table" "$zoom" --at 150 zoom.json before.json
grep -q '"model": "brown4"' wide.json && cmp -s zoom.json before.json || fail 'a refusal has touched a file'

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `rig` as users type it. Argument: the program.
set -eu
rig=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# A pinhole, and what it sees from X m to the right of the first one, MS later, of a board (the
# text after board=) that moves unless STILL is 1.
camera() {
  cat >"$1.json" <<END
{"format": "calvin-calibration", "version": 1, "camera": "$1", "image_size": [640, 480],
 "model": "pinhole", "parameters": {"fx": 500, "fy": 500, "cx": 320, "cy": 240}}
END
}
views() {
  awk -v shift="$2" -v ms="$3" -v still="$4" 'BEGIN {
    print "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"checkerboard:9x6:25mm\"}"
    for (n = 0; n < 12; ++n) {
      m = still ? 1 : n
      a = 0.5 * sin(2.4 * m); b = 0.5 * cos(2.4 * m); points = ""
      for (i = 0; i < 54; ++i) {
        x = 0.025 * (i % 9 - 4); y = 0.025 * (int(i / 9) - 2.5)
        z = 0.45 + x * sin(a) + y * cos(a) * sin(b)
        u = 320 + 500 * (x * cos(a) - y * sin(a) * sin(b) + 0.02 * sin(m) + 0.05 - shift) / z
        v = 240 + 500 * (y * cos(b) + 0.02 * cos(3 * m)) / z
        points = points sprintf("%s[%d,%.4f,%.4f,0.05]", i ? "," : "", i, u + 0.05 * sin(99 * n + 7 * i * i + 9 * shift), v + 0.05 * cos(77 * n + 5 * i * i + 7 * shift))
      }
      printf "{\"timestamp\":%d%06d,\"image_size\":[640,480],\"points\":[%s]}\n", 1000 * n + ms, 0, points
    }
  }' >"$1.jsonl"
}
for name in left right late; do camera "$name"; done
views left 0 1 0
views right 0.1 4 0
views late 0.1 501 0

expect 0 "'left' and 'right': 100.0 mm apart" "$rig" rig.json left.json left.jsonl right.json right.jsonl
grep -q '12 of 12 common views agree' out || fail "views: $(cat out)"
grep -q 'up to 3.000 ms apart' out || fail "times: $(cat out)"
grep -q '"format": "calvin-rig"' rig.json || fail 'rig.json is no rig'
cp rig.json before.json
expect 1 "'late'" "$rig" rig.json left.json left.jsonl late.json late.jsonl
cmp -s rig.json before.json || fail 'a failure has touched the file'
expect 1 "'right'" "$rig" --tolerance 1 rig.json left.json left.jsonl right.json right.jsonl
# Journals that have times of their own: that of the one that was begun later is taken to the clock of all.
expect 0 '100.0 mm apart' "$rig" --start left:0.497 rig.json left.json left.jsonl late.json late.jsonl
grep -q 'up to 3.000 ms apart' out || fail "times: $(cat out)"
expect 0 '100.0 mm apart' "$rig" --start late:-0.497 rig.json left.json left.jsonl late.json late.jsonl
expect 1 "'late'" "$rig" --start late:0.497 rig.json left.json left.jsonl late.json late.jsonl
expect 1 "No camera is called 'top'" "$rig" --start top:1 rig.json left.json left.jsonl late.json late.jsonl
mkdir pictures
expect 1 "'pictures' are pictures" "$rig" --start late:1 rig.json left.json left.jsonl late.json pictures
expect 0 '100.0 mm apart' "$rig" --tolerance 501 rig.json left.json left.jsonl late.json late.jsonl
expect 0 'was not seen together with another one' "$rig" --fixed-boards rig.json left.json left.jsonl right.json \
  right.jsonl
expect 0 "'left': fx" "$rig" --estimate-intrinsics free rig.json left.json left.jsonl right.json right.jsonl
grep -q '"sigma": ' rig.json || fail 'no sigmas of intrinsics in rig.json'
expect 0 'does not say how well they are known' "$rig" --estimate-intrinsics prior rig.json left.json left.jsonl \
  right.json right.jsonl
expect 2 'with a prior, or free' "$rig" --estimate-intrinsics magic rig.json left.json left.jsonl right.json right.jsonl
expect 1 'several places' "$rig" --floor rig.json left.json left.jsonl right.json right.jsonl
# Frames: of the other camera, of the board where it was last, with z up.
expect 0 "'left' at -100.0 [-0.0 ]*mm of 'right'" "$rig" --world right rig.json left.json left.jsonl right.json right.jsonl
expect 0 "mm of 'board' (+-" "$rig" --world board:last:x180 rig.json left.json left.jsonl right.json right.jsonl
grep -q '"world": "board"' rig.json || fail 'the frame is not that of the board'
expect 0 "mm of 'board' (+-" "$rig" --world board:11.4 rig.json left.json left.jsonl right.json right.jsonl
expect 0 "mm of 'board' (+-" "$rig" --world board:0:x180 rig.json left.json left.jsonl right.json right.jsonl
expect 1 'the board at 9999 s, and the views are from 0.001 s to 11.004 s' "$rig" --world board:9999 rig.json \
  left.json left.jsonl right.json right.jsonl
views later_left 0 100001 0
views later_right 0.1 100004 0
expect 1 'from 100.001 s to 111.004 s' "$rig" --world board:0 rig.json left.json later_left.jsonl right.json later_right.jsonl
expect 0 "mm of 'board'" "$rig" --world board rig.json left.json later_left.jsonl right.json later_right.jsonl
expect 1 "none of its cameras" "$rig" --world middle rig.json left.json left.jsonl right.json right.jsonl
expect 2 "board:x180" "$rig" --world board:x45 rig.json left.json left.jsonl right.json right.jsonl

# Files that name their cameras: each beside the calibration of its own, or of a camera that was renamed.
for name in left right; do sed "s/{\"timestamp\"/{\"camera\":\"$name\",\"timestamp\"/" $name.jsonl >of_$name.jsonl; done
expect 0 '100.0 mm apart' "$rig" rig.json left.json of_left.jsonl right.json of_right.jsonl
grep -q 'is given with' out && fail "there is nothing to say of names: $(cat out)"
cp rig.json before.json
expect 1 "'of_right.jsonl' is of 'right', and is given with the calibration of 'left': exchange it and 'of_left.jsonl'" \
  "$rig" rig.json left.json of_right.jsonl right.json of_left.jsonl
cmp -s rig.json before.json || fail 'a failure has touched the file'
sed 's/"camera": "right"/"camera": "top"/' right.json >top.json
expect 0 "of_right.jsonl is of 'right', and is given with the calibration of 'top'" "$rig" rig.json left.json of_left.jsonl top.json of_right.jsonl
# What calibdetect calls every camera that has no name tells nothing.
for name in left right; do sed 's/{"timestamp"/{"camera":"cam0","timestamp"/' $name.jsonl >$name.cam0.jsonl; done
expect 0 '100.0 mm apart' "$rig" rig.json left.json left.cam0.jsonl right.json right.cam0.jsonl
grep -q 'is given with' out && fail "a name that all have: $(cat out)"

sed 's/"pinhole"/"brown5"/; s/"cy": 240/"cy": 240, "k1": 0, "k2": 0, "p1": 0, "p2": 0, "k3": 0.001/' left.json >five.json

views left 0 1 1
views right 0.1 4 1
expect 0 "mm of 'board'" "$rig" --floor floor.json left.json left.jsonl right.json right.jsonl
grep -q '"world": "board"' floor.json || fail 'the frame is not that of the board'

expect 0 'apart' "$rig" --export kalibr:chain.yaml,gltf:rig.glb,opencv:stereo.yml,ros:ros rig.json \
  left.json left.jsonl right.json right.jsonl
grep -q 'camera_model: pinhole' chain.yaml || fail 'no camchain'
grep -q 'T_cn_cnm1' chain.yaml || fail 'a camchain without places'
[ "$(head -c 4 rig.glb)" = glTF ] || fail 'no glTF'
grep -q '^Q: !!opencv-matrix' stereo.yml || fail 'no stereo parameters'
grep -q 'projection_matrix' ros/left.yaml || fail 'no camera_info of the left camera'
# P of the right camera has -f b: a tenth of a metre.
tail -n 1 ros/right.yaml | tr -d ',[]' | awk '{ exit !($5 < -0.0995 * $2 && $5 > -0.1005 * $2) }' ||
  fail "the right camera is elsewhere: $(cat ros/right.yaml)"
# A board that was measured once more, in place of that of the files; another board is refused.
expect 0 "'left' and 'right': 120.0 mm apart" "$rig" --board 'checkerboard:8x6:1m;checkerboard:9x6:30mm' rig.json \
  left.json left.jsonl right.json right.jsonl
grep -q "right.jsonl has views of the board 'checkerboard:9x6:25mm', which is taken as 'checkerboard:9x6:30mm'" out ||
  fail "another size is not said: $(cat out)"
expect 0 "'left' and 'right': 100.0 mm apart" "$rig" --board checkerboard:9x6:2.5cm rig.json left.json left.jsonl right.json right.jsonl
grep -q 'is taken as' out && fail "the same size is no other one: $(cat out)"
for board in checkerboard:6x9:25mm checkerboard:9x7:25mm circles:9x6:25mm; do
  expect 1 "left.jsonl' has views of the board 'checkerboard:9x6:25mm', and --board is '$board'" "$rig" --board $board rig.json \
    left.json left.jsonl right.json right.jsonl
done
# The files and folders of other programs.
expect 0 'apart' "$rig" --export mrcal:models,colmap:model,caliscope:array.toml rig.json \
  left.json left.jsonl right.json right.jsonl
grep -q LENSMODEL_PINHOLE models/right.cameramodel || fail 'no model of mrcal'
grep -q '^2 PINHOLE 640 480 500 500 320.5 240.5$' model/cameras.txt || fail 'no cameras of COLMAP'
[ -f model/points3D.txt ] || fail 'no model that COLMAP reads'
grep -q '^cam_id = 1$' array.toml || fail 'no cameras of caliscope'
# The files of the second camera are calibrations, too.
sed -n '1,/^2 /{/^1 /!p}' model/cameras.txt >second.txt
expect 0 '100.0 mm apart' "$rig" rig.json left.json left.jsonl models/right.cameramodel right.jsonl
expect 0 '100.0 mm apart' "$rig" rig.json left.json left.jsonl second.txt right.jsonl

# The board is printed a percent too small: the cameras are 101 mm apart.
expect 0 "'left' and 'right': 101.0 mm apart" "$rig" --baseline 101mm:0.01mm rig.json \
  left.json left.jsonl right.json right.jsonl
grep -Eq 'Boards are 1.0(099|100)' out || fail "no scale: $(cat out)"
grep -q 'is to be 25 mm on them measures 25.2' out || fail "no remark: $(cat out)"
expect 0 "100.0 mm apart" "$rig" --baseline left:right:101mm:1mm --board-sigma 0 rig.json \
  left.json left.jsonl right.json right.jsonl
expect 1 "no distance between 'left' and 'top'" "$rig" --baseline left:top:1m rig.json left.json \
  left.jsonl right.json right.jsonl
expect 2 'left:right:110.03mm' "$rig" --baseline left:right rig.json left.json left.jsonl right.json right.jsonl
expect 2 'percent' "$rig" --board-sigma much rig.json left.json left.jsonl right.json right.jsonl

expect 1 'brown4' "$rig" --export kalibr:chain.yaml rig.json five.json left.jsonl right.json right.jsonl
expect 2 'FORMAT:PATH' "$rig" --export obj:x rig.json left.json left.jsonl right.json right.jsonl

expect 0 "'left' at" "$rig" --floor pose.json left.json left.jsonl
grep -q '"covariance"' pose.json || fail 'a pose without its error'
expect 2 'and --floor' "$rig" pose.json left.json left.jsonl

expect 1 'none.json' "$rig" rig.json none.json left.jsonl right.json right.jsonl
expect 1 'none.jsonl' "$rig" rig.json left.json none.jsonl right.json right.jsonl
expect 1 'Cannot write' "$rig" none/rig.json left.json left.jsonl right.json right.jsonl
expect 2 'Usage' "$rig"
expect 2 'Usage' "$rig" rig.json left.json left.jsonl
expect 2 'milliseconds' "$rig" --tolerance soon rig.json left.json left.jsonl right.json right.jsonl
expect 2 'no option' "$rig" --ceiling rig.json left.json left.jsonl right.json right.jsonl
expect 0 'Usage' "$rig" --help

# A result takes no input's place, nor that of what is no rig.
cp left.json before_left.json
expect 1 "'left.json' is one of the files to read" "$rig" left.json left.json left.jsonl right.json right.jsonl
expect 1 "'late.json' holds a calibration, and a rig would take its place" "$rig" late.json left.json left.jsonl right.json right.jsonl
expect 1 'holds observations of a board, and an export' "$rig" --export kalibr:late.jsonl rig.json left.json left.jsonl right.json right.jsonl
cmp -s left.json before_left.json || fail 'a refusal has touched a file'
: >empty.json
expect 0 '100.0 mm apart' "$rig" empty.json left.json left.jsonl right.json right.jsonl

#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `hand_eye` as users type it. Argument: the program.
set -eu
program=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

cat >camera.json <<END
{"format": "calvin-calibration", "version": 1, "camera": "wrist", "image_size": [640, 480],
 "model": "pinhole", "parameters": {"fx": 500, "fy": 500, "cx": 320, "cy": 240}}
END

# What a camera 50 mm beside the hand sees of a board whose middle is the base of the robot, and
# the poses of the hand (matrices), the board 1 % smaller than its text says. NAMED 1: lines begin
# with times, and the last view has no line.
run() {
  awk -v named="$1" -v shrink="$2" 'BEGIN {
    print "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"checkerboard:9x6:25mm\"}" >"views.jsonl"
    printf "" >"poses.txt"
    for (n = 0; n < 14; ++n) {
      a = 0.5 * sin(2.4 * n); b = 0.5 * cos(2.4 * n); points = ""
      tx = 0.02 * sin(n); ty = 0.02 * cos(3 * n); tz = 0.45 + 0.05 * sin(5 * n)
      for (i = 0; i < 54; ++i) {
        x = shrink * 0.025 * (i % 9 - 4); y = shrink * 0.025 * (int(i / 9) - 2.5)
        z = tz + x * sin(a) + y * cos(a) * sin(b)
        u = 320 + 500 * (x * cos(a) - y * sin(a) * sin(b) + tx) / z
        v = 240 + 500 * (y * cos(b) + ty) / z
        points = points sprintf("%s[%d,%.4f,%.4f,0.05]", i ? "," : "", i, u + 0.05 * sin(99 * n + 7 * i * i), v + 0.05 * cos(77 * n + 5 * i * i))
      }
      printf "{\"timestamp\":%d000000000,\"image_size\":[640,480],\"points\":[%s]}\n", n + 1, points >>"views.jsonl"
      if (named && n == 13) continue
      r[0] = cos(a); r[1] = 0; r[2] = sin(a)
      r[3] = -sin(a) * sin(b); r[4] = cos(b); r[5] = cos(a) * sin(b)
      r[6] = -sin(a) * cos(b); r[7] = -sin(b); r[8] = cos(a) * cos(b)
      line = named ? n + 1.005 : ""
      for (k = 0; k < 3; ++k) {
        line = line sprintf(" %.6f %.6f %.6f %.6f", r[3 * k], r[3 * k + 1], r[3 * k + 2], -(r[3 * k] * (tx + 0.05) + r[3 * k + 1] * ty + r[3 * k + 2] * tz) + 0.0001 * sin(55 * n + 9 * k))
      }
      print line >>"poses.txt"
    }
  }'
}

run 0 1
expect 0 '^hand_from_camera: 0.0[45][0-9]* ' "$program" hand_eye.json camera.json views.jsonl poses.txt
grep -q '14 go together, by their order' out || fail "poses: $(cat out)"
grep -q '"format": "calvin-hand-eye"' hand_eye.json || fail 'hand_eye.json is none'
grep -q 'pitch of the board' out && fail "the board has its size: $(cat out)"
cp hand_eye.json before.json
expect 1 'the set-up is the other one' "$program" --eye to-hand hand_eye.json camera.json views.jsonl poses.txt
expect 1 'hand_from_base' "$program" --inverted hand_eye.json camera.json views.jsonl poses.txt
cmp -s hand_eye.json before.json || fail 'a failure has touched the file'
expect 0 '^base_from_camera:' "$program" --eye to-hand --inverted hand_eye.json camera.json views.jsonl poses.txt
expect 0 'worse than was given' "$program" --turn-sigma 0.001 --place-sigma 0.001 hand_eye.json camera.json views.jsonl poses.txt
expect 0 "is taken as 'checkerboard:9x6:30mm', as --board says" "$program" --board checkerboard:9x6:30mm hand_eye.json camera.json views.jsonl poses.txt
grep -q 'pitch of the board measures 25.0' out || fail "the board of --board is not taken: $(cat out)"
expect 1 'leave --board out' "$program" --board checkerboard:8x6:25mm hand_eye.json camera.json views.jsonl poses.txt

run 1 0.99
expect 0 'pitch of the board measures 24.7' "$program" hand_eye.json camera.json views.jsonl poses.txt
grep -q '13 go together, by their time' out || fail "times: $(cat out)"
expect 0 'in the robot.s lengths' "$program" --free-scale hand_eye.json camera.json views.jsonl poses.txt
run 0 0.99
sed -i 1d poses.txt
expect 1 '14 views and 13 poses' "$program" hand_eye.json camera.json views.jsonl poses.txt
echo '1 2 3' >>poses.txt
expect 1 'line 14 has 3 numbers' "$program" hand_eye.json camera.json views.jsonl poses.txt
head -2 views.jsonl >few.jsonl
head -1 poses.txt >few.txt
expect 1 '3 are the least' "$program" hand_eye.json camera.json few.jsonl few.txt

expect 1 'none.json' "$program" hand_eye.json none.json views.jsonl poses.txt
expect 1 'none.jsonl' "$program" hand_eye.json camera.json none.jsonl poses.txt
expect 1 'none.txt' "$program" hand_eye.json camera.json views.jsonl none.txt
run 0 1
expect 1 'Cannot write' "$program" none/hand_eye.json camera.json views.jsonl poses.txt
expect 2 'Usage' "$program"
expect 2 'Usage' "$program" hand_eye.json camera.json views.jsonl
expect 2 '--eye takes in-hand or to-hand' "$program" --eye on-hand hand_eye.json camera.json views.jsonl poses.txt
expect 2 '--turn-sigma takes a number of degrees, more than 0' "$program" --turn-sigma none hand_eye.json camera.json views.jsonl poses.txt
expect 2 '--turn-sigma takes a number of degrees' "$program" hand_eye.json camera.json views.jsonl poses.txt --turn-sigma -1
expect 2 '--place-sigma takes a number of mm' "$program" hand_eye.json camera.json views.jsonl poses.txt --place-sigma
expect 2 'no option' "$program" --shoulder hand_eye.json camera.json views.jsonl poses.txt
expect 0 'Usage' "$program" --help

# ---- --method strobl: cameras of which little is known, and a board 1 % smaller and .5 % taller ----
cat >start.json <<END
{"format": "calvin-calibration", "version": 1, "image_size": [640, 480],
 "model": "pinhole", "parameters": {"fx": 520, "fy": 520, "cx": 315, "cy": 245}}
END

# The same hand with two cameras, the second one 60 mm to the right of the first and with a focal
# length of 600 px: left.jsonl, right.jsonl, poses.txt (matrices). Each fifth picture of the right
# one shows no board.
run_pair() {
  awk 'BEGIN {
    head = "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"checkerboard:9x6:25mm\"}"
    print head >"left.jsonl"; print head >"right.jsonl"; printf "" >"poses.txt"
    for (n = 0; n < 20; ++n) {
      a = 0.5 * sin(2.4 * n); b = 0.5 * cos(2.4 * n)
      tx = 0.03 + 0.02 * sin(n); ty = 0.02 * cos(3 * n); tz = 0.5 + 0.08 * sin(5 * n)
      for (c = 0; c < 2; ++c) {
        f = c ? 600 : 500; points = ""
        for (i = 0; i < 54; ++i) {
          x = 0.99 * 0.025 * (i % 9 - 4); y = 1.005 * 0.99 * 0.025 * (int(i / 9) - 2.5)
          z = tz + x * sin(a) + y * cos(a) * sin(b)
          u = 320 + f * (x * cos(a) - y * sin(a) * sin(b) + tx - 0.06 * c) / z
          v = 240 + f * (y * cos(b) + ty) / z
          points = points sprintf("%s[%d,%.4f,%.4f,0.05]", i ? "," : "", i, u + 0.05 * sin(99 * n + 7 * i * i + c), v + 0.05 * cos(77 * n + 5 * i * i + c))
        }
        if (c && n % 5 == 0) points = ""
        printf "{\"timestamp\":%d000000000,\"image_size\":[640,480],\"points\":[%s]}\n", n + 1, points >>(c ? "right.jsonl" : "left.jsonl")
      }
      r[0] = cos(a); r[1] = 0; r[2] = sin(a)
      r[3] = -sin(a) * sin(b); r[4] = cos(b); r[5] = cos(a) * sin(b)
      r[6] = -sin(a) * cos(b); r[7] = -sin(b); r[8] = cos(a) * cos(b)
      line = n + 1.005
      for (k = 0; k < 3; ++k) {
        line = line sprintf(" %.6f %.6f %.6f %.6f", r[3 * k], r[3 * k + 1], r[3 * k + 2], -(r[3 * k] * (tx + 0.05) + r[3 * k + 1] * ty + r[3 * k + 2] * tz) + 0.0001 * sin(55 * n + 9 * k))
      }
      print line >>"poses.txt"
    }
  }'
}

# near FILE KEY VALUE MOST: a number of a JSON file, the first one behind its key.
near() {
  tr -d '\n ' <"$1" | grep -o "\"$2\":[^0-9-]*[0-9.e-]*" | head -1 | sed 's/.*[^0-9.e-]//' |
    awk -v is="$3" -v most="$4" '{ found = 1; d = $1 - is; if (d < 0) d = -d; exit !(d <= most) } END { if (!found) exit 1 }' ||
    fail "$2 in $1 is not $3: $(cat "$1")"
}

run_pair
cp start.json right.json
expect 0 '^hand_from_camera: 0.0[45][0-9]* ' "$program" --method strobl --calibration one.json hand_eye.json start.json left.jsonl poses.txt
grep -q '24.7[45][0-9]* mm (.*not 25 mm' out || fail "the pitch is not said: $(cat out)"
grep -q 'Rows of the board are 0.[45][0-9]* % farther apart' out || fail "the aspect is not said: $(cat out)"
near hand_eye.json scale 0.99 0.002
near hand_eye.json aspect 1.005 0.001
near one.json fx 500 1
near one.json cx 320 1
expect 0 "60.[0-9]* mm apart" "$program" --method strobl --rig rig.json --calibration one.json --calibration two.json hand_eye.json start.json left.jsonl right.json right.jsonl poses.txt
grep -q "'right' from 'start'" out || fail "the second camera is not said: $(cat out)"
near hand_eye.json scale 0.99 0.001
near two.json fx 600 1
grep -q '"format": *"calvin-rig"' rig.json || fail 'rig.json is none'
grep -q '"camera": *"right"' rig.json || fail "rig.json: $(cat rig.json)"
# With the pitch held lengths are the board's; with both held the aspect is another lens.
expect 0 'rows of the board' "$program" --method strobl --fix pitch hand_eye.json start.json left.jsonl poses.txt
grep -q 'lengths of the robot over' out && fail "the pitch is not held: $(cat out)"
expect 0 'start 640x480' "$program" --method strobl --fix pitch --fix aspect hand_eye.json start.json left.jsonl poses.txt

cp hand_eye.json before.json
awk '{ $5 = $9 = $13 = ""; print $1, $2, $3, $4, 0, $6, $7, $8, 0, $10, $11, $12, 0 }' poses.txt >still.txt
expect 1 'nothing of the size\|do not go with' "$program" --method strobl hand_eye.json start.json left.jsonl still.txt
expect 1 'the set-up is the other one' "$program" --method strobl --eye to-hand hand_eye.json start.json left.jsonl poses.txt
expect 1 "are called 'start'" "$program" --method strobl hand_eye.json start.json left.jsonl start.json right.jsonl poses.txt
expect 1 'none.json' "$program" --method strobl hand_eye.json none.json left.jsonl poses.txt
cmp -s hand_eye.json before.json || fail 'a failure has touched the file'
expect 1 'Cannot write' "$program" --method strobl --rig none/rig.json hand_eye.json start.json left.jsonl right.json right.jsonl poses.txt
expect 2 'go with --method strobl' "$program" --fix pitch hand_eye.json start.json left.jsonl poses.txt
expect 2 '--method takes strobl' "$program" --method tsai hand_eye.json start.json left.jsonl poses.txt
expect 2 '--fix takes pitch or aspect' "$program" --method strobl --fix size hand_eye.json start.json left.jsonl poses.txt
expect 2 'of each camera' "$program" --method strobl hand_eye.json start.json left.jsonl right.json poses.txt
expect 2 'two cameras or more' "$program" --method strobl --rig rig.json hand_eye.json start.json left.jsonl poses.txt
expect 2 'than cameras' "$program" --method strobl --calibration a.json --calibration b.json hand_eye.json start.json left.jsonl poses.txt

# A result takes no input's place, nor that of what is none.
cp left.jsonl before.jsonl
cp start.json before_start.json
expect 1 "'left.jsonl' is one of the files to read" "$program" left.jsonl start.json left.jsonl poses.txt
grep -q 'The order is: calvin-hand-eye .OPTIONS. HAND_EYE.json CALIBRATION VIEWS POSES$' out || fail "no order: $(cat out)"
ln -s start.json link.json
expect 1 "'link.json' is one of the files to read" "$program" --method strobl --calibration link.json hand_eye.json start.json left.jsonl poses.txt
expect 1 "'one.json' holds a calibration, and a hand-eye calibration would" "$program" one.json start.json left.jsonl poses.txt
expect 1 'two results' "$program" --method strobl --calibration new.json --rig new.json hand_eye.json start.json left.jsonl right.json right.jsonl poses.txt
cmp -s left.jsonl before.jsonl && cmp -s start.json before_start.json || fail 'a refusal has touched a file'

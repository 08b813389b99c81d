#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `light` as users type it. Argument: the program.
set -eu
light=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# What four pinholes in the corners of a room see of a light: files of observations, and the same in
# a folder as BlueCCal has it. Every seventh sighting of cam2 is a reflection, every fifth of cam1
# is missing.
mkdir blueccal
awk 'BEGIN {
  n = split("2.5 2 -1.2  -2.4 2.1 -0.3  -2.6 -1.9 -1.4  2.3 -2.2 -0.6", p, " ")
  for (c = 0; c < 4; ++c) {
    x = p[3 * c + 1]; y = p[3 * c + 2]; z = p[3 * c + 3]; d = sqrt(x * x + y * y + z * z)
    f[0] = -x / d; f[1] = -y / d; f[2] = -z / d
    s = sqrt(f[0] * f[0] + f[1] * f[1]); r[0] = -f[1] / s; r[1] = f[0] / s; r[2] = 0
    g[0] = f[1] * r[2] - f[2] * r[1]; g[1] = f[2] * r[0] - f[0] * r[2]; g[2] = f[0] * r[1] - f[1] * r[0]
    file = "cam" c ".jsonl"
    print "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"dot\"}" >file
    printf "cam%d %s %s %s\n", c, x, y, z >"places.txt"
    printf "{\"format\":\"calvin-calibration\",\"version\":1,\"camera\":\"cam%d\",\"image_size\":[640,480],\"model\":\"pinhole\",\"parameters\":{\"fx\":600,\"fy\":600,\"cx\":320,\"cy\":240}}\n", c >("cam" c ".json")
    print "640 480" >"blueccal/Res.dat"
    us = vs = ones = seen = ""
    for (i = 0; i < 200; ++i) {
      a = sin(2.7 * i + 0.003 * i * i); b = cos(1.9 * i); e = 0.6 * sin(3.3 * i + 1)
      X = a - x; Y = b - y; Z = e - z; depth = f[0] * X + f[1] * Y + f[2] * Z
      u = 320 + 600 * (r[0] * X + r[1] * Y + r[2] * Z) / depth + 0.2 * sin(91 * i + 7 * c)
      v = 240 + 600 * (g[0] * X + g[1] * Y + g[2] * Z) / depth + 0.2 * cos(83 * i + 5 * c)
      if (c == 2 && i % 7 == 0) { u = 640 - u; v = 100 + v / 3 }
      is = u > 0 && u < 639 && v > 0 && v < 479 && !(c == 1 && i % 5 == 0)
      if (is) printf "{\"timestamp\":%d0000000,\"image_size\":[640,480],\"points\":[[0,%.4f,%.4f,0.2]]}\n", 4 * i + 4, u, v >>file
      # A wand: light 0 there, the others along it, the last one in a mirror from time to time.
      t = 1.7 * i; w = cos(2.3 * i); h = sqrt(1 - w * w); points = ""
      for (k = 0; k < 3; ++k) {
        at = k == 0 ? 0 : k == 1 ? 0.15 : 0.5
        X = a + at * h * cos(t) - x; Y = b + at * h * sin(t) - y; Z = e + at * w - z + (k == 2 && i % 25 == 0 ? 0.3 : 0)
        depth = f[0] * X + f[1] * Y + f[2] * Z
        at_u = 320 + 600 * (r[0] * X + r[1] * Y + r[2] * Z) / depth + 0.2 * sin(91 * i + 7 * c + k)
        at_v = 240 + 600 * (g[0] * X + g[1] * Y + g[2] * Z) / depth + 0.2 * cos(83 * i + 5 * c + k)
        if (depth < 0.1 || at_u < 0 || at_u > 639 || at_v < 0 || at_v > 479) continue
        points = points (points == "" ? "" : ",") sprintf("[%d,%.4f,%.4f,0.2]", k, at_u, at_v)
      }
      if (i == 0) print "{\"format\":\"calvin-observations\",\"version\":1,\"board\":\"dot\"}" >("wand" c ".jsonl")
      if (points != "") printf "{\"camera\":\"cam%d\",\"timestamp\":%d0000000,\"image_size\":[640,480],\"points\":[%s]}\n", c, 4 * i + 4, points >>("wand" c ".jsonl")
      us = us sprintf(" %.4e", u); vs = vs sprintf(" %.4e", v); ones = ones " 1"; seen = seen " " is
    }
    print us >>"blueccal/points.dat"; print vs >>"blueccal/points.dat"; print ones >>"blueccal/points.dat"
    print seen >>"blueccal/IdMat.dat"
  }
}'

expect 0 'Lengths have no unit' "$light" rig.json cam0.jsonl cam1.jsonl cam2.jsonl cam3.jsonl
grep -q '"world": "cam0"' rig.json || fail 'the first camera is not the rig'
grep -q '"unit": "none"' rig.json || fail 'the file does not say that lengths have no unit'
! grep -q ' mm' out || fail "lengths without a unit are printed in mm: $(cat out)"
grep -q "'cam3'.*f \(59[5-9]\|60[0-5]\)" out || fail "focal lengths: $(cat out)"
expect 0 'from where they were known to be' "$light" --places places.txt rig.json cam0.jsonl cam1.jsonl cam2.jsonl cam3.jsonl
grep -q '"world": "places"' rig.json || fail 'the rig is not where it was said to be'
! grep -q '"unit"' rig.json || fail 'metres have a unit of their own'
grep -q "'cam1' at -2[34]..\.. 2[01]..\.. -[23]..\.. mm" out || fail "places: $(cat out)"
# A wand gives the unit: how far the cameras stand from the first one, mm.
expect 0 'Cameras alone see the wand' "$light" --wand 150mm+350mm rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
! grep -q '"unit"' rig.json || fail 'metres have a unit of their own'
awk '/^.cam[123]/ { gsub(/[^-0-9. ]/, ""); print sqrt($2 * $2 + $3 * $3 + $4 * $4) }' out >distances
printf '4983\n6423\n4247\n' | paste - distances | awk '{ if ($1 - $2 > 15 || $2 - $1 > 15) exit 1 }' || fail "distances of cameras: $(cat out)"
expect 0 'from where they were known to be' "$light" --wand 150mm+350mm --wand-sigma 0.5mm --places places.txt rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
# A distance gives the unit, and is held against that of the wand.
expect 0 "'cam1' at" "$light" --baseline cam0:cam1:4.983m rig.json cam0.jsonl cam1.jsonl cam2.jsonl cam3.jsonl
! grep -q '"unit"' rig.json || fail 'metres have a unit of their own'
awk '/^.cam[123]/ { gsub(/[^-0-9. ]/, ""); print sqrt($2 * $2 + $3 * $3 + $4 * $4) }' out >distances
printf '4983\n6423\n4247\n' | paste - distances | awk '{ if ($1 - $2 > 25 || $2 - $1 > 25) exit 1 }' || fail "distances of cameras: $(cat out)"
head -n 1 distances | awk '{ exit !($1 > 4982.8 && $1 < 4983.2) }' || fail "not the distance that is known: $(cat out)"
expect 0 "'cam1' at" "$light" --baseline 4.983m:5mm --calibration cam0=cam0.json --calibration cam1=cam1.json rig.json cam0.jsonl cam1.jsonl
expect 0 'Cameras alone see the wand' "$light" --wand 150mm+350mm --baseline cam0:cam1:4.983m:5mm rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
! grep -q 'measure both' out || fail "a distance that is right: $(cat out)"
expect 0 'measure both' "$light" --wand 150mm+350mm --baseline cam0:cam1:5.2m:5mm rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
expect 0 'Cameras alone see the wand' "$light" --wand 150mm+350mm --baseline cam0:cam1:5.2m:200mm rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
! grep -q 'measure both' out || fail "a distance that is hardly known contradicts nothing: $(cat out)"
expect 1 'without names is that of two cameras' "$light" --baseline 4.983m rig.json cam0.jsonl cam1.jsonl cam2.jsonl
expect 1 "'cam9', which is no camera" "$light" --baseline cam0:cam9:4.983m rig.json cam0.jsonl cam1.jsonl cam2.jsonl
expect 2 'give one of them' "$light" --baseline cam0:cam1:4.983m --places places.txt rig.json cam0.jsonl cam1.jsonl cam2.jsonl
expect 2 'no option, or its value' "$light" --baseline cam0:cam1 rig.json cam0.jsonl cam1.jsonl cam2.jsonl
expect 2 'no option, or its value' "$light" --baseline cam0:cam1:5m,cam1:cam2:6m rig.json cam0.jsonl cam1.jsonl cam2.jsonl
expect 0 'measure both' "$light" --wand 156mm+364mm --places places.txt rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
# Places that are in another unit than that of the wand.
cp rig.json before.json
awk '{ print $1, 1000 * $2, 1000 * $3, 1000 * $4 }' places.txt >places_mm.txt
expect 1 'they are in millimetres. Give them in metres' "$light" --wand 150mm+350mm --places places_mm.txt rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
sed -n 1,2p places_mm.txt | awk '{ print $1, $2 / 10, $3 / 10, $4 / 10 }' >places_cm.txt
expect 1 'they are in centimetres' "$light" --wand 150mm+350mm --places places_cm.txt rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
cmp -s rig.json before.json || fail 'a failure has touched the file'
for c in 0 1 2 3; do sed 's/"dot"/"wand:150mm+350mm"/' "wand$c.jsonl" >"named$c.jsonl"; done
expect 0 'Cameras alone see the wand' "$light" rig.json named0.jsonl named1.jsonl named2.jsonl named3.jsonl
sed 's/"dot"/"wand:150mm+351mm"/' wand1.jsonl >other.jsonl
expect 1 'different wands' "$light" rig.json named0.jsonl other.jsonl named2.jsonl
expect 0 "'cam1' at" "$light" --wand 150mm+350mm --wand-sigma 0 --calibration cam0=cam0.json --calibration cam1=cam1.json rig.json wand0.jsonl wand1.jsonl
cp rig.json before.json
expect 1 'lights 0 and 1 150.. mm apart, not 350' "$light" --wand 350mm+150mm rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
expect 1 'where all lights of the wand are' "$light" --wand 500mm rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
expect 1 'is told by --wand' "$light" rig.json wand0.jsonl wand1.jsonl wand2.jsonl wand3.jsonl
expect 2 'Usage' "$light" --wand -500mm rig.json wand0.jsonl
expect 2 'Usage' "$light" --wand 500 rig.json wand0.jsonl
cmp -s rig.json before.json || fail 'a failure has touched the file'
expect 0 'mean error' "$light" rig.json blueccal/
expect 0 "'cam1' at" "$light" --calibration cam0=cam0.json --calibration cam1=cam1.json rig.json cam0.jsonl cam1.jsonl
expect 0 'mean error' "$light" --fix aspect,center,p1,p2,k2 --export kalibr:chain.yaml rig.json blueccal
[ -s chain.yaml ] || fail 'no camchain was written'
cp rig.json before.json
mkdir bare
expect 1 "'bare' cannot be used as what BlueCCal writes: points.dat is missing" "$light" rig.json bare
cp blueccal/points.dat bare
expect 1 'Res.dat is missing in it. The folder has to hold points.dat and Res.dat' "$light" rig.json bare
expect 1 'three are needed' "$light" rig.json cam0.jsonl cam1.jsonl
expect 1 "'cam1.json' is of 'cam1', and is given as the calibration of 'cam0': exchange it and 'cam0.json'" "$light" \
  --calibration cam0=cam1.json --calibration cam1=cam0.json rig.json cam0.jsonl cam1.jsonl
sed 's/"camera":"cam1"/"camera":"door"/' cam1.json >door.json
expect 0 "door.json is of 'door', and is given as the calibration of 'cam1'" "$light" --calibration cam0=cam0.json \
  --calibration cam1=door.json rig.json cam0.jsonl cam1.jsonl
cp rig.json before.json
expect 1 "No camera is called 'x'" "$light" --calibration x=cam0.json rig.json cam0.jsonl cam1.jsonl
sed 's/^\(cam.\) \([^ ]*\) \([^ ]*\) -/\1 \2 \3 /' places.txt >mirrored.txt
expect 1 'left-handed' "$light" --places mirrored.txt rig.json cam0.jsonl cam1.jsonl cam2.jsonl cam3.jsonl
expect 1 'nowhere' "$light" --places nowhere rig.json blueccal
expect 2 'Usage' "$light" rig.json
expect 2 'Usage' "$light" --tolerance x rig.json blueccal
cmp -s rig.json before.json || fail 'a failure has touched the file'

# A forgotten output takes no input's place, nor that of what is no rig.
cp cam0.jsonl before.jsonl
cp places.txt before.txt
expect 1 "'cam0.jsonl' holds observations of a board, and a rig would take its place" "$light" cam0.jsonl cam1.jsonl cam2.jsonl cam3.jsonl
grep -q 'The order is: calvin-light .OPTIONS. RIG.json SEEN...$' out || fail "nothing says what comes first: $(cat out)"
expect 1 "'places.txt' is one of the files to read" "$light" --places places.txt places.txt cam1.jsonl cam2.jsonl cam3.jsonl
expect 1 "'mirrored.txt' holds something that this tool does not write" "$light" mirrored.txt cam0.jsonl cam1.jsonl cam2.jsonl cam3.jsonl
expect 1 "'cam0.json' holds a calibration" "$light" --export kalibr:cam0.json rig.json blueccal
expect 1 'two results' "$light" --export kalibr:./rig.json rig.json blueccal
cmp -s cam0.jsonl before.jsonl && cmp -s places.txt before.txt && cmp -s rig.json before.json || fail 'a refusal has touched a file'

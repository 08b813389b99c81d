#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `export-warp` as users type it. Argument: the program.
set -eu
warp=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

camera=fx=480,fy=478,cx=325,cy=236,k1=-0.28,k2=0.09,width=640,height=480
printf '{"format": "calvin-calibration", "version": 1, "image_size": [640, 480], "model": "fisheye",
 "parameters": {"fx": 193, "fy": 193, "cx": 320, "cy": 240, "k1": 0, "k2": 0, "k3": 0, "k4": 0}}' >wide.json

# A vertex at every 16th pixel of 320x200 and where it ends, four bytes each.
expect 0 'map.bin: dw100, 320x200 px from 640x480 px' "$warp" --output 320x200 "$camera" dw100 map.bin
[ "$(wc -c <map.bin)" = $((21 * 14 * 4)) ] || fail "map.bin has $(wc -c <map.bin) bytes"
expect 0 'y.pgm: ffmpeg' "$warp" $camera ffmpeg x.pgm y.pgm --input 320x240
[ "$(head -c 14 y.pgm | tr '\n' ' ')" = 'P5 320 240 655' ] || fail 'y.pgm is no PGM of 320x240'
expect 0 'limited' "$warp" wide.json stmap map.exr --alpha 1
expect 0 'stmap-down' "$warp" wide.json stmap-down map.exr --alpha 1 --projection fisheye
! grep -q limited out || fail 'a fisheye view is limited'
expect 0 'nvdewarper' "$warp" wide.json nvdewarper wide.txt
grep -q '^projection-type=4$' wide.txt || fail "no fisheye in $(cat wide.txt)"
expect 0 'glsl' "$warp" wide.json glsl wide.frag --projection panini --zoom 0.8
grep -q gl_FragColor wide.frag || fail 'wide.frag is no shader'

expect 1 'another format' "$warp" wide.json nvdewarper no.txt --pan 10
expect 1 'another aspect' "$warp" wide.json dw100 no.bin --input 640x360
expect 1 '--input' "$warp" fx=480,fy=478,cx=325,cy=236 dw100 no.bin
expect 1 'none.json' "$warp" none.json dw100 no.bin
expect 1 'no/where' "$warp" wide.json dw100 no/where.bin
[ ! -e no.bin ] && [ ! -e no.txt ] || fail 'an error left a file behind'
expect 2 'Usage' "$warp"
expect 2 'a format are needed' "$warp" wide.json
expect 2 'no format' "$warp" wide.json avi no.bin
expect 2 'two files' "$warp" wide.json ffmpeg x.pgm
expect 2 'one file' "$warp" wide.json dw100
expect 2 "pan takes a number from -180 to 180, not 'east'" "$warp" wide.json dw100 no.bin --pan east
expect 2 "roll takes a number from -180 to 180, not '400'" "$warp" wide.json dw100 no.bin --roll 400
expect 2 "alpha takes a number from 0 to 1, not '2'" "$warp" wide.json dw100 no.bin --alpha 2
expect 2 "zoom takes a number from 0.01 to 100, not '0'" "$warp" wide.json dw100 no.bin --zoom 0
expect 2 "output takes WxH, 2x2 to 16384x16384 px, not '320'" "$warp" wide.json dw100 no.bin --output 320
expect 2 "not '99999x99999'" "$warp" wide.json dw100 no.bin --output 99999x99999
expect 2 'projection takes one of rectilinear, .*, fisheye, not .foo' "$warp" wide.json dw100 no.bin --projection foo
expect 2 "alpha-mode takes one of calvin, opencv, not ''" "$warp" wide.json dw100 no.bin --alpha-mode
expect 2 'not an option' "$warp" wide.json dw100 no.bin --fast
expect 0 'Usage' "$warp" --help

# A map takes no input's place, nor that of the other map or of what calvin-... has written.
cp wide.json before.json
cp wide.json other.json
expect 1 "'./wide.json' is one of the files to read" "$warp" wide.json glsl ./wide.json
expect 1 "'other.json' holds a calibration, and an export would" "$warp" wide.json glsl other.json
expect 1 "'x.pgm' is to hold two results" "$warp" $camera ffmpeg x.pgm x.pgm
cmp -s wide.json before.json && cmp -s other.json before.json || fail 'a refusal has touched a file'

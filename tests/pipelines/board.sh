#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `board` as users type it. Arguments: the program, "draw" where the library
# can draw.
set -eu
board=$(realpath "$1")
can_draw=${2-}
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

expect 0 'boards.json#floor' "$board" add boards.json floor checkerboard:9x6:2.5cm
expect 0 'boards.json#wall' "$board" add boards.json wall checkerboard:7x5:30mm
expect 0 'checkerboard:9x6:25mm' "$board" list boards.json
[ "$("$board" list boards.json | cut -f 1 | tr '\n' ' ')" = 'floor wall ' ] || fail 'the order'

expect 1 'checkerboard:9x6:25mm' "$board" add boards.json door checkerboard:9x6
expect 1 'checkerboard:9x6:25mm' "$board" draw boards.json#door door.pdf
expect 1 'none.json' "$board" list none.json
expect 1 'nothing to print' "$board" draw dot dot.pdf
[ ! -e dot.pdf ] || fail 'a light was drawn'
expect 2 'Usage' "$board"
expect 2 'Usage' "$board" draw checkerboard:9x6:25mm
expect 2 'Usage' "$board" draw checkerboard:9x6:25mm board.pdf --paper
expect 2 'Usage' "$board" draw checkerboard:9x6:25mm board.png --dpi many
expect 2 'no command' "$board" print
expect 2 'needs a picture' "$board" identify
expect 2 'a length' "$board" identify board.png --side wide
expect 1 'cannot be read\|can be read' "$board" identify boards.json
expect 0 'Usage' "$board" --help

pinhole_views 12 >views.jsonl
expect 2 'pictures of it' "$board" measure boards.json#floor
expect 1 'calvin-board add' "$board" measure checkerboard:9x6:25mm views.jsonl
expect 1 'none.jsonl' "$board" measure boards.json#floor none.jsonl
expect 1 'nowhere to be seen' "$board" measure boards.json#wall views.jsonl
expect 0 'boards.json#floor' "$board" measure boards.json#floor views.jsonl
expect 0 'measured by 12 views' "$board" list boards.json
expect 2 'list takes one file, and 2 are given' "$board" list boards.json extra
expect 1 'count once' "$board" measure boards.json#floor views.jsonl
cp boards.json same.json
expect 0 'Use it as' "$board" add same.json floor checkerboard:9x6:25mm
[ ! -e same.json~ ] || fail 'a copy of what is the same'
cp same.json before.json
expect 0 'What 12 views had measured .* is same.json~' "$board" add same.json floor checkerboard:8x6:25mm
cmp before.json same.json~ || fail 'the copy is not what was there'

if [ "$can_draw" != draw ]; then
  expect 1 'without Cairo' "$board" draw checkerboard:9x6:25mm board.pdf
  exit 0
fi

# first_bytes FILE N: as hexadecimal digits.
first_bytes() {
  od -An -tx1 -N "$2" "$1" | tr -d ' \n'
}

expect 0 '297.0 x 210.0 mm' "$board" draw boards.json#floor board.pdf
[ "$(first_bytes board.pdf 5)" = 255044462d ] || fail 'board.pdf is no PDF'
expect 0 '279.4 x 215.9 mm' "$board" draw boards.json#floor board.svg --paper letter
grep -q 'width="279.4mm"' board.svg || fail 'board.svg is not in mm'
expect 0 '297.0 x 210.0 mm' "$board" draw boards.json#floor board.png --dpi 50 --paper a4
[ "$(first_bytes board.png 8)" = 89504e470d0a1a0a ] || fail 'board.png is no PNG'

for text in puzzle:14x9:20mm charuco:5x7:36mm:18mm:DICT_6X6_250; do
  "$board" add "${text%%:*}.json" part "$text" >out 2>&1 || {
    grep -q 'without OpenCV' out || fail "$text has no name: $(cat out)"
    continue
  }
  for format in pdf svg png; do
    expect 0 "$text on a page" "$board" draw "${text%%:*}.json#part" "coded.$format" --dpi 50
  done
done
# What is drawn is known again, but for its length.
for text in checkerboard:9x6:20mm checkerboard:9x6:20mm:circles puzzle:9x6:20mm:120,7 circles:9x6:20mm acircles:4x11:20mm \
  charuco:9x6:20mm:14mm:DICT_4X4_50:legacy aprilgrid:4x5:20mm:0.3:tag36h11:first=3 \
  apriltag:tagStandard41h12:4x5:20mm:18mm:first=7 apriltag:tagCircle21h7:3x4:20mm:16mm; do
  "$board" draw "$text" known.png --dpi 100 >out 2>&1 || {
    grep -q 'made without' out || fail "$text is not drawn: $(cat out)"
    continue
  }
  "$board" identify known.png >out 2>&1 || true
  grep -q 'without OpenCV' out && continue
  expect 0 'known.png: ' "$board" identify known.png --side 20mm
  "$board" add known.json seen "$(cut -d ' ' -f 2 out)" >/dev/null
  "$board" add known.json drawn "$text" >/dev/null
  [ "$("$board" list known.json | cut -f 2 | uniq | wc -l)" = 1 ] || fail "$text: $(cat out)"
done
# Over several sheets: pages of a PDF, or a file for each.
expect 0 '8 sheets of 210.0 x 297.0 mm, 4 columns and 2 rows' \
  "$board" draw checkerboard:14x9:40mm tiled.pdf --tiled a4
[ "$(grep -a '/Type /Page' tiled.pdf | grep -cv '/Type /Pages')" = 8 ] || fail 'tiled.pdf has not 8 pages'
expect 0 'tiled-1.png ...' "$board" draw checkerboard:14x9:40mm tiled.png --tiled a4 --dpi 50
[ -e tiled-8.png ] && [ ! -e tiled-9.png ] && [ ! -e tiled.png ] || fail 'not 8 pictures'
expect 1 "no paper called 'fit'; use one of letter, a4" "$board" draw checkerboard:14x9:40mm tiled.pdf --tiled fit
expect 1 'more than 200 sheets' "$board" draw checkerboard:14x9:1m tiled.pdf --tiled a4
expect 1 "paper 'a2' holds it" "$board" draw checkerboard:9x6:40mm big.pdf --paper a4
expect 1 "no paper called 'b7'; use auto, fit or one of letter, a4" "$board" draw checkerboard:9x6:40mm big.pdf --paper b7
expect 1 '.pdf, .svg or .png' "$board" draw checkerboard:9x6:25mm board.jpg
expect 1 'dpi' "$board" draw checkerboard:9x6:25mm board2.png --dpi 100000
expect 1 'Cannot write' "$board" draw checkerboard:9x6:25mm none/board.pdf
[ ! -e big.pdf ] && [ ! -e board2.png ] || fail 'an error left a file behind'

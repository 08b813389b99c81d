#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# The example program `calibrate-images` as users type it. Argument: the program.
set -eu
images=$(realpath "$1")
# shellcheck source=tests/pipelines/program.sh
. "$(dirname "$0")/program.sh"

# refused WORDS OUTPUT: says so before any picture has been looked at.
refused() {
  expect 1 "$1" "$images" --output "$2" pictures
  ! grep -q 'corners' out || fail "--output $2 is refused after the work: $(cat out)"
}

mkdir pictures
gst-launch-1.0 -q calibtestsrc num-buffers=5 ! video/x-raw,width=640,height=480 ! pngenc ! \
  multifilesink location=pictures/%02d.png

echo file >file
refused "There is no folder none/new" none/new
refused "There is no folder file" file
refused "There is no folder file/new" file/new

# A folder that is not there is made, and one that is there is used.
for n in 1 2; do
  "$images" --output new pictures >out 2>&1 || fail "run $n: $(cat out)"
  for name in camera.json before.png after.png; do
    [ -s "new/$name" ] || fail "run $n made no new/$name: $(cat out)"
  done
done
[ ! -e camera.json ] || fail "a file is outside of the folder"
grep -q '^5 of 5 pictures used' out || fail "no count: $(cat out)"

# File names are of any bytes, in any locale.
LC_ALL=C "$images" --export 'opencv-xml:new/für.xml' --output new pictures >out 2>&1 || fail "$(cat out)"
[ -s new/für.xml ] || fail "no export of that name: $(cat out)"
expect 2 "'lens' is not" "$images" --model lens --output new pictures
expect 2 'bogus' "$images" --fix bogus --output new pictures
expect 1 'Cannot write' "$images" --export opencv-xml:none/x.xml --output new pictures
! grep -q 'corners' out || fail "a folder that is not there is found after the work: $(cat out)"
# What cannot hold the model that is found takes nothing of the report away.
status=0
"$images" --export kalibr:new/chain.yaml --output new pictures >out 2>err || status=$?
case $status in
  1) grep -q '^RMS reprojection error' out || fail "no report: $(cat out err)" ;;
  2) ;; # built without the formats of other programs
  *) fail "kalibr with brown5 left with $status: $(cat out err)" ;;
esac
[ "$(grep -c 'no camera model like' err)" -le 1 ] || fail "said twice: $(cat err)"
expect 1 'but for those' "$images" --leave-out '*' --output new pictures

# used WORDS: what is said to the user of a folder with more in it; the calibration is made anyway.
used() {
  rm -rf new
  "$images" --output new pictures >out 2>err || fail "$1: $(cat out err)"
  grep -q -- "$1" err || fail "stderr does not say '$1': $(cat err)"
  [ -s new/camera.json ] || fail "$1: no calibration"
}

# What is no whole picture is named, with what to do.
head -c 3000 pictures/00.png >pictures/cut.png
used 'cut.png: left out, .*: save it again as PNG or JPEG'
: >pictures/empty.png
used 'empty.png: left out, .*: save it again as PNG or JPEG'
seq -f "line %.0f of a text" 200 >pictures/notes.txt
used 'notes.txt: left out, it is no picture'
ln -s nowhere pictures/link.png
used 'link.png: left out, it cannot be opened'
gst-launch-1.0 -q videotestsrc num-buffers=1 ! video/x-raw,width=320,height=240 ! pngenc ! \
  filesink location=pictures/small.png
used 'small.png: left out, it is 320x240 and most are 640x480'
gst-launch-1.0 -q videotestsrc num-buffers=1 ! video/x-raw,width=640,height=480 ! pngenc ! \
  filesink location=pictures/blank.png
used 'small.png: left out'
mkfifo pictures/pipe.png
used 'pipe.png: left out, it is a device or a FIFO'
grep -q '^5 of 11 pictures used: 5 left out, 1 without a board' out || fail "counts: $(cat out)"
[ "$(grep -c ': left out' err)" = 7 ] || fail "not each once: $(cat err)"
grep -q 'blank.png: left out, no board was found' err || fail "no reason: $(cat err)"
grep -q '^2/6 01.png: 54 corners' out || fail "no progress: $(cat out)"

# The result is printed with its sigmas, and how good it is.
for words in '^fx  *[0-9.]*  *[0-9.]' '^accurate to [0-9.]* px where corners were seen' '^verdict: good'; do
  grep -q "$words" out || fail "no '$words': $(cat out)"
done

# Where none is left, the program says so and fails.
mkdir broken
cp pictures/cut.png broken
got=0
"$images" --output new broken >out 2>err || got=$?
[ "$got" = 1 ] || fail "a folder of broken pictures left with $got: $(cat out err)"
grep -q 'cut.png: left out' err || fail "the broken picture is not named: $(cat err)"

# leaves STATUS ARGUMENT...: how the program ends; what it says is in `out` and `err`.
leaves() {
  want=$1
  shift
  rm -rf new
  got=0
  "$images" --output new "$@" >out 2>err || got=$?
  [ "$got" = "$want" ] || fail "$* left with $got, not $want: $(cat out err)"
}
# what NAME: the value of that name in the calibration.
what() {
  /usr/bin/python3 -c 'import json, sys
c = json.load(open("new/camera.json"))
print(c.get(sys.argv[1], c["parameters"].get(sys.argv[1])))' "$1"
}

# What every picture can be: eight bits and sixteen, PNG, TIFF and JPEG, whose decoder has to be exact.
mkdir many exact
gst-launch-1.0 -q calibtestsrc num-buffers=8 noise=0 ground-truth=truth.json ! \
  video/x-raw,width=640,height=480,format=GRAY8 ! tee name=t ! queue ! \
  jpegenc quality=95 idct-method=islow ! multifilesink location=exact/%02d.jpg \
  t. ! queue ! multifilesink location=many/%02d.raw
/usr/bin/python3 - <<'END'
import glob, pathlib, struct, zlib

def tiff(data, bits):
    entries = ((256, 640), (257, 480), (258, bits), (259, 1), (262, 1), (273, 122), (277, 1),
               (278, 480), (279, len(data)))
    return (b"II*\0" + struct.pack("<IH", 8, len(entries)) +
            b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in entries) +
            struct.pack("<I", 0) + data)

def png16(data):
    def chunk(kind, content):
        return (struct.pack(">I", len(content)) + kind + content +
                struct.pack(">I", zlib.crc32(kind + content)))
    rows = b"".join(b"\0" + data[y * 1280:(y + 1) * 1280] for y in range(480))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 640, 480, 16, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))

for i, name in enumerate(sorted(glob.glob("many/*.raw"))):
    path = pathlib.Path(name)
    data = path.read_bytes()
    deep = bytes(b for x in data for b in (x, x))
    content, end = ((tiff(data, 8), ".tif"), (tiff(deep, 16), ".tiff"), (png16(deep), ".png"))[i % 3]
    path.with_suffix(end).write_bytes(content)
    path.unlink()
END
if gst-inspect-1.0 --exists gdkpixbufdec; then
  leaves 0 many
  grep -q '^8 of 8 pictures used' out || fail "TIFF and PNG: $(cat out err)"
fi
leaves 0 exact
grep -q '^8 of 8 pictures used' out || fail "JPEG: $(cat out err)"
rms=$(what rms)
[ "$(echo "$rms" | cut -c1-4)" = 0.00 ] || fail "JPEG is not decoded exactly: RMS $rms px"
grep -q 'The views ask for the model' out || fail "the model is not found: $(cat out)"

# The picture that is shown undistorted is one of the camera, not merely the first.
cp new/before.png shown.png
gst-launch-1.0 -q videotestsrc num-buffers=1 ! video/x-raw,width=640,height=480 ! pngenc ! \
  filesink location=exact/+blank.png
leaves 0 exact
grep -q '^8 of 9 pictures used: 0 left out, 1 without a board' out || fail "blank: $(cat out)"
cmp shown.png new/before.png || fail "another picture is shown than one of the result"
rm exact/+blank.png
grep -q '^camera.json, and 00.jpg as before.png and after.png, are in new' out || fail "$(cat out)"

# A text that is no board ends before the pictures are looked at.
leaves 2 --board 9x6 exact
! grep -q pictures out || fail "the pictures are to blame: $(cat out)"
# Two views are no calibration, and not since they contradict each other.
mkdir few
cp exact/00.jpg exact/01.jpg few
leaves 1 few
grep -q 'only 2 views' err || fail "no reason: $(cat err)"
! grep -q contradict err || fail "a false reason: $(cat err)"
rm -r few

# What the user says of the solve arrives there.
leaves 0 --model rational8 --fix k4,k5,k6,aspect exact
[ "$(what fx)" = "$(what fy)" ] || fail "--fix was not heard: $(cat out)"
leaves 0 --model pinhole --initial truth.json exact
[ "$(what model)" = pinhole ] || fail "--model was not heard"
leaves 1 --initial nothing.json exact
grep -q nothing.json err || fail "--initial was not heard: $(cat err)"

# The exit status by the verdict, where it is asked for.
leaves 0 --verdict exact
leaves 0 --accuracy 1 exact
leaves 3 --accuracy 0.0001 exact
grep -q 'verdict: not good enough, accurate to' out || fail "no verdict: $(cat out)"
# A few pictures of another board, which no element has had the time to name.
mkdir others
gst-launch-1.0 -q calibtestsrc num-buffers=3 board=puzzle:8x6:30mm ! \
  video/x-raw,width=640,height=480 ! pngenc ! multifilesink location=others/%02d.png
expect 1 'This is puzzle:8x6:30mm, I look for circles:7x5:30mm: see --board' \
  "$images" --board circles:7x5:30mm --output new others

# Nothing is wrong with three noisy pictures but that they tell little.
mkdir few
gst-launch-1.0 -q calibtestsrc num-buffers=3 noise=20 ! video/x-raw,width=640,height=480 ! \
  pngenc ! multifilesink location=few/%d.png
leaves 0 --model brown5 --verdict few
grep -q 'verdict: weak, though nothing is wrong' out || fail "few pictures: $(cat out)"
leaves 3 --model pinhole --verdict exact # through a lens that distorts
grep -q 'verdict: not good, misfit model' out || fail "no misfit: $(cat out)"
leaves 0 --model pinhole exact

# A board that nobody named is looked for first, so that no picture is lost; and further files.
leaves 0 --board auto:25mm --export opencv-yaml:further.yml exact
grep -q '^8 of 8 pictures used' out || fail "auto loses pictures: $(cat out)"
grep -q '^The pictures show checkerboard:9x6:25mm' out || fail "which board is it: $(cat out)"
grep -q camera_matrix further.yml || fail "no further file: $(cat out err)"
leaves 2 --export opencv:further.yml exact
grep -q "opencv-yaml" err || fail "no right format is named: $(cat err)"

# Another board than the one that is asked for is told, with its size.
leaves 1 --board checkerboard:8x5:25mm exact
[ "$(grep -c 'it shows a board of 9x6 inner corners' err)" = 1 ] || fail "no size: $(cat err)"
grep -q '^  The same: .*07' err || fail "the others are not named: $(cat err)"

# Two cameras are not one, by their names or by what they say themselves.
mkdir two
for n in 0 1 2 3; do
  cp "exact/0$n.jpg" "two/left$n.jpg"
  cp "exact/0$((n + 4)).jpg" "two/right$n.jpg"
done
leaves 1 two
grep -q "several cameras, by their names: 4 of 'left\*', 4 of 'right\*'" err || fail "$(cat err)"
! grep -q corners out || fail "it was looked for boards: $(cat out)"
leaves 0 --leave-out 'right*' two
[ "$(grep -c 'left out, as you asked for' err)" = 4 ] || fail "not left out: $(cat err)"
grep -q '^4 of 8 pictures used: 4 left out' out || fail "counts: $(cat out)"
leaves 0 --one-camera two
mkdir exif
/usr/bin/python3 - <<'END'
import glob, pathlib, struct

def with_model(jpeg, model):
    text = model.encode().ljust(12, b"\0")
    exif = (b"Exif\0\0II*\0" + struct.pack("<IHHHIII", 8, 1, 0x110, 2, len(text), 26, 0) + text)
    return jpeg[:2] + b"\xff\xe1" + struct.pack(">H", len(exif) + 2) + exif + jpeg[2:]

for i, name in enumerate(sorted(glob.glob("exact/*.jpg"))):
    path = pathlib.Path(name)
    model = "Alpha" if i % 2 else "Beta"
    pathlib.Path("exif", path.name).write_bytes(with_model(path.read_bytes(), model))
END
leaves 1 exif
grep -q 'several cameras, by what they say of them: 4 of Alpha, 4 of Beta' err || fail "$(cat err)"

# Nor are two sizes one, where neither has most of the pictures.
mkdir sizes
cp exact/0[0-3].jpg sizes
for n in 4 5 6 7; do
  gst-launch-1.0 -q filesrc location="exact/0$n.jpg" ! jpegdec ! videoscale ! \
    video/x-raw,width=320,height=240 ! pngenc ! filesink location="sizes/0$n.png"
done
leaves 1 sizes
grep -q 'several sizes (4 of 320x240, 4 of 640x480)' err || fail "$(cat err)"

# A movie is no picture, and a file with a second picture in it, as phones and stereo cameras make
# them, counts once: the pictures behind it keep their names.
cp -r exact movie
if gst-inspect-1.0 --exists avimux && gst-inspect-1.0 --exists avidemux; then
  gst-launch-1.0 -q videotestsrc num-buffers=20 ! video/x-raw,width=640,height=480 ! jpegenc ! \
    avimux ! filesink location=movie/00.avi
  leaves 0 movie
  grep -q '^00.avi: left out, it is a movie: save' err || fail "a movie: $(cat out err)"
  grep -q '^8 of 9 pictures used: 1 left out, 0 without' out || fail "beside a movie: $(cat out)"
  grep -q '^8/8 07.jpg: 54 corners' out || fail "names beside a movie: $(cat out)"
fi
for size in 640x480 160x120; do
  rm -rf second
  cp -r exact second
  gst-launch-1.0 -q videotestsrc num-buffers=1 ! \
    "video/x-raw,width=${size%x*},height=${size#*x}" ! jpegenc ! filesink location=blank.jpg
  cat blank.jpg >>second/02.jpg
  leaves 0 second
  grep -q '^8 of 8 pictures used' out || fail "a second picture of $size: $(cat out err)"
  grep -q '^8/8 07.jpg: 54 corners' out || fail "names behind a second picture: $(cat out)"
done

# Whichever board the pictures show, as the element takes it.
rm -rf new
expect 0 '^[678] of 8 pictures used' "$images" --board auto:25mm --output new exact
expect 2 'auto:25mm' "$images" --board auto:wide --output new exact

# A large folder takes no more than a small one: 100 pictures with 64 file descriptors. Copies of a
# picture say nothing of their own.
mkdir large
for n in $(seq 10 109); do ln "exact/0$((n % 8)).jpg" "large/$n.jpg"; done
# shellcheck disable=SC3045 # not in POSIX, and in every shell that is sh somewhere
(ulimit -n 64 && leaves 0 large) || exit 1
grep -q '^8 of 100 pictures used: 92 left out' out || fail "a large folder: $(cat out err)"
grep -q '^1[01-9]*.jpg: left out, it tells nothing that the others do not' err || fail "copies: $(cat out err)"
! grep -q CRITICAL err || fail "a large folder: $(cat err)"

# A name is a name, whatever it would mean to GStreamer.
cp -r exact names
mv names/00.jpg 'names/ a" ! filesink location=PWNED .jpg'
rm -rf out\\put\"
"$images" --output 'out\put"' names >out 2>err || fail "names: $(cat out err)"
grep -q '^8 of 8 pictures used' out || fail "names: $(cat out err)"
[ ! -e PWNED ] || fail "the name of a picture was run"
for name in camera.json before.png after.png; do
  [ -s 'out\put"'/$name ] || fail "there is no $name in the folder with such a name"
done

# What an earlier run left beside the pictures, where files go by default, is no picture.
cp -r exact again
cd again
"$images" . >../first 2>../err || fail "beside the pictures: $(cat ../first ../err)"
fx=$(grep '^fx' ../first)
for n in 2 3; do
  "$images" . >../out 2>../err || fail "beside the pictures, run $n: $(cat ../out ../err)"
  for name in before.png after.png; do
    grep -q "^$name: left out, this program made it" ../err || fail "$name in run $n: $(cat ../err)"
  done
  grep -q '^8 of ' ../out || fail "counts of run $n: $(cat ../out)"
  [ "$(grep '^fx' ../out)" = "$fx" ] || fail "run $n has another result: $(cat ../first ../out)"
done
# One of the user with such a name is a picture, and is not replaced.
for name in before.png after.png; do
  rm -f before.png after.png
  cp ../pictures/01.png "$name"
  got=0
  "$images" . >../out 2>../err || got=$?
  [ "$got" = 1 ] || fail "the user's $name: left with $got: $(cat ../out ../err)"
  grep -q "There is a $name in .* did not make.*rename it, or give --output" ../err ||
    fail "the user's $name: $(cat ../err)"
  ! grep -q corners ../out || fail "the user's $name is refused after the work: $(cat ../out)"
  cmp -s ../pictures/01.png "$name" || fail "the user's $name was replaced"
  "$images" --output ../new . >../out 2>../err || fail "the user's $name: $(cat ../out ../err)"
  grep -q " $name: 54 corners" ../out || fail "the user's $name is no picture: $(cat ../out ../err)"
done
cd ..

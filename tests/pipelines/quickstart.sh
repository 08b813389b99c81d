#!/bin/sh
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs examples/quickstart.sh in all its ways on a build that is there already.
#   quickstart.sh SOURCE BUILD SHIM
set -eu
source=$1
shim=$3
export CALVIN_BUILD="$2"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fails() { echo "FAILED: $1"; exit 1; }
# value FILE NAME: a number of a native calibration
value() { /usr/bin/python3 -c '
import json, sys
c = json.load(open(sys.argv[1]))
print(c["parameters"].get(sys.argv[2], c.get(sys.argv[2])))' "$1" "$2"; }
# within NUMBER WANTED TOLERANCE
within() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { exit !(a - b < t && b - a < t) }'; }
picture() { [ "$(head -c 4 "$1" | tail -c 3)" = PNG ] || fails "$1 is no picture"; }

echo "== the synthetic camera"
CALVIN_OUTPUT=$folder/synthetic "$source/examples/quickstart.sh" >"$folder/log" || {
  cat "$folder/log"; fails "quickstart"; }
cat "$folder/log"
for word in fx fy cx cy k1 k2 p1 p2 k3 truth sigma; do
  grep -q "$word" "$folder/log" || fails "no $word is printed"
done
within "$(value "$folder/synthetic/camera.json" fx)" "$(value "$folder/synthetic/truth.json" fx)" 0.5 ||
  fails "fx is not the true one"
for name in before after; do picture "$folder/synthetic/$name.png"; done
cmp -s "$folder/synthetic/before.png" "$folder/synthetic/after.png" && fails "nothing was undistorted"
grep -q plumb_bob "$folder/synthetic/camera_info.yaml" || fails "no ROS file"
grep -q camera_matrix "$folder/synthetic/camera.yml" || fails "no OpenCV file"

echo "== pictures"
pictures=${CALVIN_DATA:-}/opencv-samples
if [ -d "$pictures" ]; then
  mkdir "$folder/left"
  cp "$pictures"/left[0-9]*.jpg "$folder/left"
  CALVIN_OUTPUT=$folder/images "$source/examples/quickstart.sh" --images "$folder/left" \
    checkerboard:9x6:30mm >"$folder/log" || { cat "$folder/log"; fails "quickstart --images"; }
else
  # Debian's package is fetched, as on any machine.
  CALVIN_OUTPUT=$folder/images "$source/examples/quickstart.sh" --images >"$folder/log" || {
    cat "$folder/log"; fails "quickstart --images"; }
fi
cat "$folder/log"
result=$folder/images/camera.json
# Bouguet's published values of these pictures.
within "$(value "$result" fx)" 533.52 2 || fails "fx"
within "$(value "$result" fy)" 533.53 2 || fails "fy"
within "$(value "$result" cx)" 341.60 3 || fails "cx"
within "$(value "$result" cy)" 235.19 3 || fails "cy"
within "$(value "$result" rms)" 0 0.25 || fails "rms"
[ "$(/usr/bin/python3 -c 'import json, sys; print(len(json.load(open(sys.argv[1]))["views"]))' \
  "$result")" -ge 11 ] || fails "fewer than 11 views"
picture "$folder/images/after.png"

echo "== the live camera, YUYV and MJPEG"
# interrupt LOG COMMAND...: ends it as Ctrl-C on a terminal does, a while after its first result.
interrupt='
import os, signal, subprocess, sys, time
with open(sys.argv[1], "w") as log:
    process = subprocess.Popen(sys.argv[2:], stdout=log, stderr=log, start_new_session=True)
for _ in range(1200):
    if process.poll() is not None:
        sys.exit("it ended by itself")
    if "calib-result" in open(sys.argv[1], errors="replace").read():
        break
    time.sleep(0.1)
time.sleep(2)
os.killpg(process.pid, signal.SIGINT)
sys.exit(process.wait(60))'
for format in YUYV MJPG; do
  CALVIN_OUTPUT=$folder/$format CALVIN_V4L2_FORMATS=$format CALVIN_V4L2_FPS=60 LD_PRELOAD=$shim \
    /usr/bin/python3 -c "$interrupt" "$folder/log" "$source/examples/quickstart.sh" \
    --camera /dev/video0 || { cat "$folder/log"; fails "quickstart --camera with $format"; }
  tail -n 15 "$folder/log"
  grep -q "calib-result" "$folder/log" || fails "no result from $format"
  grep -q "^fx" "$folder/log" || fails "the result of $format is not shown"
  [ -s "$folder/$format/camera.json" ] || fails "no file from $format"
done

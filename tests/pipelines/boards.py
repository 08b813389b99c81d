#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
#
# A camera that does not exist is calibrated with a board of every kind, and is what it was within what
# the calibration says of itself: four sigmas, and twice what it promises where the board was. A light is
# found as well, but calibrates no single camera.
#   boards.py GST_LAUNCH
import json
import os
import subprocess
import sys
import tempfile

BOARDS = [
    "checkerboard:9x6:25mm",
    "checkerboard:10x7:24mm:circles",
    "puzzle:14x9:18mm",
    "puzzle:9x6:25mm:250,411",
    "charuco:8x6:32mm:24mm:DICT_5X5_250",
    "charuco:6x8:32mm:20mm:DICT_4X4_100:legacy",
    "charuco:7x5:40mm:30mm:DICT_6X6_250:inverted",
    "circles:9x7:25mm",
    "circles:8x6:30mm:inverted",
    "acircles:5x13:15mm",
    "dots:12x9:20mm:rings=2.2+9.2+2.6",
    "dots:9x9:22mm:big=0.0",
    "aprilgrid:5x4:40mm:0.3",
    "aprilgrid:4x4:50mm:0.25:tag25h9:border=1:first=3",
    "aruco:5x4:40mm:10mm:DICT_6X6_250",
    "aruco:4x4:40mm:20mm:DICT_4X4_50:first=9:inverted",
    "apriltag:tag36h11:5x4:40mm:12mm:border=2",
    "apriltag:tagStandard41h12:5x4:30mm:24mm:first=40",
    "apriltag:tagCustom48h12:60mm:0=0,0+3=190mm,-20mm,30+7/90mm=60mm,240mm,-75+12=280mm,180mm",
    "apriltag:tag36h11:60mm:0=0,0+3=150mm,-20mm,30+7/90mm=60mm,110mm,-75+12=170mm,90mm",
]


def run(launch, folder, board):
    """The calibration and the truth; None where this build does not know the board."""
    out, truth = os.path.join(folder, "camera.json"), os.path.join(folder, "truth.json")
    for path in (out, truth):
        if os.path.exists(path):
            os.remove(path)
    line = (
        f"calibtestsrc board={board} num-buffers=24 noise=2 blur=0.7 seed=5 ground-truth={truth} ! "
        f"video/x-raw,format=GRAY8,width=640,height=480 ! calibrate board={board} overlay=false "
        f"model=brown5 location={out} ! fakesink"
    )
    done = subprocess.run([launch, "-q"] + line.split(), capture_output=True, text=True, timeout=300)
    if "made without OpenCV" in done.stderr or "made without libapriltag" in done.stderr:
        return None
    if done.returncode != 0:
        sys.exit(f"{board}: {done.stderr}")
    return json.load(open(out)), json.load(open(truth))


def check(board, found, truth):
    if found["board"] != board:
        sys.exit(f"the file names {found['board']}, not {board}")
    for name in ("fx", "fy", "cx", "cy"):
        apart = found["parameters"][name] - truth["parameters"][name]
        if abs(apart) > 4 * found["sigma"][name]:
            sys.exit(f"{board}: {name} is {apart:.3f} px off, sigma {found['sigma'][name]:.3f}")
    used = [view for view in found["views"] if not view["held_out"]]
    if len(used) < 15:
        sys.exit(f"{board}: only {len(used)} views")
    if found["misfit"] != "none":
        sys.exit(f"{board}: misfit {found['misfit']}")
    print(f"{board}: rms {found['rms']:.4f}, expected error {found['expected_error']:.3f} px")


def check_light(launch):
    source = "calibtestsrc board=dot motion=hand lamps=4 num-buffers=30 ! video/x-raw,width=640,height=480 ! "
    line = source + "calibdetect board=dot post-messages=true ! caliboverlay ! fakesink"
    done = subprocess.run([launch, "-m"] + line.split(), capture_output=True, text=True, timeout=60)
    found = done.stdout.count("found=(boolean)true, points=(int)1, total=(int)1")
    if done.returncode != 0 or found < 25:
        sys.exit(f"dot: found in {found} of 30 frames. {done.stderr}")
    line = source + "calibrate board=dot location=never-written.json ! fakesink"
    done = subprocess.run([launch, "-q"] + line.split(), capture_output=True, text=True, timeout=60)
    if done.returncode == 0 or "a light calibrates several cameras together" not in done.stderr:
        sys.exit(f"dot: a single camera was calibrated, or not refused for what it is: {done.stderr}")
    if os.path.exists("never-written.json"):
        sys.exit("dot: a calibration was written")
    print(f"dot: found in {found} of 30 frames")


def check_light_journal(launch, folder):
    """Two runs with one journal: what was seen of the light in the later one is in it."""
    journal = os.path.join(folder, "light.jsonl")
    for seed in (1, 2):
        line = (
            f"calibtestsrc board=dot num-buffers=20 seed={seed} ! video/x-raw,width=640,height=480 ! "
            f"calibdetect board=dot camera=left ! calibsolve journal={journal} ! fakesink"
        )
        done = subprocess.run([launch] + line.split(), capture_output=True, text=True, timeout=60)
        if done.returncode != 0 or "in the journal" not in done.stdout + done.stderr:
            sys.exit(f"dot: nothing was said of the journal: {done.stdout} {done.stderr}")
    lines = [json.loads(text) for text in open(journal)]
    anew = [i for i, line in enumerate(lines) if "reset" in line]
    if lines[0]["board"] != "dot" or len(anew) != 1 or not 18 <= len(lines) - 1 - anew[0] <= 19:
        sys.exit(f"dot: the journal holds {len(lines)} lines of {lines[0]['board']}, anew from {anew}")
    for line in lines[anew[0] + 1 :]:
        if line["camera"] != "left" or len(line["points"]) != 1 or not 0 < line["points"][0][3] < 0.1:
            sys.exit(f"dot: the journal holds {line}")


check_light(sys.argv[1])
with tempfile.TemporaryDirectory() as folder:
    check_light_journal(sys.argv[1], folder)
    for board in BOARDS:
        result = run(sys.argv[1], folder, board)
        if result is None:
            print(f"{board}: this build does not know it")
            continue
        check(board, *result)

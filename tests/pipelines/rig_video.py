#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
# calvin-rig over videos as its users type it: recordings of a rendered rig, whose places are known.
#   rig_video.py CALVIN_RIG [opencv]    opencv: the program reads pictures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
READS_PICTURES = sys.argv[2:] == ["opencv"]
SECOND = 1_000_000_000  # ns
FRAMES = 180
# The right camera in the frame of the left one: a vector as of Rodrigues, rad, and m.
TURN = [0.02, -0.06, 0.01]
PLACE = [0.12, -0.005, 0.01]
failed = []


def run(*arguments, code=0, says=(), never=()):
    ran = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=150)
    out = ran.stdout + ran.stderr
    if code not in (None, ran.returncode) or any(w not in out for w in says) or any(w in out for w in never):
        failed.append(f"{arguments}: exit {ran.returncode}, not {code} with {says}:\n{out}")
    print(out)
    return out


def lens(name, cx):
    return {"format": "calvin-calibration", "version": 1, "camera": name, "image_size": [640, 480], "model": "brown4",
            "parameters": {"fx": 520, "fy": 518, "cx": cx, "cy": 241, "k1": -0.1, "k2": 0.02, "p1": 0, "p2": 0}}


def write_truth():
    """The rig, and the lens of each of its cameras."""
    places = {"left": ([0, 0, 0], [0, 0, 0]), "right": (TURN, PLACE)}
    cameras = []
    for name, (turn, place) in places.items():
        calibration = lens(name, 322 if name == "left" else 317)
        pathlib.Path(name + ".json").write_text(json.dumps(calibration))
        cameras.append({"camera": name, "calibration": calibration,
                        "rig_from_camera": {"rotation": turn, "translation": place}})
    rig = {"format": "calvin-rig", "version": 1, "world": "left", "cameras": cameras}
    pathlib.Path("truth.json").write_text(json.dumps(rig))


def finish(pipeline):
    pipeline.set_state(Gst.State.PLAYING)
    message = pipeline.get_bus().timed_pop_filtered(100 * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    if message is None or message.type == Gst.MessageType.ERROR:
        sys.exit(f"no recording: {message.parse_error() if message else 'too slow'}")
    pipeline.set_state(Gst.State.NULL)


def source(camera, rate, frames=FRAMES, motion="hand"):
    return (f"calibtestsrc name=source rig=truth.json camera={camera} motion={motion} noise=6 seed=3 num-buffers={frames} "
            f"! video/x-raw,format=GRAY8,width=640,height=480,framerate={rate}/1 ! identity name=taken")


def video(path, camera, rate=30, frames=FRAMES, skipped=0, every=1, first=None):
    """As that camera records it from a frame on: all, or every so many. The file's times begin at 0, or at `first` ns."""
    mux = "avimux" if path.endswith(".avi") else "matroskamux"
    code = "jpegenc quality=95 ! " if path.endswith(".avi") else ""
    pipeline = Gst.parse_launch(f"{source(camera, rate, frames)} ! {code}{mux} ! filesink location={path}")
    pad = pipeline.get_by_name("taken").get_static_pad("src")

    def choose(_, info):
        number = round(info.get_buffer().pts * rate / SECOND) - skipped
        return Gst.PadProbeReturn.OK if number >= 0 and number % every == 0 else Gst.PadProbeReturn.DROP

    pad.add_probe(Gst.PadProbeType.BUFFER, choose)
    begin = skipped * SECOND // rate
    pad.set_offset((first or 0) - begin)
    finish(pipeline)


def check_place(what, path="rig.json"):
    """Within 4.5 sigmas of the truth in every component, and of use at all."""
    rig = json.loads(pathlib.Path(path).read_text())
    camera = next(c for c in rig["cameras"] if c["camera"] == "right")
    got = camera["rig_from_camera"]["rotation"] + camera["rig_from_camera"]["translation"]
    sigmas = [camera["covariance"][i][i] ** 0.5 for i in range(6)]
    errors = [a - b for a, b in zip(got, TURN + PLACE)]
    print(what, "errors in sigmas:", [round(e / s, 2) for e, s in zip(errors, sigmas)], "sigmas:", sigmas)
    if any(abs(e) > 4.5 * s for e, s in zip(errors, sigmas)):
        failed.append(f"{what}: errors {errors} of sigmas {sigmas}")
    if max(sigmas[:3]) > 1e-3 or max(sigmas[3:]) > 1e-3:
        failed.append(f"{what}: nothing is known, sigmas {sigmas}")
    return camera


def rates_and_containers():
    video("left.avi", "left")
    video("right.mkv", "right", rate=25, frames=150)
    out = run("rig.json", "left.json", "left.avi", "right.json", "right.mkv",
              says=["left.avi: 180 frames of 6.0 s, boards in", "right.mkv: 150 frames of 6.0 s", "views count"])
    check_place("two rates")
    # A choice, and no frame after the other.
    counted = [int(line.split(" views count")[0].split()[-1]) for line in out.splitlines() if " views count" in line]
    if len(counted) != 2 or not all(8 <= n <= 120 for n in counted):
        failed.append(f"{counted} views count of 180 and 150 frames")
    before = pathlib.Path("rig.json").read_bytes()
    run("rig.json", "left.json", "left.avi", "right.json", "right.mkv")
    if pathlib.Path("rig.json").read_bytes() != before:
        failed.append("two runs differ")


def clocks():
    # Its frames are the odd ones of 60 in a second, and are said to be the even ones.
    video("late.mkv", "right", rate=60, frames=2 * FRAMES, skipped=1, every=2)
    run("rig.json", "left.json", "left.avi", "right.json", "late.mkv", "--tolerance", "20",
        says=["'right' were taken", "later than their"], never=["one pipeline"])
    offset = check_place("a clock that is off")["time_offset"]
    print("offset:", offset)
    if abs(offset["seconds"] - 1 / 60) > 4.5 * offset["sigma"] or offset["sigma"] > 1e-3:
        failed.append(f"the clock is off by 16.7 ms, not {offset}")
    video("later.mkv", "right", skipped=45)
    run("rig.json", "left.json", "left.avi", "right.json", "later.mkv", "--start", "right:1.5")
    check_place("a late start")
    # What one pipeline has recorded tells when it began.
    video("piped.mkv", "right", skipped=45, first=3 * SECOND // 2)
    run("rig.json", "left.json", "left.avi", "right.json", "piped.mkv", code=None, says=["give --start right:1.500"])
    run("rig.json", "left.json", "left.avi", "right.json", "later.mkv", "--start", "top:1.5", code=1, says=["'top'"])
    run("rig.json", "left.json", "left.avi", "right.json", "later.mkv", "--start", "right", code=2, says=["CAMERA:SECONDS"])
    # What a journal has seen goes with a video.
    finish(Gst.parse_launch(f"{source('right', 30)} ! calibdetect ! calibsolve journal=right.jsonl ! fakesink"))
    run("rig.json", "left.json", "left.avi", "right.json", "right.jsonl", says=["right.jsonl: "])
    check_place("a video and observations")


def bad_files():
    pathlib.Path("noise.mp4").write_bytes(bytes((i * i * 31 + i // 7) % 256 for i in range(100_000)))
    run("rig.json", "left.json", "left.avi", "right.json", "noise.mp4", code=1, says=["'noise.mp4' is no video"])
    pathlib.Path("text.mp4").write_text("this is a text\n")
    run("rig.json", "left.json", "left.avi", "right.json", "text.mp4", code=1, says=["text.mp4"])
    run("rig.json", "left.json", "left.avi", "right.json", "none.mp4", code=1, says=["none.mp4"])
    finish(Gst.parse_launch("audiotestsrc num-buffers=20 ! wavenc ! filesink location=sound.wav"))
    run("rig.json", "left.json", "left.avi", "right.json", "sound.wav", code=1, says=["'sound.wav' is no video"])
    finish(Gst.parse_launch(f"{source('right', 30, 1)} ! identity drop-probability=1 ! matroskamux ! filesink location=empty.mkv"))
    run("rig.json", "left.json", "left.avi", "right.json", "empty.mkv", code=1, says=["empty.mkv"])
    # Half of a file: what is there counts.
    whole = pathlib.Path("right.mkv").read_bytes()
    pathlib.Path("half.mkv").write_bytes(whole[:len(whole) // 2])
    out = run("rig.json", "left.json", "left.avi", "right.json", "half.mkv")
    check_place("half a file")
    if "half.mkv: 7" not in out:
        failed.append(f"half of 150 frames: {out}")
    run("rig.json", "left.json", "left.avi", "right.json", "right.mkv", "--board", "checkerboard:8x5:30mm", code=1,
        says=["'left.avi'", "boards in 0 of them", "no board"])


def still_board():
    """A board that lies still: videos, and pictures beside them."""
    finish(Gst.parse_launch(source("left", 30, 12, "static") + " ! jpegenc quality=95 ! avimux ! filesink location=still.avi"))
    run("--floor", "floor.json", "left.json", "still.avi", says=["mm of 'board'"])
    if not READS_PICTURES:
        return
    pathlib.Path("pictures").mkdir()
    finish(Gst.parse_launch(source("right", 30, 3, "static") + " ! pngenc ! multifilesink location=pictures/right%02d.png"))
    run("--floor", "floor.json", "left.json", "still.avi", "right.json", "pictures", says=["pictures: 3 views"])
    floor = json.loads(pathlib.Path("floor.json").read_text())["cameras"]
    apart = [b - a for a, b in zip(*(c["rig_from_camera"]["translation"] for c in floor))]
    distance = sum(d * d for d in apart) ** 0.5
    wanted = sum(d * d for d in PLACE) ** 0.5
    print("on the floor:", distance, "of", wanted)
    if abs(distance - wanted) > 0.003:
        failed.append(f"cameras over one board are {distance} m apart, not {wanted}")
    run("rig.json", "left.json", "left.avi", "right.json", "pictures", code=1, says=["'left.avi' is taken for a video", "--floor"])


Gst.init(None)
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    write_truth()
    rates_and_containers()
    clocks()
    bad_files()
    still_board()
    os.chdir("/")
for one in failed:
    print("FAIL:", one)
sys.exit(1 if failed else 0)

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
"""calvin-light over what BlueCCal is tested with: four cameras and a light (MultiCamSelfCal,
DATA20100906_134124). Argument: the program. Skipped without the folder of CALVIN_DATA."""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SET = "mcsc-strawlab-DATA20100906_134124"
NTH_FRAME = 2  # as the configuration of the published numbers says
PUBLISHED = 0.62  # px, mean error
PUBLISHED_PLACES = 522

failed = []


def check(name, value, most):
    print(f"{name}: {value:.4g}, at most {most}")
    if not value <= most:
        failed.append(name)


# The program over the folder as it is but for the instants that are left out.
def calibrated(light, data, folder, is_taken):
    folder.mkdir()
    for name in ("points.dat", "Res.dat"):
        (folder / name).write_text((data / name).read_text())
    rows = [line.split() for line in (data / "IdMat.dat").read_text().splitlines()]
    kept = [[seen if is_taken(i) else "0" for i, seen in enumerate(row)] for row in rows]
    (folder / "IdMat.dat").write_text("".join(" ".join(row) + "\n" for row in kept))
    result = folder / "rig.json"
    out = subprocess.run([light, result, folder], capture_output=True, text=True, timeout=100)
    if out.returncode != 0:
        sys.exit(f"calvin-light failed: {out.stdout}{out.stderr}")
    return json.loads(result.read_text())["cameras"], out.stdout


# Of all cameras: how far they move, of the largest distance, and their focal lengths, in sigmas.
def moved(cameras, others):
    place = focal = 0
    for a, b in zip(cameras, others):
        place = max(place, math.dist(*(c["rig_from_camera"]["translation"] for c in (a, b))))
        f, g = (c["calibration"]["parameters"]["fx"] for c in (a, b))
        focal = max(focal, abs(f - g) / a["calibration"]["sigma"]["fx"])
    return place, focal


def main():
    light = sys.argv[1]
    data = pathlib.Path(os.environ.get("CALVIN_DATA", "")) / SET
    if not (data / "points.dat").exists():
        print(f"CALVIN_DATA does not name a folder with {SET}: skipped.")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        cameras, out = calibrated(light, data, folder / "whole", lambda i: i % NTH_FRAME == 0)
        places, error = re.search(r"(\d+) of \d+ places of the light, mean error ([\d.]+) px", out).groups()
        check("mean error, px", float(error), PUBLISHED)
        check("places that are missing", PUBLISHED_PLACES - int(places), 0)
        check("cameras that are missing", 4 - len(cameras), 0)
        for tenth in range(10):
            some, _ = calibrated(light, data, folder / f"but{tenth}",
                                 lambda i: i % NTH_FRAME == 0 and i // NTH_FRAME % 10 != tenth)
            place, focal = moved(cameras, some)
            check(f"without tenth {tenth}, places", place, 0.015)
            check(f"without tenth {tenth}, focal lengths in sigmas", focal, 1)
    if failed:
        sys.exit("failed: " + "; ".join(failed))


main()

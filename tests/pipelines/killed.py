#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Runs are killed at random moments: the next one has every view that was announced, and whoever
# reads the calibration meanwhile finds a whole one.
#   killed.py GST_LAUNCH
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import threading
import time

LAUNCH = sys.argv[1]
KILLS = 100 if "CALVIN_FULL" in os.environ else 10
KILLS_OF_ONE_JOURNAL = 10
LINE = (
    "calibtestsrc is-live=true seed={seed} ! calibrate capture-mode=all overlay=false journal={journal}"
    " location={location} ! fakesink"
)
ACCEPTED = re.compile(r"calib-view,.*accepted=\(boolean\)true.*views=\(int\)(\d+)")
PROGRESS = re.compile(r"calib-progress,.*views=\(int\)(\d+)")


def views_in(journal):
    views = 0
    content = journal.read_bytes() if journal.exists() else b""
    for line in content.split(b"\n")[:-1]:  # what follows the last end is torn
        views += "points" in json.loads(line)
    return views


class Reader(threading.Thread):
    """Reads the calibration again and again."""

    def __init__(self, location):
        super().__init__()
        self.location = location
        self.reads = 0
        self.broken = []
        self.over = threading.Event()

    def run(self):
        while not self.over.is_set():
            if self.location.exists():
                text = self.location.read_text()
                try:
                    json.loads(text)
                    self.reads += 1
                except ValueError:
                    self.broken.append(text)
            time.sleep(0.0005)


def run(line, patience):
    """The first progress and the newest number of views of a run that is killed after that long."""
    program = subprocess.Popen(
        [LAUNCH, "-m"] + line.split(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    killer = threading.Timer(patience, program.kill)
    killer.start()
    first = last = None
    output = []
    for text in program.stdout:
        output.append(text)
        progress = PROGRESS.search(text)
        if progress and first is None:
            first = int(progress[1])
        accepted = ACCEPTED.search(text)
        if accepted:
            last = int(accepted[1])
    killer.cancel()
    if program.wait() != -9:
        sys.exit("it ended by itself:\n" + "".join(output))
    return first, last


def main():
    random.seed(int.from_bytes(os.urandom(4), "little"))
    announced = lost = resumed = reads = 0
    with tempfile.TemporaryDirectory() as folder:
        for kill in range(KILLS):
            journal = pathlib.Path(folder) / f"{kill // KILLS_OF_ONE_JOURNAL}.jsonl"
            location = pathlib.Path(folder) / f"{kill // KILLS_OF_ONE_JOURNAL}.json"
            before = views_in(journal)
            reader = Reader(location)
            reader.start()
            first, last = run(
                LINE.format(seed=kill, journal=journal, location=location),
                0.3 + 1.2 * random.random(),
            )
            reader.over.set()
            reader.join()
            reads += reader.reads
            if reader.broken:
                sys.exit("half a calibration was read: " + reader.broken[0][:200])
            # A run that was killed before it could say anything says nothing.
            if before and first is not None:
                resumed += 1
                if first != before:
                    sys.exit(f"kill {kill}: {first} of {before} views were taken up again")
            after = views_in(journal)
            announced += max(0, (last or before) - before)
            lost += max(0, (last or 0) - after)
    print(
        f"{KILLS} kills: {announced} views were announced and {lost} of them lost, "
        f"{resumed} runs went on, {reads} reads of a calibration"
    )
    if lost or announced < KILLS or resumed < KILLS // 5 or reads == 0:
        sys.exit("views are lost, or nothing was tried")


main()

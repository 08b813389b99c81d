#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Calibrates a camera that does not exist and reads what the elements say.

Reads the observation meta of every buffer in a pad probe and the result message from the bus.
Needs the Debian package python3-gst-1.0.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402


def read_corners(pad, info):
    """Prints the corners that calibdetect attached to the buffer."""
    meta = info.get_buffer().get_custom_meta("calvin-observation")
    if meta is not None:
        for board in meta.get_structure()["observations"]:
            if board["found"]:
                ids, uv = board["ids"], board["uv"]  # uv: u0, v0, u1, v1, ...
                print(f"{board['board']}: {len(ids)} corners, "
                      f"corner {ids[0]} at {uv[0]:.2f}, {uv[1]:.2f}")
    return Gst.PadProbeReturn.OK


def main():
    Gst.init(None)
    pipeline = Gst.parse_launch(
        "calibtestsrc num-buffers=20 ! calibrate name=calibrate ! fakesink name=sink")
    sink = pipeline.get_by_name("sink").get_static_pad("sink")
    sink.add_probe(Gst.PadProbeType.BUFFER, read_corners)
    pipeline.set_state(Gst.State.PLAYING)
    solved = False
    while True:
        message = pipeline.get_bus().timed_pop(Gst.CLOCK_TIME_NONE)
        result = message.get_structure()
        if message.type == Gst.MessageType.EOS:
            break
        if message.type == Gst.MessageType.ERROR:
            print(message.parse_error()[0].message, file=sys.stderr)
            break
        if message.has_name("calib-result") and result["state"] == "final":
            print(f"fx {result['fx']:.2f} px, sigma {result['sigma']['fx']:.2f}, "
                  f"rms {result['rms']:.3f} px from {result['views']} views")
            solved = True
    pipeline.set_state(Gst.State.NULL)
    return 0 if solved else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Calibrates a camera that does not exist and reads what the elements say.

Reads the observation meta of every buffer in a pad probe and the result message from the bus.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import Gst  # noqa: E402


def read_corners(pad, info):
    """Prints the corners that calibdetect attached to the buffer."""
    meta = info.get_buffer().get_custom_meta("calvin-observation")
    if meta is None:
        return Gst.PadProbeReturn.OK
    structure = meta.get_structure()
    for board in array(structure, "observations"):
        ids = array(board, "ids")
        uv = array(board, "uv")
        if ids:
            print(f"{board.get_string('board')}: {len(ids)} corners, "
                  f"corner {ids[0]} at {uv[0]:.2f}, {uv[1]:.2f}")
    return Gst.PadProbeReturn.OK


def array(structure, field):
    """The elements of a GST_TYPE_ARRAY field."""
    ok, values = structure.get_array(field)
    return [values.get_nth(i) for i in range(values.n_values)] if ok else []


def main():
    Gst.init(None)
    pipeline = Gst.parse_launch(
        "calibtestsrc num-buffers=20 ! calibrate name=calibrate ! fakesink name=sink")
    pipeline.get_by_name("sink").get_static_pad("sink").add_probe(
        Gst.PadProbeType.BUFFER, read_corners)
    pipeline.set_state(Gst.State.PLAYING)
    bus = pipeline.get_bus()
    failed = True
    while True:
        message = bus.timed_pop(Gst.CLOCK_TIME_NONE)
        structure = message.get_structure()
        if message.type == Gst.MessageType.EOS:
            break
        if message.type == Gst.MessageType.ERROR:
            print(message.parse_error().gerror.message, file=sys.stderr)
            break
        if structure is not None and structure.get_name() == "calib-result":
            if structure.get_string("state") == "final":
                fx = structure.get_double("fx").value
                rms = structure.get_double("rms").value
                print(f"fx {fx:.2f} px, rms {rms:.3f} px")
                failed = False
    pipeline.set_state(Gst.State.NULL)
    return failed


if __name__ == "__main__":
    sys.exit(main())

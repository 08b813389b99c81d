#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A network camera that does not exist: a board as JPEG over RTSP at rtsp://127.0.0.1:PORT/camera.

    rtsp_server.py [PORT]

Prints a line when it is ready and serves until it is killed.
"""

import sys

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402


def main():
    Gst.init(None)
    server = GstRtspServer.RTSPServer()
    server.set_address("127.0.0.1")
    server.set_service(sys.argv[1] if len(sys.argv) > 1 else "8554")
    factory = GstRtspServer.RTSPMediaFactory()
    factory.set_launch("( calibtestsrc is-live=true ! video/x-raw,format=I420,framerate=15/1 ! "
                       "jpegenc ! rtpjpegpay name=pay0 )")
    server.get_mount_points().add_factory("/camera", factory)
    server.attach(None)
    print("ready", flush=True)
    GLib.MainLoop().run()


if __name__ == "__main__":
    main()

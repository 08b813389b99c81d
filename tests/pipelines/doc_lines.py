#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the shell lines of a documentation page as typed.

    doc_lines.py PAGE SOURCE_DIR BUILD_DIR [SHIM]

Every line of every ```sh block is run in one fresh folder, in order, with the plugin and the tools of
the build in the path and an emulated camera at /dev/video0, without which lines with a camera are left
out; for lines with rtspsrc there is a server on this machine. A live pipeline is ended as a user would,
by Ctrl-C. A block behind the line `<!-- elsewhere: WHERE -->` is run by the named test instead.
`<!-- stand-in: aravissrc = ELEMENT ... -->` names what takes the place of a source, with its properties,
that needs a device.
"""

import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

SECONDS_LIVE = 8
SECONDS_MOST = 120


def blocks(page):
    """The shell blocks of a page that are to be run here."""
    pattern = r"(<!-- elsewhere: [^>]*-->\n)?```sh\n(.*?)```"
    for elsewhere, text in re.findall(pattern, page.read_text(), re.S):
        if not elsewhere:
            yield text.replace("\\\n", " ")


def stand_ins(page):
    """What to run instead of sources that need a device: name -> element with properties."""
    return dict(re.findall(r"<!-- stand-in: (\w+) = (.*?) -->", page.read_text()))


def is_live(line):
    live = re.search(r"v4l2src|rtspsrc|is-live=true", line)
    return live is not None and "num-buffers" not in line


def serve_rtsp(source):
    """A network camera; ready when this returns."""
    server = subprocess.Popen([sys.executable, source / "tests/pipelines/rtsp_server.py"],
                              stdout=subprocess.PIPE, text=True)
    if server.stdout.readline().strip() != "ready":
        raise SystemExit("no RTSP server: is gir1.2-gst-rtsp-server-1.0 installed?")
    return server


def run(line, env, folder):
    """Runs one line; its exit status and what it printed."""
    process = subprocess.Popen(["sh", "-c", "exec " + line if is_live(line) else line], env=env,
                               cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, start_new_session=True)
    try:
        output, _ = process.communicate(timeout=SECONDS_LIVE if is_live(line) else SECONDS_MOST)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGINT if is_live(line) else signal.SIGKILL)
        output, _ = process.communicate(timeout=60)
        if not is_live(line):
            return "too slow", output
    # gst-launch ends by an interrupt as by a signal, or with 0.
    good = process.returncode == 0 or (is_live(line) and process.returncode == -signal.SIGINT)
    return 0 if good or hung_up(output) else process.returncode, output


def hung_up(output):
    """Whether all went well until the end, when a network camera hung up before it was told to."""
    before, interrupted, after = output.partition("handling interrupt")
    errors = re.findall(r"^ERROR: from element (\S+)", after, re.MULTILINE)
    return (interrupted != "" and "ERROR" not in before and errors != [] and
            all("GstRTSPSrc" in element for element in errors))


def lines_of(page):
    """The lines to run: as typed, and with what stands in for missing devices."""
    places = stand_ins(page)
    for text in blocks(page):
        for line in text.splitlines():
            line = line.strip()
            if line and not line.startswith("#"):
                typed = line
                for name, instead in places.items():
                    line = re.sub(rf"\b{name}\b[^!]*", instead + " ", line)
                yield typed, line


def main():
    page, source, build = map(pathlib.Path, sys.argv[1:4])
    shim = sys.argv[4] if len(sys.argv) > 4 else None
    failed = 0
    count = 0
    server = serve_rtsp(source) if "rtspsrc" in page.read_text() else None
    with tempfile.TemporaryDirectory() as folder:
        for name in ("examples", "tests", "docs"):
            os.symlink(source / name, pathlib.Path(folder) / name)
        os.symlink(build, pathlib.Path(folder) / "build")
        for typed, line in lines_of(page):
            if "v4l2src" in line and not shim:
                continue
            count += 1
            env = dict(os.environ)
            env["PATH"] = f"{build / 'examples'}:{env['PATH']}"
            if "v4l2src" in line:
                env["LD_PRELOAD"] = shim
                # Whoever looks for a board holds it before the camera.
                board = re.search(r"\bboard=(\S+)", line)
                if board:
                    env["CALVIN_V4L2_BOARD"] = board.group(1).strip("'")
            status, output = run(line, env, folder)
            for file in re.findall(r"(?:[ :]location|ground-truth)=(\S+\.json)", line):
                if not (pathlib.Path(folder) / file).is_file():
                    status, output = "no " + file, output
            print(f"[{status}] {typed}")
            if status != 0:
                failed += 1
                print(output)
    if server:
        server.kill()
    print(f"{page.name}: {count} lines run, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

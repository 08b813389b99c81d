#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs the shell lines of a documentation page as typed.

    doc_lines.py PAGE SOURCE_DIR BUILD_DIR SHIM

Every line of every ```sh block is run in one fresh folder, in order, with the plugin in the path
and an emulated camera at /dev/video0. A live pipeline is ended as a user would, by Ctrl-C. A block
behind the line `<!-- elsewhere: WHERE -->` is run by the named test instead.
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


def is_live(line):
    return "v4l2src" in line and "num-buffers" not in line


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
    return 0 if good else process.returncode, output


def main():
    page, source, build, shim = map(pathlib.Path, sys.argv[1:5])
    failed = 0
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        for name in ("examples", "tests", "docs"):
            os.symlink(source / name, pathlib.Path(folder) / name)
        os.symlink(build, pathlib.Path(folder) / "build")
        for text in blocks(page):
            for line in text.splitlines():
                line = line.strip()
                if not line or line.startswith("#"):
                    continue
                count += 1
                env = dict(os.environ)
                if "v4l2src" in line:
                    env["LD_PRELOAD"] = str(shim)
                status, output = run(line, env, folder)
                for file in re.findall(r"(?:location|ground-truth)=(\S+\.json)", line):
                    if not (pathlib.Path(folder) / file).is_file():
                        status, output = "no " + file, output
                print(f"[{status}] {line}")
                if status != 0:
                    failed += 1
                    print(output)
    print(f"{page.name}: {count} lines run, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

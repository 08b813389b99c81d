#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Whether the page of the manual of each tool has what --help of it has: every option, every setting of a
# text ("big=0.0", of which the page may have another value), and every name of a list "one of a, b, c;" or
# of columns that rows hold.
#   man_pages.py MAN PROGRAM...
import pathlib
import re
import subprocess
import sys

faults = []


def shown_by(program):
    run = subprocess.run([program, "--help"], capture_output=True, text=True, timeout=60)
    return run.stdout + run.stderr


def text_of(page):
    """What a reader sees, without requests but for the words after them."""
    lines = [line for line in page.read_text().splitlines() if not line.startswith('.\\"')]
    return re.sub(r"\\f.", "", "\n".join(lines)).replace("\\-", "-")


def expected(help_text):
    """Pairs of what is looked for and how it is shown."""
    for option in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", help_text):
        if not option.startswith("--help"):
            yield re.escape(option) + r"(?![a-z0-9-])", option
    for name in re.findall(r"(?<![\w-])([a-z]\w*)=[\w.+]", help_text):
        yield rf"\b{name}=", f"{name}="
    lists = re.findall(r"\bone of ([a-z][\w-]*(?:,\s+[a-z][\w-]*)+);", help_text)
    for names in lists + re.findall(r"\brows hold: ([\w ]+),", help_text):
        for name in re.split(r",?\s+", names):
            yield rf"(?<![\w-]){re.escape(name)}(?![\w-])", name


def main():
    folder = pathlib.Path(sys.argv[1])
    looked_for = 0
    for program in sys.argv[2:]:
        page = folder / (pathlib.Path(program).name + ".1")
        text = text_of(page)
        wanted = dict(expected(shown_by(program)))
        looked_for += len(wanted)
        faults.extend(
            f"{page.name} lacks {shown}, which --help has"
            for pattern, shown in sorted(wanted.items())
            if not re.search(pattern, text)
        )
    if looked_for < 50:
        faults.append(f"--help of all tools shows {looked_for} options only")
    print("\n".join(faults) or f"{looked_for} options and names, as --help has them.")
    return 1 if faults else 0


sys.exit(main())

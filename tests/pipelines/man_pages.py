#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Whether the page of the manual of each tool has what --help of it has: every option, every setting of a
# text ("big=0.0", of which the page may have another value), and every name of a list "one of a, b, c;" or
# of columns that rows hold. And whether all tools answer alike what any tool is asked.
#   man_pages.py MAN PROGRAM...
import pathlib
import re
import subprocess
import sys

faults = []


def shown_by(program):
    run = subprocess.run([program, "--help"], capture_output=True, text=True, timeout=60)
    return run.stdout + run.stderr


def answers(program):
    """What is wrong with the answers to -h, --version and an option that no tool has."""
    name = pathlib.Path(program).name

    def run(word):
        return subprocess.run([program, word], capture_output=True, text=True, timeout=60)

    short = run("-h")
    if short.returncode != 0 or short.stdout + short.stderr != shown_by(program):
        yield f"{name} -h is not {name} --help"
    version = run("--version")
    if version.returncode != 0 or not re.fullmatch(rf"{name} \d+\.\d+\.\d+\n", version.stdout):
        yield f"{name} --version says {version.stdout!r}"
    wrong = run("-x")
    if wrong.returncode != 2 or "'-x'" not in wrong.stderr:
        yield f"{name} -x ends with {wrong.returncode}: {wrong.stderr!r}"


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
        faults.extend(answers(program))
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

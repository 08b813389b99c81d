#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Whether docs/library.md names what is installed: every header, and every name that the shared library
# exports, no more and no fewer; and whether the list of symbols of the Debian package does so.
#   public_names.py LIBRARY.md INCLUDE [LIBCALVIN.so DEBIAN.symbols]
import pathlib
import re
import subprocess
import sys

MOST_HEADERS = 28
MOST_SYMBOLS = 200

page = pathlib.Path(sys.argv[1]).read_text()
faults = []


def rows(heading):
    """The cells of the table below a heading, without its first two lines."""
    section = page.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def compare(what, found, documented, where=sys.argv[1]):
    faults.extend(f"{what} {name} is not in {where}" for name in sorted(found - documented))
    faults.extend(f"{where}: there is no {what} {name}" for name in sorted(documented - found))


def installed_headers():
    include = pathlib.Path(sys.argv[2])
    return {p.relative_to(include).as_posix() for p in include.rglob("*") if p.is_file()}


def exported(library):
    """Lines of nm: the qualified name with its arguments."""
    options = ["-D", "-C", "--defined-only", "--without-symbol-versions"]
    lines = subprocess.run(["nm", *options, library], capture_output=True, text=True, check=True)
    fields = [line.split(" ", 2) for line in lines.stdout.splitlines()]
    return [field[2] for field in fields if field[1] != "A"]  # but for the names of versions


def documented_names():
    for _, of, names in rows("The names"):
        for name in re.findall(r"`([^`]+)`", names):
            yield f"calvin::{of.strip('`')}::{name}" if of else f"calvin::{name}"


headers = installed_headers()
compare("header", headers, {cells[0].strip("`") for cells in rows("Headers")})
if len(headers) > MOST_HEADERS:
    faults.append(f"{len(headers)} headers are installed, more than {MOST_HEADERS}")
if len(sys.argv) > 3:
    symbols = exported(sys.argv[3])
    names = {re.sub(r"\[abi:\w+\]", "", symbol.split("(")[0]) for symbol in symbols}
    compare("name", names, set(documented_names()))
    packaged = pathlib.Path(sys.argv[4]).read_text()
    compare("symbol", set(symbols), set(re.findall(r'"(.*)@CALVIN_0"', packaged)), sys.argv[4])
    if len(symbols) > MOST_SYMBOLS:
        faults.append(f"{len(symbols)} symbols are exported, more than {MOST_SYMBOLS}")
print("\n".join(faults) or f"{len(headers)} headers, as documented.")
sys.exit(1 if faults else 0)

#!/usr/bin/python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Compares the property table of each page in docs/elements with the introspected element.

Where a blurb lists all camera models, the page points to the table that describes them; a model that
is missing there is one that the page does not have.

    element_docs.py DOCS_DIR            compares every page
    element_docs.py --print ELEMENT     prints the table as it should be
    element_docs.py --write DOCS_DIR    writes the tables into the pages, where they stand now
"""

import pathlib
import re
import sys

import gi

gi.require_version("Gst", "1.0")
from gi.repository import GObject, Gst  # noqa: E402

from enum_values import enum_values  # noqa: E402

HEAD = "| property | type | default | changes | what it does |"
MUTABLE = {
    1 << (GObject.PARAM_USER_SHIFT + 2): "READY",
    1 << (GObject.PARAM_USER_SHIFT + 3): "PAUSED",
    1 << (GObject.PARAM_USER_SHIFT + 4): "PLAYING",
}
CONTROLLABLE = 1 << (GObject.PARAM_USER_SHIFT + 1)
CONVENTIONS = pathlib.Path(__file__).parents[2] / "docs" / "conventions.md"


def type_and_default(spec):
    """The type of a property as a reader knows it, and its default."""
    kind = spec.__gtype__.name
    if kind == "GParamBoxed":
        return "structure", ""
    default = spec.default_value
    if kind == "GParamEnum":
        values = enum_values(spec)
        return " ".join(v.value_nick for v in values.values()), values[int(default)].value_nick
    if kind == "GParamBoolean":
        return "boolean", "true" if default else "false"
    if kind == "GParamString":
        return "string", default or ""
    name = spec.value_type.name.removeprefix("g")
    return f"{name} {spec.minimum:.10g}..{spec.maximum:.10g}", f"{default:.10g}"


def camera_models():
    """The names in the table of camera models."""
    section = CONVENTIONS.read_text().split("\n## Camera models\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE)


def described(blurb):
    """A blurb as the page has it."""
    models = ", ".join(camera_models())
    return blurb.replace(models, "one of the [models](../conventions.md#camera-models)")


def row(spec):
    """One row of the table."""
    kind, default = type_and_default(spec)
    if spec.flags & GObject.ParamFlags.WRITABLE:
        changes = next((s for bit, s in MUTABLE.items() if spec.flags & bit), "any time")
        if spec.flags & CONTROLLABLE:
            changes += ", controllable"
    else:
        changes = "read only"
    default = f"`{default}`" if default else ""
    blurb = described(spec.blurb).replace("|", "\\|")
    return f"| `{spec.name}` | {kind} | {default} | {changes} | {blurb} |"


def table(name):
    """The rows for the properties that the element itself has."""
    element = Gst.ElementFactory.make(name)
    if element is None:
        sys.exit(f"there is no element '{name}'")
    specs = [s for s in element.list_properties() if s.owner_type == element.__gtype__]
    return [HEAD, "|---|---|---|---|---|"] + [row(s) for s in specs]


def split(page):
    """The lines of a page before its table, the table, and the lines behind it."""
    lines = page.read_text().splitlines()
    first = lines.index(HEAD) if HEAD in lines else len(lines)
    rest = lines[first:]
    count = next((n for n, line in enumerate(rest) if not line.startswith("|")), len(rest))
    return lines[:first], rest[:count], rest[count:]


def write(page):
    """Puts the table of the element in the place of the one that the page has."""
    before, old, behind = split(page)
    if old:
        page.write_text("\n".join(before + table(page.stem) + behind) + "\n")


def compare(page):
    """Prints what differs between a page and its element; whether nothing does."""
    expected = table(page.stem)
    _, found, _ = split(page)
    for line in expected:
        if line not in found:
            print(f"{page.name}: missing: {line}")
    for line in found:
        if line not in expected:
            print(f"{page.name}: wrong: {line}")
    return found == expected


def main():
    Gst.init(None)
    if len(sys.argv) == 3 and sys.argv[1] == "--print":
        print("\n".join(table(sys.argv[2])))
        return 0
    pages = sorted(pathlib.Path(sys.argv[-1]).glob("*.md"))
    if sys.argv[1] == "--write":
        for page in pages:
            write(page)
        return 0
    features = Gst.Registry.get().get_feature_list_by_plugin("calvin")
    missing = {f.get_name() for f in features} - {p.stem for p in pages}
    for name in sorted(missing):
        print(f"no page for {name}")
    return 0 if not missing and pages and all([compare(p) for p in pages]) else 1


if __name__ == "__main__":
    sys.exit(main())

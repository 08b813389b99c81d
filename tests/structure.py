#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Whether the tree is what docs/conventions.md says, as far as a script can see it:
#   - a room of lib/calvin includes only rooms above it in lib/meson.build; inside a room a file
#     includes only its own folder and those that come before it in the room's meson.build; the files
#     at the top of a room that come last there are its face, which no file inside includes;
#   - in gst/ every folder includes only itself and those of common/, and elements.hpp;
#   - in solve/ one file alone knows at which place an unknown stands, and everybody asks it;
#   - no folder holds more than 25 .cpp and .hpp files (io/ has one for each format);
#   - every .cpp opens with a comment that says what it is for;
#   - no file but target/grid.hpp counts the ids of control points in rows;
#   - files of the library that --unity=on may join have no name of their own in common: joined are
#     eight in a row, and which ones changes with every file that is added or left out;
#   - no file but camera/image_transform.hpp knows where the centre of a pixel is in a picture of
#     another size.
#   structure.py [FOLDER]    the top of the tree
import collections
import pathlib
import re
import sys

MOST_FILES = 25
NEIGHBOURS = 12  # files that may be joined, with some between them left out
UNLIMITED = {"lib/calvin/io"}  # a file for each format

# The one file that knows the order of the unknowns, and what others look like that count for
# themselves: 4 + coefficients, head(4), shared[0].
ORDER = "lib/calvin/solve/parameters/parameter_order.hpp"
COUNTED = re.compile(
    r"\b4 \+|[])\w] [+-] 4\b(?!\.)|\bi < 4\b"
    r"|\.(head|tail|topRows|leftCols|segment|middleRows)(<\d>)?\(4"
    r"|\b(shared|parameters)(\(\))?\[\d|\bc\(\d"
)

top = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else __file__).resolve()
if top.is_file():
    top = top.parent.parent
faults = []


def sources(folder):
    found = (p for p in (top / folder).rglob("*") if p.suffix in (".cpp", ".hpp"))
    return sorted(p for p in found if "pch" not in p.parts)


def included(path):
    return re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE)


def folder_of(name):
    return name.rpartition("/")[0]


class Room:
    """The folders of a room, in the order in which its meson.build names their files."""

    def __init__(self, name):
        self.name = name
        text = (top / "lib/calvin" / name / "meson.build").read_text()
        # A folder without a .cpp is named by a comment: "# kernels/common/: headers alone".
        found = re.findall(r"'([\w/-]+\.cpp)'|# ([\w/-]+/):", text)
        self.named = [source or folder for source, folder in found]
        self.folders = list(dict.fromkeys(folder_of(n) for n in self.named if folder_of(n)))

    def rank(self, name):
        """Of a file, by its name inside the room: what it includes must have no higher one."""
        folder = folder_of(name)
        if folder:
            if folder not in self.folders:
                faults.append(f"lib/calvin/{self.name}: meson.build names no file of {folder}/")
                self.folders.append(folder)
            return 1 + self.folders.index(folder)
        source = pathlib.PurePath(name).with_suffix(".cpp").name
        if source not in self.named:
            return 0  # plain types
        behind = self.named[: self.named.index(source)]
        return len(self.folders) + 1 if any(folder_of(f) for f in behind) else 0


def check_library():
    rooms = re.findall(r"subdir\('calvin/(\w+)'\)", (top / "lib/meson.build").read_text())
    known = {name: Room(name) for name in rooms}
    for path in sources("lib/calvin"):
        if path.parent.name == "calvin":
            continue  # the face of all rooms
        room, name = path.relative_to(top / "lib/calvin").as_posix().split("/", 1)
        for header in included(path):
            if not header.startswith("calvin/"):
                continue
            other, _, inside = header[len("calvin/") :].partition("/")
            if not inside:
                faults.append(f"lib/calvin/{room}/{name} includes {header}, the face of all rooms")
                continue
            where = f"lib/calvin/{room}/{name} includes {header}"
            if rooms.index(other) > rooms.index(room):
                faults.append(f"{where}, of a room below it")
            if other == room and known[room].rank(inside) > known[room].rank(name):
                faults.append(f"{where}, which comes after it")


def check_plugin():
    for path in sources("gst"):
        name = path.relative_to(top / "gst").as_posix()
        for header in included(path):
            if not (top / "gst" / header).is_file():
                continue
            allowed = [folder_of(name), "common"]
            if folder_of(name) != "common":
                allowed += ["common/frames", "common/points"]
            if folder_of(header) not in allowed and header != "elements.hpp":
                faults.append(f"gst/{name} includes {header}, of another element")


def check_order():
    if not (top / ORDER).is_file():
        faults.append(f"{ORDER} is missing")
    for path in sources("lib/calvin/solve"):
        name = path.relative_to(top).as_posix()
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if name != ORDER and COUNTED.search(line.split("//")[0]):
                faults.append(f"{name}:{number} counts unknowns by itself: ask {ORDER}")


def check_sizes():
    files = [p.parent for folder in ("lib", "gst") for p in sources(folder)]
    for folder, count in collections.Counter(files).items():
        name = folder.relative_to(top).as_posix()
        if count > MOST_FILES and name not in UNLIMITED:
            faults.append(f"{name} holds {count} files, more than {MOST_FILES}")


def own_names(text):
    """Of what the anonymous namespaces of a file define; functions with their types."""
    names = set()
    for body in re.findall(r"^namespace \{\n(.*?)^\}  // namespace$", text, re.S | re.M):
        names.update(re.findall(r"^(?:constexpr|const) [^\n=({;]*?\b(\w+) ?(?:=|\{|\[|;)", body, re.M))
        names.update(re.findall(r"^(?:struct|class|enum class|enum) (\w+)", body, re.M))
        names.update(re.findall(r"^using (\w+) =", body, re.M))
        function = r"^[A-Za-z][\w:<>,&*\s]*?[\s&*](\w+)(\((?:[^()]|\([^()]*\))*\))(?: const)?(?: noexcept)? \{"
        for name, given in re.findall(function, body, re.M):
            types = re.sub(r"\b\w+(?=[,)])", "", re.sub(r"/\*.*?\*/", "", given))
            names.add(name + re.sub(r"\s+", "", types))
    return names


def names_in_functions(text):
    """Of constants, for which a compiler warns that they hide those of a file joined to theirs."""
    return set(re.findall(r"^ +constexpr [^\n=({;]*?\b(\w+) ?(?:=|\{|\[)", text, re.M))


def check_joined():
    rooms = re.findall(r"subdir\('calvin/(\w+)'\)", (top / "lib/meson.build").read_text())
    joined = []
    for room in rooms:
        text = (top / "lib/calvin" / room / "meson.build").read_text()
        lists = {"sources": [], "kernels": []}
        for kind, files in re.findall(r"calvin_(\w+) \+= files\((.*?)\)", text, re.S):
            lists[kind] += re.findall(r"'([\w/-]+\.cpp)'", files)
        joined += [f"lib/calvin/{room}/{f}" for f in lists["sources"] if f not in lists["kernels"]]
    read = []
    for name in joined:
        text = (top / name).read_text()
        inside = set(re.findall(r"^namespace ([\w:]+) \{$", text, re.M))
        own, hiding = own_names(text), names_in_functions(text)
        for other, its_inside, its_own in read[1 - NEIGHBOURS :]:
            clashes = own & its_own if inside & its_inside else set()
            if any(a == b or a.startswith(b + "::") for a in inside for b in its_inside):
                clashes |= hiding & its_own
            for one in sorted(clashes):
                faults.append(f"{other} and {name} each have a {one} of their own: name them apart")
        read.append((name, inside, own))


def check_purpose():
    for folder in ("lib", "gst", "tests", "examples"):
        for path in sources(folder):
            lines = path.read_text().splitlines()
            said = [line for line in lines if line and not line.startswith("// SPDX-")]
            if path.suffix == ".cpp" and not (said and said[0].startswith(("//", "/*"))):
                faults.append(f"{path.relative_to(top)} does not open with what it is for")


def check_grids():
    """The id of a control point is row * cols + col: counted in target/grid.hpp."""
    formula = re.compile(r"% *(?:\w+(?:\.|->))*cols_?\b|\* *(?:\w+(?:\.|->))*cols_? *\+")
    for path in sources("lib") + sources("gst"):
        code = re.sub(r"//.*|/\*.*?\*/", "", path.read_text())
        if path != top / "lib/calvin/target/grid.hpp" and formula.search(code):
            faults.append(f"{path.relative_to(top)} counts ids by itself: target/grid.hpp")


def check_pixel_centres():
    """s (c + 0.5) - 0.5 and its kind: a product less half a pixel."""
    formula = re.compile(r"[*/] [^;,={}?]*[\w)\]] - (?:T\()?0\.5[fF]?\b(?! [*/])")
    for path in sources("lib") + sources("gst"):
        code = re.sub(r"//.*|/\*.*?\*/", "", path.read_text())
        if path.stem != "image_transform" and formula.search(code):
            faults.append(
                f"{path.relative_to(top)} scales a coordinate by itself: camera/image_transform.hpp"
            )


check_library()
check_plugin()
check_order()
check_sizes()
check_joined()
check_purpose()
check_grids()
check_pixel_centres()
print("\n".join(faults) or "The tree is in order.")
sys.exit(1 if faults else 0)

# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
"""The example program `table2` as users type it: table2.py PROGRAM [opencv]

The spread over the simulated sets is the one that the calibrations predict, the means are the
truth, and the paper's eight standard deviations could be ours.
"""
import math
import os
import subprocess
import sys
import tempfile

program = os.path.abspath(sys.argv[1])
has_opencv = "opencv" in sys.argv[2:]
full = os.environ.get("CALVIN_FULL") == "1"
TRUTH = {"fx": 1424.32, "fy": 1424.06, "cx": 302.71, "cy": 240.95,
         "k1": -0.243, "k2": 0.391, "p1": 0, "p2": 0}
failures = []


def check(good, text):
    if not good:
        failures.append(text)


def run(*arguments, status=0):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    print("$ table2", *arguments)
    print(done.stdout + done.stderr)
    check(done.returncode == status, f"{arguments}: status {done.returncode}, not {status}")
    return done.stdout + done.stderr


def table(text):
    """{name: the numbers of its row}"""
    rows = {}
    for line in text.splitlines():
        words = line.split()
        if words and words[0] in TRUTH:
            rows[words[0]] = [float("nan") if w == "-" else float(w) for w in words[1:]]
    return rows


def check_simulation(sets, opencv):
    text = run("--sets", str(sets), *([] if opencv else ["--no-opencv"]))
    rows = table(text)
    check(list(rows) == list(TRUTH), f"the rows are {list(rows)}")
    # A standard deviation of n values is 1 / sqrt(2 n) off, one sigma.
    sampling = 1 / math.sqrt(2 * sets)
    for name, row in rows.items():
        mean, spread, predicted, ratio = row[2:6]
        check(abs(ratio - 1) < 0.005 + 3.5 * sampling, f"{name}: spread / predicted is {ratio}")
        check(abs(mean - TRUTH[name]) < 4.5 * predicted / math.sqrt(sets) + 0.02 * predicted,
              f"{name}: mean {mean}")
        if opencv:
            check(abs(row[7] / spread - 1) < 0.02, f"{name}: OpenCV's spread is {row[7]}")
    joint = float(text.split("joint spread over predicted:")[1].split()[0])
    # Eight parameters tell more than one.
    check(abs(joint - 1) < max(0.02, 3.5 * sampling / math.sqrt(8)), f"joint ratio {joint}")
    check("joint 95 % region: yes" in text, "the paper's spreads are not in our region")
    return rows


check_simulation(1000 if full else 150, has_opencv)
if full:
    for name, row in check_simulation(20000, False).items():
        check(abs(row[5] - 1) < 0.02, f"{name}: spread / predicted is {row[5]} over 20000 sets")

# Pictures: what one solve and several with another look at the corners between them make of them.
again = table(run("--pictures", "--runs", "5", "--sets", "10" if full else "4", "--views", "15",
                  "--no-opencv"))
check(list(again) == list(TRUTH), f"the rows of pictures are {list(again)}")
for name, row in again.items():
    spread, predicted = row[3:5]
    check(len(row) == 8, f"{name}: {len(row)} numbers")
    check(spread < 3 * predicted and row[7] < 3 * predicted, f"{name}: {row[3:]}")
    for mean in (row[2], row[6]):
        # Corners in pictures have a bias that corners with noise alone have not.
        check(abs(mean - TRUTH[name]) < 4 * predicted, f"{name}: mean {mean} of pictures")
check("--pictures" in run("--runs", "5", status=2), "runs without pictures")

# Files: the same views in both formats give the same table.
with tempfile.TemporaryDirectory() as folder:
    lines = ['{"format":"calvin-observations","version":1,"board":"checkerboard:9x6:25mm"}']
    rows = ["# filename x y weight"]
    for view in range(12):
        a, b = 0.5 * math.sin(2 * view), 0.5 * math.cos(3 * view)
        points = []
        for i in range(54):
            # Turned about x by a, then about y by b.
            x, y = 0.025 * (i % 9 - 4), 0.025 * (i // 9 - 2.5)
            y, z = y * math.cos(a), y * math.sin(a)
            x, z = x * math.cos(b) + z * math.sin(b), z * math.cos(b) - x * math.sin(b)
            u = 320 + 500 * x / (z + 0.3) + 0.05 * math.sin(100 * view + 7 * i)
            v = 240 + 500 * y / (z + 0.3) + 0.05 * math.cos(90 * view + 11 * i)
            points.append(f"[{i},{u!r},{v!r},0.5]")
            rows.append(f"f{view:03}.png {u!r} {v!r} 2")
        lines.append(f'{{"camera":"","image_size":[640,480],"points":[{",".join(points)}]}}')
    jsonl, vnl = os.path.join(folder, "log.jsonl"), os.path.join(folder, "corners.vnl")
    with open(jsonl, "w") as file:
        file.write("\n".join(lines) + "\n" + lines[1][:50])
    with open(vnl, "w") as file:
        file.write("\n".join(rows) + "\n")
    options = ["--views", "6", "--sets", "2", "--model", "brown4"]
    first = run(*options, jsonl)
    second = run(*options, "--board", "checkerboard:9x6:25mm", "--size", "640x480", vnl)
    check(first == second and len(table(first)) == 8, "the formats differ")
    check(abs(table(first)["fx"][0] - 500) < 5, "fx of the file")
    check("share views" in run("--views", "10", "--sets", "3", jsonl), "sets share views")
    check("--board" in run(vnl, status=1), "the board is asked for")
    check("none.jsonl" in run("none.jsonl", status=1), "the file is named")
    check("--views" in run("--views", "13", jsonl, status=1), "too few views")
check("Usage" in run("--help"), "help")
check("no option" in run("--fast", status=2), "an unknown option")
check("number" in run("--sets", "many", status=2), "a word for a number")
check("WxH" in run("--size", "640", status=2), "a size of one number")

for failure in failures:
    print("FAIL:", failure, file=sys.stderr)
sys.exit(1 if failures else 0)

#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# SPDX-FileCopyrightText: 2026 The gst-calvin authors
# calvin-solve as its users type it: a simulated object in space, what the authors of the older tools
# published of their own data, and wrong usage.
import json
import math
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

program = sys.argv[1]  # and whether it reads pictures: opencv or no-opencv
failed = []


def run(*arguments, code=0, says=""):
    ran = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True)
    out = ran.stdout + ran.stderr
    if ran.returncode != code or says not in out:
        failed.append(f"{arguments}: exit {ran.returncode}, '{says}' is not in:\n{out}")
    return out


def near(name, value, wanted, most):
    if not abs(value - wanted) <= most:
        failed.append(f"{name} is {value}, not {wanted} within {most}")


def parameters(path):
    return json.loads(path.read_text())["parameters"]


# Of each view: rms, mean, T and the place of the camera, mm.
def views(out):
    found = []
    for line in out.splitlines():
        words = line.replace(",", "").split()
        if line.startswith("view ") and "rms" in words:
            found.append({"mean": float(words[words.index("mean") + 1]), "rms": float(words[words.index("rms") + 1])})
        elif line.startswith("  T "):
            found[-1]["T"] = [float(w) for w in words[1:4]]
            found[-1]["camera"] = [float(w) for w in words[7:10]]
    return found


# Points of a box of 200 x 150 x 100 mm before a camera of 900 px, and where it sees them, with noise.
def simulated(folder):
    random.seed(4)
    rows = ["# unit: mm", "X Y Z u v"]
    for _ in range(60):
        x, y, z = random.uniform(-100, 100), random.uniform(-75, 75), random.uniform(-50, 50)
        c, s = math.cos(0.5), math.sin(0.5)
        cx, cz = c * x + s * z + 10, -s * x + c * z + 500
        u = 320 + 900 * cx / cz + random.gauss(0, 0.05)
        v = 240 + 900 * (y - 5) / cz + random.gauss(0, 0.05)
        rows.append(f"{x} {y} {z} {u} {v}")
    box = folder / "box.txt"
    box.write_text("\n".join(rows) + "\n")
    for options in ([], ["--method", "dlt"], ["--method", "tsai"], ["--method", "dlt", "--no-refine"]):
        result = folder / "box.json"
        out = run(result, box, "--size", "640x480", "--model", "pinhole", *options, says="view 0, box.txt: 60 points")
        p = parameters(result)
        near(f"fx of {options}", p["fx"], 900, 5)
        near(f"cx of {options}", p["cx"], 320, 5)
        for got, wanted in zip(views(out)[0]["T"], (10, -5, 500)):
            near(f"T of {options}", got, wanted, 3)
    out = run(folder / "box.json", box, "--size", "640x480", "--model", "pinhole", "--pitch", "3um", says="on the sensor: f 2.")
    run(folder / "box.json", box, "--size", "640x480", "--fix", "fx=900,fy=900", "--camera", "left", says="left 640x480")
    near("fx held", parameters(folder / "box.json")["fx"], 900, 0)
    return box


# A camera of 900 px with k1 = -.2: where it sees a point of the frame of the box below.
def seen(x, y, z):
    c, s = math.cos(0.3), math.sin(0.3)
    y, z = c * y - s * z, s * y + c * z + 320
    x, y = x / z, y / z
    bend = 1 - 0.2 * (x * x + y * y)
    return 331 + 900 * bend * x, 236 + 900 * bend * y


# The centroid of the image of a disc of 18 mm: a sum over its parts, each with the area of its image.
def centroid(x, y, z, right):
    def at(a, b):
        return seen(x + a * right[0], y + b, z + a * right[1])

    area, u, v, h = 0, 0, 0, 1e-3
    for square, weight in ((0.5 - math.sqrt(0.15), 5), (0.5, 8), (0.5 + math.sqrt(0.15), 5)):
        for k in range(16):
            a, b = (9 * math.sqrt(square) * f(math.pi * k / 8) for f in (math.cos, math.sin))
            (l, t), (r, q), (m, n), (o, p) = at(a - h, b), at(a + h, b), at(a, b - h), at(a, b + h)
            part = weight * abs((r - l) * (p - n) - (q - t) * (o - m))
            pu, pv = at(a, b)
            area, u, v = area + part, u + part * pu, v + part * pv
    return u / area, v / area


# Heikkila's demonstration: dots of one diameter on two planes at a right angle, whose rows have normals and
# are seen by the centres of their images, from the corner of the picture.
def dots(folder):
    random.seed(8)
    rows = []
    for side in (-1, 1):
        for i in range(5):
            for j in range(5):
                along, half = 25 * i + 15, math.sqrt(0.5)
                x, y, z = side * half * along, 25 * j - 50, half * along - 40
                u, v = centroid(x, y, z, (half, side * half))
                u, v = u + 0.5 + random.gauss(0, 0.02), v + 0.5 + random.gauss(0, 0.02)
                rows.append(f"{x} {y} {z} {u} {v} {-side * half} 0 {half}")
    data = folder / "data3d.txt"
    data.write_text("\n".join(rows) + "\n")
    given = [data, "--unit", "mm", "--size", "640x480", "--from-corner", "--method", "heikkila", "--model", "brown4"]
    result = folder / "dots.json"
    rms = {}
    for name, options in (("cacal", []), ("circal", ["--ellipse-centers", "--diameter", "18mm"])):
        for refine in ([], ["--no-refine"]):
            out = run(result, *given, *options, *refine, says="Heikkila's inverse model")
            rms[name, len(refine)] = views(out)[0]["rms"] if views(out) else math.inf
            p = parameters(result)
            near(f"fx by {name} {refine}", p["fx"], 900, 3 if name == "circal" else 30)
            near(f"k1 by {name} {refine}", p["k1"], -0.2, 0.03 if name == "circal" else 0.3)
    if not rms["circal", 0] < 0.5 * rms["cacal", 0]:
        failed.append(f"centres of ellipses leave no error: {rms}")
    run(result, *given, "--ellipse-centers", code=1, says="column 'diameter'")
    run(result, data, "--columns", "X,Y,Z,u,v,_,_,_", *given[1:], "--ellipse-centers", "--diameter", "18mm", code=1, says="nx ny nz")


# What Heikkila's toolbox has found, in mm: of releases 1 and 2 a brown4 as it is, of release 3 one that follows.
def par(folder):
    result = folder / "par.json"
    given = [result, "--size", "768x576", "--sensor", "6.2031x4.6515mm", "--from-corner"]
    run(*given, "--par", "1.002,8.4,380.5,290.5,-3e-3,4e-5,2e-5,-3e-5", says="brown4")
    p = parameters(result)
    fy = 8.4 * 576 / 4.6515
    for name, wanted in (("fx", 1.002 * 8.4 * 768 / 6.2031), ("fy", fy), ("cx", 380), ("cy", 290), ("k1", -3e-3 * 8.4**2),
                         ("k2", 4e-5 * 8.4**4), ("p1", 2e-5 * 8.4), ("p2", -3e-5 * 8.4)):
        near(f"{name} of par", p[name], wanted, 1e-9 * abs(wanted))
    # As seen, at the right end of the row through the centre: without distortion it would be at x, which is seen there.
    out = run(*given, "--par", "1.002,8.4,380.5,290.5,3e-3,4e-5,0,0", "--release-3", says="brown5 follows")
    p = parameters(result)
    d = (767 - p["cx"]) / p["fx"]
    x = d * (1 + 3e-3 * (8.4 * d) ** 2 + 4e-5 * (8.4 * d) ** 4)
    near("where par of release 3 is seen", seen_radius(p, p["fx"] * x), p["fx"] * d, 0.05)
    near("how far it is said to be", float(out.split("within ")[1].split()[0]), 0, 0.3)
    run(*given, "--par", "1,8.4,380,290,-30,0,0,0", "--release-3", code=1, says="check the sensor's size")
    run(result, "--size", "768x576", "--par", "1,8.4,380,290,0,0,0,0", code=1, says="give the size of the sensor")
    run(result, "--par", "1,8.4,380,290,0,0,0,0", code=2, says="--size")
    run(*given, "--par", "1,8.4", code=2, says="another value")
    run(*given, "views", "--par", "1,8.4,380,290,0,0,0,0", code=2, says="no views")


# A plane of 5 x 4 points through a lens that zooms from 800 to 2400 px, tilted to another side in each view.
def zooming(folder):
    random.seed(6)
    files = []
    for n in range(6):
        f = 800 * 3 ** (n / 5)
        tilt = [(0.6, 0.3), (-0.5, 0.5), (0.4, -0.7), (-0.6, -0.4), (0.1, 0.7), (0.7, -0.1)][n]
        rows = ["# unit: mm", "X Y u v"]
        for x in range(-2, 3):
            for y in range(-1, 3):
                px, py, pz = 40 * x, 40 * y, 0
                c, s = math.cos(tilt[0]), math.sin(tilt[0])
                px, pz = c * px + s * pz, -s * px + c * pz
                c, s = math.cos(tilt[1]), math.sin(tilt[1])
                py, pz = c * py - s * pz, s * py + c * pz
                pz += 0.6 * f
                u = 326 + f * px / pz + random.gauss(0, 0.02)
                v = 235 + f * py / pz + random.gauss(0, 0.02)
                rows.append(f"{40 * x} {40 * y} {u} {v}")
        files.append(folder / f"zoom{n}.txt")
        files[-1].write_text("\n".join(rows) + "\n")
    result = folder / "zoom.json"
    size = ["--size", "640x480", "--method", "sturm-maybank"]
    for options in (["--fix", "aspect"], ["--fix", "aspect", "--no-refine"]):
        run(result, *files, *size, *options, says="view 5, zoom5.txt: fx 2")
        table = json.loads(result.read_text())
        near("settings", len(table["settings"]), 6, 0)
        for n, setting in enumerate(table["settings"]):
            near("the position", setting["zoom"], n, 0)
            p = setting["calibration"]["parameters"]
            near(f"fx of {options}, view {n}", p["fx"] / (800 * 3 ** (n / 5)), 1, 0.02)
            near(f"cx of {options}", p["cx"], 326, 8)
    run(folder / "one.json", files[0], *size, "--fix", "aspect,center", says="view 0, zoom0.txt: fx 8")
    near("fx of one view", parameters(folder / "one.json")["fx"], 800, 30)
    run(result, files[0], *size, code=1, says="takes 3 views")
    run(result, *files, *size, "--fix", "k1", code=1, says="center and aspect alone")
    run(result, *files, *size, "--model", "fisheye", code=1, says="calvin-zoom")


def refusals(folder, box):
    result = folder / "none.json"
    run(result, box, code=1, says="give --size")
    run(result, box, "--size", "640x480", "--method", "zhang", code=1, says="method dlt")
    run(result, box, "--size", "640x480", "--method", "magic", code=1, says="Known methods: bakstein, discorpy, dlt, heikkila")
    run(result, box, "--size", "640x480", "--no-refine", code=1, says="give one of")
    other = folder / "other.txt"
    other.write_text("".join(box.read_text().splitlines(keepends=True)[:-1]))
    run(result, box, other, "--size", "640x480", "--method", "tsai", code=1, says="takes one view")
    run(result, box, "--size", "640x480", "--columns", "X,Y,-Z,u,v", "--method", "dlt", code=1, says="left-handed")
    run(result, box, "--size", "640x480", "--drop", "0", code=1, says="no view")
    run(result, folder / "none.txt", "--size", "640x480", code=1, says="none.txt")
    run(result, box, "--size", "640", code=2, says="Usage")
    run(result, box, "--columns", "X,Y,Q", code=2, says="'Q' is no column")
    run(result, box, "--shoulder", code=2, says="no option")
    run(result, code=2, says="Usage")
    run("--help", says="Usage")
    if result.exists():
        failed.append("a failure has written a file")
    overwriting(folder, box)


# A forgotten output takes no input's place, nor that of what is no calibration.
def overwriting(folder, box):
    seen = folder / "seen.jsonl"
    seen.write_text('{"format": "calvin-observations", "version": 1, "board": "checkerboard:9x6:25mm"}\n')
    table = folder / "table.json"
    table.write_text('{"format": "calvin-zoom", "version": 1}')
    start = folder / "start.json"
    shutil.copy(folder / "box.json", start)
    kept = {path: path.read_text() for path in (seen, table, box)}
    order = "The order is: calvin-solve [OPTIONS] CALIBRATION.json VIEWS..."
    run(seen, seen, code=1, says=f"'{seen}' is one of the files to read, and a result would take its place.")
    run(seen, folder / "more.jsonl", code=1, says="holds observations of a board, and a calibration would take its place.")
    run(seen, folder / "more.jsonl", code=1, says=order)
    run(box, seen, code=1, says="holds something that this tool does not write")
    run(table, box, "--size", "640x480", code=1, says="holds a zoom table, and a calibration would")
    run(box, seen, "--points", box, code=1, says="one of the files to read")
    for path, text in kept.items():
        if path.read_text() != text:
            failed.append(f"a refusal has touched {path}")
    # What is started from is improved where it is.
    run(start, box, "--size", "640x480", "--initial", start)


# Z. Zhang's own five views: his camera, to the digits that he printed.
def zhang(data, folder):
    result = folder / "zhang.json"
    pictures = [data / f"zhang/data{i}.txt" for i in range(1, 6)]
    points = ["--points", data / "zhang/Model.txt", "--point-columns", "X,Y", "--unit", "in", "--size", "640x480"]
    plain = ["--model", "brown4", "--skew", "--fix", "p1,p2", "--keep-all"]
    for start in ([], ["--method", "zhang"], ["--method", "bakstein"]):
        run(result, *pictures, *points, *plain, *start)
        p = parameters(result)
        for name, wanted, digit in (("fx", 832.5, 0.05), ("fy", 832.53, 5e-3), ("cx", 303.959, 5e-4), ("cy", 206.585, 5e-4),
                                    ("k1", -0.228601, 1e-6), ("k2", 0.190353, 2e-6), ("skew", 0.204494, 1e-5)):
            near(f"zhang {start} {name}", p[name], wanted, digit)
    # Without a lens in the model: the other result that he printed.
    run(result, *pictures, *points, "--model", "pinhole", "--skew", "--keep-all", "--method", "zhang")
    p = parameters(result)
    for name, wanted, digit in (("fx", 867.307, 5e-3), ("fy", 867.194, 5e-3), ("cx", 299.159, 5e-3), ("cy", 218.676, 5e-3)):
        near(f"zhang, no distortion, {name}", p[name], wanted, digit)


# Clicked points of a cube: radial alignment gives the published place, and no larger error.
def tsai(data, folder):
    cube = data / "tsai-cube-bailus/points.csv"
    for side, columns, tx, ty, error in (("left", "u,v,_,_", 22.110, 56.025, 2.5), ("right", "_,_,u,v", 9.604, 63.094, 3.6)):
        out = run(folder / "cube.json", cube, "--columns", f"X,Y,-Z,{columns}", "--unit", "mm", "--size", "3000x3000",
                  "--from-corner", "--method", "tsai", "--no-refine", "--pitch", "1.096um", says="kappa1")
        view = views(out)[0]
        # There the axes of the image point left and up.
        near(f"tsai {side} Tx", abs(view["T"][0]), tx, 0.01 * tx)
        near(f"tsai {side} Ty", abs(view["T"][1]), ty, 0.01 * ty)
        near(f"tsai {side} mean error", view["mean"], 0, error)
        run(folder / "cube.json", cube, "--columns", f"X,Y,-Z,{columns}", "--unit", "mm", "--size", "3000x3000",
            "--model", "brown4", "--method", "tsai", "--keep-all", says="RMS reprojection error 0.5")


# A plate of several levels before three cameras: with the focal length at which it was held there, the
# cameras are where they were published; the free fit is no worse than OpenCV's.
def myptv(data, folder):
    published = ((48.730, 79.461, 528.686), (-57.864, 41.095, 501.157), (125.076, 34.510, 519.266))
    for camera, place in enumerate(published, 1):
        rows = data / f"points3d-myptv/cam{camera}_cal_points"
        given = ["--columns", "u,v,X,Y,Z", "--unit", "mm", "--size", "1280x1024", "--keep-all"]
        for method in ([], ["--method", "dlt"], ["--method", "tsai"]):
            out = run(folder / "plate.json", rows, *given, "--fix", "fx=6000,fy=6000", *method)
            near(f"myptv {camera} {method}", math.dist(views(out)[0]["camera"], place), 0, 15)


# The file that discorpy wrote of dot_pattern_05: a centre, px, and the factors of powers of the ideal
# radius that give the seen one.
def published_distortion(path):
    values = [float(line.split(":")[1]) for line in path.read_text().splitlines() if ":" in line]
    return values[:2], values[2:]


# Of brown5: where a point is seen that is r px from the centre without distortion, px from it.
def seen_radius(p, r):
    s = (r / p["fx"]) ** 2
    return r * (1 + s * (p["k1"] + s * (p["k2"] + s * p["k3"])))


# How far our curve is from theirs over the picture, px, after the best common scale of the ideal radius.
def curve_difference(p, center, factors, width, height):
    most = max(math.hypot(x - center[0], y - center[1]) for x in (0, width - 1) for y in (0, height - 1))
    radii = [most * i / 200 for i in range(201)]
    theirs = [sum(f * r ** (i + 1) for i, f in enumerate(factors)) for r in radii]

    def off(scale):
        return max(abs(seen_radius(p, scale * r) - t) for r, t in zip(radii, theirs))

    low, high = 0.98, 1.02
    for _ in range(80):
        a, b = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, b) if off(a) < off(b) else (a, high)
    return off((low + high) / 2)


# RMS of the points of rows and columns from straight lines, px: without distortion, and as they are seen.
def straightness(out):
    line = next((line for line in out.splitlines() if line.startswith("straightness:")), "rms inf px, inf as seen")
    return float(line.split("rms ")[1].split()[0]), float(line.split(", ")[-1].split()[0])


def launch(line):
    ran = subprocess.run(["gst-launch-1.0", "-q", *line.split()], capture_output=True, text=True)
    if ran.returncode:
        failed.append(f"{line}: {ran.stdout}{ran.stderr}")


# What a picture shows once calibundistort has it: rows and columns are straight as seen.
def undistorted(calibration, picture, decoder, board, folder):
    mended = folder / f"mended-{picture.stem}.png"
    launch(f"filesrc location={picture} ! {decoder} ! videoconvert ! video/x-raw,format=GRAY8 ! "
           f"calibundistort calibration={calibration} ! pngenc ! filesink location={mended}")
    return straightness(run(folder / "again.json", f"{mended}*", "--board", board, "--method", "discorpy"))[1]


# A rendered grid before a lens that bends it: the distortion of one picture, and calibundistort with it.
def rendered(folder):
    lens = "fx=1200,fy=1200,cx=612,cy=491,k1=-0.25,k2=0.05,width=1280,height=960"
    for board in ("dots:5mm", "lines:5mm"):
        picture = folder / f"{board[:4]}.png"
        launch(f"calibtestsrc board={board} calibration={lens} motion=static seed=3 num-buffers=1 ! "
               f"video/x-raw,format=GRAY8,width=1280,height=960 ! pngenc ! filesink location={picture}")
        result = folder / "grid.json"
        out = run(result, f"{picture}*", "--board", board, "--method", "discorpy", says="focal length is not known")
        p = parameters(result)
        near(f"cx by {board}", p["cx"], 612, 1)
        near(f"cy by {board}", p["cy"], 491, 1)
        near(f"k1 by {board}", p["k1"], -0.25 * (1280 / 1200) ** 2, 0.01)
        mended, seen = straightness(out)
        near(f"straightness by {board}", mended, 0, 0.03)
        if seen < 1:
            failed.append(f"{board} is straight as seen: {seen} px")
        near(f"straightness of {board} by calibundistort", undistorted(result, picture, "pngdec", board, folder), 0, 0.05)


# What is left of discorpy's own steps in a result: its centre, px, and its factors.
def own_numbers(out):
    line = next((line for line in out.splitlines() if line.startswith("discorpy's own numbers")), "")
    words = line.replace(",", "").replace(";", "").split()
    if not words:
        failed.append(f"no numbers of discorpy's own steps in:\n{out}")
        return (0, 0), [1]
    at = words.index("factors") + 1
    return (float(words[words.index("xcenter") + 1]), float(words[words.index("ycenter") + 1])), [float(w) for w in words[at : at + 5]]


# One picture of a dense grid of dots or lines: what discorpy published of the same, and how straight lines
# become. Its centre is known to a pitch (15.2 px in dot_pattern_05), for it lies between two rows.
def discorpy(data, folder):
    result = folder / "distortion.json"
    pictures = data / "discorpy"
    out = run(result, f"{pictures}/dot_pattern_05*", "--board", "dots:1mm", "--method", "discorpy",
              says="focal length is not known")
    p = parameters(result)
    center, factors = published_distortion(pictures / "coef_dot_05.txt")
    near("discorpy's curve", curve_difference(p, center, factors, 1280, 800), 0, 0.3)
    for name, published in (("cx", center[0]), ("cy", center[1])):
        near(f"discorpy's {name}", p[name], published, 1.5 * 15.2)
    # Its own steps, from its own places of dots on: the published numbers.
    steps = ["--method", "discorpy", "--no-refine"]
    own, powers = own_numbers(run(result, f"{pictures}/dot_pattern_05*", "--board", "dots:1mm", *steps))
    near("centre of dot_pattern_05 by discorpy's steps", math.dist(own, center), 0, 0.01)
    off = max(abs(sum((p - f) * r ** (i + 1) for i, (p, f) in enumerate(zip(powers, factors)))) for r in range(750))
    near("curve of dot_pattern_05 by discorpy's steps", off, 0, 0.02)
    own, _ = own_numbers(run(result, f"{pictures}/dot_pattern_01*", "--board", "dots:1mm", *steps))
    near("centre of dot_pattern_01 by discorpy's steps", math.dist(own, (1252.1529, 1008.9088)), 0, 0.01)
    near("straightness of dot_pattern_05", straightness(out)[0], 0, 0.15)
    for picture, board in (("line_pattern_01", "lines:1mm"), ("dot_pattern_01", "dots:1mm")):
        out = run(result, f"{pictures}/{picture}*", "--board", board, "--method", "discorpy", says="rows and columns")
        near(f"straightness of {picture}", straightness(out)[0], 0, 0.15)
        near(f"straightness of {picture} by calibundistort",
             undistorted(result, pictures / f"{picture}.jpg", "jpegdec", board, folder), 0, 0.15)


# A folder of pictures: each view has the name of its file and the number by which it is dropped, and
# points are on the board as it is bent.
def pictures(folder, left):
    pictures_of = folder / "pictures"
    pictures_of.mkdir()
    for file in left:
        shutil.copy(file, pictures_of)
    result = folder / "pictures.json"
    given = ["--board", "checkerboard:9x6:30mm"]
    out = run(result, pictures_of, *given, says="view 4, left05.jpg: 54 points")
    if "warp" not in json.loads(result.read_text()):
        failed.append("the board is not bent")
    for view in views(out):
        if not view["mean"] <= view["rms"] + 1e-4:
            failed.append(f"the mean {view['mean']} is more than the rms {view['rms']}")
    out = run(result, pictures_of, *given, "--drop", "0,4", says="view 3, left04.jpg: 54 points")
    if "left05.jpg" in out or "view 5, left06.jpg" not in out:
        failed.append(f"left05.jpg was not left out:\n{out}")
    # Corners that the camera refines: as near as before, and elsewhere by a part of a pixel.
    once = parameters(result)
    out = run(result, pictures_of, *given, "--drop", "0,4", "--runs", "3", says="view 3, left04.jpg: 54 points")
    near("fx in three runs", parameters(result)["fx"], once["fx"], 2)
    if parameters(result)["fx"] == once["fx"]:
        failed.append("runs have refined nothing")
    run(result, pictures_of, *given, "--runs", "0", code=2, says="needs another value")
    run(result, pictures_of, *given, "--drop", "0,4")
    # A warm start by what Bouguet's toolbox has written.
    script = folder / "Calib_Results.m"
    script.write_text("% Intrinsic and Extrinsic Camera Parameters\n\nfc = [ 536 ; 536 ];\ncc = [ 342 ; 235 ];\nalpha_c = 0;\n"
                      "kc = [ -0.27 ; 0.1 ; 0 ; 0 ; 0 ];\nfc_error = [ 3 ; 3 ];\nnx = 640;\nny = 480;\n")
    cold = parameters(result)
    run(result, pictures_of, *given, "--drop", "0,4", "--initial", script)
    near("fx from Calib_Results.m on", parameters(result)["fx"], cold["fx"], 0.01)


# OpenCV's samples, or those of Debian's opencv-doc.
def left_pictures(data):
    for folder in (data and pathlib.Path(data) / "opencv-samples", pathlib.Path("/usr/share/doc/opencv-doc/examples/data")):
        found = sorted(folder.glob("left[0-9]*.jpg")) if folder else []
        if found:
            return found
    return []


def main():
    data = os.environ.get("CALVIN_DATA", "")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        box = simulated(folder)
        refusals(folder, box)
        dots(folder)
        par(folder)
        zooming(folder)
        if sys.argv[2] == "opencv":
            rendered(folder)
        for check, needs in ((zhang, "zhang"), (tsai, "tsai-cube-bailus"), (myptv, "points3d-myptv"), (discorpy, "discorpy")):
            if check is discorpy and sys.argv[2] != "opencv":
                print("built without OpenCV, which reads pictures: discorpy is left out")
            elif data and (pathlib.Path(data) / needs).is_dir():
                check(pathlib.Path(data), folder)
            else:
                print(f"CALVIN_DATA does not name a folder with {needs}: left out")
        left = left_pictures(data)
        if sys.argv[2] != "opencv":
            print("built without OpenCV, which reads pictures: left out")
        elif not left:
            print("neither CALVIN_DATA nor opencv-doc has OpenCV's pictures: left out")
        else:
            pictures(folder, left)
    print("\n".join(failed))
    return 1 if failed else 0


sys.exit(main())

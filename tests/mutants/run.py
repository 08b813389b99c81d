#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
# Whether the tests notice mistakes: each patch beside this file is one in the production code. Each
# is applied to a copy of the tree, which is built and tested until a test fails.
#   run.py [NAME|ROOM...]   all, or those of these names or rooms
#   --dir DIR      where the copy and its build are (build-mutants beside the sources)
#   --jobs N       compile N files at a time (1)
#   --check        only whether all patches still apply
#   --near         only the tests of the room itself and those that are listed for it
#   --no-baseline  do not run the tests without a mutant first; times are those of the last run
#   --report FILE  keep a line for each mutant there, those of earlier runs too
# Ends with 0 where 85 % of all mutants and 70 % of those of each room are killed, with 1 where
# they are not or a patch is stale, with 2 where the tests fail without a mutant.
import argparse
import collections
import filecmp
import fnmatch
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parent.parent
LEAST_OF_ALL = 0.85
LEAST_OF_ROOM = 0.7

# The order of docs/conventions.md: a mutant of a room may show in those below it.
ROOMS = ("core device geometry camera target io detect solve rig remap session draw synth gst").split()

# The tests of a room: what begins with one of these, those that tell most for their time first.
TESTS = {
    "core": "core file",
    "device": "lens",
    "geometry": "geometry monotone_cubic",
    "camera": "camera usable_area zoom_table",
    "target": "board",
    "io": "io observations board_names light_io rig_io rig_formats opencv_stereo mrcal colmap caliscope "
    "zoom_io",
    "detect": "detect nearest",
    "solve": "view_share single_views view_information solve pose recheck uncertainty difference",
    "rig": "rig floor light solve_rig left_out solve_zooming strobl",
    "remap": "undistorter views remap rectification",
    "session": "corner_motion view_guide operator hint session calibration_session guided_capture "
    "refine_with_camera watch rig_session",
    "draw": "overlay board_drawing",
    "synth": "motion synth",
    "gst": "",
}
# What else is likely to notice; tests/check programs by their names there.
NEAR = {
    "core": "io* board board_names observations session* calibsolve_settings",
    "device": "calibsolve_lens",
    "geometry": "session pose difference solve_initial camera motion solve",
    "camera": "solve_peers solve_opencv solve_omni solve_initial undistorter views remap_view "
    "solve_ceres solve uncertainty",
    "target": "board_names board_drawing observations io solve_board_text",
    "io": "calibundistort_files calibsolve_settings",
    "detect": "refine_with_camera calibdetect",
    "solve": "solve_zooming refine_with_camera calibsolve*",
    "rig": "rectification* rig_session calibrig*",
    "remap": "calibundistort*",
    "session": "overlay calibsolve* calibrig*",
    "draw": "caliboverlay",
    "synth": "refine_with_camera calibtestsrc detect_boards detect_fit",
}
# Mutants of gst/ begin with what is likely by the name of the file.
NEAR_FILES = {
    "gstcaliboverlay": "caliboverlay",
    "gstcalibrate": "calibrate",
    "calibration_input": "calibundistort* states",
    "calib_detector": "calibdetect* calibrate",
    "calib_solver": "calibsolve*",
    "solver_jobs": "calibsolve*",
    "gstcalibrig": "calibrig*",
    "rig_solver": "calibrig_failures calibrig*",
    "rig_solver_jobs": "calibrig_failures calibrig*",
    "rig_settings": "calibrig_failures calibrig_settings calibrig*",
    "rig_end": "calibrig_settings calibrig*",
    "view_state": "calibview",
    "solver_watch": "calibsolve_silence calibsolve_lens",
    "solve_messages": "calibsolve* calibrate*",
    "worker": "worker calibsolve*",
    "metas": "metas guidance",
    "interpolated_times": "calibdetect",
    "frame_timeline": "calibtestsrc*",
    "test_scene": "calibtestsrc*",
    "undistort_caps": "calibundistort_sizes calibundistort*",
    "undistort_settings": "calibundistort_views calibundistort_zoom_device calibundistort*",
    "properties": "calibundistort bad_input calibundistort* states",
    "detector_properties": "calibdetect*",
    "undistort_properties": "calibundistort_files calibundistort*",
    "orientation_tags": "calibundistort_frames calibundistort*",
    "frame_planes": "calibundistort_chroma calibundistort_formats",
    "frame_undistorter": "calibundistort_frames calibundistort_chroma calibundistort_zoom",
    "lens_follower": "calibundistort_zoom_device",
}
# Long, and random: they are no test of one thing.
NEVER = {"check/random_walk"}

# How often a test may take its time, of a processor: a busy machine must not kill. And seconds in
# which one that waits for ever is given up.
PATIENCE = 10
LONGEST = 900


class Mutant:
    def __init__(self, path):
        lines = path.read_text().splitlines()
        self.path = path
        self.name = path.stem
        self.room = self.name.split("-")[0]
        self.says = lines[0]
        self.files = [line[6:].split("\t")[0] for line in lines if line.startswith("+++ b/")]
        if self.room not in ROOMS:
            sys.exit(f"{path}: {self.room} is no room")


class Tree:
    """A copy of the sources and its build."""

    def __init__(self, folder, jobs):
        self.folder = folder
        self.tree = folder / "tree"
        self.build = self.tree / "build-tests"
        self.jobs = jobs

    def copy(self):
        """Makes the copy what the working tree is; files that are alike keep their times."""
        listed = subprocess.check_output(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=SOURCE
        )
        wanted = {name for name in listed.decode().split("\0") if (SOURCE / name).is_file()}
        for name in wanted:
            self.restore(name)
        for path in list(self.tree.rglob("*")):
            name = path.relative_to(self.tree)
            if path.is_file() and name.parts[0] != self.build.name and str(name) not in wanted:
                path.unlink()

    def restore(self, name):
        to = self.tree / name
        if to.is_file() and filecmp.cmp(SOURCE / name, to, shallow=False):
            return
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(SOURCE / name, to)
        shutil.copymode(SOURCE / name, to)

    def setup(self):
        if not (self.build / "build.ninja").is_file():
            subprocess.check_call(["meson", "setup", "build-tests", "-Dwerror=false"], cwd=self.tree)
        self.make(["build.ninja"], self.folder / "setup.log")

    def make(self, targets, log):
        command = ["ninja", "-C", str(self.build), f"-j{self.jobs}", *targets]
        with open(log, "a") as out:
            return subprocess.call(command, stdout=out, stderr=out) == 0


def apply(folder, mutant, *how):
    # A repository around the copy would make git look for the files there.
    env = dict(os.environ, GIT_CEILING_DIRECTORIES=str(folder.parent))
    command = ["git", "apply", "-C1", "--recount", *how, str(mutant.path)]
    return subprocess.run(command, cwd=folder, env=env, capture_output=True).returncode == 0


class Test:
    def __init__(self, known, programs, build):
        self.suite = known["suite"][0].split(":")[-1]
        self.name = f"{self.suite}/{known['name']}"
        self.short = known["name"]
        self.command = known["cmd"]
        self.env = known["env"]
        self.seconds = 0.0  # of a processor
        own = pathlib.Path(self.command[0])
        self.targets = {programs[p] for p in known["depends"] if p in programs}
        self.targets.add(str(own.relative_to(build)))

    def run(self, log):
        """What failed, or nothing."""
        env = dict(os.environ, GTEST_FAIL_FAST="1", CK_TIMEOUT_MULTIPLIER="4")
        env.update(self.env)
        env.pop("CALVIN_FULL", None)  # many times as long, to tell the same of a mutant
        limit = int(30 + PATIENCE * self.seconds)
        before = processor_seconds()
        with open(log, "w") as out:
            process = subprocess.Popen(
                self.command,
                env=env,
                stdout=out,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit)),
            )
            try:
                code = process.wait(LONGEST)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                return "time-out"
        if code in (0, 77):
            self.last = processor_seconds() - before
            return ""
        if code in (-signal.SIGXCPU, -signal.SIGKILL):
            return "time-out"
        return first_failure(log) or f"exit {code}"


def processor_seconds():
    """Of all processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def first_failure(log):
    """The name of the first test in the output of GoogleTest, or of gst-check, that failed."""
    for line in log.read_text(errors="replace").splitlines():
        if line.startswith("[  FAILED  ] "):
            return line[13:].split(",")[0].split(" (")[0]
        fields = line.split(":")
        if len(fields) > 4 and fields[1].isdigit() and fields[2] in "FE" and fields[2]:
            return fields[4]
    return ""


def tests_of(tree):
    def introspect(what):
        return json.loads(subprocess.check_output(["meson", "introspect", what, str(tree.build)]))

    programs = {}
    for target in introspect("--targets"):
        for filename in target["filename"][:1]:
            programs[target["id"]] = os.path.relpath(filename, tree.build)
    tests = {}
    for known in introspect("--tests"):
        inside = known["cmd"][0].startswith(str(tree.build))
        if inside and known["suite"][0].split(":")[-1] in ("lib", "check"):
            test = Test(known, programs, tree.build)
            tests[test.name] = test
    return {name: test for name, test in tests.items() if name not in NEVER}


def begins_with(test, words):
    return any(test.short == w or test.short.startswith(w + "_") for w in words.split())


def tests_for(mutant, tests, near_only):
    """Those that kill fast first: the room's own, then what is near, then all below it."""
    quick = sorted(tests.values(), key=lambda test: test.seconds)
    lib = [test for test in quick if test.suite == "lib"]
    check = [test for test in quick if test.suite == "check"]
    near = NEAR.get(mutant.room, "")
    for file in mutant.files:
        near = NEAR_FILES.get(pathlib.Path(file).stem, "") + " " + near
    own = [test for test in lib if begins_with(test, TESTS[mutant.room])]
    listed = [t for word in near.split() for t in lib + check if fnmatch.fnmatch(t.short, word)]
    below = " ".join(TESTS[room] for room in ROOMS[ROOMS.index(mutant.room) + 1 :])
    claimed = " ".join(TESTS.values())
    nobodys = [test for test in lib if not begins_with(test, claimed)]
    rest = nobodys + [test for test in lib if begins_with(test, below)] + check
    if near_only and own + listed:
        rest = []
    return list(dict.fromkeys(own + listed + rest))


def baseline(tree, tests, wanted):
    """Without a mutant: they have to pass, and tell their times. What fails is tried once more."""
    for test in sorted(wanted, key=lambda test: test.name):
        if not tree.make(sorted(test.targets), tree.folder / "baseline-build.log"):
            return f"{test.name} does not build: see {tree.folder}/baseline-build.log"
        log = tree.folder / "test.log"
        why = test.run(log) and test.run(log)
        if why:
            return f"{test.name} fails without a mutant: {why}, see {log}"
        test.seconds = test.last
        print(f"  {test.name}: {test.seconds:.1f} s of a processor", flush=True)
    times = {test.name: round(test.seconds, 1) for test in tests.values()}
    (tree.folder / "times.json").write_text(json.dumps(times, indent=1))
    return ""


def judge(tree, mutant, tests):
    """What killed it, "survived", or why it is none."""
    if not apply(tree.tree, mutant):
        return "does not apply"
    log = tree.folder / "test.log"
    build_log = tree.folder / f"{mutant.name}.log"
    build_log.unlink(missing_ok=True)
    for test in tests:
        if not tree.make(sorted(test.targets), build_log):
            return "does not build"
        why = test.run(log)
        # Time decides nothing in tests/lib; elsewhere a busy machine might.
        if why and test.suite == "check":
            why = test.run(log) and why
        if why:
            build_log.unlink(missing_ok=True)
            return f"killed by {test.name}: {why}"
    build_log.unlink(missing_ok=True)
    return "survived"


def is_killed(verdict):
    return verdict.startswith("killed")


def write_report(path, verdicts, says):
    with open(path, "w") as out:
        for name, verdict in sorted(verdicts.items()):
            shown = verdict if is_killed(verdict) else verdict.upper()
            print(f"{name}: {shown}" + ("" if is_killed(verdict) else f" -- {says.get(name, '')}"),
                  file=out)


def summarise(mutants, verdicts, reasons):
    """Prints the sums; whether they are good enough."""
    good = True
    counts = collections.Counter(m.room for m in mutants)
    killed = collections.Counter(m.room for m in mutants if is_killed(verdicts[m.name]))
    for room in (room for room in ROOMS if counts[room]):
        enough = killed[room] >= LEAST_OF_ROOM * counts[room]
        good &= enough
        print(f"{room}: {killed[room]}/{counts[room]}" + ("" if enough else "  too few"))
    total = sum(killed.values())
    good &= total >= LEAST_OF_ALL * len(mutants)
    print(f"all: {total}/{len(mutants)} killed")
    for mutant in mutants:
        verdict = verdicts[mutant.name]
        if is_killed(verdict):
            continue
        good &= verdict == "survived"
        print(f"{mutant.name}: {verdict}. {mutant.says}")
        if mutant.name in reasons:
            print(f"    known: {reasons[mutant.name]}")
    return good


def read_reasons():
    lines = (HERE / "survivors.txt").read_text().splitlines()
    pairs = (line.split(": ", 1) for line in lines if ": " in line and not line.startswith("#"))
    return dict(pairs)


def options():
    parser = argparse.ArgumentParser(description="Whether the tests notice mistakes.")
    parser.add_argument("names", nargs="*", help="mutants or rooms")
    parser.add_argument("--dir", type=pathlib.Path, default=SOURCE / "build-mutants")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--near", action="store_true")
    parser.add_argument("--no-baseline", action="store_true")
    parser.add_argument("--report", type=pathlib.Path)
    return parser.parse_args()


def chosen(names):
    mutants = [Mutant(path) for path in sorted(HERE.glob("*.patch"))]
    mutants.sort(key=lambda m: ROOMS.index(m.room))
    unknown = set(names) - {m.name for m in mutants} - set(ROOMS)
    if unknown:
        sys.exit(f"There is no mutant or room {' '.join(sorted(unknown))}.")
    return [m for m in mutants if not names or m.name in names or m.room in names]


def main():
    args = options()
    mutants = chosen(args.names)
    if args.check:
        stale = [m.name for m in mutants if not apply(SOURCE, m, "--check")]
        print(f"{len(mutants) - len(stale)} of {len(mutants)} patches apply", *stale)
        return 1 if stale else 0
    folder = args.dir.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    tree = Tree(folder, args.jobs)
    tree.copy()
    tree.setup()
    tests = tests_of(tree)
    if (folder / "times.json").is_file():
        for name, seconds in json.loads((folder / "times.json").read_text()).items():
            if name in tests:
                tests[name].seconds = seconds
    if not args.no_baseline:
        wanted = {t for m in mutants for t in tests_for(m, tests, args.near)}
        if problem := baseline(tree, tests, wanted):
            print(problem)
            return 2
    results = folder / "results.json"
    verdicts = json.loads(results.read_text()) if results.is_file() else {}
    says = {m.name: m.says for m in chosen([])}
    reasons = read_reasons()
    for mutant in mutants:
        begin = time.monotonic()
        # Of the copy: somebody may work on the sources meanwhile.
        before = {file: (tree.tree / file).read_bytes() for file in mutant.files}
        verdict = judge(tree, mutant, tests_for(mutant, tests, args.near))
        for file, content in before.items():
            if (tree.tree / file).read_bytes() != content:
                (tree.tree / file).write_bytes(content)
        verdicts[mutant.name] = verdict
        print(f"{mutant.name}: {verdict} ({time.monotonic() - begin:.0f} s)", flush=True)
        if mutant.name in reasons and not is_killed(verdict):
            print(f"    known: {reasons[mutant.name]}", flush=True)
        results.write_text(json.dumps({n: v for n, v in verdicts.items() if n in says}, indent=1))
        if args.report:
            write_report(args.report, {n: v for n, v in verdicts.items() if n in says}, says)
    return 0 if summarise(mutants, verdicts, reasons) else 1


if __name__ == "__main__":
    sys.exit(main())

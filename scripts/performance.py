#!/usr/bin/env python3
"""Measures what a control loop repeats and writes docs/performance.md.

    python3 scripts/performance.py                     # needs valgrind for the instruction counts
    python3 scripts/performance.py --peer              # Pinocchio beside it, in the same run

Each work of benches/works/mod.rs is run as `counted NAME COUNT` with two counts, and the difference is divided by the
difference of the counts: what is done once falls out. Instructions are counted by callgrind. Times are medians of rounds
in which the works and the peer take turns, so that a busy machine disturbs them alike.

The peer is compiled from scripts/peers/pinocchio.cpp against the wheels `pin` and `cmeel-eigen` of this Python and the
headers of urdfdom (Debian: liburdfdom-headers-dev); it is no part of the tests.
"""

import argparse
import json
import pathlib
import platform
import re
import shutil
import statistics
import subprocess
import sys
import sysconfig
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent

# (name of the work, what it is, repetitions for time, repetitions for instructions, units of work in a repetition)
WORKS = [
    ("kinematics ur5e", "forward kinematics and Jacobian, UR5e (6 joints)", 400_000, 1000, 1),
    ("kinematics panda", "forward kinematics and Jacobian, Panda (7 joints)", 400_000, 1000, 1),
    ("kinematics iiwa14", "forward kinematics and Jacobian, iiwa 14 (7 joints)", 400_000, 1000, 1),
    ("kinematics baxter", "forward kinematics and Jacobian, Baxter hand to hand (14 joints)", 200_000, 1000, 1),
    ("solve", "normal equations of a 6 x 7 Jacobian: factors, solution, bound of the singular value", 400_000, 1000, 1),
    ("step 1 panda", "step of 1 Panda, full pose", 200_000, 1000, 1),
    ("step 2 pandas", "step of 2 Pandas, full pose", 200_000, 1000, 1),
    ("step 4 pandas", "step of 4 Pandas, full pose", 100_000, 1000, 1),
    ("step 8 pandas", "step of 8 Pandas, full pose", 50_000, 1000, 1),
    ("step 2 pandas, path computed", "the same for 2 Pandas with the path computed in the step", 200_000, 1000, 1),
    ("step 2 pandas, split-ab6", "step of 2 Pandas by `split-ab6`", 200_000, 1000, 1),
    ("4 plans, one by one", "step of 2 Pandas in whole plans, made, run and recorded one by one", 20, 2, 8000),
    ("4 plans, together", "the same, four plans in the lanes", 20, 2, 8000),
]
PEER_WORKS = {"kinematics panda", "step 2 pandas"}


def build():
    command = ["cargo", "bench", "--bench", "counted", "--no-run", "--message-format=json"]
    output = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    for line in output.splitlines():
        message = json.loads(line)
        if message.get("target", {}).get("name") == "counted" and message.get("executable"):
            return message["executable"]
    sys.exit("cargo built no benchmark called `counted`")


def build_peer(folder):
    prefix = pathlib.Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix"
    if not (prefix / "include" / "pinocchio").is_dir():
        sys.exit(f"no Pinocchio in {prefix}: pip install -r scripts/requirements.txt cmeel-eigen==3.4.1")
    peer = pathlib.Path(folder) / "pinocchio"
    include = [prefix / "include", prefix / "include" / "eigen3", "/usr/include/urdfdom_headers"]
    command = ["g++", "-O3", "-DNDEBUG", "-std=c++17"]
    # Pinocchio's joints are a variant of more types than Boost counts by default.
    command += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
    command += [f"-I{path}" for path in include] + [str(ROOT / "scripts/peers/pinocchio.cpp"), "-o", str(peer)]
    library = prefix / "lib"
    command += [f"-L{library}", "-lpinocchio_default", "-lpinocchio_parsers", f"-Wl,-rpath,{library}"]
    subprocess.run(command, check=True)
    return [str(peer), str(ROOT / "robots/panda.urdf")]


def seconds(command, count):
    begin = time.perf_counter()
    subprocess.run([*command, str(count)], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - begin


def nanoseconds(command, count, units):
    return (seconds(command, 2 * count) - seconds(command, count)) / (count * units) * 1e9


def instructions(command, count, units):
    def collected(repetitions):
        valgrind = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *command, str(repetitions)]
        report = subprocess.run(valgrind, check=True, capture_output=True, text=True).stderr
        return int(re.search(r"Collected : (\d+)", report).group(1))

    return (collected(2 * count) - collected(count)) / (count * units)


def processor():
    info = pathlib.Path("/proc/cpuinfo")
    found = re.search(r"model name\s*: (.*)", info.read_text()) if info.exists() else None
    return found.group(1) if found else platform.processor() or "unknown processor"


def page(rows, peer_rows, rounds):
    lines = [
        "# Performance",
        "",
        "*Written by `python3 scripts/performance.py --peer`; run it to see your machine's figures.*",
        "",
        f"Measured on: {processor()}, one core, {platform.machine()}, release profile, no target flags.",
        f"Times are medians of {rounds} rounds in which all works take turns.",
        "",
        "A step is a whole `Planner::step`: kinematics and Jacobians, task errors, least-norm solves of feedforward and",
        "feedback with the bound of the smallest singular value, joint and velocity limits, statistics, the checks that stop",
        "a lost run, and the history of `la6-wang-guo`. References are precomputed unless the line says otherwise.",
        "",
        "| work | ns | instructions |",
        "|---|--:|--:|",
    ]
    for name, text, time_taken, count in rows:
        lines.append(f"| {text} | {time_taken:.0f} | {'-' if count is None else f'{count:,.0f}'} |")
    if peer_rows:
        lines += [
            "",
            "## Beside Pinocchio",
            "",
            "Pinocchio 4.1 from PyPI with Eigen 3.4, C++ compiled by g++ -O3, static sizes, in the same run. Its step computes",
            "kinematics, Jacobian, residual, LDLT solve and history of the same formula; it watches nothing.",
            "",
            "| work | kinstep ns | Pinocchio ns | ratio | kinstep instructions | Pinocchio instructions |",
            "|---|--:|--:|--:|--:|--:|",
        ]
        own = {name: (text, time_taken, count) for name, text, time_taken, count in rows}
        for name, time_taken, count in peer_rows:
            text, ours, our_count = own[name]
            shown = ["-" if value is None else f"{value:,.0f}" for value in (our_count, count)]
            lines.append(
                f"| {text} | {ours:.0f} | {time_taken:.0f} | {time_taken / ours:.1f} | {shown[0]} | {shown[1]} |"
            )
    return "\n".join(lines)


NOTES = """
## What makes it so

- Constants between joints are folded when a chain is made: fixed joints merge, axes turn onto z, and what is left is a
  turn about x and a shift, of which right angles and zeros cost nothing (`src/robot/segment.rs`).
- Arms that move in the same way are evaluated side by side in the lanes of registers, two in a dual-arm plan, four
  otherwise; a single arm takes two lanes for itself. AVX2 is used where the machine has it (found out at run time), the base
  instructions elsewhere, with the same bits (`src/math/lanes.rs`).
- Sines and cosines of all joints are taken four at a time (`src/math/sin_cos.rs`).
- Gram matrix, factors and substitutions have static sizes and constant indices (`src/math/gram.rs`).

## What limits it

About half of a step of two arms is spent outside the vector code: combining the history (an eighth), gathering references
and handing out results, limits and statistics. Plans run together share the vector code but keep their own history,
monitors and records, and recording a sample of two arms writes 320 bytes; so whole plans gain less from lanes than steps do.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--peer", action="store_true", help="measure Pinocchio in the same run")
    parser.add_argument("--rounds", type=int, default=9, help="rounds of timing (default 9)")
    arguments = parser.parse_args()
    program, rows, peer_rows = build(), [], []
    with tempfile.TemporaryDirectory() as folder:
        peer = build_peer(folder) if arguments.peer else None
        times, peer_times = {}, {}
        for done in range(arguments.rounds):
            print(f"round {done + 1} of {arguments.rounds}", file=sys.stderr)
            for name, _, count, _, units in WORKS:
                times.setdefault(name, []).append(nanoseconds([program, name], count, units))
                if peer and name in PEER_WORKS:
                    peer_times.setdefault(name, []).append(nanoseconds([*peer, name], count, units))
        counted = shutil.which("valgrind") is not None
        if not counted:
            print("valgrind is not installed: instructions are left out", file=sys.stderr)
        for name, text, _, count, units in WORKS:
            own = instructions([program, name], count, units) if counted else None
            rows.append((name, text, statistics.median(times[name]), own))
            if name in peer_times:
                theirs = instructions([*peer, name], count, units) if counted else None
                peer_rows.append((name, statistics.median(peer_times[name]), theirs))
    target = ROOT / "docs/performance.md"
    target.write_text(page(rows, peer_rows, arguments.rounds) + "\n" + NOTES)
    print(f"wrote {target.relative_to(ROOT)}")


if __name__ == "__main__":
    main()

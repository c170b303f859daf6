#!/usr/bin/env python3
"""Slower is red: counts the instructions of calls on fixed inputs, and fails if one has become slower.

Counts are compared with those stored in docs/design/whole.md, and may be up to 5 % above them. --update stores the
counts instead. Every call runs under Callgrind, on one thread: the command `sdm map` as a whole, and the calls of
counted_calls.cpp. Profiles remain in the folder of this test in the build folder, for callgrind_annotate.
"""

import argparse
import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "docs" / "design" / "whole.md"
BEGIN, END = "<!-- instructions: written by tests/instructions/check.py --update -->\n\n", "\n<!-- end of instructions -->\n"
MOST = 1.05
SKIPPED = 77

COMMAND = "command"
COMMAND_WORDS = "`sdm map --resolution 256`, bunny (70 thousand triangles) to armadillo, all default files"
# Symbols are resolved when a program starts, which the counts of calls leave out. Pages have the same time in all runs.
ENVIRONMENT = {"PATH": os.defpath, "LC_ALL": "C", "LD_BIND_NOW": "1", "SOURCE_DATE_EPOCH": "1151712000"}


def instructions(arguments: list, profile: Path, counting: bool) -> float:
    """Millions of instructions of a program: all, or those between its requests to Callgrind."""
    profile.unlink(missing_ok=True)
    command = ["valgrind", "--tool=callgrind", "--quiet", f"--callgrind-out-file={profile}",
               f"--instr-atstart={'yes' if counting else 'no'}", *map(str, arguments)]
    done = subprocess.run(command, env=ENVIRONMENT, cwd=profile.parent, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\nended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return int(re.search(r"^totals: (\d+)", profile.read_text(), re.MULTILINE)[1]) / 1e6


def count_command(build: Path, profile: Path) -> float:
    out = profile.with_suffix(".out")
    shutil.rmtree(out, ignore_errors=True)
    meshes = build / "meshes" / "data" / "meshes"
    count = instructions([build / "cli" / "sdm", "map", meshes / "bunny.obj", meshes / "armadillo.off", "-o", out,
                          "--resolution", 256, "--threads", 1, "--transform-o1", "fit",
                          "--transform-o2", "fit,translate:0.8:0:0"], profile, counting=True)
    report = json.loads((out / "report.json").read_text())
    # The largest distance of two bodies of size 1, which are 0.8 apart.
    if not 0.5 < report["distance"]["max"] < 1.5 or len(list(out.iterdir())) < 8:
        sys.exit(f"The results of sdm map are wrong, see {out}")
    shutil.rmtree(out)
    return count


def stored_counts(text: str) -> dict:
    _, found, rest = text.partition(BEGIN)
    table, ended, _ = rest.partition(END)
    if not found or not ended:
        sys.exit(f"{TABLE} has no table between {BEGIN.strip()} and {END.strip()}")
    rows = (line.strip("|\n ").split(" | ") for line in table.splitlines()[2:])
    return {row[0]: float(row[2].replace(",", "")) for row in rows if len(row) == 3}


def with_counts(text: str, rows: list) -> str:
    before, after = text.partition(BEGIN)[0], text.partition(END)[2]
    table = "| call | what it does | million instructions |\n| --- | --- | ---: |\n"
    table += "".join(f"| {name} | {words} | {count:,.1f} |\n" for name, words, count in rows if not math.isnan(count))
    return before + BEGIN + table + END + after


def verdict(stored: float, counted: float) -> str:
    if math.isnan(stored):
        return "NOT STORED"
    if counted > MOST * stored:
        return "SLOWER"
    return "faster: lower the stored count" if counted < stored / MOST else ""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--update", action="store_true", help=f"store the counts in {TABLE.relative_to(ROOT)}")
    parser.add_argument("--build", metavar="FOLDER", type=Path, default=ROOT / "build" / "dev",
                        help="the build folder (default: build/dev)")
    parser.add_argument("calls", metavar="CALL", nargs="*", help="only these")
    args = parser.parse_args()

    # Valgrind presents the same processor everywhere, except that it has AVX2 only if the machine has.
    if not re.search(r"^flags\b.*\bavx2\b", Path("/proc/cpuinfo").read_text(), re.MULTILINE):
        print("skipped: counts are of code for AVX2, which this processor does not have")
        return SKIPPED
    folder = args.build.resolve() / "tests" / "instructions"
    program = folder / "counted_calls"
    listed = subprocess.run([program, "--list"], capture_output=True, text=True, check=True).stdout
    calls = [(COMMAND, COMMAND_WORDS), *(tuple(line.split("\t")) for line in listed.splitlines())]
    unknown = set(args.calls) - {name for name, _ in calls}
    if unknown:
        sys.exit(f"there is no call named {', '.join(sorted(unknown))}; calls: {', '.join(name for name, _ in calls)}")

    text = TABLE.read_text()
    stored = stored_counts(text)
    rows, slower = [], []
    print(f"{'million instructions':<20} {'stored':>10} {'counted':>10} {'ratio':>7}")
    for name, words in calls:
        before = stored.get(name, math.nan)
        if args.calls and name not in args.calls:
            rows.append((name, words, before))
            continue
        profile = folder / f"{name.replace(' ', '_')}.callgrind"
        counted = (count_command(args.build.resolve(), profile) if name == COMMAND
                   else instructions([program, name], profile, counting=False))
        rows.append((name, words, counted))
        said = verdict(before, counted)
        print(f"{name:<20} {before:10,.1f} {counted:10,.1f} {counted / before:7.3f}  {said}".rstrip(), flush=True)
        if said.isupper():
            slower.append(profile)

    if args.update:
        TABLE.write_text(with_counts(text, rows))
        return 0
    gone = stored.keys() - {name for name, _ in calls}
    if gone:
        print(f"\n{TABLE.relative_to(ROOT)} has counts of calls that do not exist: {', '.join(sorted(gone))}")
    if slower:
        print(f"\nMore than {MOST - 1:.0%} above the stored count. Compare what takes the instructions with the profile "
              "of a build before the change:\n" + "".join(f"  callgrind_annotate {p}\n" for p in slower)
              + "If it must be so, store the new counts by --update, and say why in the commit.")
    return 1 if slower or gone else 0


if __name__ == "__main__":
    sys.exit(main())

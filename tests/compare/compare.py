#!/usr/bin/env python3
"""Whether two builds have the same results.

    compare.py record RECORD [--sdm FILE] [--package FOLDER [--python INTERPRETER]] [--npm FOLDER]
        runs the cases of command_cases.py, python_cases.py and javascript_cases.mjs with those parts of a build that are given, and
        writes the file RECORD: exit codes, texts, and the parts of all files and values, without what differs from run to run.
        --package: the folder that contains the package sdm; by default, its interpreter is the one of the build's environment there.
        --only TEXT: the cases whose texts contain it. --keep FOLDER: keeps the files of the cases, a folder for each command line.
    compare.py BEFORE AFTER
        prints what differs between two records of one machine: for each case, and then how many cases differ at a place. Exits
        with 1 if that is more than added keys.
"""

import argparse
import json
import os
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from itertools import groupby
from pathlib import Path

from command_cases import COMMANDS
from differences import counts, of_records
from inputs import write_inputs
from normal import Normal
from parts import digest

HERE = Path(__file__).resolve().parent
# A case that takes longer has failed.
TIMEOUT = 300


def recorded_command(sdm: Path, line: str, folder: Path, inputs: Path) -> dict:
    """The results of a command line in a folder of its own."""
    folder.mkdir(parents=True)
    (folder / "in").symlink_to(inputs)
    normal = Normal(folder, {str(inputs): "in", str(sdm): "sdm"})
    codes, out, err = [], "", ""
    for step in line.split(" ; "):
        try:
            ended = subprocess.run([sdm, *shlex.split(step)], cwd=folder, capture_output=True, text=True, timeout=TIMEOUT, check=False)
        except subprocess.TimeoutExpired:
            codes.append(f"more than {TIMEOUT} s")
            break
        codes.append(ended.returncode)
        out, err = out + ended.stdout, err + ended.stderr
    (folder / "in").unlink()
    return {"exit_codes": codes, "stdout": normal.output(out), "stderr": normal.output(err), "files": normal.files()}


def recorded_commands(sdm: Path, only: str, folder: Path, inputs: Path) -> dict:
    lines = [line for line in COMMANDS if only in line]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        records = pool.map(lambda k: recorded_command(sdm, lines[k], folder / f"{COMMANDS.index(lines[k]):03}", inputs), range(len(lines)))
        return dict(zip(lines, records))


def recorded_calls(program: list, variables: dict, only: str, folder: Path, inputs: Path) -> dict:
    """The results of the calls of a package: the program prints a line for each, its name and its value in JSON."""
    folder.mkdir(parents=True)
    normal = Normal(folder, {str(inputs): "in", **{path: "package" for path in variables.values() if "/" in path}})
    ended = subprocess.run([*program, str(inputs), only], cwd=folder, env=os.environ | variables, stdout=subprocess.PIPE, text=True,
                           timeout=TIMEOUT, check=False)
    found = {name: normal.value(value) for name, value in map(json.loads, ended.stdout.splitlines())}
    if ended.returncode != 0:  # a crash, after the last of these
        found["exit code"] = ended.returncode
        print(f"{program[-1]} ended with {ended.returncode}", file=sys.stderr)
    return found


def record(options: argparse.Namespace) -> None:
    with tempfile.TemporaryDirectory(prefix="sdm-compare-") as made:
        folder, inputs = Path(options.keep or made).resolve(), Path(made) / "in"
        write_inputs(inputs)

        def checksums() -> dict:
            return {str(p.relative_to(inputs)): digest(p.read_bytes()) for p in sorted(inputs.rglob("*")) if p.is_file()}

        found: dict = {"inputs": checksums()}
        if options.sdm:
            found["command"] = recorded_commands(options.sdm.resolve(), options.only, folder / "command", inputs)
        if options.package:
            python = options.python or options.package / "environment/bin/python"
            program = [str(python.absolute()), str(HERE / "python_calls.py")]
            variables = {"PYTHONPATH": str(options.package.resolve()), "PYTHONDONTWRITEBYTECODE": "1"}
            found["python"] = recorded_calls(program, variables, options.only, folder / "python", inputs)
        if options.npm:
            program = ["node", str(HERE / "javascript_calls.mjs")]
            found["javascript"] = recorded_calls(program, {"SDM_PACKAGE": str(options.npm.resolve())}, options.only, folder / "javascript", inputs)
        if checksums() != found["inputs"]:
            sys.exit("a case has changed its inputs")
    options.record.parent.mkdir(parents=True, exist_ok=True)
    options.record.write_text(json.dumps(found, indent=1), encoding="utf-8")
    print(f"{options.record}: the cases of " + ", ".join(f"{part} ({len(found[part])})" for part in found if part != "inputs"))


def compare(options: argparse.Namespace) -> None:
    before, after = (json.loads(path.read_text(encoding="utf-8")) for path in (options.before, options.after))
    found = of_records(before, after)
    for case, differences in groupby(found, lambda d: d.case):
        print(case)
        print("\n".join(map(str, differences)))
    if found:
        print("cases that differ at a place:")
        print("\n".join(f"{count:5}  {what}: {where}" for (what, where), count in counts(found)))
    cases = sum(len(before[part]) for part in before if part != "inputs")
    differing = {d.case for d in found if not d.harmless}
    print(f"{len(differing)} of {cases} cases differ, and {len({d.case for d in found} - differing)} only by added keys")
    sys.exit(1 if differing else 0)


def main() -> None:
    if sys.argv[1:2] == ["record"]:
        parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("record", type=Path)
        parser.add_argument("--sdm", type=Path)
        parser.add_argument("--python", type=Path)
        parser.add_argument("--package", type=Path)
        parser.add_argument("--npm", type=Path)
        parser.add_argument("--only", default="")
        parser.add_argument("--keep")
        record(parser.parse_args(sys.argv[2:]))
    else:
        parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("before", type=Path)
        parser.add_argument("after", type=Path)
        compare(parser.parse_args())


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Runs the commands of a page of the documentation, in order and in one folder.

PAGE FOLDER_OF_SDM FOLDER: every line of a block ```sh is one command; "# exits with N" at its end is the exit code that
it must have, otherwise 0. A block ```text after it has lines that must be printed, in this order: words alike, numbers
to 2 % or 1e-6 of their size.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")


def same_line(shown: str, printed: str) -> bool:
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", printed).split():
        return False
    pairs = zip(map(float, NUMBER.findall(shown)), map(float, NUMBER.findall(printed)))
    return all(abs(a - b) <= 0.02 * max(abs(a), abs(b)) + 1e-6 for a, b in pairs)


def check_output(shown: str, printed: str) -> None:
    lines = iter(printed.splitlines())
    for line in shown.splitlines():
        if not any(same_line(line, other) for other in lines):
            sys.exit(f"The page shows a line that was not printed there:\n{line}\n\nPrinted:\n{printed}")


def run(block: str, folder: Path) -> str:
    printed = ""
    for line in block.splitlines():
        expected = re.search(r"# exits with (\d+)$", line)
        done = subprocess.run(["bash", "-euo", "pipefail", "-c", line], cwd=folder, capture_output=True, text=True)
        if done.returncode != (int(expected[1]) if expected else 0):
            sys.exit(f"{line}\nended with {done.returncode}:\n{done.stdout}{done.stderr}")
        printed += done.stdout
    return printed


def main() -> None:
    page, sdm, folder = (Path(argument).resolve() for argument in sys.argv[1:])
    os.environ["PATH"] = f"{sdm}{os.pathsep}{os.environ['PATH']}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    blocks = re.findall(r"^```(\w+)\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)
    if not any(kind == "sh" for kind, _ in blocks):
        sys.exit(f"{page} has no commands")
    printed = ""
    for kind, text in blocks:
        if kind == "sh":
            printed = run(text, folder)
        elif kind == "text":
            check_output(text, printed)
    shutil.rmtree(folder)


main()

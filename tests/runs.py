#!/usr/bin/env python3
"""The last runs of what does not run each time: the table "Last runs" of docs/reliability.md.

    runs.py where-changed PART COMMAND...   runs the command if the inputs of the part differ from those of its last run, or if
                                            SDM_UNCHANGED_TOO is set; otherwise exits with 77
    runs.py passed PART                     notes that the part has just passed: date, commit, checksum of its inputs

Parts without inputs in INPUTS are those of tests/long, which run when someone starts them.
"""

import datetime
import glob
import hashlib
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/reliability.md"
SKIPPED = 77

# What a part depends on beside the code that other tests run in each check.
BUILD = ["CMakeLists.txt", "VERSION", "cmake/**", "src/CMakeLists.txt", "src/*/CMakeLists.txt", "cli/CMakeLists.txt", "scenes/CMakeLists.txt",
         "debian-packages.txt", "include/**"]
INPUTS = {
    "packages": BUILD + ["packaging/**", "examples/**", "tests/package/**"],
    "pip": BUILD + ["pyproject.toml", "python/*.*", "python/sdm/**", "python/src/**", "python/tests/pip_install", "report/*.*"],
    "site": ["docs/**", "include/**", "python/sdm/**", "python/src/**", "python/examples/**", "cli/**", "README.md", "CHANGELOG.md",
             "CONTRIBUTING.md", "report/package-lock.json", "debian-packages.txt"],
}


def checksum(part):
    paths = sorted({path for pattern in INPUTS[part] for path in glob.glob(pattern, root_dir=ROOT, recursive=True)})
    digest = hashlib.sha256()
    for path in paths:
        if (ROOT / path).is_file() and "__pycache__" not in path:
            content = (ROOT / path).read_bytes()
            if ROOT / path == PAGE:  # which has the checksums themselves
                content = re.sub(rb"(?m)^\| `tests/long [^|]*\|.*$", b"", content)
            digest.update(f"{path} {len(content)}\n".encode() + content)
    return digest.hexdigest()[:16]


def row(part):
    """The expression that finds the row of a part: its name, then the cells date, commit and inputs."""
    return re.compile(rf"(?m)^\| `tests/long {re.escape(part)}` \| ([^|\n]*) \| ([^|\n]*) \| ([^|\n]*) \|$")


def main():
    action, part = sys.argv[1:3]
    text = PAGE.read_text(encoding="utf-8")
    last = row(part).search(text)
    if last is None:
        sys.exit(f"{PAGE.relative_to(ROOT)} has no row of `tests/long {part}`")
    if action == "where-changed":
        if last.group(3) == checksum(part) and "SDM_UNCHANGED_TOO" not in os.environ:
            print(f"its inputs are those of the run of {last.group(1)}, at commit {last.group(2)}")
            sys.exit(SKIPPED)
        os.execvp(sys.argv[3], sys.argv[3:])
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short=8", "HEAD"], capture_output=True, text=True, check=True)
    inputs = checksum(part) if part in INPUTS else ""
    cells = f"| `tests/long {part}` | {datetime.date.today()} | {commit.stdout.strip()} | {inputs} |"
    PAGE.write_text(text[:last.start()] + cells + text[last.end():], encoding="utf-8")


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Whether docs/design/house.md is right about where things are.

    check_walks.py SOURCE_DIR

The files that it names exist; each file of the path of a map contains the call that leads to the next one, and occurs once; and an
option and a number of the statistics are named in no more files than their walks say.
"""

import re
import sys
from pathlib import Path

ROOT = Path(sys.argv[1])
HAND_WRITTEN = ("bench", "cli", "docs", "examples", "include", "js", "python", "report", "research", "scenes", "src", "tests")
MOST_FILES = 6


def section(page: str, begin: str, end: str) -> str:
    return page[page.index(begin) : page.index(end, page.index(begin))]


def path_of_a_map(page: str) -> list[str]:
    rows = re.findall(r"^\| `([^`]+)` \| (?:`([^`]+)`)?", section(page, "The path of a map", "\n## "), re.MULTILINE)
    files = [file for file, _ in rows]
    faults = [f"{file} occurs twice" for file in {f for f in files if files.count(f) > 1}]
    for file, call in rows:
        if call not in (ROOT / file).read_text():
            faults.append(f"{file} does not contain {call}")
    return faults if len(rows) > 10 else [*faults, f"the path of a map has {len(rows)} files"]


def named_files(page: str) -> list[str]:
    """Files in code spans of the tables of concepts and measures and of the walks, relative to the root, to src/ or to include/."""
    text = "".join(section(page, begin, "\n## ") for begin in ("## One of each", "## Adding a measure", "## Walks"))
    faults = []
    for name in re.findall(r"`([\w./-]+/[\w.-]+\.(?:h|cpp|ts|py|md|txt|html))`", text):
        if not any((ROOT / folder / name).exists() for folder in ("", "src", "include", "tests")):
            faults.append(f"there is no {name}")
    return faults


def files_that_name(name: str) -> list[str]:
    """The hand-written files that contain it as any door spells it."""
    words = {name, name.replace("_", "-"), re.sub("_(.)", lambda match: match[1].upper(), name)}
    pattern = re.compile("|".join(rf"(?<![\w-]){re.escape(word)}(?![\w-])" for word in words))
    found = [path for folder in HAND_WRITTEN for path in sorted((ROOT / folder).rglob("*"))
             if path.suffix in (".h", ".cpp", ".py", ".ts", ".mjs", ".cjs", ".md", ".txt", ".json") and pattern.search(path.read_text(errors="replace"))]  # fmt: skip
    # This page and this program are about it, not of it.
    return [str(path.relative_to(ROOT)) for path in found if path.name not in ("house.md", "check_walks.py") and "node_modules" not in path.parts]


def main() -> None:
    page = (ROOT / "docs/design/house.md").read_text()
    faults = path_of_a_map(page) + named_files(page)
    for name in ("texel_size", "p999_abs"):
        files = files_that_name(name)
        if not 3 <= len(files) <= MOST_FILES:
            faults.append(f"{name} is named in {len(files)} files: {', '.join(files)}")
    if faults:
        sys.exit("docs/design/house.md: " + "\n".join(faults))


main()

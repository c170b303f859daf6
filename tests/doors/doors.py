#!/usr/bin/env python3
"""Whether C++, the command, Python and JavaScript give the same results, or refuse by the same sentence, for random options of a map.

    doors.py SDM MAP_OPTIONS [COUNT]    where the package sdm can be imported; SDM_PACKAGE: the folder of the package for npm

Prints each difference, and exits with 1 if there is one.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import sdm
from option_sets import ALLOWED, option_sets

HERE = Path(__file__).resolve().parent
SEED = 55
USUAL = {"resolution": "64"}


def camel(name: str) -> str:
    return re.sub(r"_(.)", lambda match: match[1].upper(), name)


def meshes(folder: Path) -> list[Path]:
    """A tetrahedron, of which no two edges are equal, so that rounding decides nothing of its atlas, and a bent square, which is open."""
    tetrahedron = "v .05 .01 .03\nv 1.2 .1 0\nv .2 .9 .1\nv .3 .25 1.4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    square = "v -1 -1 .2\nv 2 -1 .3\nv 2 2 .2\nv -1 2 .5\nf 1 2 3\nf 1 3 4\n"
    files = [folder / "on.obj", folder / "open.obj"]
    for file, text in zip(files, (tetrahedron, square)):
        file.write_text(text)
    return files


def numbers(report: dict) -> list:
    d = report["distance"]
    return [report["sign"]["method"], report["texels_with_value"], *(d[name] for name in ("min", "max", "mean", "rms"))]


def by_command(command: str, files: list[Path], options: dict[str, str], folder: Path) -> "list | str":
    arguments = []
    for name, value in options.items():
        dashed = "--" + name.replace("_", "-")
        arguments.append(dashed if value == "true" else f"{dashed}={value}")
    run = subprocess.run([command, "map", *files, "-o", folder, "--write", "csv", "--json", "--quiet", *arguments], capture_output=True, text=True)
    if run.returncode in (0, 3, 4, 5):
        return numbers(json.loads(run.stdout))
    return run.stderr.splitlines()[0].removeprefix("sdm: error: ")


def value(text: str) -> object:
    if text == "true":
        return True
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def by_python(files: list[Path], options: dict[str, str]) -> "list | str":
    try:
        return numbers(sdm.map(*files, **{name: value(text) for name, text in options.items()}).report())
    except (sdm.Error, TypeError) as error:
        return str(error)


def by_lines(program: list, files: list[Path], sets: list[dict[str, str]]) -> list:
    """The results of a program that takes options by lines."""
    lines = "".join(" ".join(f"{name}={text}" for name, text in options.items()) + "\n" for options in sets)
    run = subprocess.run([*program, *files], input=lines, capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{program[0]}: {run.stderr}")
    results = []
    for line in run.stdout.splitlines():
        first, *rest = line.split()
        results.append(line.removeprefix("error ") if first == "error" else [first, *map(float, rest)])
    return results


def plain(sentence: str) -> str:
    """Without what differs by door: the spelling of names, quotes around values, and which option of the door is a remedy."""
    sentence = re.sub(r" \(--[\w ./-]+\)$", "", sentence)
    for name in ALLOWED:
        for text in {"--" + name.replace("_", "-"), camel(name)} - {name}:
            sentence = re.sub(re.escape(text) + r"(?![\w-])", name, sentence)
    sentence = re.sub(r"\bauto,", "automatic,", sentence).replace("'", "").replace('"', "").replace("NaN", "nan")
    sentence = re.sub(r"(?<=unknown option )\S+?(?=;|$)", lambda match: re.sub(r"[-_]", "", match[0]).lower(), sentence)
    return sentence.removeprefix("map() has an ")


def same(a: "list | str", b: "list | str") -> bool:
    if isinstance(a, str) or isinstance(b, str):
        return isinstance(a, str) and isinstance(b, str) and plain(a) == plain(b)
    return a[:2] == b[:2] and all(x == y or abs(x - y) <= 1e-6 for x, y in zip(map(number, a[2:]), map(number, b[2:])))


def number(value: "float | None") -> float:
    return 0.0 if value is None or value != value else value


def main() -> None:
    command, program = sys.argv[1:3]
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 500
    sets = [USUAL | options for options in option_sets(count, SEED)]
    with tempfile.TemporaryDirectory() as scratch:
        files = meshes(Path(scratch))
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            commands = list(pool.map(lambda k: by_command(command, files, sets[k], Path(scratch) / str(k)), range(count)))
        doors = {"the command": commands, "Python": [by_python(files, options) for options in sets]}
        doors["C++"] = by_lines([program], files, sets)
        doors["JavaScript"] = by_lines(["node", HERE / "map_options.mjs"], files, sets)
    differences = 0
    for k, options in enumerate(sets):
        for door, results in doors.items():
            if not same(results[k], commands[k]):
                differences += 1
                print(f"{options}\n  the command: {commands[k]}\n  {door}: {results[k]}")
    refused = sum(isinstance(result, str) for result in commands)
    print(f"{count} sets of options, of which {refused} are refused: {differences} differences between the command and other doors")
    if differences or not count // 4 < refused < count:
        sys.exit(1)


main()

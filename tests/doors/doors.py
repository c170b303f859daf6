#!/usr/bin/env python3
"""Whether C++, the command, Python and JavaScript give the same results, or refuse by the same sentence, for random options.

    doors.py SDM CALL_OPTIONS [COUNT]    where the package sdm can be imported; SDM_PACKAGE: the folder of the package for npm

Prints each difference, and exits with 1 if there is one.
"""

import json
import math
import os
import re
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import sdm
from option_sets import CALLS, Options, option_sets

HERE = Path(__file__).resolve().parent
SEED = 55
SIGNS = ["automatic", "none", "exact", "winding", "side"]
Result = "list[float] | str"


def camel(name: str) -> str:
    return re.sub(r"_(.)", lambda match: match[1].upper(), name)


def ball(size: int, radius: float) -> str:
    """A closed mesh of 8 · size² triangles, no two edges of which are equal, as OBJ."""
    index: dict[tuple[int, ...], int] = {}
    faces = []
    for signs in ((a, b, c) for a in (1, -1) for b in (1, -1) for c in (1, -1)):
        corner = lambda i, j: tuple(s * n for s, n in zip(signs, (i, j, size - i - j)))  # noqa: E731
        for i in range(size):
            for j in range(size - i):
                cells = [[(i, j), (i + 1, j), (i, j + 1)]]
                if i + j < size - 1:
                    cells.append([(i + 1, j), (i + 1, j + 1), (i, j + 1)])
                for cell in cells:
                    numbers = [index.setdefault(corner(*at), len(index) + 1) for at in cell]
                    faces.append(numbers if math.prod(signs) > 0 else numbers[::-1])
    lines = []
    for n, point in enumerate(index):
        scale = radius * (1 + 0.02 * math.sin(7 * n)) / math.hypot(*point)
        lines.append("v " + " ".join(f"{scale * x * (1 + 0.1 * k):.6f}" for k, x in enumerate(point)))
    return "\n".join(lines + ["f " + " ".join(map(str, face)) for face in faces]) + "\n"


def make_files(folder: Path) -> dict[str, list[Path]]:
    """The files of each call. A tetrahedron, of which no two edges are equal, so that rounding decides nothing of its atlas, and a bent
    square, which is open; balls; and points with normals."""
    texts = {
        "on.obj": "v .05 .01 .03\nv 1.2 .1 0\nv .2 .9 .1\nv .3 .25 1.4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
        "open.obj": "v -1 -1 .2\nv 2 -1 .3\nv 2 2 .2\nv -1 2 .5\nf 1 2 3\nf 1 3 4\n",
        "ball.obj": ball(4, 1),
        "larger.obj": ball(2, 1.1),
        "moved.obj": re.sub(r"^v (\S+)", lambda match: f"v {float(match[1]) + 1.5}", ball(3, 1), flags=re.MULTILINE),
        "cloud.xyz": "x y z nx ny nz\n" + "".join(f"{.3 * k} {.1 * k * k} {.2 + .05 * k} {.1 * k} 0 {1 - .1 * k}\n" for k in range(9)),
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    of_calls = {
        "map": ["on.obj", "open.obj"],
        "self": ["ball.obj"],
        "thickness": ["ball.obj"],
        "points": ["cloud.xyz", "open.obj"],
        "align": ["ball.obj", "moved.obj"],
        "simplify": ["ball.obj"],
        "bake": ["ball.obj", "larger.obj"],
        "bodies": ["ball.obj", "moved.obj", "on.obj"],
    }
    return {call: [folder / name for name in names] for call, names in of_calls.items()}


def distances(report: dict) -> list:
    return [report["distance"][name] for name in ("min", "max", "mean", "rms")]


def texel_distances(report: dict) -> list:
    return [report["texels_with_value"], *distances(report)]


def aligned(report: dict) -> list:
    alignment = report["alignment"]
    return [alignment["samples"], alignment["after"]["rms"], alignment["after"]["trimmed_rms"]]


def simplified(report: dict) -> list:
    return [number for level in report["levels"] for number in (level["triangles"], *(level["deviation"][end] for end in ("lower", "upper")))]


def baked(report: dict) -> list:
    counts = [report["texels"][kind] if report["atlas"]["samples"] == 1 else 0 for kind in ("closest", "facing", "ray")]
    return [report["atlas"]["resolution"], *counts]


def bodies(report: dict) -> list:
    pairs = report["pairs"]
    depths = [pair["penetration_depth"] for pair in pairs if pair["colliding"]["value"]]
    return [*(pair["separation"]["value"] for pair in pairs), *(depth[end] for depth in depths for end in ("lower", "upper"))]


# Of each call: the subcommand, what the command is also given, with DIR for a folder, the numbers of its report, and its own names.
COMMANDS = {
    "map": ("map", ["-o", "DIR", "--write", "csv"], lambda r: [SIGNS.index(r["sign"]["method"]), *texel_distances(r)], {}),
    "self": ("self", ["-o", "DIR", "--write", "csv"], texel_distances, {}),
    "thickness": ("thickness", ["-o", "DIR", "--write", "csv"], texel_distances, {}),
    "points": ("points", ["-o", "DIR", "--write", "ply"], distances, {}),
    "align": ("map", ["-o", "DIR", "--write", "csv", "--resolution=16", "--align"], aligned, {"free": "align_free", "about": "align_about"}),
    "simplify": ("simplify", ["-o", "DIR.ply"], simplified, {}),
    "bake": ("bake", ["-o", "DIR", "--no-page"], baked, {}),
    "bodies": ("bodies", [], bodies, {}),
}


def by_command(command: str, call: str, files: list[Path], options: Options, folder: Path) -> Result:
    subcommand, others, numbers, names = COMMANDS[call]
    if "about" in options:
        options = {"free": "x,y,z,rx,ry,rz"} | options  # without effect unless it is given, which the command says
    arguments = [other.replace("DIR", str(folder)) for other in others]
    for name, value in options.items():
        dashed = "--" + names.get(name, ("align_" if call == "align" else "") + name).replace("_", "-")
        arguments.append(dashed if value == "true" else f"{dashed}={value}")
    run = subprocess.run([command, subcommand, *files, "--json", "--quiet", *arguments], capture_output=True, text=True)
    if run.returncode in (0, 3, 4, 5):
        return numbers(json.loads(run.stdout))
    return run.stderr.splitlines()[0].removeprefix("sdm: error: ")


def value(name: str, text: str) -> object:
    if text == "true":
        return True
    if name in ("about", "along") and "," in text:
        return [float(x) for x in text.split(",")]
    if name == "channels":
        return text.split(",")
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def of_statistics(s: sdm.DistanceStatistics) -> list:
    return [s.texels, s.min, s.max, s.mean, s.rms]


def map_numbers(files: list[Path], options: dict) -> list:
    result = sdm.map(*files, **options)
    return [SIGNS.index(result.sign), *of_statistics(result.statistics())]


def points_numbers(files: list[Path], options: dict) -> list:
    return of_statistics(sdm.measure_points(*files, files[0].with_suffix(".ply"), **options).statistics())[1:]


def align_numbers(files: list[Path], options: dict) -> list:
    found = sdm.align(*files, **options)
    return [found.samples, found.rms, found.trimmed_rms]


def simplify_numbers(files: list[Path], options: dict) -> list:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        levels = sdm.simplify(files[0], lods=options.pop("lods", 0), **options)
    return [number for mesh, deviation in levels for number in (len(mesh.faces), deviation.lower, deviation.upper)]


def bake_numbers(files: list[Path], options: dict) -> list:
    result = sdm.bake(*files, **options)
    kinds = [sdm.MatchKind.CLOSEST, sdm.MatchKind.FACING, sdm.MatchKind.RAY]
    single = options.get("samples", 1) == 1
    return [result.kind.shape[1], *(int(np.count_nonzero(result.kind == int(kind))) if single else 0 for kind in kinds)]


def bodies_numbers(files: list[Path], options: dict) -> list:
    query = sdm.MultiBodyQuery([sdm.Mesh(file) for file in files], **options)
    return [*query.separations().separation, *query.penetration_depths().penetration_depth_bounds.ravel()]


PYTHON = {
    "map": map_numbers,
    "self": lambda files, options: of_statistics(sdm.self_map(*files, **options).statistics()),
    "thickness": lambda files, options: of_statistics(sdm.thickness(*files, **options).statistics()),
    "points": points_numbers,
    "align": align_numbers,
    "simplify": simplify_numbers,
    "bake": bake_numbers,
    "bodies": bodies_numbers,
}


def by_python(call: str, files: list[Path], options: Options) -> Result:
    try:
        return PYTHON[call](files, {name: value(name, text) for name, text in options.items()})
    except (sdm.Error, TypeError) as error:
        return str(error)


# The calls that JavaScript has.
OF_JAVASCRIPT = ["map", "self", "thickness", "bodies"]


def by_lines(program: list, lines: list[str]) -> list[Result]:
    """The results of a program that takes options by lines."""
    run = subprocess.run(program, input="".join(line + "\n" for line in lines), capture_output=True, text=True)
    if run.returncode != 0:
        sys.exit(f"{program[0]}: {run.stderr}")
    results: list[Result] = []
    for line in run.stdout.splitlines():
        words = line.split()
        numbers = lambda: [SIGNS.index(word) if word in SIGNS else float(word) for word in words]  # noqa: E731
        results.append(line.removeprefix("error ") if words[:1] == ["error"] else numbers())
    return results


def words(options: Options) -> str:
    return " ".join(f"{name}={text}" for name, text in options.items())


def plain(sentence: str, call: str) -> str:
    """Without what differs by door: the spelling of names, quotes around values, and which option of the door is a remedy."""
    sentence = re.sub(r" \(--[\w ./-]+\)$", "", sentence).replace("--align-", "--")
    for name in {*CALLS[call].allowed, *CALLS[call].refused}:
        for text in {"--" + name.replace("_", "-"), camel(name)} - {name}:
            sentence = re.sub(re.escape(text) + r"(?![\w-])", name, sentence)
    # Words that the command abbreviates, or has besides, and sequences.
    sentence = re.sub(r"\bauto,", "automatic,", sentence).replace(", or a share such as 5%", "")
    sentence = re.sub(r"(?<=must be )automatic, (?=(uv|charts|closest)\b)", "", sentence)
    sentence = re.sub(r"(?<= is )\[(.*?)\](?=: it must)", lambda match: match[1].replace(", ", ","), sentence)
    sentence = sentence.replace("'", "").replace('"', "").replace("NaN", "nan")
    sentence = re.sub(r"(?<=unknown option )\S+?(?=;|$)", lambda match: re.sub(r"[-_]", "", match[0]).lower(), sentence)
    sentence = re.sub(r"(?<=about is |along is )[^:]*,[^:]*", lambda match: ",".join(str(float(x)) for x in match[0].split(",")), sentence)
    return re.sub(r"^\w+\(\) has an ", "", sentence)


def number(x: "float | None") -> float:
    return math.nan if x is None else float(x)


# Another compiler rounds the atlases of balls, of radius 1, in another way: the centre of a texel on an edge has another face, or none.
ROUNDED_ATLAS = 1e-2


def same(call: str, a: Result, b: Result, tolerance: float = 1e-6) -> bool:
    if isinstance(a, str) or isinstance(b, str):
        return isinstance(a, str) and isinstance(b, str) and plain(a, call) == plain(b, call)
    near = lambda x, y: abs(x - y) <= tolerance * max(1, abs(y))  # noqa: E731
    return len(a) == len(b) and all(x == y or (x != x and y != y) or near(x, y) for x, y in zip(map(number, a), map(number, b)))


def of_points(call: str, numbers: Result) -> Result:
    """The statistics of C++ without their count, which the command states elsewhere."""
    return numbers[1:] if call == "points" and not isinstance(numbers, str) else numbers


def main() -> None:
    command, program = sys.argv[1:3]
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 500
    sets = option_sets(count, SEED)
    with tempfile.TemporaryDirectory() as scratch:
        files = make_files(Path(scratch))
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            run = lambda k: by_command(command, sets[k][0], files[sets[k][0]], sets[k][1], Path(scratch) / str(k))  # noqa: E731
            commands = list(pool.map(run, range(count)))
        doors = {"Python": [by_python(call, files[call], options) for call, options in sets]}
        lines = [" ".join([call, words(options), "--", *map(str, files[call])]) for call, options in sets]
        doors["C++"] = [of_points(call, result) for (call, _), result in zip(sets, by_lines([program], lines))]
        in_node = [k for k in range(count) if sets[k][0] in OF_JAVASCRIPT]
        by_node = by_lines(["node", HERE / "call_options.mjs"], [lines[k] for k in in_node])
        doors["JavaScript"] = dict(zip(in_node, by_node))
    differences = 0
    for k, (call, options) in enumerate(sets):
        for door, results in doors.items():
            if door == "JavaScript" and call not in OF_JAVASCRIPT:
                continue
            tolerance = ROUNDED_ATLAS if door == "JavaScript" and call in ("self", "thickness") else 1e-6
            if not same(call, results[k], commands[k], tolerance):
                differences += 1
                print(f"{call} {options}\n  the command: {commands[k]}\n  {door}: {results[k]}")
    refused = Counter(call for (call, _), result in zip(sets, commands) if isinstance(result, str))
    of_call = Counter(call for call, _ in sets)
    print(", ".join(f"{call}: {refused[call]} of {of_call[call]} refused" for call in of_call))
    print(f"{count} sets of options, of which {refused.total()} are refused: {differences} differences between the command and other doors")
    if differences or not all(of_call[call] // 4 < refused[call] < of_call[call] for call in of_call):
        sys.exit(1)


main()

#!/usr/bin/env python3
"""Do the tests find faults? `tests/long mutants` runs this program.

    mutants.py insert SOURCE BUILD [--seed N]   chooses faults in a copy of the sources and inserts all of them
    mutants.py run SOURCE BUILD                 runs the test programs once for each fault, prints a table

A fault is one changed expression or statement, as someone could have mistyped it. All are compiled into one build; the variable
SDM_MUTANT=K in the environment of a program selects the K-th of them, so that nothing is built per fault. BUILD, which
`insert` needs for the compile commands of single files, is configured from SOURCE.
"""

import argparse
import concurrent.futures
import glob
import json
import os
import random
import re
import shlex
import signal
import subprocess
import sys
import time

# What is tested together: the sources of a part, the test programs that are run for it.
PARTS = {
    "closest points": (["src/closest/*.cpp", "src/closest/*/*.cpp"], ["engine_test"]),
    "inside": (["src/inside/*.cpp", "src/inside/*/*.cpp", "src/mesh/crossings/*.cpp"],
               ["inside_test", "engine_test"]),
    "rays": (["src/rays/*.cpp"], ["rays_test"]),
    "hausdorff": (["src/certify/hausdorff/*.cpp"], ["hausdorff_test"]),
    "metrics": (["src/certify/metrics/*.cpp"], ["metrics_test"]),
    "tolerance": (["src/certify/tolerance/*.cpp", "src/summary/verdict/*.cpp"],
                  ["tolerance_proof_test", "engine_test", "cli_test"]),
    "depth": (["src/certify/depth/*.cpp", "src/bodies/shape/*.cpp"], ["proximity_test"]),
    "translations": (["src/bodies/separate/*.cpp", "src/bodies/convex/*.cpp"], ["proximity_test"]),
    "pairs": (["src/bodies/pairs/*.cpp", "src/bodies/motion/*.cpp"], ["proximity_test"]),
    "contacts": (["src/bodies/contacts/*.cpp", "src/bodies/many/*.cpp"], ["proximity_test"]),
    "self": (["src/map/self/*.cpp", "src/map/thickness/*.cpp"], ["thickness_test", "proximity_test"]),
    "map": (["src/map/*.cpp", "src/map/*/*.cpp"], ["engine_test", "along_test", "cli_test"]),
    "simplify": (["src/simplify/*.cpp"], ["simplify_test"]),
    "registration": (["src/registration/*.cpp"], ["registration_test", "cli_test"]),
    "baking": (["src/baking/*.cpp", "src/baking/geometry/*.cpp"], ["baking_test", "baked_geometry_test"]),
    "volume": (["src/volume/*.cpp"], ["volume_test"]),
    "atlas": (["src/atlas/*.cpp", "src/atlas/*/*.cpp", "src/surface/sampling_bound/*.cpp"], ["atlas_test", "surface_test"]),
    "edit": (["src/mesh/*.cpp", "src/sites/*.cpp", "src/surface/*.cpp", "src/tree/*.cpp"],
             ["memory_test", "edit_test", "sites_test", "surface_test"]),
    "files": (["src/io/mesh/*.cpp", "src/io/mesh/*/*.cpp", "src/io/points/*.cpp", "src/io/file/*.cpp"],
              ["io_test", "cli_test"]),
    "pages": (["src/io/page/*/*.cpp"], ["report_test"]),
    "command": (["cli/*.cpp"], ["cli_test", "report_test"]),
}

NAME = r"[A-Za-z_]\w*"
OPERAND = rf"(?:{NAME}(?:(?:\.|->|::){NAME}|\([^()]*\)|\[[^\[\]]*\])*|\d[\d.e]*)"
BEFORE = r"(?:(?<=\()|(?<=&& )|(?<=\|\| )|(?<=return )|(?<= = )|(?<=!\())"
AFTER = r"(?=\)|;| &&| \|\||\s\?)"
SYMMETRIC = {"min", "max", "dot", "distance", "swap", "hypot", "abs", "pow", "sqrt", "size", "make_pair"}


def flipped(line):
    if "for (" in line:
        return
    for m in re.finditer(rf"{BEFORE}({OPERAND}) (<|<=|>|>=) ({OPERAND}){AFTER}", line):
        a, op, b = m.groups()
        other = op.replace("<", "#").replace(">", "<").replace("#", ">")
        yield m.span(), f"{a} {op} {b}", f"{a} {other} {b}"


def off_by_one(line):
    for m in re.finditer(r"(?<=[\w)\]] [+-] )1(?=[)\];,])", line):
        yield m.span(), "1", "2"


def dropped_bound(line):
    for m in re.finditer(rf"std::(?:min|max)\(({OPERAND}), ({OPERAND})\)", line):
        yield m.span(), m.group(0), m.group(1)


def swapped_arguments(line):
    for m in re.finditer(rf"(?:(?<=return )|(?<= = )|(?<=\())({NAME}(?:::{NAME})*)\(({OPERAND}), ({OPERAND})\)", line):
        name, a, b = m.groups()
        if name.split("::")[-1] not in SYMMETRIC | {"if", "for", "while"} and a != b:
            yield m.span(), m.group(0), f"{name}({b}, {a})"


def past_the_end(line):
    for m in re.finditer(rf"(?<=for \(std::size_t )({NAME}) = (\w+); \1 < ({NAME}[\w.>()-]*\.size\(\));", line):
        i, first, size = m.groups()
        yield m.span(), m.group(0), f"{i} = {first}; {i} < {size} + 1;"


def unprotected(line):
    """Room that is reserved before a change, so that the change cannot fail half-way, and what undoes one."""
    for m in re.finditer(r"^\s*((?:\w+::)?reserve_for\(.*\);|\w+\.restore\(.*\);)", line):
        yield m.span(1), m.group(1), ";"


KINDS = {
    "flipped comparison": flipped,
    "off by one": off_by_one,
    "dropped bound": dropped_bound,
    "swapped arguments": swapped_arguments,
    "read past the end": past_the_end,
    "memory after a failed allocation": unprotected,
}

# Faults that may read or write what they should not, which sanitizers find. Others change values only.
MISREAD = {"off by one", "read past the end", "memory after a failed allocation"}

HEADER = """#pragma once
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wunused"
#pragma GCC diagnostic ignored "-Wtype-limits"
#include <cstdlib>
inline const int sdm_mutant = [] {
  const char* const text = std::getenv("SDM_MUTANT");
  return text ? std::atoi(text) : 0;
}();
"""


def mutated(line, span, before, after, kind, number):
    """The line with both variants, of which the variable in the environment selects one."""
    chosen = f"sdm_mutant == {number}"
    if kind == "memory after a failed allocation":
        text = f"if (sdm_mutant != {number}) {before}"
    elif kind == "read past the end":
        text = after.replace("() + 1;", f"() + ({chosen} ? 1 : 0);")
    else:
        text = f"({chosen} ? {after} : {before})"
    return line[:span[0]] + text + line[span[1]:]


def candidates(source):
    """All faults, by kind and part."""
    found = {kind: {} for kind in KINDS}
    for part, (patterns, _) in PARTS.items():
        for path in sorted({p for pattern in patterns for p in glob.glob(pattern, root_dir=source)}):
            with open(os.path.join(source, path), encoding="utf-8") as file:
                lines = file.read().split("\n")
            for number, line in enumerate(lines):
                if re.match(r"\s*(//|#|static_assert|constexpr|template|case |\*|///)", line) or "constexpr" in line or '"' in line:
                    continue
                for kind, faults_of in KINDS.items():
                    for span, before, after in faults_of(line.split("  //")[0]):
                        found[kind].setdefault(part, []).append((path, number, span, before, after))
    return found


def compiles(source, commands, path, text):
    """Whether the file would compile with that text."""
    command = commands.get(path)
    if command is None:
        return False
    copy = os.path.join(source, os.path.dirname(path), "mutated.cpp")
    with open(copy, "w", encoding="utf-8") as file:
        file.write(text)
    words = shlex.split(command["command"])
    cut = words.index("-o")
    words = [w for w in words[:cut] if "ccache" not in w] + ["-fsyntax-only", "-w", copy]
    done = subprocess.run(words, cwd=command["directory"], capture_output=True)
    os.remove(copy)
    return done.returncode == 0


def insert(source, build, seed, count, spare):
    source, build = os.path.abspath(source), os.path.abspath(build)
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        commands = {os.path.relpath(c["file"], source): c for c in json.load(file) if "sanitized" not in c["command"]}
    header = os.path.join(build, "mutant.h")
    with open(header, "w", encoding="utf-8") as file:
        file.write(HEADER)
    choice = random.Random(seed)
    found = candidates(source)
    for kind, parts in found.items():
        print(f"{kind}: {sum(map(len, parts.values()))} places in {len(parts)} parts")
    faults, uses, taken = [], dict.fromkeys(PARTS, 0), set()
    for _ in range(count + spare):
        for kind in KINDS:
            # A part with the fewest faults so far, so that all have some.
            while True:
                parts = sorted(p for p, places in found[kind].items() if places)
                least = min(uses[p] for p in parts)
                part = choice.choice([p for p in parts if uses[p] == least])
                places = found[kind][part]
                path, number, span, before, after = places.pop(choice.randrange(len(places)))
                if (path, number) in taken:
                    continue
                with open(os.path.join(source, path), encoding="utf-8") as file:
                    lines = file.read().split("\n")
                included = 1 if lines[0] == f'#include "{header}"' else 0
                at = number + included
                lines[at] = mutated(lines[at], span, before, after, kind, len(faults) + 1)
                if not included:
                    lines.insert(0, f'#include "{header}"')
                if compiles(source, commands, path, "\n".join(lines)):
                    break
            with open(os.path.join(source, path), "w", encoding="utf-8") as file:
                file.write("\n".join(lines))
            taken.add((path, number))
            uses[part] += 1
            faults.append({"number": len(faults) + 1, "kind": kind, "part": part, "path": path, "line": number + 1,
                           "before": before, "after": after})
            print(f"{len(faults)}: {kind}, {part}, {path}:{number + 1}: {before} -> {after}", flush=True)
    with open(os.path.join(build, "mutants.json"), "w", encoding="utf-8") as file:
        json.dump(faults, file, indent=1)


def run(build, jobs, only, least):
    build = os.path.abspath(build)
    with open(os.path.join(build, "mutants.json"), encoding="utf-8") as file:
        faults = json.load(file)

    def programs_of(fault):
        names = PARTS[fault["part"]][1] + ["smoke_test"]
        if fault["kind"] == "memory after a failed allocation" and "memory_test" not in names:
            names.insert(0, "memory_test")
        programs = [os.path.join(build, "tests", name) for name in names]
        if fault["kind"] in MISREAD:
            programs += [program + "_sanitized" for program in programs]
        return [program for program in programs if os.path.exists(program)]

    def outcome(program, number):
        """What the program says, or None if it passes."""
        environment = dict(os.environ, SDM_MUTANT=str(number), GTEST_FAIL_FAST="1", GTEST_BRIEF="1",
                           SOURCE_DATE_EPOCH="1151712000")
        try:
            done = subprocess.run([program], env=environment, cwd=os.path.dirname(program), capture_output=True,
                                  timeout=3600, text=True, errors="replace")
        except subprocess.TimeoutExpired:
            return "does not end"
        if done.returncode == 0:
            return None
        failed = re.search(r"\[  FAILED  \] ([\w./]+)", done.stdout)
        return failed.group(1) if failed else f"ends with {done.returncode}"

    def find(fault):
        begin = time.monotonic()
        for program in programs_of(fault):
            found = outcome(program, fault["number"])
            if found is not None:
                fault["found"] = f"{os.path.basename(program)}: {found}"
                break
        else:
            fault["found"] = None
        fault["seconds"] = round(time.monotonic() - begin)
        print(f"{fault['number']}: {fault['found']} ({fault['seconds']} s)", flush=True)
        return fault

    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have it ignored, also by programs started here
    if only:
        faults = [fault for fault in faults if fault["number"] in only]
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        faults = list(pool.map(find, faults))
    with open(os.path.join(build, "found.json"), "w", encoding="utf-8") as file:
        json.dump(faults, file, indent=1)
    print("\n| fault | place | found by |\n| --- | --- | --- |")
    for fault in faults:
        change = f"`{fault['before']}` → `{fault['after']}`".replace("|", "\\|")
        print(f"| {fault['number']} {fault['kind']} | `{fault['path']}:{fault['line']}`: {change} | {fault['found']} |")
    found = [fault for fault in faults if fault["found"]]
    plain = [fault for fault in found if "_sanitized" not in fault["found"]]
    print(f"\n{len(found)} of {len(faults)} found, {len(plain)} of them without sanitizers")
    return 0 if len(found) >= (len(faults) if least is None else least) else 1


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("step", choices=["insert", "run"])
    arguments.add_argument("source")
    arguments.add_argument("build")
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--of-each-kind", type=int, default=4)
    arguments.add_argument("--spare", type=int, default=0, help="further faults of each kind")
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--only", type=int, nargs="*", help="numbers of faults to run")
    arguments.add_argument("--least", type=int, help="how many have to be found; all by default")
    given = arguments.parse_args()
    if given.step == "insert":
        insert(given.source, given.build, given.seed, given.of_each_kind, given.spare)
        return 0
    return run(given.build, given.jobs, given.only, given.least)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Prints where the time of a run of ./check went: the minutes of each part, and the thirty slowest cases.

    times.py BUILD

Of BUILD/Testing it reads phases.txt (a line "name seconds" of each step of ./check), junit.xml of ctest, and times/, which has the
cases of each GoogleTest program.
"""

import collections
import json
import pathlib
import sys
import xml.etree.ElementTree

# The part of a test by its name; tests of GoogleTest programs have none of these names.
PARTS = [("sanitized", "sanitized."), ("browser", "report_test"), ("browser", "live."), ("browser", "js."), ("docs", "docs."),
         ("packages", "package."), ("packages", "python.pip_install"), ("python", "python."), ("instructions", "instructions")]


def part_of(test):
    return next((part for part, beginning in PARTS if test.startswith(beginning)), "native")


def cases_of(folder, tests):
    """(seconds, name) of all cases: those of GoogleTest programs, and tests that are one case."""
    for test, seconds in tests.items():
        report = folder / "times" / f"{test}.json"
        if not report.exists():
            yield seconds, test
            continue
        for suite in json.loads(report.read_text(encoding="utf-8"))["testsuites"]:
            for case in suite["testsuite"]:
                yield float(case["time"].rstrip("s")), f"{test} {suite['name']}.{case['name']}"


def main():
    folder = pathlib.Path(sys.argv[1]) / "Testing"
    phases = folder / "phases.txt"
    if phases.exists():
        print("\nminutes of each step:")
        for line in phases.read_text(encoding="utf-8").splitlines():
            name, seconds = line.split()
            print(f"  {name:14}{int(seconds) / 60:6.1f}")
    junit = folder / "junit.xml"
    if not junit.exists():
        return
    tests = {case.get("name"): float(case.get("time") or 0)
             for case in xml.etree.ElementTree.parse(junit).getroot().iter("testcase")}
    totals = collections.Counter()
    for test, seconds in tests.items():
        totals[part_of(test)] += seconds
    print("minutes of the tests, added up over those that run at the same time:")
    for part, seconds in totals.most_common():
        print(f"  {part:14}{seconds / 60:6.1f}")
    print("the slowest cases, in seconds:")
    for seconds, name in sorted(cases_of(folder, tests), reverse=True)[:30]:
        print(f"  {seconds:6.1f}  {name}")


if __name__ == "__main__":
    main()

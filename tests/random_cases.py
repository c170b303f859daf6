"""The command line of a program that checks random cases: PROGRAM SDM [--cases N] [--first SEED]."""

import argparse
import sys
from pathlib import Path
from typing import Callable


def run(what: str, description: str, check: Callable[[Path, int], str]) -> None:
    """Calls check(command, seed), which returns what is wrong or "", for each seed, and exits at the first fault."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sdm", type=Path)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    options = parser.parse_args()
    for seed in range(options.first, options.first + options.cases):
        if fault := check(options.sdm, seed):
            sys.exit(f"case {seed} {fault}")
    print(f"{options.cases} {what} agree")

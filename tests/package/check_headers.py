#!/usr/bin/env python3
"""Whether the public headers are where docs/design/house.md and the umbrellas say.

    check_headers.py SOURCE_DIR

The table "what you are doing" names each header of include/sdm once, and the page says how many there are. sdm/sdm.h includes
all those of sdm::sdm and sdm/io.h all those of sdm::io: each header is in one of them, and only those of io include others of io.
"""

import re
import sys
from collections import Counter
from pathlib import Path

MOST = 42
ROOT = Path(sys.argv[1])
FOLDER = ROOT / "include/sdm"


def included(header: str) -> list[str]:
    return re.findall(r"^#include <sdm/(\w+)\.h>", (FOLDER / f"{header}.h").read_text(), re.MULTILINE)


def main() -> None:
    headers = {path.stem for path in FOLDER.glob("*.h")}
    page = (ROOT / "docs/design/house.md").read_text()
    begin = page.index("## Which header")
    section = page[begin : page.index("\n## ", begin)]
    faults = []
    listed = Counter(re.findall(r"\| `sdm/(\w+)\.h` \|$", section, re.MULTILINE))
    faults += [f"the table names {name}.h, which does not exist" for name in sorted(set(listed) - headers)]
    faults += [f"the table does not name {name}.h" for name in sorted(headers - set(listed))]
    faults += [f"the table names {name}.h {count} times" for name, count in sorted(listed.items()) if count > 1]
    said = re.search(r"(\d+) headers", section)
    if said is None or int(said[1]) != len(headers) or len(headers) > MOST:
        faults.append(f"there are {len(headers)} headers; the page says {said and said[1]}, and at most {MOST} are wanted")
    core, io = set(included("sdm")), set(included("io"))
    faults += [f"{name}.h is in no umbrella" for name in sorted(headers - core - io - {"sdm", "io"})]
    faults += [f"{name}.h is in both umbrellas" for name in sorted(core & io)]
    faults += [f"{name}.h of sdm::sdm includes {other}.h of sdm::io" for name in sorted(core & headers) for other in included(name) if other in io]
    if faults:
        sys.exit("\n".join(faults))


main()

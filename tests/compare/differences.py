"""What differs between two records."""

import re
from collections import Counter
from dataclasses import dataclass


@dataclass
class Difference:
    case: str
    what: str  # such as "value changed"
    where: str  # such as out/report.json: distance.mean
    before: object = None
    after: object = None

    @property
    def harmless(self) -> bool:
        """Only a key was added, which those who read the others do not see."""
        return self.what == "key added"

    def __str__(self) -> str:
        text = f"  {self.what}: {self.where}"
        if self.before is None and self.after is None:
            return text
        return f"{text}: {short(self.before)} -> {short(self.after)}"


def short(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 160 else f"{text[:150]}…"


def of_values(case: str, where: str, before: object, after: object) -> list:
    """Of JSON. NaN equals NaN: numbers are compared as they are written."""
    if isinstance(before, dict) and isinstance(after, dict):
        found = []
        for key in list(before) + [key for key in after if key not in before]:
            place = f"{where}.{key}" if where else key
            if key not in after:
                found.append(Difference(case, "key removed", place))
            elif key not in before:
                found.append(Difference(case, "key added", place))
            else:
                found += of_values(case, place, before[key], after[key])
        return found
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        return [d for k, (a, b) in enumerate(zip(before, after)) for d in of_values(case, f"{where}[{k}]", a, b)]
    if isinstance(before, list) and isinstance(after, list):
        gone, new = [x for x in before if x not in after], [x for x in after if x not in before]
        return [Difference(case, "value changed", f"{where}, {len(before)} -> {len(after)} elements", gone, new)]
    if repr(before) == repr(after):
        return []
    return [Difference(case, "value changed", where, before, after)]


def of_files(case: str, before: dict, after: dict) -> list:
    found = []
    for name in sorted(before.keys() | after.keys()):
        if name not in after:
            found.append(Difference(case, "file removed", name))
        elif name not in before:
            found.append(Difference(case, "file added", name))
        else:
            for d in of_values(case, "", before[name], after[name]):
                what = "file changed" if d.what == "value changed" else d.what
                found.append(Difference(case, what, f"{name}: {d.where}", d.before, d.after))
    return found


def of_outputs(case: str, stream: str, before: object, after: object) -> list:
    """Of texts, the lines of one that are not in the other."""
    if not all(isinstance(x, list) and all(isinstance(line, str) for line in x) for x in (before, after)):
        return of_values(case, stream, before, after)
    gone, new = [line for line in before if line not in after], [line for line in after if line not in before]
    if not gone and not new and before != after:
        return [Difference(case, "value changed", f"{stream}, order of lines")]
    return ([Difference(case, "value changed", stream, gone, new)] if gone or new else [])


def of_cases(part: str, before: dict, after: dict) -> list:
    """Of the cases of a part, by their names."""
    found = []
    for name in list(before) + [name for name in after if name not in before]:
        case = f"{part}: {name}"
        if name not in before or name not in after:
            found.append(Difference(case, "case removed" if name in before else "case added", ""))
        elif part == "command":
            a, b = before[name], after[name]
            if a["exit_codes"] != b["exit_codes"]:
                found.append(Difference(case, "exit code changed", "", a["exit_codes"], b["exit_codes"]))
            found += of_outputs(case, "stdout", a["stdout"], b["stdout"]) + of_outputs(case, "stderr", a["stderr"], b["stderr"])
            found += of_files(case, a["files"], b["files"])
        else:
            found += of_values(case, "", before[name], after[name])
    return found


def of_records(before: dict, after: dict) -> list:
    """The inputs first: where these differ, so does all else. A part that one record lacks is one difference."""
    found = of_values("inputs", "", before["inputs"], after["inputs"])
    for part in sorted((before.keys() | after.keys()) - {"inputs"}):
        if part in before and part in after:
            found += of_cases(part, before[part], after[part])
        else:
            found.append(Difference(part, "not recorded", "before" if part in after else "after"))
    return found


def counts(differences: list) -> list:
    """How many cases have a difference of a kind at a place, whichever its index and number, the most frequent first."""
    places = {(d.case, d.what, re.sub(r"\[\d+\]|\d+", lambda m: "[]" if m.group()[0] == "[" else "N", d.where)) for d in differences}
    return Counter((what, where) for _, what, where in places).most_common()

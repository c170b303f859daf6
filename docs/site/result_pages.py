"""The fields that results of the library declare, for all of their outputs."""

from sdm import _core

from option_pages import plain

INTRODUCTION = """The fields of results, as they are named in C++ and Python and, in another spelling, in JavaScript, where these have the
result. JSON has them by the same names, but for `triangle` and `triangles` in place of `face` and `faces`, `kind` in place of
`certainty`, and what the pages on its files say.
"""


def entry(name: str, camel: str, kind: str, text: str) -> list[str]:
    names = " · ".join(f"``{spelling}``" for spelling in dict.fromkeys((name, camel)))
    return [names, f"   {plain(text)}", "", f"   *{plain(kind[0].upper() + kind[1:])}.*", ""]


def page() -> str:
    lines = ["Results", "=======", "", INTRODUCTION.replace("`", "``"), ""]
    for result, rows in _core.result_tables():
        lines += [f"``{result}``", "-" * (len(result) + 4), ""]
        for row in rows:
            lines += entry(*row)
    return "\n".join(lines)

"""The options that structs of the library declare, for all calls of the package for Python."""

from sdm import _core

# What most readers look for comes first.
FIRST = ["map", "Surface", "self_map", "thickness"]


def plain(text: str) -> str:
    return text.replace("*", r"\*").replace("`", r"\`").replace("|", r"\|")


def entry(name: str, dashed: str, camel: str, needed: str, unit: str, default: str, excluded: str, since: str, text: str) -> list[str]:
    value = f"{needed[0].upper()}{needed[1:]}" + (", in units of the meshes" if unit == "length" else "")
    remarks = [f"{value}.", f"Default: {default or 'none'}.", *([f"Not with {excluded}."] if excluded else []), f"Since {since}."]
    names = " · ".join(f"``{spelling}``" for spelling in dict.fromkeys((name, dashed, camel)))
    return [names, f"   {plain(text)}", "", f"   *{plain(' '.join(remarks))}*", ""]


def page() -> str:
    lines = ["Options", "=======", ""]
    lines += ["What calls can be asked for, as it is named in C++ and Python, in the command and in JavaScript, where these have it.", ""]
    calls = _core.option_calls()
    for call in [*FIRST, *(call for call in calls if call not in FIRST)]:
        lines += [f"``{call}``", "-" * (len(call) + 4), ""]
        for row in _core.option_table(call):
            lines += entry(*row)
    return "\n".join(lines)

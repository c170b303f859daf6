"""The table of the options that structs of the library declare, for all calls of the package for Python."""

from sdm import _core

HEADER = ["C++, Python", "Command", "JavaScript", "Value", "Default", "Not with", "Since", ""]


def cell(text: str) -> str:
    return text.replace("|", "\\|").replace("`", "\\`").replace("*", "\\*")


def rows(call: str) -> list[list[str]]:
    table = []
    for name, dashed, camel, needed, unit, default, excluded, since, text in _core.option_table(call):
        value = needed + (", in units of the meshes" if unit == "length" else "")
        table.append([f"``{name}``", f"``{dashed}``", f"``{camel}``", cell(value), default or "none", excluded, since, cell(text)])
    return table


def page() -> str:
    lines = ["Options", "=======", ""]
    lines += ["What calls can be asked for, as it is named in C++ and Python, in the command and in JavaScript, where these have it.", ""]
    for call in _core.option_calls():
        lines += [f"``{call}``", "-" * (len(call) + 4), "", ".. list-table::", "   :header-rows: 1", "   :class: options", ""]
        for row in [HEADER, *rows(call)]:
            lines += [f"   {'* -' if k == 0 else '  -'} {text}" for k, text in enumerate(row)]
        lines.append("")
    return "\n".join(lines)

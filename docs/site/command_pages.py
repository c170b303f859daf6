"""The reference of the command, one page for each subcommand, made from its manual page."""

import re

UNESCAPED = str.maketrans({"`": "``", "*": r"\*", "|": r"\|"})


def plain(text: str) -> str:
    return re.sub(r"\\f[BIP]", "", text).replace(r"\-", "-").replace(r"\(aq", "'").replace(r"\\", "\\")


def prose(text: str) -> str:
    """reStructuredText of a sentence, in which `code` is the only markup."""
    return "``".join(part.translate(UNESCAPED) if i % 2 == 0 else part for i, part in enumerate(plain(text).split("`")))


def section_lines(lines: list[str]) -> list[str]:
    """The commands .TP, .PP, .nf of a section and what follows them, as reStructuredText."""
    page, i = [], 0
    while i < len(lines):
        line = lines[i]
        if line == ".TP":
            term = plain(lines[i + 1])
            page += ["", f".. option:: {term}", "", f"   {prose(lines[i + 2])}"]
            i += 2
        elif line == ".nf":
            end = lines.index(".fi", i)
            page += ["", ".. code-block:: sh", "", *(f"   {plain(code).strip()}" for code in lines[i + 1 : end]), ""]
            i = end
        elif line == ".PP":
            page.append("")
        else:
            page.append(prose(line))
        i += 1
    return page


def pages(manual: str) -> dict[str, str]:
    """The pages of the manual page's commands, by file name."""
    commands = manual.partition(".SH COMMANDS\n")[2].partition("\n.SH ")[0]
    result, summaries = {}, []
    for section in re.split(r"^\.SS ", commands, flags=re.MULTILINE)[1:]:
        usage, summary, *lines = section.splitlines()
        usage = plain(usage.strip('"'))
        name = usage.split()[1]
        title = f"sdm {name}"
        page = [title, "=" * len(title), "", prose(summary), "", ".. code-block:: sh", "", f"   {usage}", ""]
        page += [f".. program:: {title}", "", *section_lines(lines), ""]
        result[f"commands/sdm-{name}.rst"] = "\n".join(page)
        summaries.append((name, summary))
    assert len(summaries) > 5, "the manual page has another form"
    index = ["Commands", "========", "", "What ``sdm COMMAND --help`` and the manual page say.", ""]
    for name, summary in summaries:
        index += [f":doc:`sdm {name} <sdm-{name}>`", f"   {prose(summary)}", ""]
    statuses = re.findall(r"^\.TP\n(\d+)\n(.+)$", manual.partition(".SH EXIT STATUS\n")[2], flags=re.MULTILINE)
    index += ["Exit codes: " + ", ".join(f"{code} {meaning}" for code, meaning in statuses) + ".", ""]
    index += [".. toctree::", "   :hidden:", "", *(f"   sdm-{name}" for name, _ in summaries), ""]
    result["commands/index.rst"] = "\n".join(index)
    return result

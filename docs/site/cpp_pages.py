"""The C++ reference, one page for each public header, made by Doxygen and Breathe."""

import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree

# What has no comment of its own: the fields whose names say it all, and the functions that every class has.
PLAIN = re.compile(r"\(variable\)|\w+\((\w+ ?&&|const \w+ ?&)\)|operator=|operator==|~\w+\(\)")
# Headers by subject, in the order of the reference.
SUBJECTS = {
    "Meshes": ["mesh", "mesh_attributes", "mesh_edit", "simplify"],
    "Files": ["mesh_files", "map_files", "points", "bake_files"],
    "The two shapes": ["surface", "sampling_bound", "sites", "engine", "gl", "gpu"],
    "Distances": ["map", "closest_points", "measure", "self_proximity_query"],
    "Results and verdicts": ["statistics", "tolerance", "verdict", "doubts", "places", "summary"],
    "Bodies": ["shape", "proximity_query", "multi_body_query"],
    "Other comparisons": ["match", "bake", "hausdorff", "metrics", "align", "rays", "volume"],
    "Basics": ["types", "bounds", "error", "execution", "names", "options"],
}  # fmt: skip
# Headers that declare nothing of their own.
WITHOUT_PAGE = {"io", "sdm"}


def run_doxygen(headers: Path, folder: Path) -> Path:
    """Returns the folder of the XML. A public declaration without a comment is an error."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "warnings"
    settings = (Path(__file__).parent / "Doxyfile").read_text()
    settings += f"INPUT = {headers}\nOUTPUT_DIRECTORY = {folder}\nWARN_LOGFILE = {log}\nSTRIP_FROM_PATH = {headers.parent}\n"
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)
    warnings = sorted({line for line in log.read_text().splitlines() if not PLAIN.search(line)})
    if warnings:
        sys.exit("\n".join(warnings))
    return folder / "xml"


def description(header: Path) -> str:
    """The first sentence of the comment at the top of a header."""
    text = " ".join(line[3:].strip() for line in re.match(r"(///.*\n)+", header.read_text())[0].splitlines())
    return re.match(r".*?[.](?= |$)", text)[0].replace("`", "``").replace("*", r"\*")


def declarations(xml: Path) -> dict[str, list[list[str]]]:
    """The directives for the declarations of each header, in its order."""
    found = defaultdict(list)
    namespace = ElementTree.parse(xml / "namespacesdm.xml").getroot()
    for inner in namespace.iter("innerclass"):
        compound = ElementTree.parse(xml / f"{inner.get('refid')}.xml").getroot().find("compounddef")
        place = compound.find("location")
        if "::" not in inner.text.removeprefix("sdm::"):
            directive = [f".. doxygen{compound.get('kind')}:: {inner.text}", "   :members:", "   :undoc-members:"]
            found[Path(place.get("file")).stem].append((int(place.get("line")), directive))
    for member in namespace.iter("memberdef"):
        kind, place = member.get("kind"), member.find("location")
        name = f"sdm::{member.findtext('name')}"
        if "<" in name:  # a specialisation, such as the words of an enumeration
            continue
        if re.fullmatch(r"sdm::k\w+(Text|Options)", name):  # a part of the options of several structs
            continue
        if kind == "function":
            types = ("".join(p.find("type").itertext()) for p in member.findall("param"))
            name += f"({', '.join(types)})"
        found[Path(place.get("file")).stem].append((int(place.get("line")), [f".. doxygen{kind}:: {name}"]))
    return {header: [directive for _, directive in sorted(lines)] for header, lines in found.items()}


def pages(headers: Path, xml: Path) -> dict[str, str]:
    """The pages of the reference, by file name."""
    listed = [name for names in SUBJECTS.values() for name in names]
    missing = {header.stem for header in headers.glob("*.h")} - set(listed) - WITHOUT_PAGE
    if missing:
        sys.exit(f"cpp_pages.py: add to SUBJECTS the headers {', '.join(sorted(missing))}")
    declared = declarations(xml)
    result = {}
    index = ["C++ reference", "=============", ""]
    index += ["``#include <sdm/sdm.h>`` includes all headers of ``sdm::sdm``, ``#include <sdm/io.h>`` the files of"]
    index += ["``sdm::io``. Everything is in the namespace ``sdm``.", ""]
    for subject, names in SUBJECTS.items():
        index += [subject, "-" * len(subject), ""]
        for name in names:
            title = f"sdm/{name}.h"
            page = [title, "=" * len(title), "", ".. code-block:: cpp", "", f"   #include <sdm/{name}.h>", ""]
            page += [f".. doxygenfile:: {name}.h", "   :sections: detaileddescription", ""]
            for directive in declared[name]:
                page += [*directive, ""]
            result[f"cpp/{name}.rst"] = "\n".join(page)
            index += [f":doc:`{title} <{name}>`", f"   {description(headers / f'{name}.h')}", ""]
    index += [".. toctree::", "   :hidden:", "", *(f"   {name}" for name in listed), ""]
    result["cpp/index.rst"] = "\n".join(index)
    return result

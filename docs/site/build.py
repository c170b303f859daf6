#!/usr/bin/env python3
"""Builds the documentation site.

build.py SOURCE_DIR BUILD_DIR SDM NODE_MODULES: stages the pages in BUILD_DIR/source, where links between them are those of
the repository; generates the references of the command SDM, of the C++ headers and of the package for npm; has Sphinx run the gallery and write
BUILD_DIR/html, with MathJax of NODE_MODULES; and checks the links, and the pages in headless Chromium. Warnings are
errors. Nothing is fetched.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import sdm as sdm_module

import check_links
import command_pages
import cpp_pages
import option_pages
import result_pages

SITE = Path(__file__).resolve().parent


def staged_files(source: Path) -> dict[str, Path]:
    """The files of the site's source folder by their place there."""
    files = {name: source / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "LICENSE", "CITATION.cff")}
    for folder, pattern in (("docs", "**/*.md"), ("docs/images", "*.png"), ("scenes/meshes", "README.md"),
                            ("include/sdm", "*.h"), ("python/examples", "*.py")):  # fmt: skip
        for path in (source / folder).glob(pattern):
            if SITE not in path.parents:
                files[str(path.relative_to(source))] = path
    for page in SITE.glob("*.rst"):
        files[page.name] = page
    return files


def main() -> None:
    source, build, sdm, node_modules = (Path(argument).resolve() for argument in sys.argv[1:])
    listed = (SITE / "python.rst").read_text()
    if missing := [name for name in sdm_module.__all__ if name != "NONE" and f"sdm.{name}\n" not in listed]:
        sys.exit(f"python.rst: add {', '.join(missing)}")
    staged, html = build / "source", build / "html"
    for folder in ("source", "static", "programs", "doxygen", "doctrees", "html"):
        shutil.rmtree(build / folder, ignore_errors=True)

    pages: dict[str, bytes | str] = {name: path.read_bytes() for name, path in staged_files(source).items()}
    pages |= command_pages.pages(subprocess.check_output([sdm, "help", "--man"], text=True))
    pages["options.rst"] = option_pages.page()
    pages["results.rst"] = result_pages.page()
    xml = cpp_pages.run_doxygen(source / "include/sdm", build / "doxygen")
    pages |= cpp_pages.pages(source / "include/sdm", xml)
    pages["javascript.md"] = subprocess.check_output(
        ["node", SITE / "js_types.cjs", source / "js", source / "build/wasm/package/declared.d.ts"], env=os.environ | {"NODE_PATH": str(node_modules)})  # fmt: skip
    if (source / "build/wasm/live.html").exists():
        pages["docs/live.md"] += b'\n```{raw} html\n<p><a href="../live.html"><strong>Open the live page</strong></a></p>\n```\n'
    for name, content in pages.items():
        path = staged / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())

    shutil.copytree(source / "docs/gallery", build / "programs")  # they write their pictures beside them
    (build / "static").mkdir()
    shutil.copy(node_modules / "mathjax/es5/tex-svg.js", build / "static/mathjax.js")

    environment = os.environ | {
        "NODE_PATH": str(node_modules),
        "SDM_DOXYGEN_XML": str(xml),
        "SDM_STATIC": str(build / "static"),
        "SDM_GALLERY": str(build / "programs"),
        "MPLBACKEND": "agg",
    }
    built = subprocess.run(
        [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q", "-j", "2",
         "-c", SITE, "-d", build / "doctrees", staged, html],
        env=environment)  # fmt: skip
    if built.returncode != 0:
        sys.exit("Sphinx has warnings")
    # Of the other build, if that was made: its page is one file, which is only linked.
    live = source / "build/wasm/live.html"
    if live.exists():
        shutil.copy(live, html / "live.html")
    check_links.check(html)
    if subprocess.run(["node", SITE / "check_pages.cjs", html], env=environment).returncode != 0:
        sys.exit("the pages have faults")
    print(f"{html}/index.html")


main()

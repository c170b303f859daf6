"""Sphinx configuration of the documentation site. build.py runs Sphinx on a staged copy of the pages."""

import os
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import sdm
import search_summaries
import view_scraper
from sphinx.ext.autodoc import ClassDocumenter, MethodDocumenter

project = "sdm"
author = "The sdm developers"
copyright = author
release = version = sdm.__version__

extensions = [
    "breathe",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx_gallery.gen_gallery",
]
root_doc = "index"
exclude_patterns = ["gallery/**.ipynb", "gallery/**.py", "gallery/**.md5"]
nitpicky = False
primary_domain = None
highlight_language = "none"
smartquotes = False  # options begin with two hyphens

# Markdown: anchors of headings are those of GitHub.
myst_heading_anchors = 4
myst_enable_extensions = ["dollarmath"]  # $…$ and $$…$$, as on GitHub
suppress_warnings = ["myst.header"]  # pages that begin at a deeper heading, such as the gallery's

# The C++ reference, from the XML that Doxygen makes of the headers.
breathe_projects = {"sdm": os.environ["SDM_DOXYGEN_XML"]}
breathe_default_project = "sdm"
breathe_default_members = ("members", "undoc-members")
breathe_show_include = False
breathe_domain_by_extension = {"h": "cpp"}
cpp_id_attributes = ["SDM_API"]

# The Python reference, from docstrings.
autodoc_member_order = "bysource"
autodoc_typehints = "none"
add_module_names = False

# The gallery: scripts of cells, run by every build.
sphinx_gallery_conf = {
    "examples_dirs": os.environ["SDM_GALLERY"],
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py",
    "abort_on_example_error": True,
    "plot_gallery": True,
    "download_all_examples": False,
    "min_reported_time": 1e9,
    "show_memory": False,
    "show_signature": False,
    "remove_config_comments": True,
    "within_subsection_order": __import__("gallery_order").Listed,
    "image_scrapers": (view_scraper.scrape, "matplotlib"),
    "image_srcset": ["2x"],
    "thumbnail_size": (400, 300),
    "capture_repr": ("_repr_html_", "__repr__"),
}

html_theme = "furo"
html_title = f"sdm {release}"
html_static_path = [str(Path(__file__).parent / "static"), os.environ["SDM_STATIC"]]
html_css_files = ["site.css"]
html_js_files = ["search_summaries.js"]
mathjax_path = "mathjax.js"
mathjax3_config = {"options": {"enableMenu": False}}  # its menu loads further files
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
# Pages open from files as well, where a browser loads no page into another: search_summaries.js does without.
html_show_search_summary = False
templates_path = []
copybutton_exclude = ".linenos, .gp, .go"
copybutton_prompt_text = r">>> |\.\.\. "
copybutton_prompt_is_regexp = True

PARAMETER = re.compile(r"(\w+(?:, \w+)*): ")


def list_parameters(app, what, name, obj, options, lines):
    """Docstrings describe each parameter in a line of its own, "name: text": makes a list of them."""
    if what not in ("function", "method", "boundmethod", "class"):
        return
    listed, first = [], True
    for line in lines:
        if not line.lstrip().startswith((">>>", "...")):
            line = line.replace("|", r"\|")  # lengths, no substitutions
        if PARAMETER.match(line) and (first or listed[-1] != "" or not line):
            if not in_list(listed):
                listed.append("")
            listed.append(PARAMETER.sub(r"* **\1**: ", line, count=1))
        elif in_list(listed) and line:
            listed.append("  " + line)
        else:
            listed.append(line)
        first = line == ""
    lines[:] = listed


def in_list(lines):
    for line in reversed(lines):
        if line.startswith("* **"):
            return True
        if not line.startswith("  "):
            return False
    return False


def hide_empty_contents(app, pagename, templatename, context, doctree):
    """Furo shows "On this page" for a page that has nothing but a list of pages, and its script then fails."""
    if context.get("toc", "").count("<li>") <= 1:
        context["furo_hide_toc"] = True


class BoundClass(ClassDocumenter):
    """A class in its own order."""

    priority = ClassDocumenter.priority + 1

    def sort_documenters(self, documenters, order):
        names = list(vars(self.object))
        return sorted(documenters, key=lambda member: names.index(member[0].name.rpartition(".")[2]))


class BoundMethod(MethodDocumenter):
    """A method that nanobind has bound."""

    objtype, directivetype = "boundmethod", "method"
    priority = 100  # above that of attributes

    @classmethod
    def can_document_member(cls, member, membername, isattr, parent):
        return type(member).__name__ == "nb_method"


def bound_signature(app, what, name, obj, options, signature, return_annotation):
    """nanobind states signatures, with self, in the first lines of docstrings, constructors' in those of __init__."""
    if what == "boundmethod" and signature:
        return re.sub(r"^\(self(, )?", "(", signature), return_annotation
    found = re.match(r"__init__\(self(?:, )?(.*)\) -> None", getattr(obj, "__init__", obj).__doc__ or "")
    if what == "class" and found:
        return f"({found[1]})", None
    return None


def setup(app):
    app.connect("build-finished", search_summaries.write)
    app.connect("html-page-context", hide_empty_contents, priority=900)  # after the theme's
    app.add_autodocumenter(BoundClass, override=True)
    app.add_autodocumenter(BoundMethod)
    app.connect("autodoc-process-docstring", list_parameters)
    app.connect("autodoc-process-signature", bound_signature)

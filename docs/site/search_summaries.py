"""A line of text for each result of a search, from the page itself.

Sphinx has the browser load the pages that it found, which browsers refuse for pages that were opened as files. Here, a
script of the site has the first sentences of all pages.
"""

import json
import textwrap
from pathlib import Path

from docutils import nodes

LONGEST = 180  # characters


def summary(document: nodes.document) -> str:
    """The beginning of the first paragraph; of the first long one, if there is any."""
    texts = [" ".join(paragraph.astext().split()) for paragraph in document.findall(nodes.paragraph)]
    text = next((text for text in texts if len(text) > 40), texts[0] if texts else "")
    return textwrap.shorten(text, LONGEST, placeholder=" …")


def write(app, error) -> None:
    """Writes the texts of all documents, and the script that shows them, after a build."""
    if error is not None:
        return
    texts = {name: summary(app.env.get_doctree(name)) for name in sorted(app.env.found_docs)}
    script = Path(__file__).parent / "search_summaries.js"
    (Path(app.outdir) / "_static/search_summaries.js").write_text(
        f"const pageSummaries = {json.dumps(texts, ensure_ascii=False)};\n" + script.read_text(), encoding="utf-8")  # fmt: skip

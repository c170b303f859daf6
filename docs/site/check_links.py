"""Checks the links of a site: every file and every anchor that a page refers to exists, and no page loads anything."""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADED = {("script", "src"), ("img", "src"), ("link", "href"), ("iframe", "src"), ("source", "srcset")}


class Page(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors, self.links, self.loaded = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)
            elif (tag, name) in LOADED or (name == "href" and value):
                self.links.append(value)
                if (tag, name) in LOADED and dict(attributes).get("rel") not in ("canonical", "next", "prev"):
                    self.loaded.append(value)


def check(folder: Path) -> None:
    """Ends the program with a list of the faults, if there are any."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in folder.rglob("*.html")}
    faults, links = [], 0
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            links += 1
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not target.exists():
                faults.append(f"{path.relative_to(folder)}: {link} does not exist")
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                faults.append(f"{path.relative_to(folder)}: {link} has no such anchor")
        faults += [f"{path.relative_to(folder)}: loads {link}" for link in page.loaded if urlsplit(link).netloc]
    if faults:
        sys.exit("\n".join(sorted(set(faults))))
    print(f"{len(pages)} pages, {links} links")


if __name__ == "__main__":
    check(Path(sys.argv[1]).resolve())

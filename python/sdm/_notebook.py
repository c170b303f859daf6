"""How notebooks show a map: the surface in 3D, its picture and its numbers, in a text of bounded size."""

import base64
import html
import os
import tempfile
from typing import Any

from . import _core

# Of the page in the notebook: texels a side, and triangles. A viewer of 0.7 MB, and at most 3 MB in all.
_SIDE = 256
_TRIANGLES = 100_000


def _read(file: str) -> bytes:
    with open(file, "rb") as opened:
        return opened.read()


def _page(distance_map: Any, folder: str) -> str:
    """The page of save("x.html"), with fewer texels and triangles if there are many; it loads nothing."""
    file = os.path.join(folder, "map.html")
    at_vertices = distance_map.at_vertices()
    report = distance_map._core.report(at_vertices, {})
    distance_map._core.write_page(file, at_vertices, report, largest=_SIDE, triangles=_TRIANGLES)
    page = html.escape(_read(file).decode())
    style = "width: 100%; height: 640px; border: 1px solid #8888; border-radius: 4px"
    return f'<iframe title="distances in 3D" sandbox="allow-scripts" style="{style}" srcdoc="{page}"></iframe>'


def _rows(distance_map: Any) -> str:
    s = distance_map.statistics()
    height, width = distance_map.distance.shape
    rows = {
        "distance": f"{s.min:.6g} to {s.max:.6g}",
        "mean, rms": f"{s.mean:.6g}, {s.rms:.6g}",
        "median, 95 %, 99 %": f"{s.p50:.6g}, {s.p95:.6g}, {s.p99:.6g}",
        "sign": f"{distance_map.sign}: {distance_map.sign_reason}",
        "texels": f"{s.texels} of {width} × {height}",
    }
    return "".join(f"<tr><th>{key}</th><td>{html.escape(value)}</td></tr>" for key, value in rows.items())


def html_of(distance_map: Any) -> str:
    """The picture and the numbers also where a notebook is not trusted, and frames are not shown."""
    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, "map.png")
        distance_map.save(picture, size=256)
        data = base64.b64encode(_read(picture)).decode()
        page = _page(distance_map, folder) if _core.can_write_html() else ""
    return (
        f'<div>{page}<div style="display: flex; gap: 1em; align-items: center">'
        f'<img alt="distances in the atlas" src="data:image/png;base64,{data}">'
        f"<table>{_rows(distance_map)}</table></div></div>"
    )

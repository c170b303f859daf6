"""Pictures of maps by matplotlib."""

from typing import Any

import numpy as np

from ._core import Error


def _colours(distance_map: Any, cmap: "str | None") -> tuple[Any, ...]:
    """A colour map, its range and the colour of no value, which are those of all pictures of the map."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap, Normalize

    _, low, high, colours = distance_map._core.colors()
    *shown, none = colours / 255
    return colormaps[cmap] if cmap else ListedColormap(shown), Normalize(low, high), (*none, 1.0)


def plot(distance_map: Any, ax: Any, kind: str, cmap: "str | None", units: str) -> Any:
    if kind not in ("surface", "atlas"):
        raise Error(f"kind must be one of surface, atlas, not '{kind}'")
    try:
        import matplotlib.pyplot as plt
        from matplotlib.cm import ScalarMappable
    except ImportError:
        raise Error("plot() needs matplotlib; install it with pip install 'surface-distance-maps[viz]'") from None

    label = f"distance [{units}]" if units else "distance"
    if kind == "atlas":
        ax = ax or plt.figure().add_subplot()
        colours, norm, _ = _colours(distance_map, cmap)
        picture = ax.imshow(distance_map.distance, cmap=colours, norm=norm)
        ax.figure.colorbar(picture, ax=ax, label=label)
        ax.set_axis_off()
        return ax

    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    ax = ax or plt.figure().add_subplot(projection="3d")
    corners = distance_map.surface.vertices[distance_map.surface.faces]
    values = distance_map.at_vertices()[distance_map.surface.faces].mean(axis=1)
    colours, norm, none = _colours(distance_map, cmap)
    # Lambertian shading from above the viewer's left.
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    light = np.array([0.4, -0.5, 0.77])
    shade = 0.6 + 0.4 * np.abs(np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0) @ light)
    rgba = np.where(np.isfinite(values)[:, None], colours(norm(np.nan_to_num(values))), none)
    rgba[:, :3] *= shade[:, None]
    ax.add_collection3d(Poly3DCollection(corners, facecolors=rgba, linewidths=0, antialiased=False))
    low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(np.maximum(high - low, 1e-3 * (high - low).max()))
    ax.figure.colorbar(ScalarMappable(norm, colours), ax=ax, label=label, shrink=0.7)
    return ax

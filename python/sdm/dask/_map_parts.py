import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import dask
import numpy as np
import numpy.typing as npt

import sdm
from sdm import _core

from . import _files, _meshes
from ._split import Parts

_SLACK = 1e-6  # of distances and of the size of a part, as in the reference engine

_sites = _meshes.Cache(4)


@dataclass(frozen=True)
class PartsMap:
    """The map of a surface to O2 in parts: the arrays of DistanceMap, unsigned. Arrays have a row for each row of texels;
    texels without a value hold NaN or NONE."""

    distance: npt.NDArray[Any]
    """(H, W) float32."""
    vector: npt.NDArray[Any]
    """From the texel's point to the closest point of O2, (H, W, 3) float32."""
    site: npt.NDArray[Any]
    """The closest vertex, edge or face, numbered as in the whole O2, (H, W) uint32."""
    site_type: npt.NDArray[Any]
    """(H, W) uint8."""
    face: npt.NDArray[Any]
    """The face of the surface that owns each texel, (H, W) uint32."""
    visits: int
    """How often a part of O2 was searched for a tile; tiles × parts if bounds exclude none."""
    tiles: int
    """The number of tasks."""

    def save(self, file: "str | os.PathLike[str]") -> None:
        """Writes all arrays as .npz. The complete file appears, or none."""
        with _files.replacing(file) as partial, open(partial, "wb") as opened:
            np.savez(opened, **vars(self))

    @classmethod
    def load(cls, file: "str | os.PathLike[str]") -> "PartsMap":
        """Reads what save() has written."""
        with np.load(file) as arrays:
            values: Any = {name: arrays[name] if arrays[name].ndim else int(arrays[name]) for name in arrays.files}
            return cls(**values)


def map_parts(
    a: Any,
    parts: Parts,
    folder: "str | os.PathLike[str]",
    *,
    samples_per_tile: int = 65536,
    max_distance: float = float("inf"),
    threads: int = 1,
    **layout: Any,
) -> Any:
    """Describes the map of ``a`` (O1) to a mesh in parts (O2), and returns it as a Dask Delayed of a PartsMap.

    a: a mesh in any form, which is laid out here; or Parts, for an O1 that is too large as well: then each of its parts has
    an atlas of its own, laid out by a task, and the result is a list of the files that PartsMap.load() reads, one for each
    part. There ``face`` is numbered as in the part; Parts.numbers() has the numbers in the whole.
    parts: O2, from split().
    folder: for the tiles. A tile that is in the folder is not computed again.
    samples_per_tile: texels of a task, which are neighbours on the surface.
    max_distance: as of sdm.map(). threads: used by each task. layout: resolution, atlas, max_stretch and gutter of
    sdm.Surface.

    A task visits the parts of O2 by increasing distance of their boxes from the tile. It reads a part only if its box is
    nearer than the closest points found so far for some texel, and keeps the four used last for other tasks of the process.
    Memory of a worker: about 0.5 kB for each face of these parts and of the one being built.

    The result does not depend on how O2 is divided, on tiles or on workers: it is, bit for bit, sdm.map(a, b,
    engine='reference', sign='none') for the whole O2, in which the first of equally close sites is the closest one. The
    default engine differs from it at texels where two sites are equally close to within its accuracy. Distances are
    unsigned: inside and outside need the whole mesh. Raises sdm.Error for a mesh and options that cannot be used.

    >>> parts = sdm.dask.split(box, folder, faces_per_part=5)
    >>> result = sdm.dask.map_parts(sphere, parts, folder, resolution=64).compute()
    >>> whole = sdm.map(sphere, box, resolution=64, sign='none', engine='reference')
    >>> np.array_equal(result.distance, whole.distance, equal_nan=True)
    True
    """
    if samples_per_tile < 1 or threads < 0:
        raise sdm.Error("samples_per_tile must be at least 1, threads at least 0")
    if not max_distance > 0:
        raise sdm.Error("the maximum distance must be greater than 0")
    work = {"max_distance": float(max_distance), "threads": threads, "parts": parts.folder}
    key = {"version": sdm.__version__, "o2": parts.key, "max_distance": work["max_distance"]}
    folder = Path(os.path.abspath(os.fsdecode(folder)))
    folder.mkdir(parents=True, exist_ok=True)
    if isinstance(a, Parts):
        map_part = dask.delayed(_map_part, pure=False)
        names = [_files.key_of(o1=a.key, part=part, layout=layout, **key) for part in range(len(a))]
        return dask.delayed(list)(
            [map_part(a.folder, part, layout, str(folder / f"{name}.npz"), work) for part, name in enumerate(names)]
        )

    surface = a if isinstance(a, sdm.Surface) else sdm.Surface(a, **layout)
    points, texels = _core.sample_points(surface), _core.sample_texels(surface)
    name = _files.key_of(points=_meshes.digest_of_arrays([points, texels]), samples=samples_per_tile, **key)
    of_surface = str(folder / f"{name}-points.npy"), str(folder / f"{name}-texels.npz")
    with _files.replacing(of_surface[0]) as partial:
        np.save(partial, points)
    with _files.replacing(of_surface[1]) as partial:
        np.savez(partial, texels=texels, faces=surface.texel_faces)
    map_tile = dask.delayed(_map_tile, pure=False)
    tiles = [
        map_tile(of_surface[0], first, first + samples_per_tile, str(folder / f"{name}-{number:06}.npz"), work)
        for number, first in enumerate(range(0, len(points), samples_per_tile))
    ]
    return dask.delayed(_map_of_tiles, pure=False)(tiles, of_surface[1])


def _map_of_tiles(files: list[Any], of_surface: str) -> PartsMap:
    with np.load(of_surface) as arrays:
        return _assembled(map(_read, files), arrays["texels"], arrays["faces"])


def _read(file: str) -> dict[str, Any]:
    with np.load(file) as arrays:
        return dict(arrays)


def _map_tile(points: str, begin: int, end: int, file: str, work: dict[str, Any]) -> str:
    """Computes a tile unless its file is there; returns the file's name."""
    if not os.path.exists(file):
        queries = np.array(np.load(points, mmap_mode="r")[begin:end])
        with _files.replacing(file) as partial:
            np.savez(partial, **_stored(closest_in_parts(queries, Parts.open(work["parts"]), work)))
    return file


def _map_part(folder: str, part: int, layout: dict[str, Any], file: str, work: dict[str, Any]) -> str:
    """Computes the map of one part of O1 unless its file is there; returns the file's name."""
    if not os.path.exists(file):
        with sdm.thread_limit(work["threads"]):
            surface = sdm.Surface(Parts.open(folder).mesh(part), **layout)
        tile = _stored(closest_in_parts(_core.sample_points(surface), Parts.open(work["parts"]), work))
        _assembled([tile], _core.sample_texels(surface), surface.texel_faces).save(file)
    return file


def _stored(found: dict[str, Any]) -> dict[str, Any]:
    """What a map stores of closest points."""
    distance = found["distance"].astype(np.float32)
    vector = found["vector"].astype(np.float32)
    nothing = found["site_type"] == sdm.SiteType.NONE
    distance[nothing], vector[nothing] = np.nan, np.nan
    return {"distance": distance, "vector": vector, "site": found["site"], "site_type": found["site_type"],
            "visits": found["visits"]}  # fmt: skip


def _assembled(tiles: Iterable[Any], texels: npt.NDArray[Any], faces: npt.NDArray[Any]) -> PartsMap:
    result: dict[str, Any] = {
        "distance": np.full(faces.size, np.nan, np.float32), "vector": np.full((faces.size, 3), np.nan, np.float32),
        "site": np.full(faces.size, sdm.NONE, np.uint32), "site_type": np.full(faces.size, sdm.SiteType.NONE, np.uint8),
    }  # fmt: skip
    begin = visits = count = 0
    for tile in tiles:
        owned = texels[begin : begin + len(tile["distance"])]
        for name, values in result.items():
            values[owned] = tile[name]
        begin, visits, count = begin + len(owned), visits + int(tile["visits"]), count + 1
    shaped = {name: values.reshape(*faces.shape, *values.shape[1:]) for name, values in result.items()}
    return PartsMap(face=faces, visits=visits, tiles=count, **shaped)


def closest_in_parts(queries: npt.NDArray[Any], parts: Parts, work: dict[str, Any]) -> dict[str, Any]:
    """The closest points of the whole O2, from those parts that bounds do not exclude."""
    count = len(queries)
    best: dict[str, Any] = {
        "distance": np.full(count, work["max_distance"]), "vector": np.zeros((count, 3)),
        "site": np.full(count, sdm.NONE, np.uint32), "site_type": np.full(count, sdm.SiteType.NONE, np.uint8),
        "face": np.full(count, sdm.NONE, np.uint32),
    }  # fmt: skip
    slack = _SLACK * np.linalg.norm(parts.high - parts.low, axis=1)
    gaps = np.maximum(np.maximum(parts.low - queries.max(axis=0), queries.min(axis=0) - parts.high), 0)
    nearest = (1 - _SLACK) * np.linalg.norm(gaps, axis=1) - slack  # lower bounds for all queries
    visits = 0
    with sdm.thread_limit(work["threads"]):
        for part in np.argsort(nearest, kind="stable"):
            if nearest[part] > best["distance"].max():
                break  # so are all others
            gap = np.maximum(np.maximum(parts.low[part] - queries, queries - parts.high[part]), 0)
            within = np.flatnonzero((1 - _SLACK) * np.linalg.norm(gap, axis=1) - slack[part] <= best["distance"])
            if len(within) == 0:
                continue
            visits += 1
            built = lambda part=part: (sdm.Sites(parts.mesh(part)), parts.numbers(part))  # noqa: E731
            sites, numbers = _sites.get((parts.key, part), built)
            some = {name: np.ascontiguousarray(values[within]) for name, values in best.items()}
            vertices, edges, faces = numbers
            _core.merge_closest(sites, vertices, edges, faces, queries[within], **some)
            for name, values in best.items():
                values[within] = some[name]
    return {**best, "visits": visits}

import contextlib
import operator
import os
import re
import time
import uuid
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import dask
import numpy as np
import pandas as pd

import sdm
from sdm import _arrays

from . import _files, _meshes

_NUMBERS = tuple(name for name in vars(sdm.DistanceStatistics) if not name.startswith("_") and not name.endswith("texels"))
_BOUNDS = ("lower", "upper", "covering_radius", "accuracy")
_FORMATS = (".exr", ".png", ".glb", ".ply", ".csv", ".npy", ".vtp")
_ATTEMPTS = 3  # as many as Dask's setting distributed.scheduler.allowed-failures

_sites = _meshes.Cache(2)


def map_pairs(
    pairs: Iterable[Any],
    folder: "str | os.PathLike[str]",
    *,
    resolution: "int | None" = None,
    precision: "float | None" = None,
    align: bool = False,
    tolerance: "float | tuple[float, float] | None" = None,
    save: "str | Iterable[str]" = ".exr",
    engine: str = "cpu",
    sign: str = "automatic",
    max_distance: float = float("inf"),
    atlas: str = "charts",
    max_stretch: float = 1.3,
    gutter: int = 1,
    threads: int = 1,
    rows_per_partition: int = 64,
) -> Any:
    """Describes the maps of many pairs of meshes, and returns their table: a Dask DataFrame, computed on demand.

    pairs: (o1, o2) or (o1, o2, transform), with meshes in any form and transform a 4 × 4 matrix that moves o1. Files are
    read by the tasks; prefer them to arrays, which Dask sends to its workers.
    folder: for the maps and the records of what is done.
    align: whether to move each o1, after its transform, onto its o2 by sdm.align().
    tolerance: the largest accepted distance, or the least and the most; adds verdicts to the table.
    save: the formats of the maps, '' for none. The other options are those of sdm.map().
    threads: used by each task. A worker runs as many tasks at a time as it has threads for Dask.
    rows_per_partition: of the table.

    The table has one row for each pair, in their order: ``o1`` and ``o2`` (names), ``verdict`` ('PASS', 'FAIL', 'NOT
    DECIDED', or '' without a tolerance), the statistics of DistanceMap.statistics(), the bounds of DistanceMap.bounds
    (``lower``, ``upper``, ``covering_radius``, ``accuracy``), ``sign``, ``sign_reason``, ``resolution``, ``seconds``, the
    file of the map in a column for each format (``exr``, ...), ``key`` and ``error``. Verdicts hold for all points of o1,
    not only for texels, unless the sign is an estimate (see sdm.map); statistics are estimates.

    A pair that cannot be mapped has a row with its ``error`` and NaN for numbers; nothing is raised. So has one whose
    worker was killed three times, which is what happens where memory does not suffice.

    A pair is done when its record is in the folder. The record is named by the content of both meshes and by the options
    that results depend on, and is written after the maps. Calling again with the same folder computes what is not done.
    Pairs with an error are tried again.

    >>> table = sdm.dask.map_pairs([(sphere, box), (sphere, 'no such file.stl')], folder, resolution=64, tolerance=2)
    >>> table.compute()[['verdict', 'max']].round(3)
      verdict    max
    0    PASS  0.997
    1            NaN
    """
    import dask.dataframe

    if rows_per_partition < 1 or threads < 0:
        raise sdm.Error("rows_per_partition must be at least 1, threads at least 0")
    formats = [save] if isinstance(save, str) else list(save)
    formats = [suffix for suffix in formats if suffix]
    for suffix in formats:
        if suffix not in _FORMATS:
            raise sdm.Error(f"a map is saved as {', '.join(_FORMATS)}, not as '{suffix}'")
    options = {
        "resolution": None if resolution is None else operator.index(resolution),
        "precision": None if precision is None else float(precision), "engine": engine, "sign": sign,
        "max_distance": float(max_distance), "atlas": atlas, "max_stretch": float(max_stretch), "gutter": operator.index(gutter),
    }  # fmt: skip
    work = {
        "map": options, "align": bool(align), "tolerance": _limits(tolerance), "formats": formats,
        "folder": os.path.abspath(os.fsdecode(folder)), "threads": threads, "run": uuid.uuid4().hex,
    }  # fmt: skip
    for name in ("records", "maps", "attempts"):
        Path(str(work["folder"]), name).mkdir(parents=True, exist_ok=True)

    # A mesh in memory that occurs in several pairs is sent once.
    sent: dict[int, Any] = {}

    def argument(mesh: Any) -> Any:
        if isinstance(mesh, (str, os.PathLike)):
            return _meshes.portable(mesh)
        if id(mesh) not in sent:
            sent[id(mesh)] = mesh, dask.delayed(_meshes.portable(mesh), traverse=False)
        return sent[id(mesh)][1]

    row = dask.delayed(map_pair, pure=False)
    rows = []
    for number, pair in enumerate(pairs):
        if not isinstance(pair, (tuple, list)) or len(pair) not in (2, 3):
            raise sdm.Error(f"pair {number} must be (o1, o2) or (o1, o2, transform)")
        o1, o2, transform = (*pair, None) if len(pair) == 2 else pair
        names = _meshes.name_of(o1, f"pair {number}, O1"), _meshes.name_of(o2, f"pair {number}, O2")
        rows.append(row(names, argument(o1), argument(o2), _matrix(transform), work))
    columns = _columns(formats)
    partition = dask.delayed(_partition, pure=False)
    partitions = [
        partition(rows[first : first + rows_per_partition], first, columns)
        for first in range(0, max(len(rows), 1), rows_per_partition)
    ]
    return dask.dataframe.from_delayed(partitions, meta=_partition([], 0, columns), verify_meta=False)


def _limits(tolerance: Any) -> "list[Any] | None":
    if tolerance is None:
        return None
    low, high = (-tolerance, tolerance) if np.ndim(tolerance) == 0 else tolerance
    if not (low <= high and np.isfinite(high - low)):
        raise sdm.Error("tolerance must be a finite number that is not negative, or two, the smaller one first")
    return [float(low), float(high)]


def _matrix(transform: Any) -> Any:
    """Returns a list, or None, or the error that says why it is no matrix."""
    try:
        return None if transform is None else _arrays.matrix(transform, "transform").tolist()
    except (TypeError, ValueError, sdm.Error):
        return sdm.Error("the transform must be a 4 × 4 matrix")


def _columns(formats: list[Any]) -> dict[str, Any]:
    texts, files = ("o1", "o2", "verdict"), [suffix[1:] for suffix in formats]
    return {
        **dict.fromkeys(texts, "object"), **dict.fromkeys((*_NUMBERS, *_BOUNDS), "float64"),
        **dict.fromkeys(("texels", "negative_texels", "resolution"), "int64"), "seconds": "float64",
        **dict.fromkeys(("sign", "sign_reason", *files, "key", "error"), "object"),
    }  # fmt: skip


def _partition(rows: list[Any], first: int, columns: dict[str, Any]) -> pd.DataFrame:
    empty = {"object": "", "float64": np.nan, "int64": 0}
    values = {name: [row.get(name, empty[kind]) for row in rows] for name, kind in columns.items()}
    index = pd.RangeIndex(first, first + len(rows))
    return pd.DataFrame({name: pd.Series(values[name], index, dtype=kind) for name, kind in columns.items()})


def map_pair(names: tuple[Any, ...], o1: Any, o2: Any, transform: Any, work: dict[str, Any]) -> dict[str, Any]:
    """Returns the row of a pair: from its record, or by computing the map."""
    row = {"o1": names[0], "o2": names[1]}
    try:
        if isinstance(transform, sdm.Error):
            raise transform
        with _meshes.naming(names[0]):
            first = _meshes.digest(o1)
        with _meshes.naming(names[1]):
            second = _meshes.digest(o2)
        results = {name: work[name] for name in ("map", "align", "tolerance", "formats")}
        row["key"] = _files.key_of(version=sdm.__version__, o1=first, o2=second, transform=transform, **results)
        record = Path(work["folder"], "records", f"{row['key']}.json")
        done = _files.read_json(record)
        if done is None or not all(os.path.exists(done[suffix[1:]]) for suffix in work["formats"]):
            with _attempt(row["key"], work), sdm.thread_limit(work["threads"]):
                done = _computed(names, (o1, o2), (first, second), transform, row["key"], work)
            _files.write_json(record, done)
        row.update(done)
    except (sdm.Error, OSError) as error:
        row["error"] = str(error)
    except Exception as error:  # nothing that is wrong with one pair ends the others
        row["error"] = f"{type(error).__name__}: {error}"
    return row


@contextlib.contextmanager
def _attempt(key: str, work: dict[str, Any]) -> Iterator[None]:
    """Raises sdm.Error where several workers have not survived the block for this pair. Dask would give up the whole table."""
    folder = Path(work["folder"], "attempts", f"{key}-{work['run']}")
    folder.mkdir(exist_ok=True)
    killed = len(list(folder.iterdir()))
    if killed >= _ATTEMPTS:
        raise sdm.Error(
            f"the worker was killed {killed} times while it computed this pair, "
            "which happens where its memory does not suffice; use workers with more memory or a lower resolution"
        )
    mark = folder / uuid.uuid4().hex
    mark.touch()
    try:
        yield
    except Exception:
        mark.unlink()
        raise
    mark.unlink()
    with contextlib.suppress(OSError):
        folder.rmdir()


def _computed(names: tuple[Any, ...], meshes: tuple[Any, ...], digests: tuple[Any, ...], transform: Any, key: str, work: dict[str, Any]) -> dict[str, Any]:
    began = time.perf_counter()
    options = dict(work["map"])
    with _meshes.naming(names[0]):
        mesh = _meshes.load(meshes[0])
    with _meshes.naming(names[1]):
        sites = _sites.get(digests[1], lambda: sdm.Sites(_meshes.load(meshes[1])))
    with _meshes.naming(names[0]):
        if transform is not None:
            mesh = mesh.transformed(np.array(transform))
        if work["align"]:
            mesh = mesh.transformed(sdm.align(mesh, sites).transform)
        search = {name: options.pop(name) for name in ("engine", "sign", "max_distance")}
        surface = sdm.Surface(mesh, **options)
    distance_map = sdm.map(surface, sites, **search)
    if [_meshes.digest(m) for m in meshes] != list(digests):
        raise sdm.Error(f"{' or '.join(names)} was changed while it was read; repeat the call")

    stem = re.sub(r"[^\w.-]", "_", Path(names[0]).stem)[:80]
    files = {}
    for suffix in work["formats"]:
        files[suffix[1:]] = str(Path(work["folder"], "maps", f"{stem}-{key[:16]}{suffix}"))
        distance_map.save(files[suffix[1:]])
    statistics, bounds = distance_map.statistics(), distance_map.bounds
    return {
        **{name: getattr(statistics, name) for name in (*_NUMBERS, "texels", "negative_texels")},
        **{name: getattr(bounds, name) for name in _BOUNDS},
        "verdict": "" if work["tolerance"] is None else distance_map.check(work["tolerance"]).verdict.upper(),
        "sign": distance_map.sign, "sign_reason": distance_map.sign_reason, "resolution": surface.resolution,
        **files, "seconds": time.perf_counter() - began,
    }  # fmt: skip

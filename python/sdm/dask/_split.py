"""Divides a mesh into parts that are close together in space. Reads arrays in chunks: they need not fit in memory."""

import contextlib
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import sdm
from sdm._arrays import numpy_of

from . import _files, _meshes

_CHUNK = 1 << 22  # faces read at a time
_CELLS = 32  # per axis of the grid that orders faces, at each level
_EDGES_AT_A_TIME = 1 << 25
_LARGEST = 1e37
# What split() writes into the folder "incomplete".
_OF_WORK = re.compile(r"f(-\d+)+|edges-\d+|part-\d{6,}\.npz|\.[0-9a-f]{32}\.npz")


@dataclass(frozen=True)
class Parts:
    """A mesh divided into spatial parts, as files in a folder. Returned by split(); Parts.open() finds it again."""

    folder: str
    vertices: int
    """Of the whole mesh."""
    edges: int
    faces: int
    low: npt.NDArray[Any]
    """The lower corners of the boxes of all parts, (n, 3)."""
    high: npt.NDArray[Any]
    """The upper corners, (n, 3)."""
    part_faces: npt.NDArray[Any]
    """The number of faces of each part, (n,)."""
    key: str
    """Names the content of the mesh and how it was divided."""

    @classmethod
    def open(cls, folder: "str | os.PathLike[str]") -> "Parts":
        """Returns the parts in a folder that split() has written. Raises sdm.Error if it has not been completed."""
        folder = os.path.abspath(os.fsdecode(folder))
        about = _files.read_json(Path(folder, "parts.json"))
        if about is None:
            raise sdm.Error(f"{folder} has no parts.json; split() writes it after all parts")
        arrays: dict[str, Any] = {name: np.array(about.pop(name)) for name in ("low", "high", "part_faces")}
        return cls(folder=folder, **arrays, **about)

    def __len__(self) -> int:
        return len(self.part_faces)

    def mesh(self, part: int) -> sdm.Mesh:
        """Reads a part as a mesh of its own, whose vertices and faces are in their order in the whole one."""
        with self._file(part) as arrays:
            return sdm.Mesh(arrays["positions"], arrays["triangles"])

    def numbers(self, part: int) -> tuple[Any, ...]:
        """Reads the numbers of a part's vertices, edges and faces in the whole mesh: three uint32 arrays that increase."""
        with self._file(part) as arrays:
            return arrays["vertices"], arrays["edges"], arrays["faces"]

    def _file(self, part: int) -> Any:
        return np.load(Path(self.folder, f"part-{part:06}.npz"))


def split(
    mesh: Any, folder: "str | os.PathLike[str]", *, faces_per_part: int = 1_000_000, faces: "object | None" = None
) -> Parts:
    """Divides a mesh into spatial parts of at most ``faces_per_part`` faces, which it writes to a folder.

    mesh: in any form; or the vertices, (n, 3), with ``faces``, (m, 3). Arrays may be memory-mapped, or paths of .npy files,
    which are: then the mesh need not fit in memory. At a time, some chunks of 4 million faces, 33 million edges and one
    part are in memory. The files take about 40 bytes for each face of a closed mesh, and about 100 while they are made.

    Each face belongs to one part. A part has more faces only if they have the same centroid. Nothing is done if the folder
    has the parts of the same mesh. Raises sdm.Error for a mesh that cannot be used (see sdm.Mesh). Runs here, not on
    workers. Cost: linear in faces, reading them once for each level of division, at least three times.

    >>> parts = sdm.dask.split(sphere, folder, faces_per_part=50)
    >>> len(parts) > 1, int(parts.part_faces.sum()) == len(sphere.faces)
    (True, True)
    """
    if faces_per_part < 1:
        raise sdm.Error("faces_per_part must be at least 1")
    positions, triangles = _arrays(mesh, faces)
    folder = os.path.abspath(os.fsdecode(folder))
    os.makedirs(folder, exist_ok=True)
    key = _checked(positions, triangles, faces_per_part)
    about = _files.read_json(Path(folder, "parts.json"))
    if about is not None:
        if about["key"] != key:
            raise sdm.Error(f"{folder} has the parts of another mesh, or of another size; use another folder or empty it")
        return Parts.open(folder)

    work = _work_folder(folder, [path for path in (mesh, faces) if isinstance(path, (str, os.PathLike))])
    lists = _with_area(_divided(positions, triangles, None, faces_per_part, work, "f"), positions, triangles)
    boxes = [_write_part(number, ids, positions, triangles, Path(folder)) for number, ids in enumerate(lists)]
    edges = _number_edges(len(boxes), len(positions), 3 * len(triangles), Path(folder), work)
    about = {
        "vertices": len(positions), "edges": edges, "faces": len(triangles), "key": key,
        "low": [low for low, _, _ in boxes], "high": [high for _, high, _ in boxes],
        "part_faces": [count for _, _, count in boxes],
    }  # fmt: skip
    for file in work.iterdir():
        if _OF_WORK.fullmatch(file.name):
            file.unlink()
    with contextlib.suppress(OSError):  # something else is in it
        work.rmdir()
    _files.write_json(Path(folder, "parts.json"), about)
    return Parts.open(folder)


def _work_folder(folder: str, inputs: "list[Any]") -> Path:
    """The folder for files of the work. Raises sdm.Error if there is something else in it, or an input."""
    work = Path(folder, "incomplete")
    work.mkdir(exist_ok=True)
    for file in work.iterdir():
        if not _OF_WORK.fullmatch(file.name):
            raise sdm.Error(f"{file} is in the folder of files that split() removes; move it, or use another folder")
        for path in inputs:
            if os.path.exists(path) and os.path.samefile(file, path):
                raise sdm.Error(f"split() would remove {file}: it is the input {os.fsdecode(path)}; use another folder")
    return work


def _arrays(mesh: Any, faces: Any) -> tuple[Any, ...]:
    def array(value: Any) -> Any:
        if isinstance(value, (str, os.PathLike)):
            try:
                return np.load(value, mmap_mode="r")
            except (OSError, ValueError) as error:
                raise sdm.Error(f"{os.fsdecode(value)}: {error}") from None
        return numpy_of(value, "an array")

    if faces is None:
        with _meshes.naming(_meshes.name_of(mesh, "the mesh")):
            return tuple(sdm.Mesh(mesh))
    positions, triangles = array(mesh), array(faces)
    if positions.ndim != 2 or positions.shape[1] != 3 or positions.dtype.kind not in "fiu":
        raise sdm.Error("the vertices must be n × 3 numbers")
    if triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind not in "iu":
        raise sdm.Error("the faces must be m × 3 integers")
    return positions, triangles


def _chunks(ids: "npt.NDArray[Any] | None", triangles: Any) -> Iterator[tuple[Any, ...]]:
    """Yields (face numbers, their corners), in increasing order."""
    for first in range(0, len(triangles) if ids is None else len(ids), _CHUNK):
        chosen = np.arange(first, min(first + _CHUNK, len(triangles))) if ids is None else np.array(ids[first : first + _CHUNK])
        yield chosen, np.asarray(triangles[chosen[0] : chosen[-1] + 1] if ids is None else triangles[chosen], np.int64)


def _checked(positions: Any, triangles: Any, faces_per_part: int) -> str:
    """Checks what sdm.Mesh checks, and returns the key of the parts."""
    if len(triangles) == 0:
        raise sdm.Error("there are no triangles")
    if len(triangles) > 1 << 30:
        raise sdm.Error(f"there are {len(triangles)} triangles, more than 2^30")
    if len(positions) >= sdm.NONE:
        raise sdm.Error(f"there are {len(positions)} vertices, too many for 32-bit indices")
    digests = [sdm.__version__, str(faces_per_part)]
    for first in range(0, len(positions), _CHUNK):
        chunk = np.asarray(positions[first : first + _CHUNK], np.float64)
        bad = np.flatnonzero(~(np.abs(chunk) <= _LARGEST).all(axis=1))
        if len(bad):
            raise sdm.Error(f"vertex {first + bad[0]} has a coordinate that is NaN or beyond 1e37")
        digests.append(_meshes.digest_of_arrays([chunk]))
    any_area = False
    for chosen, corners in _chunks(None, triangles):
        outside = np.flatnonzero(((corners < 0) | (corners >= len(positions))).any(axis=1))
        if len(outside):
            vertex = next(v for v in corners[outside[0]] if not 0 <= v < len(positions))
            raise sdm.Error(
                f"index out of range: triangle {chosen[outside[0]]} refers to vertex {vertex} of {len(positions)}"
            )
        digests.append(_meshes.digest_of_arrays([corners]))
        any_area = any_area or bool(_has_area(positions, corners).any())
    if not any_area:
        raise sdm.Error("all triangles are degenerate: none has positive area")
    return _files.key_of(digests=digests)


def _has_area(positions: Any, corners: npt.NDArray[Any]) -> npt.NDArray[Any]:
    a, b, c = (np.asarray(positions[corners[:, k]], np.float64) for k in range(3))
    area: npt.NDArray[Any] = (np.cross(b - a, c - a) != 0).any(axis=1)
    return area


def _centroids(positions: Any, corners: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """From sorted corners, so that duplicate faces have the same one, and stay together."""
    corners = np.sort(corners, axis=1)
    return np.asarray(sum(np.asarray(positions[corners[:, k]], np.float64) / 3 for k in range(3)))


def _divided(positions: Any, triangles: Any, ids: Any, largest: int, work: Path, name: str) -> list[Any]:
    """Returns files with the increasing face numbers of parts. Faces are ordered by the cells of a grid, along a Z-order
    curve; parts are runs of cells. A cell with too many faces has a grid of its own."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for _, corners in _chunks(ids, triangles):
        centroids = _centroids(positions, corners)
        low, high = np.minimum(low, centroids.min(axis=0)), np.maximum(high, centroids.max(axis=0))
    size = (high - low).max()

    def cells(corners: npt.NDArray[Any]) -> npt.NDArray[Any]:
        at = (_centroids(positions, corners) - low) * ((_CELLS - 1e-6) / size)
        return _z_order(np.clip(at, 0, _CELLS - 1).astype(np.int64))

    count = len(triangles) if ids is None else len(ids)
    if count <= largest or not size > 1e-300:
        counts, part_of_cell = None, np.zeros(_CELLS**3, np.int64)
    else:
        counts = np.zeros(_CELLS**3, np.int64)
        for _, corners in _chunks(ids, triangles):
            counts += np.bincount(cells(corners), minlength=len(counts))
        part_of_cell = _runs(counts, largest)
    files = [work / f"{name}-{part}" for part in range(int(part_of_cell.max()) + 1)]
    for file in files:
        file.unlink(missing_ok=True)
    for chosen, corners in _chunks(ids, triangles):
        part = np.zeros(len(chosen), np.int64) if counts is None else part_of_cell[cells(corners)]
        order = np.argsort(part, kind="stable")
        starts = np.flatnonzero(np.diff(part[order], prepend=-1))
        for begin, end in zip(starts, [*starts[1:], len(order)]):
            with open(files[part[order[begin]]], "ab") as opened:
                chosen[order[begin:end]].astype(np.int64).tofile(opened)
    result = []
    for file in files:
        members = np.memmap(file, np.int64, "r")
        if counts is None or len(members) <= largest:
            result.append(members)
        else:
            result += _divided(positions, triangles, members, largest, work, file.name)
    return result


def _z_order(cells: npt.NDArray[Any]) -> npt.NDArray[Any]:
    code = np.zeros(len(cells), np.int64)
    for bit in range(_CELLS.bit_length() - 1):
        for axis in range(3):
            code |= (cells[:, axis] >> bit & 1) << (3 * bit + axis)
    return code


def _runs(counts: npt.NDArray[Any], largest: int) -> npt.NDArray[Any]:
    """The run of each cell: consecutive cells with no more than ``largest`` faces together, or one cell with more."""
    run, total, runs = 0, 0, np.zeros(len(counts), np.int64)
    for cell in np.flatnonzero(counts):
        if total > 0 and total + counts[cell] > largest:
            run, total = run + 1, 0
        total += counts[cell]
        runs[cell] = run
    return runs


def _with_area(lists: list[Any], positions: Any, triangles: Any) -> list[Any]:
    """Joins parts that have no face with an area, which are no mesh of their own, to the one before or after."""
    result: list[Any] = []
    without: list[Any] = []
    for members in lists:
        if any(_has_area(positions, corners).any() for _, corners in _chunks(members, triangles)):
            result.append(np.sort(np.concatenate([*without, members])) if without else members)
            without = []
        else:
            without.append(members)
    if without:
        result[-1] = np.sort(np.concatenate([result[-1], *without]))
    return result


def _write_part(number: int, ids: Any, positions: Any, triangles: Any, folder: Path) -> tuple[Any, ...]:
    """Returns (lower corner, upper corner, number of faces)."""
    faces = np.array(ids)
    corners = np.asarray(triangles[faces], np.int64)
    vertices, local = np.unique(corners, return_inverse=True)
    own = np.asarray(positions[vertices], np.float64)
    local = local.reshape(-1, 3)
    with _files.replacing(folder / "incomplete" / f"part-{number:06}.npz") as partial:
        np.savez(partial, positions=own, triangles=local.astype(np.uint32), vertices=vertices.astype(np.uint32),
                 faces=faces.astype(np.uint32))  # fmt: skip
    return own.min(axis=0).tolist(), own.max(axis=0).tolist(), len(faces)


def _edges_of(corners: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The edges of a mesh as sdm numbers them: smaller · 2^32 + larger vertex, increasing. Faces that repeat a corner have
    none."""
    a, b, c = corners.astype(np.uint64).T
    proper = (a != b) & (b != c) & (c != a)
    ends = [(a[proper], b[proper]), (b[proper], c[proper]), (c[proper], a[proper])]
    edges: npt.NDArray[Any] = np.unique(np.concatenate([np.minimum(*e) << np.uint64(32) | np.maximum(*e) for e in ends]))
    return edges


def _number_edges(parts: int, vertices: int, most: int, folder: Path, work: Path) -> int:
    """Moves the parts to the folder with the numbers of their edges in the whole mesh, and returns how many it has.

    Edges are numbered in lexicographic order. They are gathered in files by ranges of their smaller vertex."""
    ranges = max(1, -(-most // _EDGES_AT_A_TIME))
    limits = np.linspace(0, vertices, ranges + 1).astype(np.uint64) << np.uint64(32)
    files = [work / f"edges-{k}" for k in range(ranges)]
    for file in files:
        file.unlink(missing_ok=True)

    def whole_edges(arrays: Any) -> npt.NDArray[Any]:
        return _edges_of(arrays["vertices"][arrays["triangles"]])

    for part in range(parts):
        with np.load(work / f"part-{part:06}.npz") as arrays:
            edges = whole_edges(arrays)
        cuts = np.searchsorted(edges, limits)
        for file, begin, end in zip(files, cuts, cuts[1:]):
            with open(file, "ab") as opened:
                edges[begin:end].tofile(opened)
    before = [0]
    for file in files:
        edges = np.unique(np.fromfile(file, np.uint64))
        edges.tofile(file)
        before.append(before[-1] + len(edges))
    if before[-1] >= sdm.NONE:
        raise sdm.Error(f"there are {before[-1]} edges, too many for 32-bit indices")
    for part in range(parts):
        with np.load(work / f"part-{part:06}.npz") as arrays:
            kept = {name: arrays[name] for name in arrays.files}
            edges = whole_edges(arrays)
        cuts = np.searchsorted(edges, limits)
        numbers = []
        for file, first, begin, end in zip(files, before, cuts, cuts[1:]):
            if begin < end:
                numbers.append(first + np.searchsorted(np.memmap(file, np.uint64, "r"), edges[begin:end]))
        joined = np.concatenate(numbers) if numbers else np.empty(0)
        with _files.replacing(folder / f"part-{part:06}.npz") as partial:
            np.savez(partial, edges=joined.astype(np.uint32), **kept)
    return before[-1]

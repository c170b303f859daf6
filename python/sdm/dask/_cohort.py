import contextlib
import copy
import operator
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import dask
import numpy as np
import numpy.typing as npt

import sdm
from sdm._arrays import numpy_of

from . import _files, _meshes

_FAN = 8

_sites = _meshes.Cache(2)
_surfaces = _meshes.Cache(2)  # lists of those that are free


@dataclass(frozen=True)
class CohortStatistics:
    """Statistics of the distance at each texel, over the copies of a mesh. Returned by the tasks of cohort_statistics().

    Arrays have a row for each row of texels, (H, W). Texels without a value in any copy hold NaN.
    """

    count: npt.NDArray[Any]
    """The number of copies with a value at the texel, uint32."""
    mean: npt.NDArray[Any]
    """float64, to rounding."""
    variance: npt.NDArray[Any]
    """Of the sample, divided by count − 1, float64, to rounding; NaN for a single copy."""
    min: npt.NDArray[Any]
    """float32, exact."""
    max: npt.NDArray[Any]
    """float32, exact."""
    low: float
    """The range of the bins."""
    high: float
    bins: npt.NDArray[Any]
    """The number of copies below the range, in each of n bins of equal width, and above, (n + 2, H, W) integers."""
    errors: dict[int, Any]
    """Why copies are not part of this, by their number."""

    @property
    def bin_width(self) -> float:
        """The width of the widest bin; all are equal, to rounding."""
        return float(np.diff(_edges(self.low, self.high, len(self.bins) - 2)).max())

    def quantile(self, q: float) -> "tuple[npt.NDArray[Any], npt.NDArray[Any]]":
        """Returns bounds (lower, upper), both (H, W) float64, on the q-quantile of the distances at each texel.

        The quantile is the smallest of them that at least the fraction q of all do not exceed, or the smallest one for q =
        0. Both bounds hold; they differ by no more than bin_width where the quantile is in the range.

        >>> copies = [sphere.vertices * scale for scale in (1, 1.25, 1.5)]
        >>> work = sdm.dask.cohort_statistics(sphere, copies, box, range=(-1, 2), resolution=64)
        >>> statistics = work.compute()
        >>> lower, upper = statistics.quantile(0.5)
        >>> bool(np.nanmax(upper - lower) <= statistics.bin_width)
        True
        """
        if not 0 <= q <= 1:
            raise sdm.Error("q must be in [0, 1]")
        rank = np.maximum(np.ceil(q * self.count), 1)
        bin_of = (np.cumsum(self.bins, axis=0) < rank).sum(axis=0)
        edges = _edges(self.low, self.high, len(self.bins) - 2)
        lower = np.maximum(np.concatenate([[-np.inf], edges])[np.minimum(bin_of, len(edges))], self.min)
        upper = np.minimum(np.concatenate([edges, [np.inf]])[np.minimum(bin_of, len(edges))], self.max)
        return lower, upper

    def save(self, file: "str | os.PathLike[str]") -> None:
        """Writes all arrays as .npz. The complete file appears, or none."""
        with _files.replacing(file) as partial, open(partial, "wb") as opened:
            np.savez_compressed(
                opened, count=self.count, mean=self.mean, variance=self.variance, min=self.min, max=self.max,
                low=self.low, high=self.high, bins=self.bins, error_copies=np.array(list(self.errors), np.int64),
                error_texts=np.array(list(self.errors.values()), str),
            )  # fmt: skip


def cohort_statistics(
    mesh: Any,
    copies: Iterable[Any],
    b: Any,
    *,
    range: "tuple[float, float]",
    bins: int = 64,
    resolution: int = 512,
    copies_per_task: int = 8,
    engine: str = "cpu",
    sign: str = "automatic",
    max_distance: float = float("inf"),
    threads: int = 1,
    **layout: Any,
) -> Any:
    """Describes statistics of the distance of many deformed copies of a mesh to ``b``, texel by texel on one atlas, and
    returns them as a Dask Delayed of CohortStatistics.

    mesh: in any form. Its atlas is used for all copies, so a texel is the same point of the body in each of them.
    copies: the vertices of each copy, in the order of those of ``mesh``: (n, 3) numbers, the path of an .npy file of them,
    or (path, k) for the k-th of a .npy file of (copies, n, 3).
    b: what distances are measured to, a mesh in any form; or a list of meshes, one for each copy.
    range, bins: distances are counted in ``bins`` intervals of equal width over the range, which bounds the error of
    quantiles by their width. Distances beyond are counted, too.
    The other options are those of sdm.Surface and sdm.map(). threads: used by each task.

    Tasks compute copies_per_task copies each; their results are merged by a tree, eight at a time, whose shape depends on
    copies_per_task and their number only. So the result is the same in every run, whatever the workers. A copy that cannot
    be used is left out and listed in ``errors``. Memory of a worker: 2 (bins + 16) bytes for each texel and each of up to
    nine results that are merged, twice that for 65536 copies or more.
    """
    low, high = float(range[0]), float(range[1])
    if not (low < high and np.isfinite(high - low)):
        raise sdm.Error("range must be two finite numbers, the smaller one first")
    if bins < 1 or copies_per_task < 1 or threads < 0:
        raise sdm.Error("bins and copies_per_task must be at least 1, threads at least 0")
    copies = [_portable_copy(vertices) for vertices in copies]
    if not copies:
        raise sdm.Error("there are no copies")
    several = isinstance(b, list)
    if several and len(b) != len(copies):
        raise sdm.Error(f"there are {len(copies)} copies, but {len(b)} meshes to measure to; give one, or one for each")
    work = {
        "layout": {"resolution": resolution, **layout},
        "search": {"engine": engine, "sign": sign, "max_distance": max_distance}, "threads": threads,
        "low": low, "high": high, "bins": bins, "counter": np.uint16 if len(copies) < 1 << 16 else np.uint32,
    }  # fmt: skip
    whole = dask.delayed(_meshes.portable(mesh), traverse=False)
    targets = [_meshes.portable(target) for target in (b if several else [b])]
    target = None if several else dask.delayed(targets[0], traverse=False)
    statistics = dask.delayed(_of_copies, pure=False)
    level = []
    for first in np.arange(0, len(copies), copies_per_task).tolist():
        own = copies[first : first + copies_per_task]
        to = targets[first : first + copies_per_task] if several else target
        level.append(statistics(whole, own, first, to, several, work))
    merged = dask.delayed(_merged, pure=False)
    while len(level) > _FAN:
        level = [merged(level[k : k + _FAN]) for k in np.arange(0, len(level), _FAN).tolist()]
    return dask.delayed(_finished, pure=False)(whole, merged(level), work)


def _portable_copy(copy: Any) -> Any:
    if isinstance(copy, (str, os.PathLike)):
        return os.path.abspath(os.fsdecode(copy)), None
    if isinstance(copy, tuple) and len(copy) == 2 and isinstance(copy[0], (str, os.PathLike)):
        return os.path.abspath(os.fsdecode(copy[0])), operator.index(copy[1])
    return np.array(numpy_of(copy, "a copy"))


def _vertices(copy: Any) -> npt.NDArray[Any]:
    if isinstance(copy, np.ndarray):
        return copy
    path, number = copy
    try:
        array = np.load(path, mmap_mode="r")
        return np.array(array if number is None else array[number])
    except (OSError, ValueError, IndexError) as error:
        raise sdm.Error(str(error) if path in str(error) else f"{path}: {error}") from None


def _edges(low: float, high: float, bins: int) -> npt.NDArray[Any]:
    return np.linspace(low, high, bins + 1)


class _Sums:
    """Of the distances of some copies, at the texels that faces own: count, mean, squares (of differences from the mean),
    min, max and bins; and what was wrong with other copies."""

    def __init__(self, texels: int, work: dict[str, Any]) -> None:
        self.count = np.zeros(texels, np.uint32)
        self.mean, self.squares = np.zeros(texels), np.zeros(texels)
        self.min, self.max = np.full(texels, np.inf, np.float32), np.full(texels, -np.inf, np.float32)
        self.bins = np.zeros((work["bins"] + 2, texels), work["counter"])
        self.errors: dict[int, Any] = {}

    def add(self, distances: npt.NDArray[Any], edges: npt.NDArray[Any]) -> None:
        """Adds a copy; NaN where it has no value (Welford 1962)."""
        at = np.flatnonzero(np.isfinite(distances))
        values = distances[at].astype(np.float64)
        self.count[at] += 1
        step = values - self.mean[at]
        self.mean[at] += step / self.count[at]
        self.squares[at] += step * (values - self.mean[at])
        self.min[at], self.max[at] = np.minimum(self.min[at], distances[at]), np.maximum(self.max[at], distances[at])
        # Bin k has edges[k - 1] < d <= edges[k], so that its upper edge bounds what it counts.
        self.bins[np.searchsorted(edges, values, side="left"), at] += 1

    def merge(self, other: "_Sums") -> None:
        """Adds the copies of the other one (Chan et al. 1979)."""
        count = self.count + other.count
        share = np.divide(other.count, count, out=np.zeros(len(count)), where=count > 0)
        step = other.mean - self.mean
        self.mean = self.mean + step * share
        self.squares = self.squares + other.squares + step * step * share * self.count
        self.count, self.bins = count, self.bins + other.bins
        self.min, self.max = np.minimum(self.min, other.min), np.maximum(self.max, other.max)
        self.errors = {**self.errors, **other.errors}


def _of_copies(mesh: Any, copies: list[Any], first: int, targets: Any, several: bool, work: dict[str, Any]) -> _Sums:
    edges = _edges(work["low"], work["high"], work["bins"])
    with sdm.thread_limit(work["threads"]), _surface(mesh, work) as surface:
        owned = surface.texel_faces != sdm.NONE
        sums = _Sums(int(np.count_nonzero(owned)), work)
        for number, vertices in enumerate(copies):
            try:
                sites = _sites_of(targets[number] if several else targets)
                surface.refit(_vertices(vertices))
                sums.add(sdm.map(surface, sites, **work["search"]).distance[owned], edges)
            except (sdm.Error, OSError) as error:
                sums.errors[first + number] = str(error)
    return sums


def _sites_of(target: Any) -> sdm.Sites:
    with _meshes.naming(target if isinstance(target, str) else "the mesh to measure to"):
        sites: sdm.Sites = _sites.get(_meshes.digest(target), lambda: sdm.Sites(_meshes.load(target)))
        return sites


@contextlib.contextmanager
def _surface(mesh: Any, work: dict[str, Any]) -> Iterator[sdm.Surface]:
    """A surface that no other thread uses meanwhile, with the atlas of the mesh as it is in the mesh. Laying it out takes
    longer than a map, so surfaces are kept for later tasks."""
    key = _meshes.digest(mesh), _files.key_of(layout=work["layout"])
    free = _surfaces.get(key, list)
    try:
        surface = free.pop()
    except IndexError:
        surface = sdm.Surface(_meshes.load(mesh), **work["layout"])
    try:
        yield surface
    finally:
        free.append(surface)


def _merged(sums: list[Any]) -> _Sums:
    """From the first to the last. Does not change what it is given, which Dask may use again."""
    total: _Sums = copy.copy(sums[0])
    for other in sums[1:]:
        total.merge(other)
    return total


def _finished(mesh: Any, sums: _Sums, work: dict[str, Any]) -> CohortStatistics:
    none = sums.count == 0
    if none.all():
        number, text = next(iter(sorted(sums.errors.items())), (0, "no texel has a value"))
        raise sdm.Error(f"no copy has distances; copy {number}: {text}")
    with sdm.thread_limit(work["threads"]), _surface(mesh, work) as surface:
        owned = surface.texel_faces != sdm.NONE

    def image(values: npt.NDArray[Any], without: Any) -> npt.NDArray[Any]:
        result = np.full((*values.shape[:-1], *owned.shape), without, values.dtype)
        result[..., owned] = values
        return result

    def valued(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
        return image(np.where(none, values.dtype.type(np.nan), values), np.nan)

    variance = np.full(len(sums.count), np.nan)
    np.divide(sums.squares, sums.count - 1.0, out=variance, where=sums.count > 1)
    return CohortStatistics(
        count=image(sums.count, 0), mean=valued(sums.mean), variance=image(variance, np.nan),
        min=valued(sums.min), max=valued(sums.max), low=work["low"], high=work["high"],
        bins=image(sums.bins, 0), errors=dict(sorted(sums.errors.items())),
    )  # fmt: skip

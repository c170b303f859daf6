"""Maps on many machines, with Dask: ``pip install 'surface-distance-maps[dask]'``.

=====================  ==========================================================================================
map_pairs()            many pairs of meshes: a table of statistics, verdicts and files
split(), map_parts()   one pair that is too large for a machine: O2 in parts, O1 in tiles
cohort_statistics()    deformed copies of a mesh on one atlas: mean, variance and quantiles at each texel
=====================  ==========================================================================================

Every function describes the work and returns at once. Dask carries it out: on the machine's cores, or on the workers of a
``dask.distributed.Client`` if there is one. Folders must be reachable, by the same path, from all of them.
"""

from ._cohort import CohortStatistics, cohort_statistics
from ._map_parts import PartsMap, map_parts
from ._pairs import map_pairs
from ._split import Parts, split

__all__ = ["CohortStatistics", "Parts", "PartsMap", "cohort_statistics", "map_pairs", "map_parts", "split"]

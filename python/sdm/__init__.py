"""Surface distance maps between triangle meshes, and exact proximity.

Arrays in, arrays out: vertices and points are n × 3 numbers of any dtype and order, faces m × 3 integers. Lengths are in
the units of the meshes. Distances are negative inside a closed mesh where they are signed. Errors are raised as
``sdm.Error``, with one sentence that names the object, the fault and the remedy.

>>> distance_map = sdm.map(sphere, box, resolution=256)
>>> distance_map.distance.shape
(256, 256)
>>> closest = sdm.closest_points(*box, [[2, 0.5, 0.5]])
>>> closest.point
array([[1. , 0.5, 0.5]])
"""

from ._core import (
    Alignment,
    BoundedLength,
    Cancelled,
    ClosestPoints,
    Contacts,
    Coverage,
    DegreeOfFreedom,
    DistanceField,
    DistanceStatistics,
    Doubt,
    Error,
    FaceNames,
    FieldSamples,
    GroupVerdict,
    GroupVerdicts,
    MadeScan,
    Mesh,
    MultiBodyQuery,
    NearestMap,
    Pairs,
    Place,
    Places,
    PointDistances,
    PointExtreme,
    ProximityQuery,
    RayHits,
    Scene,
    SceneBody,
    SelfProximityQuery,
    Shape,
    Sites,
    Surface,
    TimeOfContact,
    ToleranceVerdict,
    WeldReport,
    align,
    align_321,
    align_points,
    alignment_doubts,
    coverage,
    distance_field,
    engines,
    fit_to_unit,
    hausdorff,
    make_scan,
    measure_points,
    read,
    read_face_names,
    read_points,
    remove_islands,
    scene,
    thread_limit,
    time_of_contact,
    weld,
)
from ._core import version as __version__
from ._closest_points import NONE, SiteType, closest_points
from ._distance_map import DistanceMap, MapBounds
from ._maps import map, self_map, thickness

__all__ = [
    "Alignment",
    "BoundedLength",
    "Cancelled",
    "ClosestPoints",
    "Contacts",
    "Coverage",
    "DegreeOfFreedom",
    "DistanceField",
    "DistanceMap",
    "DistanceStatistics",
    "Doubt",
    "Error",
    "FaceNames",
    "FieldSamples",
    "GroupVerdict",
    "GroupVerdicts",
    "MadeScan",
    "MapBounds",
    "Mesh",
    "MultiBodyQuery",
    "NONE",
    "NearestMap",
    "Pairs",
    "Place",
    "Places",
    "PointDistances",
    "PointExtreme",
    "ProximityQuery",
    "RayHits",
    "Scene",
    "SceneBody",
    "SelfProximityQuery",
    "Shape",
    "Sites",
    "SiteType",
    "Surface",
    "TimeOfContact",
    "ToleranceVerdict",
    "WeldReport",
    "align",
    "align_321",
    "align_points",
    "alignment_doubts",
    "closest_points",
    "coverage",
    "distance_field",
    "engines",
    "fit_to_unit",
    "hausdorff",
    "make_scan",
    "map",
    "measure_points",
    "read",
    "read_face_names",
    "read_points",
    "remove_islands",
    "scene",
    "self_map",
    "thickness",
    "thread_limit",
    "time_of_contact",
    "weld",
]

# Tracebacks, reprs and pickles name what users import.
for _name in __all__:
    if isinstance(globals()[_name], type):
        globals()[_name].__module__ = "sdm"

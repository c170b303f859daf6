"""Random options of calls: sets that are allowed, and sets with one fault."""

import random
from dataclasses import dataclass, field

Options = dict[str, str]


@dataclass
class Call:
    """Values that every door can be given. None depends on another one, but for what options exclude."""

    allowed: dict[str, list[str]]
    refused: dict[str, list[str]]
    excluded: list[Options] = field(default_factory=list)
    usual: Options = field(default_factory=dict)
    """What is given unless another value is."""
    faults: list[str] = field(default_factory=list)
    """Options of which some values do not go with some of others: with one of them in a fault, the others are left out."""


MAX_DISTANCE = ["0.05", "0.75", "1e6"]
NO_DISTANCE = ["0", "-0.5", "nan"]
ANGLE, NO_ANGLE = ["1e-3", "60", "90", "180"], ["0", "-90", "180.5"]
ATLAS = {
    "resolution": ["16", "32", "47"],
    "atlas": ["charts", "triangles"],
    "gutter": ["0", "2"],
    "strict_uv": ["true"],
    "max_stretch": ["1.05", "2.5", "100"],
}
NO_ATLAS = {
    "resolution": ["15", "32769", "-16"],
    "atlas": ["chart", "UV", "none"],
    "gutter": ["-1", "8193"],
    "max_stretch": ["1", "0.5", "100.5", "nan"],
}
MAP = {"max_distance": MAX_DISTANCE, "sign": ["automatic", "none", "exact", "winding", "side"], "facing": ANGLE}
NO_MAP = {"max_distance": NO_DISTANCE, "sign": ["inside", "None", "automatics"], "facing": NO_ANGLE}
ALONG = {"along": ["normal", "0,0,1", "0.5,-1,2"]}
NO_ALONG = {"along": ["0,0,0", "up", "1,2"]}
FACING_SIGNS = [{"facing": "90", "sign": "exact"}, {"facing": "12.5", "sign": "winding"}]
ALONG_OTHERS = [{"along": "normal", "facing": "90"}, {"along": "0,0,1", "sign": "side"}]

CALLS = {
    "map": Call(ATLAS | MAP | ALONG, NO_ATLAS | NO_MAP | NO_ALONG, FACING_SIGNS + ALONG_OTHERS, {"resolution": "64"}, ["facing", "sign", "along"]),
    "self": Call(
        ATLAS | {"max_distance": MAX_DISTANCE, "rings": ["1", "2", "5"], "geodesic": ["0.01", "0.5"]},
        NO_ATLAS | {"max_distance": NO_DISTANCE, "rings": ["0", "-1", "1.5"], "geodesic": ["0", "nan"]},
        [{"rings": "2", "geodesic": "0.5"}],
        {"resolution": "32"},
        ["rings", "geodesic"],
    ),
    "thickness": Call(
        ATLAS | {"method": ["ball", "ray"], "angle": ["1e-3", "60", "179"]},
        NO_ATLAS | {"method": ["balls", "rays"], "angle": ["0", "180", "-90"]},
        [],
        {"resolution": "32"},
    ),
    "points": Call(
        MAP | {"colormap": ["automatic", "viridis", "diverging"], "tolerance": ["0", "0.1"], "separator": ["automatic", "blank"], "decimal": ["point"]},
        NO_MAP | {"colormap": ["jet", "Viridis"], "tolerance": ["-0.1", "nan"], "separator": ["blanks"], "decimal": ["dot"]},
        FACING_SIGNS,
        {},
        ["facing", "sign"],
    ),
    "align": Call({"free": ["xyz", "x,y,rz", "xyz,rxyz"], "about": ["0,0,0", "1,-2.5,1e3"]}, {"free": ["xyw", "xyz,r", "z,,x"], "about": ["0,nan,0", "0,0,1e38"]}),
    "simplify": Call(
        {"triangles": ["10", "60", "1000"], "lods": ["0", "1", "3"], "keep_vertices": ["true"]},
        {"triangles": ["0", "-5", "2.5"], "lods": ["33", "-1", "0.5"], "max_deviation": ["0", "-0.5", "nan"]},
        [{"max_deviation": "0.1", "triangles": "10"}],
        {"triangles": "20"},
        ["max_deviation", "triangles"],
    ),
    "bake": Call(
        {
            "channels": ["displacement", "position,displacement", "face"],
            "resolution": ["16", "32"],
            "atlas": ["charts", "triangles"],
            "gutter": ["0", "2"],
            "samples": ["1", "4"],
            "match": ["facing", "ray"],
            "facing": ["60", "90"],
            "max_distance": ["0.75", "1e6"],
            "occlusion_rays": ["1", "65536"],
            "occlusion_distance": ["0.5"],
            "thickness_method": ["ball", "ray"],
        },
        {
            "channels": ["displacements", "face,gloss"],
            "resolution": ["15", "32769"],
            "atlas": ["chart"],
            "gutter": ["-1", "8193"],
            "samples": ["2", "0", "65"],
            "match": ["nearest"],
            "facing": NO_ANGLE,
            "cage": NO_DISTANCE,
            "max_distance": NO_DISTANCE,
            "occlusion_rays": ["0", "65537"],
            "occlusion_distance": NO_DISTANCE,
            "thickness_method": ["balls"],
        },
        [{"facing": "60", "match": "closest"}, {"cage": "0.5", "match": "facing"}],
        {"channels": "displacement", "resolution": "32"},
        ["match", "facing", "cage"],
    ),
    "bodies": Call(
        {"depth_precision": ["0.01", "1e-3"], "contact_margin": ["0", "0.1"], "ignore_internal_edges": ["true"]},
        {"depth_precision": NO_DISTANCE, "contact_margin": ["-0.1", "nan"]},
    ),
}


def misspelt(name: str, chance: random.Random) -> str:
    """A name without one letter that is not at its end, so that it is nearest to the right one."""
    at = chance.randrange(1, len(name) - 1)
    return misspelt(name, chance) if "_" in name[at - 1 : at + 2] else name[:at] + name[at + 1 :]


def option_set(call: Call, fault: int, chance: random.Random) -> Options:
    names = chance.sample(sorted(call.allowed), chance.randint(0, min(4, len(call.allowed))))
    options = {name: chance.choice(call.allowed[name]) for name in names}
    while any(set(excluded) <= set(options) for excluded in call.excluded):
        del options[chance.choice([name for name in options if name in call.faults])]
    name = ""
    if fault == 1:
        name = chance.choice(sorted(call.refused))
        given = {name: chance.choice(call.refused[name])}
    elif fault == 2:
        name = chance.choice(sorted(set(call.allowed) - {"sign", "atlas", "along", "match", "separator", "decimal"}))
        options.pop(name, None)
        given = {misspelt(name, chance): call.allowed[name][0]}
    elif fault == 3 and call.excluded:
        name, given = call.faults[0], chance.choice(call.excluded)
    else:
        given = {}
    if name in call.faults:
        options = {other: value for other, value in options.items() if other not in call.faults}
    return {**{other: value for other, value in call.usual.items() if name not in call.faults or other not in call.faults}, **options, **given}


def option_sets(count: int, seed: int) -> "list[tuple[str, Options]]":
    """Calls with their options: of the map twice as many as of each other call."""
    chance = random.Random(seed)
    names = ["map", *CALLS]
    return [(names[k % len(names)], option_set(CALLS[names[k % len(names)]], k // len(names) % 4, chance)) for k in range(count)]

"""Random options of a map: sets that are allowed, and sets with one fault."""

import random

# Values that every door can be given. None depends on another one, but for what options exclude.
ALLOWED = {
    "resolution": ["16", "32", "47"],
    "atlas": ["charts", "triangles"],
    "gutter": ["0", "2"],
    "strict_uv": ["true"],
    "max_stretch": ["1.05", "2.5", "100"],
    "max_distance": ["0.05", "0.75", "1e6"],
    "sign": ["automatic", "none", "exact", "winding", "side"],
    "facing": ["1e-3", "60", "90", "180"],
    "along": ["normal", "0,0,1", "0.5,-1,2"],
}
REFUSED = {
    "resolution": ["15", "32769", "-16"],
    "atlas": ["chart", "UV", "none"],
    "gutter": ["-1", "8193"],
    "max_stretch": ["1", "0.5", "100.5", "nan"],
    "max_distance": ["0", "-0.5", "nan"],
    "sign": ["inside", "None", "automatics"],
    "facing": ["0", "-90", "180.5"],
    "along": ["0,0,0", "up", "1,2"],
}
EXCLUDED = [
    {"facing": "90", "sign": "exact"},
    {"facing": "12.5", "sign": "winding"},
    {"along": "normal", "facing": "90"},
    {"along": "0,0,1", "sign": "side"},
]


def misspelt(name: str, chance: random.Random) -> str:
    """A name without one letter that is not at its end, so that it is nearest to the right one."""
    at = chance.randrange(1, len(name) - 1)
    return misspelt(name, chance) if "_" in name[at - 1 : at + 2] else name[:at] + name[at + 1 :]


def option_sets(count: int, seed: int) -> list[dict[str, str]]:
    chance = random.Random(seed)
    sets = []
    for k in range(count):
        names = chance.sample(sorted(ALLOWED), chance.randint(0, 4))
        options = {name: chance.choice(ALLOWED[name]) for name in names}
        if "facing" in options and options.get("sign") in ("exact", "winding"):
            del options["facing"]
        if "along" in options:
            options.pop("facing", None)
            options.pop("sign", None)
        fault = k % 4
        if fault == 1:
            name = chance.choice(sorted(REFUSED))
            if name == "facing":
                options.pop("sign", None)
                options.pop("along", None)
            if name == "sign":
                options.pop("facing", None)
                options.pop("along", None)
            if name == "along":
                options.pop("sign", None)
                options.pop("facing", None)
            options[name] = chance.choice(REFUSED[name])
        elif fault == 2:
            name = chance.choice(sorted(set(ALLOWED) - {"sign", "atlas", "along"}))
            options.pop(name, None)
            options[misspelt(name, chance)] = ALLOWED[name][0]
        elif fault == 3 and k % 8 == 3:
            options.pop("along", None)
            options |= chance.choice(EXCLUDED)
        sets.append(options)
    return sets

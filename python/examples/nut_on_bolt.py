#!/usr/bin/env python3
"""A nut screws down its bolt: it is turned by 6°, falls until the threads touch, and so on.

usage: nut_on_bolt.py

MultiBodyQuery.time_of_contact() says how far the nut falls, and that it is free on the way.
"""

import numpy as np

import sdm

SIDES, ROWS = 48, 4  # around the axis, and along each pitch
PITCH, CREST, ROOT = 1.0, 3.0, 2.5


class Helix:
    """A band around the axis whose rows climb by a pitch with each turn: after SIDES columns, row j meets row j + ROWS
    of the first one."""

    def __init__(self, rows):
        self.rows = rows
        places = [(i, j) for i in range(SIDES) for j in range(rows + 1 + (ROWS if i == 0 else 0))]
        self.column, self.row = np.array(places).T
        self.number = {place: k for k, place in enumerate(places)}

    def vertex(self, i, j):
        return self.number[(0, j + ROWS) if i == SIDES else (i, j)]

    def points(self, radius):
        angle = 2 * np.pi * self.column / SIDES
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), PITCH * (self.row / ROWS + self.column / SIDES)], axis=1)

    def quads(self):
        v = self.vertex
        return [(v(i, j), v(i + 1, j), v(i + 1, j + 1), v(i, j + 1)) for i in range(SIDES) for j in range(self.rows)]

    def end(self, row):
        """The edges of an end in order around the axis: a turn of the first or last row, and the step back."""
        loop = [self.vertex(i, row) for i in range(SIDES)] + [self.vertex(0, row + j) for j in range(ROWS, 0, -1)]
        return list(zip(loop, loop[1:] + loop[:1]))


def triangles(quads):
    return [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def thread(row):
    """Two rows on the crest of the thread, and two on its root."""
    return np.where(row % ROWS < ROWS // 2, CREST, ROOT)


def bolt(rows):
    helix = Helix(rows)
    points = helix.points(thread(helix.row))
    faces = triangles(helix.quads())
    low, high = len(points), len(points) + 1  # points of the axis that close the ends
    faces += [(a, low, b) for a, b in helix.end(0)] + [(a, b, high) for a, b in helix.end(helix.rows)]
    return np.vstack([points, [[0, 0, PITCH / 2], [0, 0, PITCH * (rows / ROWS + 0.5)]]]), np.array(faces)


def nut(rows, clearance):
    """Hexagonal outside; the thread inside is wider than that of the bolt by the clearance."""
    helix = Helix(rows)
    inside = helix.points(thread(helix.row) + clearance)
    side = np.pi / 3
    outside = helix.points(4.5 / np.cos(np.fmod(2 * np.pi * helix.column / SIDES, side) - side / 2))
    out = len(inside)
    quads = [q[::-1] for q in helix.quads()] + [tuple(out + k for k in q) for q in helix.quads()]
    quads += [(a, b, out + b, out + a) for a, b in helix.end(0)]
    quads += [(out + a, out + b, b, a) for a, b in helix.end(helix.rows)]
    return np.vstack([inside, outside]), np.array(triangles(quads))


def pose(degrees, height):
    """The nut, turned as a right-handed screw that is driven down."""
    half = np.radians(-degrees) / 2
    return [0, 0, height, np.cos(half), 0, 0, np.sin(half)]


def main(turns=2, step=6.0, tolerance=1e-4, log=print):
    """Returns how far each turn advances the nut. Raises RuntimeError for a collision."""
    world = sdm.MultiBodyQuery([bolt(6 * ROWS), nut(ROWS + 2, 0.05)])
    world.set_filter(0, fixed=True)
    rest, fall = pose(0, 0), PITCH / 2
    angle, height, advances = 0.0, 4 * PITCH, []
    for turn in range(turns + 1):
        before = height
        for _ in range(1 if turn == 0 else round(360 / step)):
            # The bodies are more than half of the tolerance apart, and turning makes room for the nut.
            by = 0 if turn == 0 else step
            turned = pose(angle + by, height)
            if len(world.time_of_contact([rest, pose(angle, height)], [rest, turned], tolerance=tolerance / 4)):
                raise RuntimeError("the nut is stuck")
            angle += by
            found = world.time_of_contact([rest, turned], [rest, pose(angle, height - fall)], tolerance=tolerance)
            if len(found) == 0:
                raise RuntimeError("the nut falls off the bolt")
            height -= fall * found.time[0]
            world.set_poses([rest, pose(angle, height)])
            if len(world.colliding()):
                raise RuntimeError("the threads intersect")
        if turn > 0:  # before, it falls from where it was held to where it rests on the thread
            advances.append(before - height)
            log(f"turn {turn}: advanced by {before - height:.4f}")
    return advances


if __name__ == "__main__":
    main()

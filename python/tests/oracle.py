"""Closest points by brute force in NumPy: every point against every face."""

import numpy as np


def closest_on_segments(p, a, b):
    """For (n, 1, 3) points and (1, m, 3) segments: the closest points, (n, m, 3)."""
    along = b - a
    length = (along * along).sum(-1)
    t = ((p - a) * along).sum(-1) / np.where(length > 0, length, 1)
    return a + np.clip(t, 0, 1)[..., None] * along


def closest_points(vertices, faces, points):
    """Returns (distances, closest points)."""
    p = points[:, None]
    a, b, c = (vertices[faces[:, k]][None] for k in range(3))
    candidates = [closest_on_segments(p, a, b), closest_on_segments(p, b, c), closest_on_segments(p, c, a)]
    normal = np.cross(b - a, c - a)
    squared = (normal * normal).sum(-1)
    height = ((p - a) * normal).sum(-1) / np.where(squared > 0, squared, 1)
    foot = p - height[..., None] * normal
    inside = squared > 0
    for start, end in ((a, b), (b, c), (c, a)):
        inside = inside & ((np.cross(end - start, foot - start) * normal).sum(-1) >= 0)
    candidates.append(np.where(inside[..., None], foot, np.inf))
    every = np.concatenate(candidates, axis=1)
    distances = np.linalg.norm(every - p, axis=-1)
    best = distances.argmin(axis=1)
    rows = np.arange(len(points))
    return distances[rows, best], every[rows, best]


def winding_numbers(vertices, faces, points):
    """By solid angles (Van Oosterom & Strackee 1983), (n,)."""
    a, b, c = (vertices[faces[:, k]][None] - points[:, None] for k in range(3))
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    numerator = (a * np.cross(b, c)).sum(-1)
    denominator = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    return np.arctan2(numerator, denominator).sum(axis=1) / (2 * np.pi)

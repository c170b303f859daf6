#!/usr/bin/env python3
"""Fifty rings, which are not convex, fall onto a floor and come to rest in a pile.

usage: pile.py

A rigid-body loop on the contacts of MultiBodyQuery, with those of all pairs in arrays.
"""

import numpy as np

import sdm

RADIUS, TUBE = 0.5, 0.2  # of a ring, and of the tube
TIME, GRAVITY, MARGIN, SLOP, PUSH = 1 / 120, 9.81, 0.02, 1e-3, 0.5
DAMPING, FRICTION = 0.97, 0.6
# The inertia of a ring of mass 1, about its axis and across it.
ALONG, ACROSS = RADIUS**2 + 3 / 4 * TUBE**2, RADIUS**2 / 2 + 5 / 8 * TUBE**2


def box(low, high):
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)])
    faces = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4],
             [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]  # fmt: skip
    return np.where(corners, high, low).astype(float), np.array(faces)


def ring(around=14, across=7):
    i, j = np.divmod(np.arange(around * across), across)
    u, v = 2 * np.pi * i / around, 2 * np.pi * j / across
    r = RADIUS + TUBE * np.cos(v)
    b, d = (i + 1) % around * across + j, i * across + (j + 1) % across
    a, c = i * across + j, (i + 1) % around * across + (j + 1) % across
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    return np.stack([r * np.cos(u), r * np.sin(u), TUBE * np.sin(v)], axis=1), faces


class World:
    """Rings of mass 1, of which the last body, the floor, has infinitely much."""

    def __init__(self, rings):
        i = np.arange(rings)
        self.centre = np.zeros((rings + 1, 3))
        self.centre[:-1] = np.stack([1.5 * (i % 5 - 2), 1.5 * (i // 5 % 5 - 2), 0.8 + 1.5 * (i // 25)], axis=1)
        self.turn = np.tile([1.0, 0, 0, 0], (rings + 1, 1))  # quaternions, w x y z
        self.turn[:-1] = np.stack([np.cos(i), np.sin(i) * np.cos(3 * i), np.sin(i) * np.sin(3 * i), 0 * i], axis=1)
        self.motion = np.zeros((rings + 1, 6))  # velocity and spin
        self.moves = np.append(np.ones(rings), 0)
        floor = box([-9, -9, -1], [9, 9, 0])
        self.query = sdm.MultiBodyQuery([sdm.Shape(ring())] * rings + [floor], contact_margin=MARGIN)
        self.query.set_filter(rings, fixed=True)
        self.impulses = {}  # of contacts, by bodies and id

    def inverse_masses(self):
        """What turns an impulse and an angular impulse of each body into a change of its motion, (bodies, 6, 6)."""
        w, x, y, z = self.turn.T
        axis = np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], axis=1)
        inverse = np.zeros((len(axis), 6, 6))
        inverse[:, :3, :3] = np.eye(3)
        inverse[:, 3:, 3:] = np.eye(3) / ACROSS + (1 / ALONG - 1 / ACROSS) * axis[:, :, None] * axis[:, None, :]
        return inverse * self.moves[:, None, None]

    def step(self, iterations=30):
        self.motion = DAMPING * self.motion - self.moves[:, None] * [0, 0, TIME * GRAVITY, 0, 0, 0]
        self.query.set_poses(np.concatenate([self.centre, self.turn], axis=1))
        contacts = self.query.contacts()
        gap = -contacts.depth  # below 0: pushed out, a fifth of it in each frame
        push = np.maximum(0.2 * np.minimum(gap + SLOP, 0) / TIME, -PUSH)
        self.solve(contacts, np.where(gap > 0, gap / TIME, push), iterations, warm=True)
        self.centre += TIME * self.motion[:, :3]
        w, v, spin = self.turn[:, :1], self.turn[:, 1:], self.motion[:, 3:]
        rate = np.concatenate([-np.sum(spin * v, axis=1, keepdims=True), w * spin + np.cross(spin, v)], axis=1)
        self.turn += TIME / 2 * rate
        self.turn /= np.linalg.norm(self.turn, axis=1, keepdims=True)
        # What pushed bodies out of each other is no motion that lasts.
        self.solve(contacts, np.maximum(gap, 0) / TIME, iterations // 3)

    def solve(self, contacts, allowed, iterations, warm=False):
        """Finds the impulses of all contacts at once, each with its share of the masses of its bodies. allowed: the
        speeds at which the bodies of each contact may approach each other. warm: begins with the impulses of before."""
        if len(contacts) == 0:
            return
        a, b = contacts.bodies.T.astype(int)
        across = np.cross(contacts.normal, np.where(np.abs(contacts.normal[:, :1]) < 0.7, [1.0, 0, 0], [0, 1.0, 0]))
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        axes = np.stack([contacts.normal, across, np.cross(contacts.normal, across)], axis=1)  # (n, 3, 3)
        # The impulse and angular impulse on both bodies of an impulse of 1 along each axis, (n, 3, 6).
        arms = (contacts.point1 - self.centre[a])[:, None], (contacts.point2 - self.centre[b])[:, None]
        on_a, on_b = (s * np.concatenate([axes, np.cross(arm, axes)], axis=2) for s, arm in zip((1, -1), arms))
        inverse = self.inverse_masses()
        change_a, change_b = on_a @ inverse[a], on_b @ inverse[b]
        shares = np.bincount(np.concatenate([a, b]), minlength=len(inverse))[:, None]
        response = np.sum(change_a * on_a, axis=2) * shares[a] + np.sum(change_b * on_b, axis=2) * shares[b]
        index = (np.concatenate([a, b])[:, None] * 6 + np.arange(6)).ravel()
        change, on = np.concatenate([change_a, change_b]), np.concatenate([on_a, on_b])
        bodies = np.concatenate([a, b])

        def moved(by):
            both = np.matmul(np.concatenate([by, by])[:, None], change)
            return np.bincount(index, both.ravel(), minlength=self.motion.size).reshape(self.motion.shape)

        keys = list(zip(a.tolist(), b.tolist(), contacts.id.tolist()))
        impulse = np.array([self.impulses.get(key, (0, 0, 0)) for key in keys], float)
        allowed = np.stack([allowed, 0 * allowed, 0 * allowed], axis=1)
        motion = self.motion + (moved(impulse) if warm else 0)
        for _ in range(iterations):
            speed = np.matmul(on, motion[bodies][:, :, None])[:, :, 0]
            wanted = impulse - (speed[: len(a)] + speed[len(a) :] + allowed) / response
            wanted[:, 0] = np.maximum(wanted[:, 0], 0)
            most = FRICTION * wanted[:, :1]
            wanted[:, 1:] = np.clip(wanted[:, 1:], -most, most)
            motion += moved(wanted - impulse)
            impulse = wanted
        self.motion, self.impulses = motion, dict(zip(keys, impulse))

    def kinetic_energy(self):
        """At most: the inertia about the axis is the largest."""
        return 0.5 * np.sum(self.motion[:, :3] ** 2) + 0.5 * ALONG * np.sum(self.motion[:, 3:] ** 2)


def main(rings=50, frames=500, log=print):
    """Returns the kinetic energy at the end, and how deep a ring is in another body at most."""
    world = World(rings)
    for frame in range(1, frames + 1):
        world.step()
        if frame % 100 == 0:
            log(f"frame {frame:3}: {len(world.impulses)} contacts, kinetic energy {world.kinetic_energy():.5f}")
    deepest = world.query.penetration_depths().penetration_depth_bounds[:, 1].max(initial=0)
    log(f"the highest is at {world.centre[:, 2].max():.2f}; none is deeper than {deepest:.4f} in another")
    return world.kinetic_energy(), deepest


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Fits a template to a scan by gradient descent in PyTorch: the template keeps its faces, and its vertices move.

usage: fit_template.py TEMPLATE SCAN OUTPUT.ply

The loss is the sum of the mean squared distances from points of the scan to the template, and from vertices of the template
to the scan. Its derivatives are smoothed over the edges of the template, first much, then less, so that it bends and does not
fold. Both meshes are prepared once: the scan does not change, and the Sites of the template are refitted in each step.
"""

import sys

import numpy as np
import torch

import sdm
import sdm.torch


def smoothing(sites):
    """The sparse matrix that replaces the values of vertices by the means of them and their neighbours."""
    count = len(sites.vertices)
    a, b = torch.from_numpy(sites.edges.astype(np.int64)).T
    itself = torch.arange(count)
    rows, columns = torch.cat([a, b, itself]), torch.cat([b, a, itself])
    degrees = torch.bincount(rows, minlength=count).double()
    indices = torch.stack([rows, columns])
    return torch.sparse_coo_tensor(indices, 1 / degrees[rows], (count, count), check_invariants=False).to_sparse_csr()


def fit(template, scan, steps=60, samples=50_000, log=print):
    """Returns the vertices of the fitted template, (v, 3)."""
    torch.manual_seed(0)
    sites, scan = sdm.Sites(template), sdm.Sites(scan)
    faces = torch.from_numpy(sites.faces.astype(np.int64))
    vertices = torch.from_numpy(np.array(sites.vertices)).requires_grad_()
    chosen = sdm.torch.sample_surface(scan, samples)
    corners = torch.from_numpy(scan.vertices[scan.faces[chosen.face.numpy()]])
    points = (chosen.barycentric[..., None] * corners).sum(1)

    matrix, size = smoothing(sites), float(np.ptp(scan.vertices, axis=0).max())
    # A mean has derivatives that shrink with the number of vertices: the rate makes up for it.
    optimizer = torch.optim.SGD([vertices], lr=0.2 * len(vertices), momentum=0.5)
    for step in range(steps):
        optimizer.zero_grad()
        from_scan = sdm.torch.point_to_surface(points, vertices, faces, sites=sites)
        loss = from_scan + sdm.torch.point_to_surface(vertices, scan)
        loss.backward()
        for _ in range(1 + 4 * (steps - 1 - step) // steps):
            vertices.grad = matrix @ vertices.grad
        optimizer.step()
        if step % 10 == 0:
            log(f"step {step:3}: rms distance {float(loss.detach() / 2) ** 0.5 / size:.2e} of the size")
    return vertices.detach().numpy()


def main(template_file, scan_file, output):
    template, scan = sdm.read(template_file), sdm.read(scan_file)
    fitted = fit(template, scan)
    sdm.map((fitted, template.faces), scan, sign="none", resolution=512).save(output)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__.strip().splitlines()[2])
    main(*sys.argv[1:])

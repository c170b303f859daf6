"""Cases of `bench/python` beyond closest points of one closed mesh: signed distances, signs of an open mesh by winding
numbers, and batches of small meshes. Each contender is checked, and then takes its turn.

Figures are processor time of all threads of the process, which other programs hardly change, by point. A contender whose
package is not installed is left out.
"""

import importlib
import statistics
import sys
import time


def processor_us(call, count, repetitions):
    """The median, in microseconds by point."""
    times = []
    for _ in range(repetitions):
        begin = time.process_time()
        result = call()  # kept until the end
        times.append((time.process_time() - begin) * 1e6 / count)
        del result
    return statistics.median(times)


def row(where, name, us, mine, remark=""):
    print(f"| {where} | {name} | {us:.3g} | {us / mine:.3g} | {remark} |", flush=True)
    return {"case": where, "package": name, "processor_us": us, "remark": remark}


def header(title):
    print(f"\n{title}:\n\n| case | package | processor µs a point | beside sdm | |\n| --- | --- | ---: | ---: | --- |")


def installed(contenders):
    """Of (package, name, ...) those that can be imported."""
    found = []
    for package, *rest in contenders:
        try:
            importlib.import_module(package)
        except ImportError:
            continue
        found.append(rest)
    return found


def open3d_signed(points, vertices, faces):
    import numpy as np
    import open3d

    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(vertices.astype(np.float32)), open3d.core.Tensor(faces.astype(np.uint32)))
    return scene.compute_signed_distance(points.astype(np.float32)).numpy()


def igl_signed(points, vertices, faces, method):
    import igl
    import numpy as np

    kind = getattr(igl.SignedDistanceType, "SIGNED_DISTANCE_TYPE_" + method)
    return igl.signed_distance(points, vertices, faces.astype(np.int64), kind)[0]


def pcu_signed(points, vertices, faces):
    import numpy as np
    import point_cloud_utils

    return np.asarray(point_cloud_utils.signed_distance_to_mesh(points, vertices, faces.astype(np.int32))[0])


def sdm_signed(points, vertices, faces, sign="automatic"):
    import sdm

    return sdm.Sites(vertices, faces).signed_distance(points, sign=sign)


def check_signed(name, found, exact, winding):
    """Returns by how much the distances of the first points are off, if at all, and how many signs differ of those whose
    winding number is far from 1/2. Ends the program if sdm is off."""
    import numpy as np

    found = np.asarray(found).ravel()[: len(exact)]
    worst = np.abs(np.abs(found) - exact).max()
    if name.startswith("sdm") and not worst < 1e-5:
        sys.exit(f"{name}: distances differ by {worst} of the size")
    surely = (np.abs(winding - 0.5) > 0.05) & (exact > 1e-5)
    wrong = np.count_nonzero((found < 0)[surely] != (winding > 0.5)[surely])
    off = "" if worst < 1e-5 else f", distances are off by up to {worst:.1g} of the size"
    return f"{wrong} of {np.count_nonzero(surely)} signs differ{off}"


def winding_numbers(points, vertices, faces):
    """Exact sums of solid angles, in blocks of points."""
    import numpy as np

    corners = vertices[faces]
    total = np.empty(len(points))
    for i, p in enumerate(points):
        a, b, c = np.moveaxis(corners - p, 1, 0)
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        dot = np.einsum
        below = (la * lb * lc + dot("nk,nk->n", a, b) * lc + dot("nk,nk->n", b, c) * la + dot("nk,nk->n", c, a) * lb)
        total[i] = np.arctan2(dot("nk,nk->n", a, np.cross(b, c)), below).sum() / (2 * np.pi)
    return total


def signed_cases(mesh, points, repetitions):
    """Of a closed mesh, and of what is left of it without the faces of its lowest tenth."""
    import sdm

    vertices, faces = mesh
    middles = vertices[faces].mean(axis=1)[:, 1]
    low = middles.min() + 0.1 * (middles.max() - middles.min())
    header("Signed distances, from the mesh to the result, of "
           f"{len(points)} points in a box of twice the size, {len(faces)} triangles")  # fmt: skip
    cases = {
        "closed": (faces, [
            ("sdm", "sdm", sdm_signed),
            ("open3d", "Open3D", open3d_signed),
            ("igl", "libigl, pseudonormals", lambda *m: igl_signed(*m, "PSEUDONORMAL")),
            ("igl", "libigl, fast winding numbers", lambda *m: igl_signed(*m, "FAST_WINDING_NUMBER")),
            ("point_cloud_utils", "point-cloud-utils", pcu_signed)]),
        "open": (faces[middles > low], [
            ("sdm", 'sdm, sign="winding"', lambda *m: sdm_signed(*m, sign="winding")),
            ("igl", "libigl, fast winding numbers", lambda *m: igl_signed(*m, "FAST_WINDING_NUMBER")),
            ("point_cloud_utils", "point-cloud-utils", pcu_signed)]),
    }  # fmt: skip
    results = []
    for where, (of, contenders) in cases.items():
        checked = 100
        exact = sdm.Sites(vertices, of).closest_points(points[:checked], engine="reference").distance
        winding = winding_numbers(points[:checked], vertices, of)
        mine = None
        for name, signed in installed(contenders):
            remark = check_signed(name, signed(points, vertices, of), exact, winding)
            us = processor_us(lambda: signed(points, vertices, of), len(points), repetitions)
            mine = mine or us
            results.append(row(where, name, us, mine, remark))
    return results


def small_meshes(count):
    """Tori of 2,000 triangles with noise."""
    import numpy as np

    n, m = 40, 25
    i, j = (a.ravel() for a in np.mgrid[0:n, 0:m])
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    vertices = np.column_stack([(2 + np.cos(v)) * np.cos(u), (2 + np.cos(v)) * np.sin(u), np.sin(v)]) / 6
    a, b, c, d = i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    random = np.random.default_rng(1)
    return [(vertices + random.normal(0, 1e-3, vertices.shape), faces) for _ in range(count)]


def batched_cases(contenders_of, repetitions, meshes=100, points_of_each=1000):
    """contenders_of: of bench/python, by vertices and faces."""
    import numpy as np

    import sdm

    items = small_meshes(meshes)
    random = np.random.default_rng(2)
    points = [random.uniform(-0.6, 0.6, (points_of_each, 3)) for _ in items]
    exact = [sdm.Sites(*mesh).closest_points(p, engine="reference").distance for mesh, p in zip(items, points)]

    def one_by_one(name):
        def call():
            results = []
            for mesh, p in zip(items, points):
                build, query, _ = contenders_of(*mesh)[name]
                results.append(query(build(), p))
            return results

        return call

    contenders = []
    if hasattr(sdm, "closest_points_batch"):
        batch = lambda: sdm.closest_points_batch(items, points).distance.reshape(meshes, -1)  # noqa: E731
        contenders.append(("sdm", "sdm, in one call", batch))
    contenders.append(("sdm", "sdm", one_by_one("sdm")))
    for package, name in (("fcpw", "FCPW"), ("open3d", "Open3D"), ("igl", "libigl"), ("point_cloud_utils", "point-cloud-utils")):
        contenders.append((package, name, one_by_one(name)))
    header(f"Closest points of {meshes} meshes of {len(items[0][1])} triangles, {points_of_each} points each, with the build")
    results, mine = [], None
    for name, call in installed(contenders):
        found = call()
        if name == "FCPW":
            found = [np.array([i.d for i in one]) for one in found]
        worst = max(np.abs(f - e).max() for f, e in zip(found, exact))
        if not worst < 1e-5:
            sys.exit(f"{name}: distances differ by {worst}")
        us = processor_us(call, meshes * points_of_each, repetitions)
        mine = mine or us
        results.append(row("batch", name, us, mine))
    return results

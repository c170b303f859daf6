"""Jobs of inspection with a known answer, for `bench/inspection jobs`: what each program finds, beside the truth.

A program without a counterpart has no answer. Where a part has to be cut out or rays have to be cast by hand, the script
here does it for the program.
"""

import json
import math
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SDM = ROOT / "build" / "dev" / "cli" / "sdm"


def write_obj(file, vertices, groups):
    """groups: a name and its faces each, from vertex 0."""
    lines = [f"v {float(x)!r} {float(y)!r} {float(z)!r}" for x, y, z in vertices]
    for name, faces in groups:
        lines += [f"g {name}", *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces)]
    file.write_text("\n".join(lines) + "\n")


def grid(n, size, height):
    """n × n squares over [0, size]², with heights by a function of x and y."""
    import numpy as np

    x, y = (a.ravel() for a in np.meshgrid(np.linspace(0, size, n + 1), np.linspace(0, size, n + 1)))
    faces = []
    for j in range(n):
        for i in range(n):
            a, b = j * (n + 1) + i, (j + 1) * (n + 1) + i
            faces += [(a, a + 1, b + 1), (a, b + 1, b)]
    return np.column_stack([x, y, height(x, y)]), faces


def box(low, high):
    import numpy as np

    corners = np.array([[(i >> k) & 1 for k in (2, 1, 0)] for i in range(8)], float)
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
             (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]  # fmt: skip
    return np.array(low) + corners * (np.array(high) - np.array(low)), faces


def fine_box(low, high, step):
    """A box whose sides are squares of about a step, so that samples at vertices are spread over it."""
    import numpy as np

    vertices, faces = [], []
    low, high = np.array(low, float), np.array(high, float)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        m, n = (max(1, round((high[k] - low[k]) / step)) for k in (u, v))
        for side in (low, high):
            first = len(vertices)
            for j in range(n + 1):
                for i in range(m + 1):
                    p = side.copy()
                    p[u], p[v] = low[u] + i / m * (high[u] - low[u]), low[v] + j / n * (high[v] - low[v])
                    vertices.append(p)
            for j in range(n):
                for i in range(m):
                    a, b = first + j * (m + 1) + i, first + (j + 1) * (m + 1) + i
                    pair = [(a, a + 1, b + 1), (a, b + 1, b)]
                    faces += pair if side is high else [(x, z, y) for x, y, z in pair]
    return np.array(vertices), faces


def sdm(command, folder, *arguments):
    subprocess.run([SDM, command, *map(str, arguments), "-o", folder / "out", "--quiet", "--write", "none"], check=False)
    return json.loads((folder / "out" / "report.json").read_text())


# The signed distances of the vertices of O1, with these vertices.


def open3d_distances(o1, o2):
    import numpy as np
    import open3d as o3d

    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(o3d.t.geometry.TriangleMesh.from_legacy(o3d.io.read_triangle_mesh(str(o2))))
    vertices = np.asarray(o3d.io.read_triangle_mesh(str(o1)).vertices)
    return vertices, scene.compute_signed_distance(vertices.astype(np.float32)).numpy()


def meshlib_distances(o1, o2):
    import numpy as np
    from meshlib import mrmeshnumpy
    from meshlib import mrmeshpy as mr

    scan = mr.loadMesh(str(o1))
    values = mr.findSignedDistances(mr.loadMesh(str(o2)), scan)
    vertices = mrmeshnumpy.getNumpyVerts(scan)
    return vertices, np.array([values.vec[i] for i in range(len(vertices))])


def cloudcompare(o1, o2, *steps):
    """Of the vertices of O1 as a cloud, which that program compares with meshes."""
    import numpy as np

    vertices = np.array([line.split()[1:4] for line in o1.read_text().splitlines() if line.startswith("v ")], float)
    cloud = o1.with_suffix(".asc")
    np.savetxt(cloud, vertices)
    command = ["CloudCompare", "-SILENT", "-AUTO_SAVE", "OFF", "-C_EXPORT_FMT", "ASC", "-PREC", "9", "-O", cloud, "-O", o2, *steps]
    subprocess.run(list(map(str, command)), capture_output=True, check=True, env={**os.environ, "QT_QPA_PLATFORM": "offscreen"})


def cloudcompare_distances(o1, o2):
    import numpy as np

    saved = o1.with_name("compared.asc")
    cloudcompare(o1, o2, "-C2M_DIST", "-SAVE_CLOUDS", "FILE", saved)
    found = np.loadtxt(saved, comments="//")
    return found[:, :3], found[:, -1]


DISTANCES = {"Open3D": open3d_distances, "MeshLib": meshlib_distances}
if shutil.which("CloudCompare"):
    DISTANCES["CloudCompare"] = cloudcompare_distances


def dent_behind_a_wall(folder):
    """A sheet 1 thick, and a scan of its upper side with a dent of 0.79."""
    import numpy as np

    def dent(x, y):
        return -0.79 * np.maximum(0, 1 - ((x - 10) ** 2 + (y - 10) ** 2) / 16) ** 2

    scan, sheet = folder / "scan.obj", folder / "sheet.obj"
    vertices, faces = grid(40, 20, dent)
    write_obj(scan, vertices, [("scan", faces)])
    vertices, faces = box((-5, -5, -1), (25, 25, 0))
    write_obj(sheet, vertices, [("sheet", faces)])
    ours = sdm("map", folder, scan, sheet, "--facing", "--resolution", 256)
    found = {"sdm map --facing": ours["extremes"]["min"]["distance"]}
    for tool, distances in DISTANCES.items():
        found[tool] = distances(scan, sheet)[1].min()
    return "deepest of a dent in a sheet 1 thick", -0.79, found


def walls_of_a_tube(folder):
    """Radii 10 and 8, 720 facets, 40 long."""
    import numpy as np

    n, rings = 720, 21
    vertices, faces = [], []
    for radius in (10, 8):
        for i in range(rings):
            for k in range(n):
                angle = 2 * math.pi * k / n
                vertices.append((radius * math.cos(angle), radius * math.sin(angle), 2 * i))

    def at(wall, i, k):
        return wall * rings * n + i * n + k % n

    for k in range(n):
        for i in range(rings - 1):
            for wall in (0, 1):
                a, b, c, d = at(wall, i, k), at(wall, i, k + 1), at(wall, i + 1, k + 1), at(wall, i + 1, k)
                faces += [(a, b, c), (a, c, d)] if wall == 0 else [(a, c, b), (a, d, c)]
        for i, up in ((0, False), (rings - 1, True)):
            a, b, c, d = at(0, i, k), at(0, i, k + 1), at(1, i, k + 1), at(1, i, k)
            faces += [(a, b, c), (a, c, d)] if up else [(a, c, b), (a, d, c)]
    tube = folder / "tube.obj"
    vertices = np.array(vertices)
    write_obj(tube, vertices, [("tube", faces)])
    inner = np.abs(vertices[:, 2] - 20) < 17
    found = {}
    for method in ("ball", "ray"):
        subprocess.run([SDM, "thickness", tube, "--method", method, "--write", "npy", "-o", folder / "out", "--quiet",
                        "--resolution", "64"], check=True)  # fmt: skip
        found[f"sdm thickness, {method}"] = float(np.median(np.load(folder / "out" / "vertices.npy")[inner]))
    from meshlib import mrmeshnumpy
    from meshlib import mrmeshpy as mr

    mesh = mr.loadMesh(str(tube))
    inner = np.abs(mrmeshnumpy.getNumpyVerts(mesh)[:, 2] - 20) < 17
    settings = mr.InSphereSearchSettings()
    settings.maxRadius = 20
    for name, values in (("ball", mr.computeInSphereThicknessAtVertices(mesh, settings)),
                         ("ray", mr.computeRayThicknessAtVertices(mesh))):  # fmt: skip
        found[f"MeshLib, {name}"] = float(np.median(np.array([values.vec[i] for i in range(len(inner))])[inner]))
    return "wall of a tube, median at its vertices", 2, found


def open_terrain(folder):
    """Settlement of 0.05 and heave of 0.03 of an open surface."""
    import numpy as np

    def hills(x, y):
        return 0.5 * np.sin(x / 3) * np.cos(y / 4)

    def moved(x, y):
        def bump(u, v):
            return np.maximum(0, 1 - ((x - u) ** 2 + (y - v) ** 2) / 9) ** 2

        return hills(x, y) - 0.05 * bump(6, 6) + 0.03 * bump(14, 14)

    before, after = folder / "before.obj", folder / "after.obj"
    vertices, faces = grid(80, 20, hills)
    write_obj(before, vertices, [("ground", faces)])
    vertices, faces = grid(80, 20, moved)
    write_obj(after, vertices, [("ground", faces)])
    ours = sdm("map", folder, after, before, "--along", "0,0,1", "--resolution", 256)["extremes"]
    found = {"sdm map --along 0,0,1": (ours["min"]["distance"], ours["max"]["distance"])}
    ours = sdm("map", folder, after, before, "--sign", "side", "--resolution", 256)["extremes"]
    found["sdm map --sign side"] = (ours["min"]["distance"], ours["max"]["distance"])
    for tool, distances in DISTANCES.items():
        d = distances(after, before)[1]
        found[tool] = (d.min(), d.max())
    return "settlement and heave of open terrain (vertical)", (-0.05, 0.03), found


def datum_and_bent_tab(folder):
    """A plate is the datum; the tab beside it is bent. How far a corner is from its place, aligned on the datum."""
    import numpy as np

    plate, plate_faces = fine_box((0, 0, 0), (10, 10, 2), 0.25)
    tab, tab_faces = fine_box((10, 2, 0), (18, 8, 1), 0.25)
    tab_faces = [tuple(v + len(plate) for v in face) for face in tab_faces]
    bent = tab.copy()
    bent[:, 2] += 0.08 * (tab[:, 0] - 10)
    angle = math.radians(2)
    turn = np.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])
    shift = np.array([0.2, -0.1, 0.15])
    scan, part, datum = folder / "scan.obj", folder / "part.obj", folder / "datum.obj"
    write_obj(part, np.vstack([plate, tab]), [("datum", plate_faces), ("tab", tab_faces)])
    write_obj(datum, plate, [("datum", plate_faces)])
    write_obj(scan, np.vstack([plate, bent]) @ turn.T + shift, [("datum", plate_faces), ("tab", tab_faces)])

    def error(matrix):
        back = np.array(matrix)
        there = plate @ turn.T + shift
        return float(np.linalg.norm(there @ back[:3, :3].T + back[:3, 3] - plate, axis=1).max())

    def ours(*more):
        return error(sdm("map", folder, scan, part, "--align", *more, "--resolution", 128)["alignment"]["matrix"])

    found = {"sdm map --align-on datum": ours("--align-on", "datum"), "sdm map --align": ours()}
    found["Open3D, on a datum cut out"] = error(open3d_icp(scan, datum))
    found["MeshLib, on a datum cut out"] = error(meshlib_icp(scan, datum))
    if shutil.which("CloudCompare"):
        cloudcompare(scan, datum, "-ICP", "-MIN_ERROR_DIFF", "1e-8", "-RANDOM_SAMPLING_LIMIT", "30000", "-OVERLAP", "60")
        found["CloudCompare, on a datum cut out"] = error(np.loadtxt(next(folder.glob("*REGISTRATION_MATRIX*.txt"))))
    return "error of a pose on a datum, beside a bent tab", 0, found


def open3d_icp(scan, target):
    import numpy as np
    import open3d as o3d

    moved, fixed = (o3d.io.read_triangle_mesh(str(f)) for f in (scan, target))
    for mesh in (moved, fixed):
        mesh.compute_triangle_normals()
    o3d.utility.random.seed(1)
    points = moved.sample_points_uniformly(30000)
    places = fixed.sample_points_uniformly(100000, use_triangle_normal=True)
    registration = o3d.pipelines.registration
    return registration.registration_icp(
        points, places, 0.5, np.eye(4), registration.TransformationEstimationPointToPlane(registration.TukeyLoss(k=0.05)),
        registration.ICPConvergenceCriteria(max_iteration=200)).transformation  # fmt: skip


def meshlib_icp(scan, target):
    from meshlib import mrmeshpy as mr

    moved, fixed = mr.loadMesh(str(scan)), mr.loadMesh(str(target))
    icp = mr.ICP(mr.MeshOrPoints(mr.MeshPart(moved)), mr.MeshOrPoints(mr.MeshPart(fixed)), mr.AffineXf3f(),
                 mr.AffineXf3f(), 0.1)  # fmt: skip
    properties = mr.ICPProperties()
    properties.iterLimit = 200
    properties.distThresholdSq = 0.25
    icp.setParams(properties)
    found = icp.calculateTransformation()
    rows = [[getattr(getattr(found.A, r), c) for c in "xyz"] + [getattr(found.b, r)] for r in "xyz"]
    return [*rows, [0, 0, 0, 1]]


def defect_between_the_vertices(folder):
    """A flat plate as two triangles, whose reference has a hollow of 1.2 times the limit of 0.01."""
    import numpy as np

    scan, part = folder / "plate.obj", folder / "hollow.obj"
    vertices, faces = grid(1, 20, lambda x, y: 0 * x)
    write_obj(scan, vertices, [("plate", faces)])
    vertices, faces = grid(40, 20, lambda x, y: -0.012 * np.maximum(0, 1 - ((x - 12) ** 2 + (y - 8) ** 2) / 4) ** 2)
    write_obj(part, vertices, [("plate", faces)])
    report = sdm("map", folder, scan, part, "--tolerance", "0.01", "--resolution", 64)
    found = {f"sdm map: {report['tolerance']['verdict']}": max(abs(report["extremes"][end]["distance"]) for end in ("min", "max"))}
    run = subprocess.run([SDM, "hausdorff", scan, part, "--json"], capture_output=True, text=True, check=True)
    found["sdm hausdorff"] = json.loads(run.stdout)["hausdorff"]["upper"]
    for tool, distances in DISTANCES.items():
        found[tool] = float(np.abs(distances(scan, part)[1]).max())
    return "largest distance, between the vertices", 0.012, found


JOBS = [dent_behind_a_wall, walls_of_a_tube, open_terrain, datum_and_bent_tab, defect_between_the_vertices]


def main(wanted):
    def text(value):
        return " and ".join(map(text, value)) if isinstance(value, tuple) else f"{value:.5g}"

    print("| job | truth | program | answer |\n| --- | ---: | --- | ---: |")
    for job in JOBS:
        if not wanted.search(job.__name__):
            continue
        with tempfile.TemporaryDirectory() as folder:
            title, truth, found = job(Path(folder))
        for program, answer in found.items():
            print(f"| {title} | {text(truth)} | {program} | {text(answer)} |", flush=True)

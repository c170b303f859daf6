"""sdm.torch, where torch is installed; tests/long torch runs it. The chain rule is tested without torch in test_closest_points.py."""

import importlib.util
import time
from pathlib import Path

import numpy as np
import pytest

import meshes
import sdm

torch = pytest.importorskip("torch")

import sdm.torch as st  # noqa: E402
from sdm import _torch_search  # noqa: E402


def tensors(mesh, noise=0.05, seed=3):
    vertices, faces = mesh
    moved = vertices + np.random.default_rng(seed).normal(0, noise, vertices.shape)
    return torch.tensor(moved, requires_grad=True), torch.tensor(faces)


def random_points(*shape, seed=4):
    return torch.tensor(np.random.default_rng(seed).uniform(-0.7, 1.7, (*shape, 3)), requires_grad=True)


@pytest.mark.parametrize("sign", ["none", "exact"])
def test_distance(sign):
    vertices, faces = tensors(meshes.box())
    points = random_points(20)
    assert torch.autograd.gradcheck(lambda p, v: st.distance(p, v, faces, sign=sign), (points, vertices))
    sites = sdm.Sites(vertices, faces)
    expected = sites.closest_points(points, sign=sign).distance
    np.testing.assert_array_equal(st.distance(points, vertices, faces, sign=sign).detach(), expected)
    np.testing.assert_array_equal(st.distance(points, sites, sign=sign).detach(), expected)


def test_closest_points():
    vertices, faces = tensors(meshes.box())
    points = random_points(40)
    found = st.closest_points(points, vertices, faces)
    expected = sdm.closest_points(vertices.detach(), faces, points.detach())
    np.testing.assert_array_equal(found.face, expected.face)
    np.testing.assert_array_equal(found.barycentric.detach(), expected.barycentric)
    np.testing.assert_allclose(found.point.detach(), expected.point, atol=1e-15)
    for name in ("point", "barycentric"):
        function = lambda p, v, name=name: getattr(st.closest_points(p, v, faces), name)  # noqa: E731
        assert torch.autograd.gradcheck(function, (points, vertices))
        assert torch.autograd.gradgradcheck(function, (points[:6].detach().requires_grad_(), vertices))
    near = st.closest_points(points, vertices, faces, max_distance=0.2)
    none = near.face < 0
    assert none.any() and not none.all()
    assert near.point[none].isnan().all() and near.distance[none].isinf().all()
    near.point[~none].sum().backward()
    assert points.grad.isfinite().all() and vertices.grad.isfinite().all()


def test_no_derivative_is_nan():
    vertices, faces = tensors(meshes.box(), 0)
    points = torch.tensor([[1.0, 0.5, 0.25], [0, 0, 0], [9, 9, 9]], dtype=torch.float64, requires_grad=True)
    found = st.closest_points(points, vertices, faces, max_distance=5)
    (torch.where(found.face < 0, 0, found.distance).sum() + found.point[:2].sum()).backward()
    assert points.grad.isfinite().all() and vertices.grad.isfinite().all()


def test_batches_equal_single_calls():
    vertices, faces = tensors(meshes.sphere(steps=1))
    stack = torch.stack([vertices, vertices * 1.5, vertices + 0.3])
    points = random_points(3, 10)
    found = st.closest_points(points, stack, faces)
    for i in range(3):
        single = st.closest_points(points[i], stack[i], faces)
        torch.testing.assert_close(found.distance[i], single.distance, rtol=0, atol=1e-12)
        torch.testing.assert_close(found.point[i], single.point, rtol=0, atol=1e-6)
    small = tensors(meshes.box())
    both = torch.stack([small[0], small[0] + 0.1])
    assert torch.autograd.gradcheck(lambda p, v: st.distance(p, v, small[1]), (random_points(2, 8), both))
    assert torch.autograd.gradcheck(lambda p, v: st.closest_points(p, v, small[1]).point, (random_points(8), both))
    assert torch.autograd.gradcheck(lambda p: st.distance(p, *small), random_points(2, 8))
    per_item = torch.stack([small[1], small[1].flip(0)])
    torch.testing.assert_close(st.distance(points[:2], both, per_item), st.distance(points[:2], both, small[1]))


def test_func_transforms():
    vertices, faces = tensors(meshes.box())
    vertices = vertices.detach()
    points = random_points(5, 8).detach()

    def loss(p, v):
        return st.distance(p, v, faces).square().sum()

    expected = []
    for p in points:
        p = p.clone().requires_grad_()
        loss(p, vertices).backward()
        expected.append(p.grad)
    torch.testing.assert_close(torch.func.grad(loss)(points[0], vertices), expected[0])
    torch.testing.assert_close(torch.vmap(torch.func.grad(loss), (0, None))(points, vertices), torch.stack(expected))
    stack = torch.stack([vertices + 0.1 * i for i in range(5)])
    by_vertices = torch.vmap(torch.func.grad(loss, argnums=1))(points, stack)
    singly = torch.stack([torch.func.grad(loss, argnums=1)(p, v) for p, v in zip(points, stack)])
    torch.testing.assert_close(by_vertices, singly)
    sums = torch.func.grad(lambda v: torch.vmap(loss, (0, None))(points, v).sum())(vertices)
    torch.testing.assert_close(sums, sum(torch.func.grad(loss, argnums=1)(p, vertices) for p in points))
    nested = torch.vmap(torch.vmap(st.distance, (None, 0, None)), (0, None, None))(points, stack, faces)
    torch.testing.assert_close(nested[2, 3], st.distance(points[2], stack[3], faces))
    last = torch.vmap(lambda p, v: st.closest_points(p, v, faces).point, (1, 2), 1)(points.movedim(0, 1), stack.movedim(0, 2))
    torch.testing.assert_close(last[:, 4], st.closest_points(points[4], stack[4], faces).point)
    jacobian = torch.func.jacrev(lambda p: st.closest_points(p, vertices, faces).point)(points[0])
    assert jacobian.shape == (8, 3, 8, 3) and jacobian.isfinite().all()
    still = sdm.Sites(vertices, faces)
    fixed = torch.vmap(lambda p: st.closest_points(p, still).point)(points)
    torch.testing.assert_close(fixed, st.closest_points(points, vertices, faces).point)


@pytest.mark.parametrize("sign", ["none", "exact"])
def test_second_derivatives(sign):
    vertices, faces = tensors(meshes.box())
    points = random_points(6)
    assert torch.autograd.gradgradcheck(lambda p, v: st.distance(p, v, faces, sign=sign), (points, vertices))
    assert torch.autograd.gradgradcheck(lambda p: st.distance(p, sdm.Sites(vertices, faces), sign=sign), points)
    slope = lambda p: torch.func.grad(lambda q: st.distance(q, vertices, faces, sign=sign).sum())(p)  # noqa: E731
    hessian = torch.func.jacrev(slope)(points.detach())
    step = torch.zeros_like(points).detach()
    step[2, 1] = 1e-6
    differences = (slope(points.detach() + step) - slope(points.detach() - step)) / 2e-6
    torch.testing.assert_close(hessian[:, :, 2, 1], differences, rtol=0, atol=1e-7)


def test_derivatives_in_one_batch():
    """Jacobians that are computed at once, for which backward() is called with a batch."""
    vertices, faces = tensors(meshes.box())
    points = random_points(6)
    function = lambda p, v: st.distance(p, v, faces)  # noqa: E731
    at_once = torch.autograd.functional.jacobian(function, (points, vertices), vectorize=True)
    singly = torch.autograd.functional.jacobian(function, (points, vertices))
    torch.testing.assert_close(at_once, singly)


@pytest.mark.parametrize("dtype", [torch.bfloat16, torch.float16, torch.float32])
def test_other_types(dtype):
    vertices, faces = tensors(meshes.box())
    points = random_points(30).detach().to(dtype).requires_grad_()
    small = vertices.detach().to(dtype).requires_grad_()
    found = st.closest_points(points, small, faces.to(torch.int32))
    assert {found.distance.dtype, found.point.dtype, found.barycentric.dtype} == {dtype}
    (found.distance.sum() + found.point.sum()).backward()
    assert points.grad.dtype == small.grad.dtype == dtype
    exact = sdm.closest_points(small.detach().double(), faces, points.detach().double())
    assert torch.equal(found.distance, torch.from_numpy(exact.distance).to(dtype))
    assert st.distance(points.float(), vertices, faces).dtype == torch.float32


def test_sites_are_refitted():
    vertices, faces = tensors(meshes.sphere(steps=2))
    points = random_points(50)
    sites = sdm.Sites(vertices, faces)
    for scale in (1, 1.5, 0.7):
        found = st.distance(points, vertices * scale, faces, sites=sites)
        np.testing.assert_array_equal(sites.vertices, (vertices * scale).detach())
        torch.testing.assert_close(found, st.distance(points, vertices * scale, faces), rtol=0, atol=1e-12)
    # What an earlier call returned has the derivatives of its own shape.
    first = st.distance(points, vertices, faces, sites=sites)
    st.distance(points, vertices * 3, faces, sites=sites)
    (found,) = torch.autograd.grad(first.sum(), vertices)
    (expected,) = torch.autograd.grad(st.distance(points, vertices, faces).sum(), vertices)
    torch.testing.assert_close(found, expected)


@pytest.mark.parametrize("squared", [True, False])
def test_losses(squared):
    a = tensors(meshes.box())
    b = tensors(meshes.box((0.2, 0.1, -0.3), (1.3, 1.2, 0.9)), seed=9)
    samples = tuple(st.sample_surface(m, 12, generator=torch.Generator().manual_seed(k)) for k, m in enumerate((a, b)))
    for loss in (st.chamfer, st.normal_consistency):
        function = lambda v, w, loss=loss: loss((v, a[1]), (w, b[1]), samples=samples, squared=squared)  # noqa: E731
        assert torch.autograd.gradcheck(function, (a[0], b[0]))
    points = random_points(15)
    assert torch.autograd.gradcheck(lambda p, v: st.point_to_surface(p, v, a[1], squared=squared), (points, a[0]))
    # A surface that does not change, as Sites; and Sites that are refitted.
    still = sdm.Sites(*b)
    expected = st.surface_losses(a, b, samples=samples)
    for found in (st.surface_losses(a, still, samples=samples),
                  st.surface_losses(a, b, samples=samples, sites=(sdm.Sites(*a), sdm.Sites(b[0] * 2, b[1])))):  # fmt: skip
        torch.testing.assert_close(tuple(found), tuple(expected))
    both = torch.stack([a[0], a[0]]), a[1]
    pairs = tuple(st.Samples(*(torch.stack([t, t]) for t in s)) for s in samples)
    batch = st.surface_losses(both, still, samples=(pairs[0], samples[1]))
    torch.testing.assert_close(tuple(batch), tuple(expected))


def test_equal_surfaces_have_no_loss():
    mesh = tensors(meshes.sphere(steps=2))
    losses = st.surface_losses(mesh, mesh, samples=500)
    assert losses.chamfer < 1e-20 and losses.normals < 1e-3
    apart = st.chamfer(mesh, (mesh[0] + torch.tensor([10.0, 0, 0]), mesh[1]), samples=2000)
    assert 150 < apart < 250


def test_samples_are_uniform():
    vertices, faces = (torch.tensor(a) for a in meshes.box((0, 0, 0), (4, 1, 1)))
    samples = st.sample_surface((vertices, faces), 20_000, generator=torch.Generator().manual_seed(1))
    points = (samples.barycentric[..., None] * vertices[faces[samples.face]]).sum(-2)
    assert abs(points[:, 0].mean() - 2) < 0.05 and abs((points[:, 0] == 0).double().mean() - 1 / 18) < 0.01
    assert st.sample_surface((torch.stack([vertices, 2 * vertices]), faces), 7).face.shape == (2, 7)


def test_wrong_arguments():
    vertices, faces = tensors(meshes.box())
    points = random_points(4)
    sites = sdm.Sites(vertices, faces)
    for call in (
        lambda: st.distance(points, vertices),
        lambda: st.distance(points, sites, faces),
        lambda: st.distance(points, torch.stack([vertices, vertices]), faces, sites=sites),
        lambda: st.distance(points, vertices, faces.double()),
        lambda: st.distance(points * float("nan"), vertices, faces),
        lambda: st.distance(points, vertices[1:], faces),
    ):
        with pytest.raises(sdm.Error):
            call()


def test_fit_template(monkeypatch):
    path = Path(__file__).resolve().parents[1] / "examples" / "fit_template.py"
    spec = importlib.util.spec_from_file_location("fit_template", path)
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    vertices, faces = meshes.sphere(steps=5)
    scan = vertices * (1 + 0.3 * vertices[:, :1]) * [1, 1.3, 1.7] + 0.3, faces
    lines, used, found = [], [], _torch_search._found

    def measured(*arguments):
        begin = time.process_time()
        result = found(*arguments)
        used.append(time.process_time() - begin)
        return result

    monkeypatch.setattr(_torch_search, "_found", measured)
    example.fit(meshes.sphere(steps=5), scan, steps=2, log=print)  # what PyTorch imports at first
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    used.clear()
    begin = time.process_time()
    with sdm.thread_limit(1):
        example.fit(meshes.sphere(steps=5), scan, steps=20, log=print)
    torch.set_num_threads(threads)
    assert time.process_time() - begin < 1.6 * sum(used)  # processor time, of some 1.3 times that of the queries
    fitted = example.fit(meshes.sphere(steps=4), scan, steps=40, samples=5000, log=lines.append)
    assert len(lines) == 4
    assert np.sqrt(np.mean(sdm.closest_points(*scan, fitted).distance ** 2)) < 0.01
    back = sdm.closest_points(fitted, meshes.sphere(steps=4)[1], scan[0])
    assert np.sqrt(np.mean(back.distance**2)) < 0.02

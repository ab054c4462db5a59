"""Slides in extended precision (`numpy.longdouble`), against which the truth of a slide and its bounds are tested.

The equations are solved in log time by Gauss's collocation with many stages. A step is accepted where the last Legendre
coefficients of the rates are below the tolerance. Friction of a rectangle is in closed form, as a sum of triangles between the
instantaneous centre and the edges; that of a disk a quadrature along its rim; far from the centre both are Gauss's rule on the
face.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bodycheck.reference.scene import Brick, Cylinder, Plane, Scene, Shape

Wide = NDArray[np.longdouble]

#: The last coefficients of a step, over the size of the unknowns.
TOLERANCE = 1e-18

#: Stages of a step, the longest step, and the speed over the initial one at which the rest of the motion is extrapolated.
STAGES, LONGEST_STEP, STOP_FRACTION = 12, 0.3, 1e-17


def gauss(count: int) -> tuple[Wide, Wide]:
    """Nodes and weights of Gauss's rule from -1 to 1, polished by Newton's method in extended precision."""
    x = np.polynomial.legendre.leggauss(count)[0].astype(np.longdouble)
    for _ in range(3):
        before, now = np.ones_like(x), x
        for n in range(1, count):
            before, now = now, ((2 * n + 1) * x * now - n * before) / (n + 1)
        slope = count * (x * now - before) / (x * x - 1)
        x = x - now / slope
    return x, 2 / ((1 - x * x) * slope * slope)


def legendre(x: Wide, count: int) -> Wide:
    """The values (len(x), count) of the first Legendre polynomials."""
    values = [np.ones_like(x), x]
    for n in range(1, count - 1):
        values.append(((2 * n + 1) * x * values[n] - n * values[n - 1]) / (n + 1))
    return np.stack(values, axis=1)


X, W = gauss(STAGES)
#: From values at the stages to Legendre coefficients, and the integrals from the beginning of a step to each stage.
TO_COEFFICIENTS: Wide = (np.arange(STAGES) + np.longdouble(0.5))[:, None] * legendre(X, STAGES).T * W
_P = legendre(X, STAGES + 1)
_INTEGRALS = np.stack([X + 1, *((_P[:, n + 1] - _P[:, n - 1]) / (2 * n + 1) for n in range(1, STAGES))], axis=1)
PARTIAL: Wide = _INTEGRALS @ TO_COEFFICIENTS / 2

EDGE_X, EDGE_W = gauss(80)
FACE_X, FACE_W = gauss(26)


@dataclass(frozen=True, eq=False)
class WideSlide:
    """A slide: times (n,) and rows (n, 6) x, y, psi and their rates, while it moves, and its stop t, x, y, psi (4,)."""

    times: Wide
    rows: Wide
    stop: Wide


def fan_of_rectangle(a: Wide, b: Wide, c: Any) -> tuple[Any, Any, Any, Any]:
    """Means over a rectangle of rho/|rho|, |rho|, x rho/|rho| + i..., as four sums; see `means`."""
    corners = np.array([a - 1j * b, a + 1j * b, -a + 1j * b, -a - 1j * b], dtype=np.clongdouble)
    unit = outer = size = moment = 0
    for i, along in enumerate((1j, -1, -1j, 1)):
        first, last = (corners[i] - c) / along, (corners[(i + 1) % 4] - c) / along
        d = -first.imag
        safe = np.where(d == 0, np.longdouble(1), np.abs(d))

        def integrals(s: Any, d: Any = d, safe: Any = safe) -> tuple[Any, Any, Any, Any, Any]:
            root = np.sqrt(s * s + d * d)
            rise = np.where(d == 0, 0, np.arcsinh(s / safe))
            return rise, root, (s * root - d * d * rise) / 2, (s * root + d * d * rise) / 2, root**3 / 3

        # Integrals along the edge of 1/|rho|, s/|rho|, s^2/|rho|, |rho| and s |rho|.
        i0, i1, i2, j0, j1 = (high - low for low, high in zip(integrals(first.real), integrals(last.real), strict=True))
        n = -1j * along
        unit = unit + d * (n * d * i0 + along * i1) / 2
        size = size + d * j0 / 3
        # rho_x rho/|rho| and rho_y rho/|rho|
        parts = []
        for part in (np.real, np.imag):
            pn, pt = part(n), part(along)
            parts.append(d * (pn * n * d * d * i0 + (pn * along + pt * n) * d * i1 + pt * along * i2) / 3)
        outer = outer + np.stack(parts)
        moment = moment + d * (n * d * j0 + along * j1) / 4
    area = 4 * a * b
    return unit / area, outer / area, size / area, moment / area


def fan_of_disk(radius: Wide, c: Any) -> tuple[Any, Any, Any, Any]:
    """The same for a disk, by quadrature along its rim, graded towards the centre."""
    q = np.abs(c)
    axis = np.where(q > 0, c / np.where(q > 0, q, 1), 1)
    gap = np.abs(radius - q) / (2 * np.sqrt(radius * np.maximum(q, 1e-6 * radius)))
    g = np.clip(2 * np.arcsinh(gap), np.longdouble(1e-9), np.longdouble(4))[:, None]
    end = np.arcsinh(np.longdouble("3.14159265358979323846") / g)
    sigma = end * (1 + EDGE_X) / 2
    theta, step = g * np.sinh(sigma), g * np.cosh(sigma) * end * EDGE_W / 2
    theta, step = np.concatenate([theta, -theta], axis=1), np.concatenate([step, step], axis=1)
    q = q[:, None]
    versine = 2 * np.sin(theta / 2) ** 2
    ray = ((radius - q - radius * versine) + 1j * radius * np.sin(theta)) * axis[:, None]
    length = np.sqrt((radius - q) ** 2 + 2 * radius * q * versine)
    e = ray / np.where(length > 0, length, 1)
    doubled = step * (radius - q + q * versine) / (np.longdouble("3.14159265358979323846") * radius)
    return (
        (doubled * e).sum(axis=1) / 2,
        np.stack([(doubled * part(ray) * e).sum(axis=1) / 3 for part in (np.real, np.imag)]),
        (doubled * length).sum(axis=1) / 3,
        (doubled * length * ray).sum(axis=1) / 4,
    )


@dataclass(frozen=True, eq=False)
class Face:
    """The face that a body lies on: C/m, its greatest radius, nodes of a quadrature with their shares of the load, the means of
    x^2 and y^2, the height of the centre above it, and the integrals about an instantaneous centre."""

    k2: Wide
    reach: Wide
    nodes: Any
    shares: Wide
    seconds: tuple[Wide, Wide]
    height: Wide
    fan: Callable[[Any], Any]


def face_of(shape: Shape | None, plane: Plane) -> Face:
    """The face of a brick or a cylinder, with the load all over it or, under the law of corners, at its corners."""
    if isinstance(shape, Brick):
        a, b, height = map(np.longdouble, shape.semi_axes)
        x, y = np.meshgrid(a * FACE_X, b * FACE_X, indexing="ij")
        nodes, shares = (x + 1j * y).ravel(), np.outer(FACE_W, FACE_W).ravel() / 4
        whole = Face(
            (a * a + b * b) / 3, np.hypot(a, b), nodes, shares, (a * a / 3, b * b / 3), height, partial(fan_of_rectangle, a, b)
        )
        if plane.law != "corners":
            return whole
        corners = np.array([a + 1j * b, a - 1j * b, -a + 1j * b, -a - 1j * b])
        return replace(whole, nodes=corners, shares=np.full(4, np.longdouble(0.25)), seconds=(a * a, b * b))
    assert isinstance(shape, Cylinder)
    radius = np.longdouble(shape.radius)
    angles = np.longdouble("6.28318530717958647693") * np.arange(80) / 80
    r = radius * (1 + FACE_X) / 2
    nodes = np.multiply.outer(r, np.cos(angles) + 1j * np.sin(angles)).ravel()
    shares = np.repeat(r * FACE_W / radius / 80, 80)
    second, height = radius * radius / 4, np.longdouble(shape.half_length)
    return Face(radius * radius / 2, radius, nodes, shares, (second, second), height, partial(fan_of_disk, radius))


def friction_of(scene: Scene) -> tuple[Callable[[Wide, Wide], Wide], Wide]:
    """Maps yaws (n,) and directions (n, 3) v_x, v_y, k w, of any length, to accelerations (n, 3); and k = sqrt(C/m)."""
    shape, plane = scene.body.shape, scene.plane
    assert plane is not None
    mu = np.longdouble(plane.friction)
    face = face_of(shape, plane)
    reach, nodes, shares, seconds, height = face.reach, face.nodes, face.shares, face.seconds, face.height
    k = np.sqrt(face.k2)

    def means(v: Any, w: Wide) -> tuple[Any, Any]:
        """Means of (1, x, y) e and of (1, x, y) r x e, (3, n) each."""
        e_means, arms = np.zeros((3, len(w)), dtype=np.clongdouble), np.zeros((3, len(w)), dtype=np.longdouble)
        fixed = (np.abs(v) > 4 * reach * np.abs(w)) | (plane.law == "corners")
        if fixed.any():
            u = v[fixed, None] + 1j * w[fixed, None] * nodes
            e = u / np.abs(u) * shares
            arm = (np.conj(nodes) * e).imag
            e_means[:, fixed] = np.stack([(e * f).sum(axis=1) for f in (np.ones(len(nodes)), nodes.real, nodes.imag)])
            arms[:, fixed] = np.stack([(arm * f).sum(axis=1) for f in (np.ones(len(nodes)), nodes.real, nodes.imag)])
        if not fixed.all():
            near, sign = ~fixed, np.sign(w[~fixed])
            c = 1j * v[near] / w[near]
            unit, outer, size, moment = face.fan(c)
            e_means[:, near] = 1j * sign * np.stack([unit, c.real * unit + outer[0], c.imag * unit + outer[1]])
            # r x e = sign r . rho/|rho| = sign (c . rho/|rho| + |rho|)
            along = (np.conj(c) * unit).real
            rows = [along + size]
            for part, tensor in zip((np.real, np.imag), outer, strict=True):
                rows.append(part(c) * (along + size) + (np.conj(c) * tensor).real + part(moment))
            arms[:, near] = sign * np.stack(rows)
        return e_means, arms

    def accelerations(yaw: Wide, direction: Wide) -> Wide:
        turn = np.cos(yaw) + 1j * np.sin(yaw)
        e, arms = means((direction[:, 0] + 1j * direction[:, 1]) * np.conj(turn), direction[:, 2] / k)
        px = py = np.zeros(len(yaw), dtype=np.longdouble)
        if plane.pressure == "balanced":
            lever = mu * height
            m11, m12 = seconds[0] - lever * e[1].real, -lever * e[2].real
            m21, m22 = -lever * e[1].imag, seconds[1] - lever * e[2].imag
            r1, r2 = lever * e[0].real, lever * e[0].imag
            det = m11 * m22 - m12 * m21
            px, py = (r1 * m22 - m12 * r2) / det, (m11 * r2 - m21 * r1) / det
        force = (e[0] + px * e[1] + py * e[2]) * turn
        torque = arms[0] + px * arms[1] + py * arms[2]
        return -mu * np.longdouble(scene.gravity) * np.stack([force.real, force.imag, torque / k], axis=1)

    return accelerations, k


def wide_slide(scene: Scene) -> WideSlide:
    """The slide of a scene whose body slides and spins at once under Coulomb friction, until it stops."""
    accelerations, k = friction_of(scene)
    w, _, _, z = map(np.longdouble, scene.initial.quaternion)
    metric = np.array([1, 1, k])
    u = np.array([*scene.initial.velocity[:2], scene.initial.angular_velocity[2]], dtype=np.longdouble) * metric
    speed = np.sqrt((u * u).sum())
    state = np.array([0, *scene.initial.position[:2], 2 * np.arctan2(z, w), *(u / speed), 0], dtype=np.longdouble)
    assert scene.plane is not None
    pace = speed / (np.longdouble(scene.plane.friction) * np.longdouble(scene.gravity))

    def rates(y: Wide) -> Wide:
        n, now = y[:, 4:7], np.exp(y[:, 7:8])
        change = pace / speed * accelerations(y[:, 3], n)
        power = (change * n).sum(axis=1, keepdims=True) / (n * n).sum(axis=1, keepdims=True)
        return np.concatenate([pace * now, pace * speed * now * now * n / metric, change - power * n, power], axis=1)

    sizes = np.array([pace, pace * speed, pace * speed, pace * speed / k, 1, 1, 1, 1])
    found, h = [state], LONGEST_STEP
    while state[7] > np.log(STOP_FRACTION):
        stages = np.repeat(state[None], STAGES, axis=0)
        for _ in range(60):
            f = rates(stages)
            improved = state + h * (PARTIAL @ f)
            moved, stages = np.abs((improved - stages) / sizes).max(), improved
            if moved < 1e-19:
                break
        f = rates(stages)
        rest = np.abs(TO_COEFFICIENTS[-2:] @ f / sizes).max() * h
        if rest > TOLERANCE and h > 1e-7:
            h /= 2
            continue
        state = state + h * (W @ f) / 2
        state[4:7] /= np.sqrt((state[4:7] ** 2).sum())
        found.append(state)
        h = min(LONGEST_STEP, h * (1.6 if rest < TOLERANCE / 100 else 1.0))
    states = np.array(found)
    velocity = speed * np.exp(states[:, 7:]) * states[:, 4:7]
    last = accelerations(states[-1:, 3], velocity[-1:])[0]
    remaining = -(velocity[-1] @ velocity[-1]) / (velocity[-1] @ last)
    stop = states[-1, :4] + remaining * np.array([1, *(velocity[-1] / metric / 2)])
    return WideSlide(states[:, 0], np.concatenate([states[:, 1:4], velocity / metric], axis=1), stop)

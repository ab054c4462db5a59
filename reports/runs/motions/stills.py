"""Small pictures of motions: the outlines of the bodies of the truth at a few instants, and the paths of their centres."""

import math
from collections.abc import Iterator

import numpy as np

from bodycheck.reference.bodies import AnyBody, bodies, of_bodies
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism, alone
from bodycheck.reference.requirements import touches
from bodycheck.reference.trajectory import Array, Trajectory
from bodycheck.reports.runs.motions.playback import solid_of
from bodycheck.reports.runs.motions.several_bodies import sticks_of
from bodycheck.reports.runs.motions.single_body import solid_in_flight

#: The size of a picture and its margin, in units of its own.
WIDTH, HEIGHT, MARGIN = 160.0, 96.0, 6.0

#: The number of instants at which bodies are drawn, and of the points of a path.
INSTANTS, POINTS = 5, 60

#: The points of the outline of a round solid in each of its sections.
ROUND = 16

#: The distance between the pictures of a body in flight, in twice the distance of its farthest point.
APART = 1.05

#: The share of the horizontal extent below which the vertical extent counts as none, so that the motion is seen from above.
FLAT = 0.02

#: The most bodies of a picture, and the most outlines of all bodies at all instants.
MOST_BODIES, MOST_OUTLINES = 40, 60

#: The radius of a body that has no extent.
POINT = 2.5


def still(scene: AnyScene, trajectory: Trajectory) -> str:
    """Return a small picture of a motion as SVG text; empty if the motion is not known or has too many bodies.

    A body in flight is drawn about its own centre of mass, one instant beside the other; all others are drawn where they are.
    The picture looks at right angles to the widest extent of the motion: from the side, or from above where all is level.
    """
    motion = of_bodies(trajectory)
    known = np.asarray(np.isfinite(motion.position).all(axis=(0, 2)) & np.isfinite(motion.quaternion).all(axis=(0, 2)))
    count = len(known) if known.all() else int(np.argmin(known))
    if not count or len(motion.position) > MOST_BODIES:
        return ""
    instants = max(2, min(INSTANTS, MOST_OUTLINES // len(motion.position)))
    picked = np.unique(np.linspace(0, count - 1, instants).astype(int))
    path = np.unique(np.linspace(0, count - 1, POINTS).astype(int))
    positions, paths = motion.position[:, picked], motion.position[:, path]
    shapes = [np.concatenate(outlines) if outlines else np.zeros((1, 3)) for outlines in map(list, _outlines(scene))]
    if not isinstance(scene, Mechanism) and not touches(scene):
        reach = 2 * APART * max(float(np.linalg.norm(shapes[0], axis=1).max()), 1e-12)
        positions = np.zeros_like(positions)
        positions[0, :, 0] = reach * np.arange(len(picked))
        paths = positions[:, :0]
    placed = [
        np.stack([centre + rotate(turn, shape) for centre, turn in zip(places, motion.quaternion[index, picked], strict=True)])
        for index, (places, shape) in enumerate(zip(positions, shapes, strict=True))
    ]
    if not all(np.isfinite(points).all() for points in placed):
        return ""
    return _svg(placed, paths, _seen(np.concatenate([*(points.reshape(-1, 3) for points in placed), paths.reshape(-1, 3)])))


def _outlines(scene: AnyScene) -> Iterator[list[Array]]:
    """Yield the points (k, 3), m, of each body, from its centre of mass along its axes, in one array for each of its parts."""
    if not isinstance(scene, Mechanism) and not touches(scene):
        kind, semi_axes = solid_in_flight(alone(scene).body)
        yield [_solid(kind, np.array(semi_axes))]
        return
    for index, body in enumerate(bodies(scene)):
        yield _of_body(scene, index, body)


def _of_body(scene: AnyScene, index: int, body: AnyBody) -> list[Array]:
    if body.shape is not None:
        kind, semi_axes = solid_of(body.shape)
        return [_solid(kind, np.array(semi_axes))]
    return [np.array(stick, dtype=float) for stick in sticks_of(scene, index)]


def _solid(kind: str, semi_axes: Array) -> Array:
    """Return points (k, 3), m, on a solid, whose convex hull looks like the solid from any side."""
    if kind == "brick":
        return np.asarray(semi_axes * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float))
    angle = 2 * math.pi * np.arange(ROUND) / ROUND
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(ROUND)
    if kind == "cylinder":
        rings = [np.column_stack([c, s, zero + end]) for end in (-1, 1)]
    else:
        rings = [np.column_stack(axes) for axes in ((c, s, zero), (c, zero, s), (zero, c, s))]
    return np.asarray(semi_axes * np.concatenate(rings))


def _seen(points: Array) -> Array:
    """Return the axes (2, 3) of the picture, to the right and up, for all points (k, 3), m, of a motion."""
    _, axes = np.linalg.eigh(np.cov(points[:, :2].T) if len(points) > 1 else np.eye(2))
    along = np.array([*axes[:, 1], 0.0]) * (1.0 if axes[0, 1] >= 0 else -1.0)
    extent = float(np.ptp(points @ along))
    if float(np.ptp(points[:, 2])) < FLAT * extent:
        return np.array([along, [-along[1], along[0], 0.0]])
    return np.array([along, [0.0, 0.0, 1.0]])


def _svg(placed: list[Array], paths: Array, axes: Array) -> str:
    """Return the picture of bodies, each with points (n, k, 3), m, at n instants, and of paths (b, m, 3), m."""
    flat = [points @ axes.T for points in placed]
    lines = paths @ axes.T
    every = np.concatenate([*(points.reshape(-1, 2) for points in flat), lines.reshape(-1, 2)])
    low, high = every.min(axis=0), every.max(axis=0)
    sizes = np.maximum(high - low, 1e-300)
    scale = float(min((WIDTH - 2 * MARGIN) / sizes[0], (HEIGHT - 2 * MARGIN) / sizes[1]))
    middle = (low + high) / 2

    def drawn(points: Array) -> str:
        shifted = scale * (points - middle) * np.array([1.0, -1.0]) + np.array([WIDTH, HEIGHT]) / 2
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in shifted)

    parts = [f'<polyline points="{drawn(line)}" fill="none" stroke-opacity="0.35"/>' for line in lines if len(line) > 1]
    instants = len(flat[0])
    for instant in range(instants):
        opacity = 0.12 + 0.5 * (instant + 1) / instants
        shade = f'fill-opacity="{opacity / 2:.2g}" stroke-opacity="{opacity:.2g}"'
        for points in flat:
            corners = drawn(_hull(points[instant]))
            x, _, y = corners.partition(",")
            point = " " not in corners
            parts.append(
                f'<circle cx="{x}" cy="{y}" r="{POINT}" {shade}/>' if point else f'<polygon points="{corners}" {shade}/>'
            )
    return (
        f'<svg class="still" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" fill="currentColor" stroke="currentColor" aria-hidden="true">'
        f"{''.join(parts)}</svg>"
    )


def _hull(points: Array) -> Array:
    """Return the corners (k, 2) of the convex hull of points (n, 2), in order."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)

    def half(those: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for x, y in those:
            while len(chain) > 1:
                (a, b), (c, d) = chain[-2:]
                if (c - a) * (y - b) > (d - b) * (x - a):
                    break
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))

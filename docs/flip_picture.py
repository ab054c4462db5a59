"""Draw the picture of the README and of the front page. Run: python docs/flip_picture.py

A brick ten seconds after it was thrown: the exact one, and those of two integrators of MuJoCo at 2 ms with the outline of the
exact one. It writes docs/images/flip-SCHEME.svg. Letters are large, since a telephone shows the picture at two fifths.
"""

from pathlib import Path
from typing import Any

import numpy as np

import bodycheck
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.trajectory import Array

FOLDER = Path(__file__).parent / "images"

CASE, STEP = "intermediate-axis-flip", 0.002

#: The integrators of MuJoCo beside the truth, and what a reader knows them as.
INTEGRATORS = {"Euler": "MuJoCo, default", "RK4": "MuJoCo, RK4"}

#: Ground, ink, and the fills of the three pairs of faces, in light and dark.
COLOURS = {
    "light": ("#ffffff", "#1f2430", ("#8fc1ea", "#2b7bba", "#0b4a7d")),
    "dark": ("#14181e", "#e6e9ef", ("#9cc9ee", "#3f8fce", "#1b5d94")),
}

#: The size of the picture and of one part of it, and the size of a metre.
WIDTH, HEIGHT, PART, SCALE = 900, 370, 300, 360

#: The unit vectors of the picture, to the right, up and out of it, for an eye at this azimuth and height, in rad.
AZIMUTH, ELEVATION = 0.1, 0.5
RIGHT = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
OUT = np.array([np.cos(AZIMUTH) * np.cos(ELEVATION), np.sin(AZIMUTH) * np.cos(ELEVATION), np.sin(ELEVATION)])
VIEW = np.array([RIGHT, np.cross(OUT, RIGHT), OUT])

#: Signs of the corners of each face, in order round it, for the face at the positive end of each axis.
ROUND = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])


def faces(quaternion: Array, semi_axes: Array) -> list[tuple[int, bool, Array]]:
    """Return the faces of a brick that are towards the viewer: axis, whether at its positive end, and corners in the picture.

    quaternion: body to world. semi_axes (3,), m. Corners (4, 2), m, from the centre.
    """
    seen = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            corners = np.empty((4, 3))
            corners[:, axis] = sign
            corners[:, [each for each in range(3) if each != axis]] = ROUND
            normal = sign * np.eye(3)[axis]
            turned = rotate(np.tile(quaternion, (5, 1)), np.vstack([corners * semi_axes, normal])) @ VIEW.T
            if turned[4, 2] > 0:
                seen.append((axis, sign > 0, turned[:4, :2]))
    return seen


def points(corners: Array, left: float) -> str:
    """Return corners as the points of a polygon in the part of the picture that begins at `left`."""
    x, y = left + PART / 2 + SCALE * corners[:, 0], 150 - SCALE * corners[:, 1]
    return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y, strict=True))


def brick(seen: list[tuple[int, bool, Array]], left: float, fills: tuple[str, ...]) -> str:
    """Return a brick, with a white mark on one of its faces."""
    drawn = []
    for axis, positive, corners in seen:
        drawn.append(f'<polygon points="{points(corners, left)}" fill="{fills[axis]}" stroke-linejoin="round"/>')
        if axis == 0 and positive:
            middle = corners.mean(axis=0)
            drawn.append(f'<polygon points="{points(middle + (corners - middle) * 0.35, left)}" fill="#ffffff"/>')
    return "".join(drawn)


def outline(seen: list[tuple[int, bool, Array]], left: float, ink: str) -> str:
    """Return the edges of a brick."""
    style = f'fill="none" stroke="{ink}" stroke-width="2" stroke-dasharray="7 6"'
    return "".join(f'<polygon points="{points(corners, left)}" {style}/>' for _, _, corners in seen)


def short(number: str) -> str:
    """Return a number without zeros in its exponent."""
    return number.replace("e-0", "e-")


def rounded_up(bound: float) -> str:
    """Return a bound with two digits that is no smaller."""
    unit = 10.0 ** (np.floor(np.log10(bound)) - 1)
    return short(f"{np.ceil(bound / unit) * unit:.1e}")


def picture(scheme: str) -> str:
    """Return the picture as SVG."""
    ground, ink, fills = COLOURS[scheme]
    case = bodycheck.load(CASE)
    truth = bodycheck.truth(case)
    scene: Any = case.scene  # a brick in free flight
    size = np.asarray(scene.body.shape.semi_axes)
    exact = faces(truth.trajectory.quaternion[-1], size)
    parts = [(brick(exact, 0, fills), "exact", f"to {rounded_up(truth.bounds.error.max())} rad")]
    for place, (integrator, name) in enumerate(INTEGRATORS.items(), 1):
        run = bodycheck.simulate(case, "mujoco", integrator, timestep=STEP)
        error = bodycheck.compare(truth, run).maxima()["attitude_error"]
        outcome: Any = run.outcome  # completed, since there is an error
        drawn = brick(faces(outcome.trajectory.quaternion[-1], size), place * PART, fills)
        parts.append((drawn + outline(exact, place * PART, ink), name, f"off by {short(f'{error:.2g}')} rad"))
    words = "".join(
        f'<text x="{PART * (place + 0.5)}" y="315">{name}</text>'
        f'<text x="{PART * (place + 0.5)}" y="353" font-weight="bold">{told}</text>'
        for place, (_, name, told) in enumerate(parts)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">'
        f'<rect width="100%" height="100%" fill="{ground}"/>{"".join(drawn for drawn, _, _ in parts)}'
        f'<g fill="{ink}" font-family="sans-serif" font-size="31" text-anchor="middle">{words}</g></svg>\n'
    )


if __name__ == "__main__":
    for scheme in COLOURS:
        path = FOLDER / f"flip-{scheme}.svg"
        path.write_text(picture(scheme), "utf-8")
        print(path)

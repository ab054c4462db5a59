"""Redraw figures of the chapter as SVG, those of Example 2.1 from the truth of the shipped cases.

    python docs/figures.py --out DIR

The figures are 2.17 (single rotation axis), 2.18 and 2.19 (spin and pitch of the stable brick), 2.20 and 2.21 (the same of the
unstable brick), 2.22 and 2.23 (its angular momentum in the body frame and in the inertial frame), and 2.24 (the integral in the
torque of a pure spin).

The chapter states neither the size nor the mass of its brick, so that only the shapes of the curves in Figs. 2.18-2.23 can be
compared. In Fig. 2.23 its angular momentum is some 0.006, that of a smaller or lighter brick; in the case it is 0.333 kg m^2/s.
"""

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import vl_convert

import bodycheck
from bodycheck.reference.chapter.orientation import axis_and_angle, zxz
from bodycheck.reference.kinematics import euler_from_quaternion, euler_rates
from bodycheck.reference.observables import observe
from bodycheck.reference.trajectory import Array

Rows = list[dict[str, Any]]
Spec = dict[str, Any]

STABLE, UNSTABLE = "free-brick", "intermediate-axis-flip"

#: Euler angles z-x-z of Fig. 2.17 (rad).
TRIAD = (math.pi / 4, math.pi / 4, math.pi / 2)
COLOURS = ("#009e73", "#b35c8d", "#8c8500")
DASHES = ([1, 0], [7, 3], [2, 2])

#: Cells of the heat map along each side.
CELLS = 40

#: Vega-Lite's configuration of all figures.
CONFIG = {"background": "white", "font": "sans-serif", "view": {"stroke": None}, "axis": {"gridOpacity": 0.3}}

#: Direction from which Fig. 2.17 is seen: longitude from i, and elevation above the plane of i and j (rad).
AZIMUTH, ELEVATION = math.radians(10), math.radians(20)


def spin(case: str) -> Rows:
    """Return the spin rate psi' of the Euler angles and the body rate about K over time (rad/s) [G 2.21a].

    Where K passes near the vertical, psi' has a peak that belongs to the angles and not to the motion of the body.
    """
    motion = bodycheck.truth(bodycheck.load(case)).trajectory
    _, theta, psi = euler_from_quaternion(motion.quaternion)
    _, _, dpsi = euler_rates(theta, psi, motion.angular_velocity)
    return over_time(motion.t, {"ψ̇": dpsi, "Ω_Z": motion.angular_velocity[:, 2]})


def pitch(case: str) -> Rows:
    """Return the angle theta between K and the vertical over time (rad)."""
    motion = bodycheck.truth(bodycheck.load(case)).trajectory
    return over_time(motion.t, {"θ": euler_from_quaternion(motion.quaternion)[1]})


def momentum(case: str, frame: str) -> Rows:
    """Return the angular momentum about the centre of mass over time (kg m^2/s), in the frame "body" or "inertial"."""
    loaded = bodycheck.load(case)
    motion = bodycheck.truth(loaded).trajectory
    seen = observe(loaded.scene, motion)
    in_frame = {"body": ("IJK", seen.body_angular_momentum), "inertial": ("xyz", seen.angular_momentum)}
    names, values = in_frame[frame]
    return over_time(motion.t, dict(zip(names, values.T, strict=True)))


def spin_integral(a: Array, b: Array) -> Array:
    """Return the integral of sqrt(X^2 + Y^2) over 0 < X < a and 0 < Y < b (m^3), for a, b > 0, in closed form.

    Multiplied by mu m g/(a b) it is the torque of friction on a brick of half-lengths a, b that spins without sliding.
    """
    return (2 * a * b * np.hypot(a, b) + a**3 * np.arcsinh(b / a) + b**3 * np.arcsinh(a / b)) / 6


def torque_integral() -> Rows:
    """Return `spin_integral` over 0 < a < 2, 0 < b < 2 (m), one row for the middle of each of `CELLS` x `CELLS` cells."""
    width = 2 / CELLS
    middles = np.arange(CELLS) * width + width / 2
    a, b = (grid.ravel() for grid in np.meshgrid(middles, middles, indexing="ij"))
    table = np.stack([a - width / 2, a + width / 2, b - width / 2, b + width / 2, spin_integral(a, b)], axis=1)
    return [dict(zip(("a", "a2", "b", "b2", "integral"), row, strict=True)) for row in table.round(12).tolist()]


def rotation_axis() -> Rows:
    """Return lines from the origin, in space (x, y, z) and in the picture (u, v): inertial axes, body axes, rotation axis a."""
    a1 = zxz(*map(np.asarray, TRIAD))
    axis, _ = axis_and_angle(a1)
    lines = [("inertial", name, end) for name, end in zip("ijk", np.eye(3), strict=True)]
    lines += [("body", name, end) for name, end in zip("IJK", a1.T, strict=True)]
    lines += [("rotation axis", "a", axis)]
    east = np.array([-math.sin(AZIMUTH), math.cos(AZIMUTH), 0.0])
    towards = np.array([math.cos(AZIMUTH) * math.cos(ELEVATION), math.sin(AZIMUTH) * math.cos(ELEVATION), math.sin(ELEVATION)])
    up = np.cross(towards, east)
    return [
        {"frame": frame, "name": name, "end": end, "u": float(point @ east), "v": float(point @ up)}
        | dict(zip("xyz", point.tolist(), strict=True))
        for frame, name, tip in lines
        for end, point in enumerate((0 * tip, tip))
    ]


def over_time(t: Array, components: dict[str, Array]) -> Rows:
    """Return a row for each instant t (s) and component, from the values (n,) of the components by name."""
    return [
        {"t": instant, "component": name, "value": value}
        for name, values in components.items()
        for instant, value in zip(t.tolist(), values.tolist(), strict=True)
    ]


def curves(rows: Rows, title: str, axis: str) -> Spec:
    """Return a chart of components over time, with a line for each and a legend if there are several."""
    names = list(dict.fromkeys(row["component"] for row in rows))
    legend = {"title": None, "symbolSize": 300} if len(names) > 1 else None
    channels = (("color", COLOURS), ("strokeDash", DASHES))
    styles = {
        channel: {
            "field": "component",
            "type": "nominal",
            "scale": {"domain": names, "range": list(values[: len(names)])},
            "legend": legend,
        }
        for channel, values in channels
    }
    return {
        "title": title,
        "width": 460,
        "height": 240,
        "data": {"values": rows},
        "mark": {"type": "line", "strokeWidth": 1.5},
        "encoding": {
            "x": {"field": "t", "type": "quantitative", "title": "Time, s"},
            "y": {"field": "value", "type": "quantitative", "title": axis, "scale": {"zero": False}},
            **styles,
        },
        "config": CONFIG,
    }


def heat_map(rows: Rows, title: str) -> Spec:
    """Return a heat map over a and b whose steps of colour are the contours."""
    colour = {
        "field": "integral",
        "type": "quantitative",
        "title": "m³",
        "scale": {"type": "threshold", "domain": [0.25, 0.5, 1, 1.5, 2, 3, 4, 5], "scheme": "viridis"},
    }
    return {
        "title": title,
        "width": 8 * CELLS,  # a cell has a whole number of pixels, or seams would be visible
        "height": 8 * CELLS,
        "data": {"values": rows},
        "mark": "rect",
        "encoding": {
            "x": {"field": "a", "type": "quantitative", "title": "a, m", "axis": {"grid": False}},
            "x2": {"field": "a2"},
            "y": {"field": "b", "type": "quantitative", "title": "b, m", "axis": {"grid": False}},
            "y2": {"field": "b2"},
            "color": colour,
        },
        "config": CONFIG,
    }


def sketch(rows: Rows, title: str) -> Spec:
    """Return a parallel projection of lines from the origin, with their names at their ends."""
    frames = {"domain": ["inertial", "body", "rotation axis"], "range": ["#888888", *COLOURS[:2]]}
    place = {
        channel: {"field": channel, "type": "quantitative", "axis": None, "scale": {"domain": [-1.2, 1.2]}} for channel in "uv"
    }
    encoding = {
        "x": place["u"],
        "y": place["v"],
        "color": {"field": "frame", "type": "nominal", "scale": frames, "legend": {"title": None, "symbolType": "stroke"}},
    }
    size = {"field": "frame", "type": "nominal", "scale": {**frames, "range": [1, 2, 4]}, "legend": None}
    names = {"mark": {"type": "text", "fontSize": 14, "dx": 9, "dy": -7}, "transform": [{"filter": "datum.end == 1"}]}
    return {
        "title": title,
        "width": 320,
        "height": 320,
        "data": {"values": rows},
        "encoding": encoding,
        "layer": [
            {"mark": "line", "encoding": {"detail": {"field": "name"}, "order": {"field": "end"}, "strokeWidth": size}},
            {**names, "encoding": {"text": {"field": "name"}}},
        ],
        "config": CONFIG,
    }


def single_rotation() -> Spec:
    """Return Fig. 2.17: the single rotation that is equivalent to the Euler angles `TRIAD`."""
    _, angle = axis_and_angle(zxz(*map(np.asarray, TRIAD)))
    return sketch(
        rotation_axis(), f"Fig. 2.17: the one rotation of {{π/4, π/4, π/2}}, by {float(angle) / math.pi:.3f} π about a"
    )


#: Functions that return the Vega-Lite specification of a figure with its data, by the figure's number in the chapter.
FIGURES: dict[str, Callable[[], Spec]] = {
    "2.17": single_rotation,
    "2.18": lambda: curves(spin(STABLE), "Fig. 2.18: spin of the stable brick", "rad/s"),
    "2.19": lambda: curves(pitch(STABLE), "Fig. 2.19: pitch of the stable brick", "θ, rad"),
    "2.20": lambda: curves(spin(UNSTABLE), "Fig. 2.20: spin of the unstable brick", "rad/s"),
    "2.21": lambda: curves(pitch(UNSTABLE), "Fig. 2.21: pitch of the unstable brick", "θ, rad"),
    "2.22": lambda: curves(
        momentum(UNSTABLE, "body"), "Fig. 2.22: angular momentum of the unstable brick, body frame", "kg m²/s"
    ),
    "2.23": lambda: curves(
        momentum(UNSTABLE, "inertial"), "Fig. 2.23: angular momentum of the unstable brick, inertial frame", "kg m²/s"
    ),
    "2.24": lambda: heat_map(torque_integral(), "Fig. 2.24: ∫∫ √(X² + Y²) dX dY over 0 < X < a, 0 < Y < b"),
}


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Redraw figures of the chapter as SVG.")
    parser.add_argument("--out", type=Path, required=True, help="folder for the figures; it is made if it is missing")
    out: Path = parser.parse_args(arguments).out
    out.mkdir(parents=True, exist_ok=True)
    for number, figure in FIGURES.items():
        path = out / f"figure-{number}.svg"
        path.write_text(vl_convert.vegalite_to_svg(figure()), encoding="utf-8")
        print(path)


if __name__ == "__main__":
    main()

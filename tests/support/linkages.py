"""Mechanisms with loops: the N-four-bar of the IFToMM benchmark A02, a slider-crank, a four-bar and a spatial one."""

import math
from dataclasses import replace

import numpy as np

from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, JointedBody, Loop, Mechanism
from bodycheck.reference.scene import Tensor, Vector

#: The axis of planar linkages: positive angles turn x towards z.
_ACROSS = (0.0, -1.0, 0.0)


def rod(name: str, length: float, mass: float = 1.0) -> JointedBody:
    """A uniform rod along x from the origin of its frame, with the moment of a thin one across."""
    across = mass * length * length / 12
    rows = ((across / 50, 0.0, 0.0), (0.0, across, 0.0), (0.0, 0.0, across))
    return JointedBody(name, Tensor(mass, rows), (length / 2, 0.0, 0.0))


def hinge(name: str, parent: int, child: int, position: Vector, angle: float, rate: float) -> Joint:
    """A hinge across the plane x, z."""
    return Joint(name, "revolute", parent, child, position=position, axis=_ACROSS, start=(angle,), start_velocity=(rate,))


def n_four_bar(bars: int, angle: float = math.pi / 2, rate: float = -1.0) -> Mechanism:
    """The benchmark A02: bars + 1 vertical rods of 1 m and 1 kg, whose ends are joined by horizontal ones."""
    verticals = [rod(f"vertical-{place}", 1.0) for place in range(bars + 1)]
    horizontals = [rod(f"horizontal-{place}", 1.0) for place in range(bars)]
    joints = [hinge(f"foot-{place}", WORLD, place, (float(place), 0.0, 0.0), angle, rate) for place in range(bars + 1)]
    joints += [hinge(f"head-{n}", n, bars + 1 + n, (1.0, 0.0, 0.0), -angle, -rate) for n in range(bars)]
    ends = ((1.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    loops = [Loop((bars + 1 + n, n + 1), ends) for n in range(bars)]
    return Mechanism((*verticals, *horizontals), tuple(joints), tuple(loops), 9.81)


def slider_crank(angle: float = 0.6, rate: float = 3.0) -> Mechanism:
    """A crank of 1 m, a connecting rod of 2 m and a slider along x."""
    lean = -math.asin(math.sin(angle) / 2)
    leans = -math.cos(angle) * rate / (2 * math.cos(lean))
    place, speed = math.cos(angle) + 2 * math.cos(lean), -math.sin(angle) * rate - 2 * math.sin(lean) * leans
    joints = (
        hinge("crank", WORLD, 0, (0.0, 0.0, 0.0), angle, rate),
        hinge("pin", 0, 1, (1.0, 0.0, 0.0), lean - angle, leans - rate),
        Joint("rail", "prismatic", WORLD, 2, axis=(1.0, 0.0, 0.0), start=(place,), start_velocity=(speed,)),
    )
    bodies = (rod("crank", 1.0), rod("rod", 2.0), rod("slider", 0.2, 0.5))
    return Mechanism(bodies, joints, (Loop((1, 2), ((2.0, 0.0, 0.0), (0.0, 0.0, 0.0))),), 9.81)


def four_bar() -> Mechanism:
    """A crank of 3 m, a coupler of 5 m and a rocker of 4 m on a base of 6 m, at rest at a right angle between the last two."""
    # The crank stands at the angle at which the distance from its end to the rocker's foot is the hypotenuse of the other two.
    angle = math.acos((9 + 36 - 41) / 36)
    end = (3 * math.cos(angle), 3 * math.sin(angle))
    away = math.atan2(-end[1], 6 - end[0])
    coupler = away + math.atan2(4, 5)
    knee = (end[0] + 5 * math.cos(coupler), end[1] + 5 * math.sin(coupler))
    rocker = math.atan2(knee[1], knee[0] - 6)
    joints = (
        hinge("crank", WORLD, 0, (0.0, 0.0, 0.0), angle, 0.0),
        hinge("knuckle", 0, 1, (3.0, 0.0, 0.0), coupler - angle, 0.0),
        hinge("rocker", WORLD, 2, (6.0, 0.0, 0.0), rocker, 0.0),
    )
    bodies = (rod("crank", 3.0), rod("coupler", 5.0), rod("rocker", 4.0))
    return Mechanism(bodies, joints, (Loop((1, 2), ((5.0, 0.0, 0.0), (4.0, 0.0, 0.0))),), 9.81)


def spatial() -> Mechanism:
    """Joints of every type, with armature, damping, a spring and an effort; it has no loops yet."""
    rows = ((0.3, 0.01, 0.0), (0.01, 0.4, 0.02), (0.0, 0.02, 0.5))
    bodies = tuple(
        JointedBody(name, Tensor(1.0 + place, rows), (0.1, 0.2 * place, -0.3)) for place, name in enumerate("abcdefg")
    )
    tilted = (0.9, 0.1, -0.2, 0.3)
    still6, still4 = (0.0,) * 6, (1.0, 0.0, 0.0, 0.0)
    joints = (
        Joint(
            "turn", "revolute", WORLD, 0, axis=(1.0, 2.0, 2.0), armature=0.3, damping=0.2, start=(0.4,), start_velocity=(0.0,)
        ),
        Joint("ball", "spherical", 0, 1, (0.5, 0.0, 0.1), damping=0.1, start=tilted, start_velocity=(0.0,) * 3),
        Joint("cross", "universal", 1, 2, (0.0, 0.4, 0.0), tilted, start=(0.2, -0.3), start_velocity=(0.0, 0.0)),
        Joint("table", "planar", WORLD, 3, (1.0, 0.0, 0.0), tilted, start=(0.1, 0.2, 0.3), start_velocity=(0.0,) * 3),
        Joint(
            "rail",
            "prismatic",
            3,
            4,
            (0.0, 0.0, 0.5),
            axis=(0.0, 3.0, 4.0),
            stiffness=30.0,
            rest=0.1,
            effort=2.0,
            start=(0.2,),
            start_velocity=(0.0,),
        ),
        Joint("weld", "fixed", 4, 5, (0.2, 0.1, 0.0), tilted),
        Joint("air", "free", WORLD, 6, start=(2.0, 0.0, 0.0, *still4), start_velocity=still6),
    )
    return Mechanism(bodies, joints, (), 9.81)


def closed_spatially() -> Mechanism:
    """The spatial linkage with two loops through points that meet at the start."""
    made = spatial()
    start = kinematics.initial(made)

    def point(body: int, place: np.ndarray) -> tuple[float, float, float]:
        """A place in the world as a point of a body, whose frame is found from its centre of mass."""
        turn, centre = start.quaternion[body, 0], start.position[body, 0]
        back = np.array([1, -1, -1, -1]) * turn
        x, y, z = kinematics.rotate(back[None], (place - centre)[None])[0] + np.array(made.bodies[body].center_of_mass)
        return float(x), float(y), float(z)

    first, second = start.position[2, 0] + [0.1, 0.0, 0.2], start.position[5, 0] + [0.0, 0.3, 0.1]
    loops = (
        Loop((2, WORLD), (point(2, first), (float(first[0]), float(first[1]), float(first[2])))),
        Loop((5, 6), (point(5, second), point(6, second))),
    )
    return replace(made, loops=loops)

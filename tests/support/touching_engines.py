"""Measure how an adapter's engine slides, rolls, bounces, bears and pushes bodies, for the tests of each engine.

The scenes that several engines refuse are here too.
"""

import math
from dataclasses import replace

import numpy as np

from bodycheck import load
from bodycheck.adapters import offers
from bodycheck.adapters.contract import Adapter, InterfaceLoads, Method, Sensing
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene
from bodycheck.reference.scene import Body, Brick, Ellipsoid, Plane, Push, Scene, Sphere, State
from bodycheck.reference.trajectory import Array
from tests.support import touching
from tests.support.sensor_readings import readings
from tests.support.touching import MASS

GRAVITY = 9.81

#: A ball of 1 kg that touches the plane z = 0 at the origin.
RADIUS = 0.1
BALL = Body(1.0, (0.004, 0.004, 0.004), Sphere(RADIUS))


def states(adapter: Adapter, scene: AnyScene, spelling: str, timestep: float, strides: list[int]) -> Array:
    """The states (n, bodies, 13) of a scene after each of n strides."""
    return adapter.prepare([scene], Method.parse(spelling, timestep)).advance(np.array(strides))[0]


def ball(plane: Plane, position: float = RADIUS, velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Scene:
    """The ball above the origin of a plane, at a distance (m) of its centre along the normal."""
    centre = (position * math.sin(plane.incline), 0.0, position * math.cos(plane.incline))
    return Scene(BALL, State(position=centre, velocity=velocity), gravity=GRAVITY, plane=plane)


def slide(adapter: Adapter, spelling: str, timestep: float) -> float:
    """The acceleration down a ramp of a block that slides, from 0.5 s on, over that of mechanics.

    The first half second is left out, in which a block may sink a little before the plane bears it.
    """
    scene = load("sensor-block-on-ramp").scene
    assert scene.plane is not None
    first, second = states(adapter, scene, spelling, timestep, [round(0.5 / timestep)] * 2)[:, 0, 7:10]
    incline = scene.plane.incline
    along = np.array([math.cos(incline), 0.0, -math.sin(incline)])
    exact = GRAVITY * (math.sin(incline) - scene.plane.friction * math.cos(incline))
    return float((second - first) @ along) / (0.5 * exact)


def rolling_speed(adapter: Adapter, spelling: str, timestep: float) -> tuple[float, float]:
    """The speed of a ball that slipped at 1 m/s until it rolled, over that at the start, and the part of it that slips."""
    scene = ball(Plane(0.5), velocity=(1.0, 0.0, 0.0))
    last = states(adapter, scene, spelling, timestep, [round(0.5 / timestep)])[-1, 0]
    return float(last[7]), float(last[7] - RADIUS * last[11])


def bounce(adapter: Adapter, spelling: str, timestep: float, restitution: float = 0.8) -> float:
    """The largest upward speed of a ball after its first impact over its largest downward speed; it falls by half a metre."""
    scene = ball(Plane(0.3, restitution=restitution), position=RADIUS + 0.5)
    speeds = states(adapter, scene, spelling, timestep, [1] * round(0.5 / timestep))[:, 0, 9]
    return float(-speeds.max() / speeds.min())


def sunk_at_rest(adapter: Adapter, spelling: str, timestep: float) -> float:
    """The distance (m) that a ball at rest moves in a second."""
    scene = ball(Plane(0.5))
    last = states(adapter, scene, spelling, timestep, [round(1 / timestep)])[-1, 0]
    return float(np.linalg.norm(last[:3] - scene.initial.position))


def loads_of_stack(adapter: Adapter, spelling: str, timestep: float) -> dict[tuple[int, int], float]:
    """The mean loads of the pairs of ten bricks at rest in the last of two seconds, in units of the weight of one."""
    assert isinstance(adapter, InterfaceLoads)
    steps = round(2 / timestep)
    loads = adapter.interface_loads(load("stack-of-ten").scene, Method.parse(spelling, timestep), steps)
    return {pair: float(load_of_pair[steps // 2 :].mean()) / GRAVITY for pair, load_of_pair in loads.items()}


def loads_of_three_balls(adapter: Adapter, spelling: str, timestep: float, steps: int) -> dict[tuple[int, int], float]:
    """The loads of the pairs of three balls on each other after some steps, over what they bear: the weights above."""
    assert isinstance(adapter, InterfaceLoads)
    scene = touching.several([(touching.BALL, (0.0, 0.0, (2 * number + 1) * RADIUS)) for number in range(3)], Plane(0.5))
    loads = adapter.interface_loads(scene, Method.parse(spelling, timestep), steps)
    weights = {(WORLD, 0): 3 * MASS * GRAVITY, (0, 1): 2 * MASS * GRAVITY, (1, 2): MASS * GRAVITY}
    assert loads.keys() == weights.keys()
    return {pair: float(loads[pair][-1]) / weight for pair, weight in weights.items()}


def read_on_two_balls(adapter: Adapter, spelling: str, timestep: float, steps: int) -> Array:
    """The readings (2, 3) of the forces of contacts on each of two balls, one on the other, after some steps.

    They are over the weight of a ball: each ball at rest has the force that bears its own weight, (0, 0, 1).
    """
    assert isinstance(adapter, Sensing)
    scene = touching.several([(touching.BALL, (0.0, 0.0, RADIUS)), (touching.BALL, (0.0, 0.0, 3 * RADIUS))], Plane(0.5))
    force = load("sensor-rolling-ball").sensors[-1]
    sensors = [replace(force, name=f"on {body}", body=body) for body in (0, 1)]
    sensing = offers.prepare_sensing(adapter, scene, sensors, Method.parse(spelling, timestep))
    sensing.simulation.advance(np.array([steps]))
    return np.array(sensing.read()) / (MASS * GRAVITY)


def read_on_ramp(adapter: Adapter, spelling: str, friction: bool) -> tuple[Array, Array]:
    """The last reading (3,) of the force of contacts on a block of 1 kg that slides down a ramp for 0.2 s, and the exact one.

    friction: whether the engine's reading contains friction; otherwise the exact one is the normal force.
    """
    seen = readings(adapter, "sensor-block-on-ramp", spelling, 0.002, 100)
    plane = load("sensor-block-on-ramp").scene.plane
    assert plane is not None
    uphill = np.array([-math.cos(plane.incline), 0.0, math.sin(plane.incline)])
    part = np.array(plane.normal) + (plane.friction * uphill if friction else 0.0)
    return seen.given["contact"][-1], GRAVITY * math.cos(plane.incline) * part


def cube_and_ball() -> AnyScene:
    """A cube and a ball side by side on a plane, which engines with contacts of spheres alone refuse."""
    return touching.several([(touching.CUBE, (0.0, 0.0, RADIUS)), (touching.BALL, (1.0, 0.0, RADIUS))], Plane(0.5))


def ellipsoid() -> Scene:
    """An ellipsoid on a plane, a shape that several engines lack."""
    scene = ball(Plane(0.3))
    return replace(scene, body=replace(scene.body, shape=Ellipsoid((0.1, 0.1, 0.2))))


def pushed(adapter: Adapter, spelling: str, timestep: float) -> Array:
    """The velocity and the angular velocity (6,) of the ball after a push beside its centre from 0.1 s to 0.2 s.

    There is no friction. Mechanics gives 0.2 m/s along x, and about y 2 N times 0.02 m times 0.1 s over 0.004 kg m^2, with
    the torque of the push as at the start: the ball turns by 0.05 rad, so that this holds to a few thousandths.
    """
    scene = replace(ball(Plane(0.0)), pushes=(Push((2.0, 0.0, 0.0), point=(0.0, 0.0, 0.02), start=0.1, end=0.2),))
    return states(adapter, scene, spelling, timestep, [round(0.3 / timestep)])[-1, 0, 7:]


def differs_along_other_axes(adapter: Adapter, spelling: str, timestep: float) -> float:
    """The largest difference in the states of a brick that falls on an edge, given along its principal axes or turned by 90°.

    The turned description has the same moments in the other order, and principal axes that are turned back.
    """
    (x, y, z), h = (0.1, 0.15, 0.05), math.sqrt(0.5)
    shape, (xx, yy, zz) = Brick((x, y, z)), ((y * y + z * z) / 3, (x * x + z * z) / 3, (x * x + y * y) / 3)
    attitude = (math.cos(0.2), math.sin(0.2), 0.0, 0.0)
    bricks = [
        Scene(body, State(position=(0.0, 0.0, 0.3), quaternion=attitude), gravity=GRAVITY, plane=Plane(0.5))
        for body in (Body(1.0, (xx, yy, zz), shape), Body(1.0, (yy, xx, zz), shape, axes=(h, 0.0, 0.0, h)))
    ]
    one, other = (states(adapter, scene, spelling, timestep, [1] * round(0.3 / timestep)) for scene in bricks)
    return float(np.abs(one - other).max())


def rolling_deceleration(adapter: Adapter, spelling: str, timestep: float, coefficient: float, speed: float = 1.0) -> float:
    """The deceleration from 0.3 s to 0.5 s of the ball that rolls, over that of its rolling friction, mu_r g / (1.4 r)."""
    start = State((0.0, 0.0, RADIUS), velocity=(speed, 0.0, 0.0), angular_velocity=(0.0, speed / RADIUS, 0.0))
    scene = replace(ball(Plane(0.5, rolling_friction=coefficient)), initial=start)
    first, second = states(adapter, scene, spelling, timestep, [round(0.3 / timestep), round(0.2 / timestep)])[:, 0, 7]
    return float(first - second) / 0.2 / (coefficient * GRAVITY / (1.4 * RADIUS))


def spin_deceleration(adapter: Adapter, spelling: str, timestep: float, coefficient: float) -> float:
    """The deceleration from 0.3 s to 0.5 s of the ball that spins at 10 rad/s, over that of mu_t m g."""
    start = State((0.0, 0.0, RADIUS), angular_velocity=(0.0, 0.0, 10.0))
    scene = replace(ball(Plane(0.5, torsional_friction=coefficient)), initial=start)
    first, second = states(adapter, scene, spelling, timestep, [round(0.3 / timestep), round(0.2 / timestep)])[:, 0, 12]
    return float(first - second) / 0.2 / (coefficient * GRAVITY * BALL.mass / BALL.moments[2])

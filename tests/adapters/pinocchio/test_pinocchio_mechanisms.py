"""What is special to mechanisms in Pinocchio: the forces that are added to its algorithms, its loops, and its schemes."""

from dataclasses import replace

import numpy as np
import pytest

from bodycheck.adapters.contract import Method, SceneUnsupported
from bodycheck.adapters.mechanisms import frames
from bodycheck.adapters.pinocchio import engine as adapter
from bodycheck.reference.kinematics import rotate
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import WORLD, Joint, Loop, Mechanism
from bodycheck.reference.trajectory import Array
from tests.support.jointed import body, cart_pole, four_bar, trajectory, tree
from tests.support.orders import observed_mechanism_order

STEP = 0.002

#: A few roundings of numbers near 1.
ROUNDING = 1e-14


def after(mechanism: Mechanism, spelling: str, *strides: int, timestep: float = STEP) -> Array:
    """The states (1, n, bodies, 13) after strides."""
    return adapter.prepare([mechanism], Method.parse(spelling, timestep)).advance(np.array(strides))


def test_a_step_has_armature_and_all_forces_of_a_joint() -> None:
    """The acceleration is (e - d v - k (x - rest) - f sign v) / (m + armature), taken at the start of the step."""
    rail = Joint(
        *("rail", "prismatic", WORLD, 0, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        *(0.3, 5.0, 40.0, -0.1, 1.5, 2.0),
        start=(0.2,),
        start_velocity=(-0.7,),
    )
    moved = after(Mechanism((body("cart", 0.8, (0.1, 0.1, 0.1)),), (rail,), gravity=9.81), "semi-implicit-euler", 1)[0, 0, 0]
    expected = -0.7 + STEP * (2.0 + 5.0 * 0.7 - 40.0 * 0.3 + 1.5) / 1.1
    assert moved[7] == pytest.approx(expected, abs=ROUNDING)
    assert moved[0] == pytest.approx(0.2 + STEP * expected, abs=ROUNDING)


@pytest.mark.parametrize(
    ("spelling", "order"), [("semi-implicit-euler", 1), ("body-twist-euler", 1), ("rk4", 4), ("rk4-naive", 2)]
)
def test_schemes_have_their_order_on_every_type_of_joint(spelling: str, order: int) -> None:
    """The tree has a joint of every type; terms of the next order are a tenth at these steps."""
    orders = observed_mechanism_order(adapter, tree(), spelling, (0.008, 0.004, 0.002), 0.2)
    assert orders == pytest.approx(dict.fromkeys(orders, order), abs=0.15)


def reordered(mechanism: Mechanism, order: tuple[int, ...]) -> Mechanism:
    """A mechanism whose bodies are given in another order: first the one that was at the first of some places."""
    now = {place: number for number, place in enumerate(order)} | {WORLD: WORLD}
    joints = tuple(replace(joint, parent=now[joint.parent], child=now[joint.child]) for joint in mechanism.joints)
    loops = tuple(replace(loop, bodies=(now[loop.bodies[0]], now[loop.bodies[1]])) for loop in mechanism.loops)
    return replace(mechanism, bodies=tuple(mechanism.bodies[place] for place in order), joints=joints, loops=loops)


@pytest.mark.parametrize("spelling", ["rk4", "semi-implicit-euler"])
def test_a_loop_moves_the_same_in_any_order_of_bodies(spelling: str) -> None:
    """`constraintDynamics` needs the joints depth first, and says nothing where they are not."""
    order = (0, 2, 1)
    given = after(four_bar(), spelling, 200)
    other = after(reordered(four_bar(), order), spelling, 200)
    # Two hundred steps with redundant constraints, whose rounding is divided by a regularisation of 1e-6.
    np.testing.assert_allclose(other, given[:, :, order], rtol=0, atol=1e-9)


def test_the_drift_of_a_loop_is_corrected_by_its_gains() -> None:
    strides, bent = np.full(10, 40), uneven_four_bar()
    t = STEP * np.cumsum(strides)
    drifts = [
        float(kinematics.gaps(bent, trajectory(t, after(bent, spelling, *strides)))[-1])
        for spelling in ("semi-implicit-euler", "semi-implicit-euler:baumgarte=10000 200")
    ]
    # The critically damped correction forgets what is older than some hundredths of the 0.8 s.
    assert drifts[1] < 0.2 * drifts[0]


def uneven_four_bar() -> Mechanism:
    """Four bars of different lengths, released at rest. The coordinates of a parallelogram have no drift: they are linear."""
    bars, end = four_bar(), (0.8, 0.0, 0.0)
    resting = tuple(replace(joint, start_velocity=(0.0,)) for joint in bars.joints)
    turned = replace(resting[2], start=(1.4,))
    open_chain = replace(bars, joints=(*resting[:2], turned), loops=())
    (third,) = frames(open_chain)[2:]
    ground = np.array(third.position) + rotate(np.array(third.quaternion), np.array(end))
    x, y, z = ground.tolist()
    return replace(open_chain, loops=(Loop((2, WORLD), (end, (x, y, z))),))


def test_a_correction_without_loops_is_refused() -> None:
    with pytest.raises(SceneUnsupported, match="baumgarte=100 20 for a mechanism without loops"):
        after(cart_pole(), "rk4:baumgarte=100 20", 1)


def test_a_mechanism_that_would_fill_the_memory_is_refused() -> None:
    """Two hundred balls have six hundred velocities, and Pinocchio's data grow with the third power of their number."""
    bodies = tuple(body(f"rod {number}", 1.0, (0.01, 0.1, 0.1), (0.5, 0.0, 0.0)) for number in range(200))
    joints = tuple(
        Joint(
            f"ball {child}",
            "spherical",
            child - 1,
            child,
            (1.0, 0.0, 0.0),
            start=(1.0, 0.0, 0.0, 0.0),
            start_velocity=(0.0,) * 3,
        )
        for child in range(200)
    )
    with pytest.raises(SceneUnsupported, match="600 velocities of joints"):
        after(Mechanism(bodies, joints), "rk4", 1)

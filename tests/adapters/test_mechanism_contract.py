"""What the contract asks of an adapter that builds bodies on joints, tried on every one whose engine is installed here."""

from collections.abc import Iterator

import numpy as np
import pytest

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Method, SceneUnsupported, Simulation
from bodycheck.reference.kinematics import geodesic_angle
from bodycheck.reference.mechanisms import kinematics
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.requirements import missing
from bodycheck.reference.trajectory import Array
from tests.support.asked import adapter_asked_for
from tests.support.coupled_joints import gripper, hip
from tests.support.jointed import ball_chain, bare_tree, cart_pole, free_chain, tree

ONLY = adapter_asked_for()
NAMES = [ONLY] if ONLY else [name for name in registry.names() if registry.installed(name)]

#: Mechanisms of several bodies: on a rail, on hinges in space, on ball joints, with a joint of every type, with several joints
#: of one body, and with a joint that follows another.
MECHANISMS = {
    "cart and pole": cart_pole(),
    "free chain": free_chain(),
    "ball chain": ball_chain(),
    "bare tree": bare_tree(),
    "tree": tree(),
    "hip": hip(),
    "gripper": gripper(),
}

STEP = 1e-4


def runs() -> Iterator[tuple[str, str, str]]:
    """Engine, mechanism and spelling of every method that is run where none is asked for."""
    for name in NAMES:
        adapter = registry.load(name)
        for which, mechanism in MECHANISMS.items():
            if missing(mechanism, adapter.engine.models) is None:
                yield from ((name, which, method) for method in offers.offered(adapter.engine, mechanism))


RUNS = list(runs())


def prepared(name: str, mechanism: Mechanism, spelling: str) -> Simulation:
    """The simulation of a mechanism; the test is skipped where the engine refuses it."""
    adapter = registry.load(name)
    try:
        return adapter.prepare([mechanism], Method.parse(spelling, STEP))
    except SceneUnsupported as refused:
        pytest.skip(str(refused))


def start_of(mechanism: Mechanism) -> Array:
    """The states (bodies, 13) at t = 0."""
    first = kinematics.initial(mechanism)
    parts = (first.position, first.quaternion, first.velocity, first.angular_velocity)
    return np.concatenate([part[:, 0] for part in parts], axis=1)


@pytest.mark.parametrize(("name", "which", "method"), RUNS)
def test_a_mechanism_begins_at_its_initial_state(name: str, which: str, method: str) -> None:
    """With its bodies in the order of the file."""
    mechanism = MECHANISMS[which]
    (row,) = prepared(name, mechanism, method).advance(np.array([0]))[0]
    start = start_of(mechanism)
    # Some tens of products in a chain of frames, each of which rounds once; the numbers are at most some tens.
    rounding = 450 * float(np.finfo(registry.load(name).engine.precision).eps)
    np.testing.assert_allclose(np.delete(row, slice(3, 7), 1), np.delete(start, slice(3, 7), 1), rtol=0, atol=rounding)
    assert geodesic_angle(row[:, 3:7], start[:, 3:7]).max() < rounding


@pytest.mark.parametrize(("name", "which", "method"), RUNS)
def test_a_mechanism_moves_with_its_velocities(name: str, which: str, method: str) -> None:
    mechanism, steps = MECHANISMS[which], 4
    start, row = prepared(name, mechanism, method).advance(np.array([0, steps]))[0]
    time = steps * STEP
    # Accelerations are some tens of m/s^2 and rad/s^2; a whole step of an error of first order is as large as that.
    limit = 200 * time
    rounding = 1e4 * float(np.finfo(registry.load(name).engine.precision).eps)
    np.testing.assert_allclose(row[:, 7:], start[:, 7:], rtol=0, atol=limit + rounding)
    moved = start[:, :3] + time * start[:, 7:10]
    np.testing.assert_allclose(row[:, :3], moved, rtol=0, atol=limit * time + rounding)
    turned = np.linalg.norm(start[:, 10:], axis=1) * time
    np.testing.assert_allclose(geodesic_angle(row[:, 3:7], start[:, 3:7]), turned, rtol=0, atol=limit * time + rounding)


@pytest.mark.parametrize(("name", "which", "method"), RUNS)
def test_stepping_a_mechanism_in_pieces_is_stepping_at_once(name: str, which: str, method: str) -> None:
    mechanism, strides = MECHANISMS[which], np.array([0, 3, 0, 5, 60, 1])
    whole = prepared(name, mechanism, method).advance(strides)
    assert whole.shape == (1, len(strides), len(mechanism.bodies), 13)
    assert whole.dtype == np.float64
    simulation = prepared(name, mechanism, method)
    pieces = []
    for part in (strides[:2], strides[2:3], strides[3:]):
        found = simulation.advance(part)
        pieces.append(found.copy())
        found[:] = np.nan  # a copy
    np.testing.assert_array_equal(np.concatenate(pieces, axis=1), whole)

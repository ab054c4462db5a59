"""A body is the same in every representation, and its states are the same after conversion."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bodycheck.adapters.links import link_of
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.scene import Body, Quaternion, Scene, State, Vector
from bodycheck.studies.audit.representations import along_principal_axes, representations, split, started
from tests.support.rotations import UNIT
from tests.support.welded import rotation, tensor, welded

#: Second moments (kg m^2), of which any two sum to a moment of inertia, so that the body exists; none is so small beside the
#: others that subtracting from it loses digits.
SECOND_MOMENTS = st.tuples(*[st.floats(0.05, 1)] * 3)
VECTOR = st.tuples(*[st.floats(-2, 2)] * 3)
QUATERNION = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1).map(lambda q: unit(q))

#: Roundings of numbers of order one, of which some hundred are made.
ROUNDING = 1e-13


def unit(q: tuple[float, ...]) -> Quaternion:
    w, x, y, z = (np.array(q) / np.linalg.norm(q)).tolist()
    return w, x, y, z


def body(mass: float, second_moments: Vector, axes: Quaternion) -> Body:
    a, b, c = second_moments
    return Body(mass, (b + c, c + a, a + b), axes=axes)


@given(st.floats(0.1, 10), SECOND_MOMENTS, QUATERNION, st.floats(0.05, 0.95), VECTOR, QUATERNION)
def test_two_links_have_the_mass_the_centre_and_the_tensor_of_the_body(
    mass: float, second_moments: Vector, axes: Quaternion, share: float, position: Vector, quaternion: Quaternion
) -> None:
    whole = body(mass, second_moments, axes)
    links = split(whole, share, position, quaternion)
    total, centre, inertia = welded(links)
    assert total == pytest.approx(mass, rel=ROUNDING)
    # The position of the second frame, of some metres, is subtracted and added again.
    np.testing.assert_allclose(centre, np.zeros(3), rtol=0, atol=10 * ROUNDING)
    np.testing.assert_allclose(inertia, inertia_tensor(whole), rtol=0, atol=100 * ROUNDING)
    assert links[1].mass == pytest.approx(share * mass, rel=ROUNDING)
    for link in links:  # each is a body that can exist
        moments = np.linalg.eigvalsh(tensor(link))
        assert moments[0] > 0
        assert moments[2] <= (moments[0] + moments[1]) * (1 + ROUNDING)
        assert np.linalg.norm(link.center_of_mass) > 1e-3, "its centre of mass is not the origin"


@given(st.floats(0.1, 10), SECOND_MOMENTS, UNIT, VECTOR, VECTOR)
def test_every_representation_is_the_same_body_in_the_same_state(
    mass: float, second_moments: Vector, axis: np.ndarray, velocity: Vector, spin: Vector
) -> None:
    """By its mass, and by energy, momentum and angular momentum about the origin of the world, which are physics."""
    scene = Scene(body(mass, second_moments, (1.0, 0.0, 0.0, 0.0)), State((1.0, -2.0, 0.5), unit((0.3, *axis)), velocity, spin))
    expected = momenta([link_of(scene.body)], scene.initial)
    for representation in representations(scene.body):
        seen = started(representation, scene)
        found = momenta(representation.links or [link_of(seen.body)], seen.initial)
        scale = 2 if representation.name.startswith("mass") else 1
        # Sums of a hundred products of numbers up to 100.
        np.testing.assert_allclose(found, scale * expected, rtol=1e-12, atol=1e-10)
        state = seen.initial
        row = np.array([[*state.position, *state.quaternion, *state.velocity, *state.angular_velocity]])
        back = along_principal_axes(representation, row)[0]
        start = scene.initial
        np.testing.assert_allclose(back[:3], start.position, rtol=0, atol=10 * ROUNDING)
        assert abs(back[3:7] @ start.quaternion) == pytest.approx(1, abs=ROUNDING)
        np.testing.assert_allclose(back[7:], [*start.velocity, *start.angular_velocity], rtol=0, atol=10 * ROUNDING)


def momenta(links: list, state: State) -> np.ndarray:
    """Mass, kinetic energy, momentum and angular momentum about the origin of the world, of links in a state of the first."""
    mass, centre, inertia = welded(links)
    turn, spin = rotation(state.quaternion), np.array(state.angular_velocity)
    velocity = np.array(state.velocity) + turn.apply(np.cross(spin, centre))
    place = np.array(state.position) + turn.apply(centre)
    own = turn.apply(inertia @ spin)
    energy = mass * velocity @ velocity / 2 + spin @ inertia @ spin / 2
    return np.array([mass, energy, *(mass * velocity), *(own + np.cross(place, mass * velocity))])

"""Links in the forms in which engines take them: as URDF files, and as states of other frames of the same body."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from bodycheck.adapters.links import Link, angles, carried, state_in, urdf, velocity_of, velocity_to_origin
from bodycheck.reference.kinematics import conjugate, geodesic_angle, rotate
from bodycheck.reference.scene import Quaternion, State

LINK = Link(1 / 3, (0.3, 0.4, 0.5, 0.02, -0.03, 1e-17), (0.1, -0.2, 0.3), (1.0, 2.0, 3.0), (0.5, -0.1, 0.7, -0.5))
STATE = State((1.0, 2.0, -3.0), (0.1, 0.7, -0.5, 0.5), (4.0, -5.0, 6.0), (0.7, -0.8, 0.9))
ROW = np.array([[*STATE.position, *STATE.quaternion, *STATE.velocity, *STATE.angular_velocity]])


def test_a_urdf_file_has_every_digit_of_a_link() -> None:
    robot = ElementTree.fromstring(urdf((LINK, replace(LINK, mass=2.0))))
    assert [link.get("name") for link in robot.findall("link")] == ["link_0", "link_1"]
    inertial = robot.findall("link")[0].find("inertial")
    assert inertial is not None
    mass, origin, inertia = (inertial.find(name) for name in ("mass", "origin", "inertia"))
    assert mass is not None
    assert origin is not None
    assert inertia is not None
    assert float(mass.attrib["value"]) == LINK.mass
    assert tuple(map(float, origin.attrib["xyz"].split())) == LINK.center_of_mass
    assert tuple(float(inertia.attrib[name]) for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")) == LINK.inertia
    place = robot.find("joint/origin")
    assert place is not None
    assert tuple(map(float, place.attrib["xyz"].split())) == LINK.position
    turned = Rotation.from_euler("xyz", list(map(float, place.attrib["rpy"].split())))
    assert geodesic_angle(turned.as_quat(scalar_first=True), np.array(LINK.quaternion)) < 1e-15


@pytest.mark.parametrize("quaternion", [LINK.quaternion, (0.5, 0.5, 0.5, 0.5), (0.5, 0.5, -0.5, 0.5), (1.0, 0.0, 0.0, 0.0)])
def test_the_angles_of_urdf_are_about_fixed_axes_even_in_gimbal_lock(quaternion: Quaternion) -> None:
    turned = Rotation.from_euler("xyz", angles(quaternion))
    assert geodesic_angle(turned.as_quat(scalar_first=True), np.array(quaternion)) < 1e-15


def test_a_frame_is_carried_with_its_body() -> None:
    """As over a short time: the place moves with its velocity, and the attitude turns by the angular velocity."""
    place, turn = np.array(LINK.position), np.array(LINK.quaternion)
    there = carried(ROW, place, turn)[0]
    attitude = np.array(STATE.quaternion)
    np.testing.assert_allclose(there[:3], STATE.position + rotate(attitude, place), rtol=0, atol=1e-14)
    # The time is far shorter than that of a turn; the second order of the motion is 1e-12.
    h = 1e-6
    world = rotate(attitude, np.array(STATE.angular_velocity))
    turned = (Rotation.from_rotvec(h * world) * Rotation.from_quat(attitude, scalar_first=True)).as_quat(scalar_first=True)
    later = np.array(STATE.position) + h * np.array(STATE.velocity) + rotate(turned, place)
    np.testing.assert_allclose((later - there[:3]) / h, there[7:10], rtol=0, atol=1e-5)
    np.testing.assert_allclose(rotate(there[3:7], there[10:]), world, rtol=0, atol=1e-14)
    back = carried(there[None], -rotate(conjugate(turn), place), conjugate(turn))
    np.testing.assert_allclose(back, ROW, rtol=0, atol=1e-14)


def test_the_velocity_of_a_centre_of_mass_and_that_of_the_origin_belong_together() -> None:
    centre = LINK.center_of_mass
    rows = ROW.copy()
    rows[0, 7:10] = velocity_of(centre, STATE)
    assert state_in((centre, (1.0, 0.0, 0.0, 0.0)), STATE).velocity == velocity_of(centre, STATE) != STATE.velocity
    np.testing.assert_allclose(velocity_to_origin(rows, centre), ROW, rtol=0, atol=1e-14)

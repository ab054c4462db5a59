"""The probes of contact on a miniature engine with planted contacts, each of which must be measured."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
import pytest

from bodycheck.adapters.contract import Adapter, Engine, Integrator, Method
from bodycheck.reference.mechanisms.mechanism import AnyScene
from bodycheck.reference.scene import Brick, Scene
from bodycheck.reference.trajectory import Array
from bodycheck.studies.audit.flights import Pilot
from bodycheck.studies.contact.probes import BY_NAME, GRAVITY, RADIUS
from bodycheck.studies.contact.property import Property
from bodycheck.studies.contact.rows import PropertyRow
from bodycheck.studies.contact.wording import law

STEP = 2e-3


ENGINE = Engine(
    name="planted",
    distribution="planted",
    version="1",
    integrators=(Integrator("step"),),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "incline", "restitution", "rolling"}),
)


@dataclass(frozen=True)
class Contacts:
    """The contacts of a miniature engine: rigid ones that obey the laws of the scene, except for what is planted.

    keeps: the part of the restitution that impacts have. bounces_above: the speed (m/s) below which they have none. stiffness:
    that of the plane under a ball at rest (N/m), 0 for a rigid plane. asleep: the speed (m/s) below which a ball that rolls is
    put to rest after half a second. creep: the speed (m/s) of a box that should rest on a ramp. viscous: the speed (m/s) below
    which friction grows with the speed.
    """

    keeps: float = 1.0
    bounces_above: float = 0.0
    stiffness: float = 0.0
    asleep: float = 0.0
    creep: float = 0.0
    viscous: float = 0.0

    @property
    def engine(self) -> Engine:
        return ENGINE

    def prepare(self, scenes: Sequence[AnyScene], method: Method) -> "Stepped":
        (scene,) = scenes
        assert isinstance(scene, Scene)
        return Stepped(self, scene, method.timestep)


class Stepped:
    """A simulation of a ball or a box on a plane."""

    def __init__(self, own: Contacts, scene: Scene, timestep: float) -> None:
        start, shift = scene.initial, own.creep
        self.own, self.scene, self.timestep, self.time = own, scene, timestep, 0.0
        self.position, self.velocity = np.array(start.position), np.array(start.velocity)
        self.down = np.array([shift, 0.0, 0.0])
        self.attitude = np.array(start.quaternion)

    def advance(self, strides: Sequence[int]) -> Array:
        rows = []
        for stride in strides:
            for _ in range(int(stride)):
                self.step()
            rows.append([*self.position, *self.attitude, *self.velocity, 0.0, 0.0, 0.0])
        return np.array(rows)[None, :, None]

    def step(self) -> None:
        assert self.scene.plane is not None
        self.time += self.timestep
        if isinstance(self.scene.body.shape, Brick):
            self.slide()
        else:
            self.bounce()
        self.position = self.position + self.timestep * self.velocity

    def slide(self) -> None:
        """Brake a box by friction, whose force grows with the speed up to a planted one; on a ramp it creeps."""
        assert self.scene.plane is not None
        if self.scene.plane.incline:
            self.velocity = self.down
            return
        speed = float(self.velocity[0])
        part = min(1.0, speed / self.own.viscous) if self.own.viscous else 1.0
        self.velocity[0] = max(0.0, speed - part * self.scene.plane.friction * GRAVITY * self.timestep)

    def bounce(self) -> None:
        """Let a ball fall, bounce, rest and roll."""
        plane, own = self.scene.plane, self.own
        assert plane is not None
        fall = float(self.velocity[2]) - self.scene.gravity * self.timestep
        depth = self.scene.body.mass * self.scene.gravity / own.stiffness if own.stiffness else 0.0
        if self.position[2] + self.timestep * fall < RADIUS - depth:
            rebounds = -fall > max(own.bounces_above, 2 * self.scene.gravity * self.timestep)
            fall = -own.keeps * plane.restitution * fall if rebounds else (RADIUS - depth - self.position[2]) / self.timestep
        self.velocity[2] = fall
        if abs(self.velocity[0]) < own.asleep and self.time > 0.5:
            self.velocity[0] = 0.0


def measured(own: Contacts, probe: str) -> dict[str, float | None]:
    """The values of a probe, by property and condition."""
    return {f"{one.name} {one.condition}".strip(): one.value for one in properties(own, probe)}


def properties(own: Contacts, probe: str) -> tuple[Property, ...]:
    return BY_NAME[probe](Pilot(cast(Adapter, own), "step", STEP))


def test_rigid_contacts_have_the_values_of_mechanics() -> None:
    for probe in ("restitution", "bounce-threshold", "depth", "sleeping", "creep", "viscous"):
        for one in properties(Contacts(), probe):
            assert one.value == pytest.approx(one.expected, abs=1e-12), one


def test_a_planted_restitution_is_measured_at_every_speed_and_step() -> None:
    values = measured(Contacts(keeps=0.9), "restitution")
    assert len(values) == 8
    assert list(values.values()) == pytest.approx([0.45] * 8, rel=1e-12)


def test_a_planted_bounce_threshold_is_found() -> None:
    """The search ends when its bounds are within 0.2 % of each other, and an impact is resolved to the fall of a step."""
    (value,) = measured(Contacts(bounces_above=0.7), "bounce-threshold").values()
    assert value == pytest.approx(0.7, abs=2e-3 * 0.7 + GRAVITY * STEP)
    assert measured(Contacts(keeps=0.4), "bounce-threshold") == {"bounce-threshold": None}


def test_a_planted_spring_is_found() -> None:
    values = measured(Contacts(stiffness=1e6), "depth")
    assert values["depth-at-rest 1 kg"] == pytest.approx(GRAVITY / 1e6, rel=1e-6)
    assert values["depth-at-rest 100 kg"] == pytest.approx(100 * GRAVITY / 1e6, rel=1e-6)


def test_planted_sleep_creep_and_viscous_friction_are_found() -> None:
    assert measured(Contacts(asleep=0.05), "sleeping")["sleeping"] == pytest.approx(0.05, rel=2e-3)
    assert measured(Contacts(creep=0.003), "creep")["creep"] == pytest.approx(0.003, rel=1e-9)
    value = measured(Contacts(viscous=0.2), "viscous")["viscous-speed"]
    assert value is not None
    # Nine tenths of the planted speed, to what the box loses in two steps.
    assert value == pytest.approx(0.18, abs=2 * 0.5 * GRAVITY * STEP)


def test_the_words_name_the_planted_law() -> None:
    own = Contacts(keeps=0.9, bounces_above=0.7, stiffness=1e6, asleep=0.05, creep=0.003, viscous=0.2)
    names = ("restitution", "bounce-threshold", "depth", "sleeping", "creep", "viscous")
    rows = [
        PropertyRow(
            "planted", "1", "defaults", "step", STEP, one.name, one.condition, one.value, one.unit, one.expected, one.note
        )
        for name in names
        for one in properties(own, name)
    ]
    assert law(rows) == (
        "a ball of 1 kg lies 9.81e-6 m deep, and one of 100 kg 100 times as deep: the plane is a spring; a restitution of 0.5 "
        "is 0 to 0.45, and nothing bounces below 0.69 m/s; friction is viscous below 0.18 m/s and lets a box that it should "
        "hold creep at 0.003 m/s; a ball that rolls below 0.05 m/s falls asleep."
    )

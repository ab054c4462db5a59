"""`bodycheck truth --certify` with a fault that all ways to the truth share: the proof finds it, and says by how much.

The cross-check is left out, since it would agree: what is tested is that the proof alone contradicts the printed states.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from bodycheck.reference import certificate
from bodycheck.reference.certified import Certificate
from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.mechanisms.articulation import articulated
from bodycheck.reference.mechanisms.mechanism import AnyScene, Joint, Mechanism
from bodycheck.reference.scene import Definition, Scene, Tensor
from bodycheck.reference.truth import truth
from tests.support.cases import a_case
from tests.support.commands import bodycheck

pytest.importorskip("flint")
pytest.importorskip("heyoka")

#: A scene with a fault in it.
Faulty = Callable[[Any], AnyScene]

#: What contradicts a truth, with the printed bound and the proved distance.
FIGURE = re.compile(
    r"contradicted: the printed bound of the error.*, ([\d.e+-]+) \S+ at t = .*proved distance, ([\d.e+-]+) \S+\n"
)

#: A body whose axes are not those of its frame.
TURNED = {"shape": "none", "mass": 1.0, "inertia": [[0.3, 0.05, -0.02], [0.05, 0.45, 0.04], [-0.02, 0.04, 0.4]]}
TUMBLING = {"euler_zxz": [0.3, 0.8, -0.4], "velocity": [1.0, 2.0, 3.0], "angular_velocity": [1.0, 2.0, -3.0]}


def tensor(change: Callable[[list[list[float]]], None]) -> Faulty:
    """A fault of the inertia tensor of a free body."""

    def faulty(scene: Scene) -> Scene:
        assert scene.definition is not None
        assert isinstance(scene.definition.inertia, Tensor)
        rows = [list(row) for row in scene.definition.inertia.rows]
        change(rows)
        (a, b, c), (d, e, f), (g, h, i) = rows
        definition: Definition = replace(
            scene.definition, inertia=replace(scene.definition.inertia, rows=((a, b, c), (d, e, f), (g, h, i)))
        )
        new = defined_scene(definition, None)
        initial = replace(scene.initial, quaternion=new.initial.quaternion, angular_velocity=new.initial.angular_velocity)
        return replace(scene, body=new.body, initial=initial, definition=new.definition)

    return faulty


def larger(rows: list[list[float]]) -> None:
    rows[1][1] *= 1 + 1e-9


def opposite_products(rows: list[list[float]]) -> None:
    rows[0][1], rows[1][0] = -rows[0][1], -rows[1][0]


def exchanged(rows: list[list[float]]) -> None:
    rows[0][0], rows[1][1] = rows[1][1], rows[0][0]


def joint(change: Callable[[Joint], Joint]) -> Faulty:
    """A fault of every joint of a mechanism."""
    return lambda scene: replace(scene, joints=tuple(map(change, scene.joints)))


def stops(joint: Joint) -> Joint:
    assert joint.stops is not None
    assert joint.stops.restitution is not None
    return replace(joint, stops=replace(joint.stops, restitution=joint.stops.restitution * (1 + 1e-6)))


def gravity(factor: float) -> Faulty:
    return lambda scene: replace(scene, gravity=factor * scene.gravity)


def on_the_plane(scene: Scene) -> Scene:
    assert scene.plane is not None
    return replace(scene, plane=replace(scene.plane, restitution=scene.plane.restitution * (1 + 1e-6)))


def between_spheres(scene: Mechanism) -> Mechanism:
    (law,) = scene.contacts
    return replace(scene, contacts=(replace(law, restitution=law.restitution * (1 + 1e-6)),))


def later(scene: Mechanism) -> Mechanism:
    (controller,) = scene.controllers
    return replace(scene, controllers=(replace(controller, delay=controller.delay + 1),))


@dataclass(frozen=True)
class Fault:
    """A fault of the scene of a shipped case, or of the turned body if none is named, and instants at which it shows (s)."""

    faulty: Faulty
    case: str = ""
    at: tuple[float, ...] = (0.0, 0.5, 3.0)


FAULTS = {
    "damping doubled": Fault(joint(lambda one: replace(one, damping=2 * one.damping)), "hinge-all", (0.2,)),
    "damping doubled, in a tree": Fault(joint(lambda one: replace(one, damping=2 * one.damping)), "sensor-pendulum", (0.05,)),
    "armature ignored": Fault(joint(lambda one: replace(one, armature=0.0)), "hinge-armature", (0.2,)),
    "a moment times 1 + 1e-9, turned frame": Fault(tensor(larger)),
    "axes exchanged": Fault(tensor(exchanged)),
    "sign of a product of inertia": Fault(tensor(opposite_products)),
    "gravity upwards": Fault(gravity(-1)),
    "gravity times 1 + 1e-9": Fault(gravity(1 + 1e-9)),
    "restitution times 1 + 1e-6": Fault(on_the_plane, "thrown-ball-with-spin", (0.5, 1.0)),
    "restitution times 1 + 1e-6, of spheres": Fault(between_spheres, "spheres-oblique-sliding", (1.0,)),
    "restitution times 1 + 1e-6, of a stop": Fault(joint(stops), "driven-stop-rebounds", (0.2, 0.4, 0.6, 0.8)),
    "delay off by one": Fault(later, "driven-hinge-delayed", (0.3,)),
}


def with_the_truth_of(faulty: Faulty, patch: pytest.MonkeyPatch) -> None:
    """Let the truth of a scene be that of a faulty one, without a cross-check."""

    def alone(scene: AnyScene, times: Any) -> Certificate:
        found = truth(faulty(scene), times, vouched=False)
        return Certificate(found, {}, np.asarray(found.bounds.error), 0, others=False, faults=(), growth=None)

    patch.setattr(certificate, "certify", alone)


def contradictions(case: str, *at: float) -> list[tuple[float, float]]:
    """The printed bounds and proved distances in what the command says of a case, whose exit code is 1."""
    done = bodycheck("truth", case, "--certify", *(["--at", *at]))
    found = [(float(bound), float(proved)) for bound, proved in FIGURE.findall(done.stdout)]
    assert (done.returncode, bool(found)) in ((0, False), (1, True)), done.stdout
    assert "enclosed: yes" in done.stdout
    return found


@pytest.fixture
def turned(tmp_path: Any) -> str:
    """The file of the turned body in free fall."""
    path = tmp_path / "turned.case.toml"
    path.write_text(a_case("turned", body=TURNED, initial=TUMBLING, scene={"gravity": 9.81}), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_every_way_is_found_by_the_proof(
    fault: str, turned: str, calls_here: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    planted = FAULTS[fault]
    with_the_truth_of(planted.faulty, monkeypatch)
    found = contradictions(planted.case or turned, *planted.at)
    assert any(proved > bound for bound, proved in found)


@pytest.mark.parametrize("case", ["", "hinge-all", "thrown-ball-with-spin"])
def test_a_truth_without_a_fault_is_not_contradicted(
    case: str, turned: str, calls_here: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_the_truth_of(lambda scene: scene, monkeypatch)
    assert contradictions(case or turned, 0.5) == []


def test_a_gyroscopic_torque_of_the_wrong_sign_is_found_by_the_proof(calls_here: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The candidate of the proof, which comes from the same code, is computed after the fault is gone."""
    right = articulated._inertial_force

    def faulty(constants: Any, motion: Any) -> Any:
        still = [0 * part for part in motion.linear]
        torque = right(constants, replace(motion, linear=still, angular=still))[:3]
        force = right(constants, motion)
        return [*(one - 2 * part for one, part in zip(force, torque, strict=False)), *force[3:]]

    def alone(scene: AnyScene, times: Any) -> Certificate:
        with monkeypatch.context() as patch:
            patch.setattr(articulated, "_inertial_force", faulty)
            found = truth(scene, times, vouched=False)
        return Certificate(found, {}, np.asarray(found.bounds.error), 0, others=False, faults=(), growth=None)

    monkeypatch.setattr(certificate, "certify", alone)
    assert any(proved > bound for bound, proved in contradictions("universal-pendulum", 0.05))

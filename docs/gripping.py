"""Print the table of docs/contacts.md on bodies between fingers in MuJoCo. Run: python docs/gripping.py"""

from dataclasses import replace
from pathlib import Path

import numpy as np

import bodycheck
from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.reference.mechanisms.mechanism import JointedBody, Mechanism
from bodycheck.reference.scene import Solid

CASE = Path(__file__).parent.parent / "cases/contact/gripped-block-holds.case.toml"

METHODS = (
    "Euler",
    "Euler:noslip=10",
    "Euler:impratio=10",
    "Euler:impratio=100",
    "Euler:cone=elliptic",
    "Euler:cone=elliptic,noslip=10",
    "Euler:cone=elliptic,impratio=10",
    "Euler:cone=elliptic,impratio=100",
)

#: Masses (kg), forces of a finger (N) and time steps (s).
COLUMNS = ((1.0, 12.0, 0.002), (1.0, 24.0, 0.002), (2.0, 24.0, 0.002), (1.0, 12.0, 0.0005))

#: The span in which the creep is measured (s), after the fingers have sunk into the contacts.
BEGIN, END = 0.1, 0.3


def gripped(mass: float, press: float) -> Mechanism:
    """Return the block of a mass (kg) between fingers that press with a force (N) each."""
    scene = bodycheck.load(CASE).scene
    assert isinstance(scene, Mechanism)
    block, *fingers = scene.bodies
    assert isinstance(block.inertia, Solid)
    heavier: JointedBody = replace(block, inertia=replace(block.inertia, mass=mass))
    joints = tuple(replace(joint, effort=press) for joint in scene.joints)
    return replace(scene, bodies=(heavier, *fingers), joints=joints, controllers=())


def creep(mass: float, press: float, timestep: float, spelling: str) -> float:
    """Return the mean speed (m/s) at which the block slips down."""
    method = Method.parse(spelling, timestep)
    steps = np.array([round(BEGIN / timestep), round((END - BEGIN) / timestep)])
    heights = registry.load("mujoco").prepare([gripped(mass, press)], method).advance(steps)[0][:, 0, 2]
    return float((heights[0] - heights[1]) / (END - BEGIN))


def main() -> None:
    """Print the table."""
    heads = [f"{mass:g} kg, {press:g} N, {1000 * timestep:g} ms" for mass, press, timestep in COLUMNS]
    print("| " + " | ".join(["method", *heads]) + " |")
    print("| --- |" + " --- |" * len(heads))
    for spelling in METHODS:
        print("| " + " | ".join([spelling, *(f"{creep(*column, spelling):.2g}" for column in COLUMNS)]) + " |", flush=True)


if __name__ == "__main__":
    main()

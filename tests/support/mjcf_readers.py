"""MJCF files as a case reads them, against MuJoCo, which is the second reader of the same files."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from bodycheck.casefile.mechanisms.building import build_mechanism
from bodycheck.casefile.mechanisms.grammar import WORLD, MechanismTable
from bodycheck.casefile.robots.mjcf import tree as mjcf_tree
from bodycheck.casefile.robots.reading import Choice, Read
from bodycheck.reference.mechanisms.mechanism import Mechanism
from bodycheck.reference.robots.dynamics import terms_at
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots import elements
from bodycheck.robots.from_mechanism import robot_model
from bodycheck.robots.named_files import Folders, NotFound

#: What is left out where the free motion of the tree is compared.
TREE_ALONE = frozenset({"equalities"})


@dataclass(frozen=True)
class FilesOfFolder:
    """The files of a folder and the folders in it. main: the folder of the model, whose path is relative to the first one."""

    home: Path
    main: Path

    def text(self, name: str, near: str) -> tuple[str, str]:
        path = Folders(self.home).find(name, (self.main, (self.home / near).parent))
        return path.relative_to(self.home).as_posix(), path.read_text(encoding="utf-8")

    def content(self, name: str) -> bytes:
        return Folders(self.home).find(name, (self.main,)).read_bytes()


class NoFiles:
    """No files."""

    def text(self, name: str, near: str) -> tuple[str, str]:
        raise NotFound("is not there")

    def content(self, name: str) -> bytes:
        raise NotFound("is not there")


def read_text(text: str, **choice: Any) -> Read:
    """Return the result of reading a text that names no other file. choice: fields of `Choice`."""
    return mjcf_tree.tree(elements.parsed(text.encode(), "robot.xml"), WORLD, Choice(**{"files": NoFiles(), **choice}))


def read_file(path: Path, home: Path | None = None, **choice: Any) -> Read:
    """Return the result of reading a file, which may name files of its folder, or of the folder `home` around it."""
    root = elements.parsed(path.read_bytes(), path.name)
    root.file = path.relative_to(home or path.parent).as_posix()
    files = FilesOfFolder((home or path.parent).resolve(), path.parent.resolve())
    return mjcf_tree.tree(root, WORLD, Choice(**{"files": files, **choice}))


def mechanism(read: Read) -> Mechanism:
    """Return the mechanism of a case that has what was read; bodies and joints have numbers as names."""
    bodies = {WORLD: WORLD} | {body["name"]: f"b{index}" for index, body in enumerate(read.tables["bodies"])}
    joints = {joint["name"]: f"j{index}" for index, joint in enumerate(read.tables["joints"])}
    tables = []
    for joint in read.tables["joints"]:
        ends = {end: bodies[joint[end]] for end in ("parent", "child")}
        rule = {"mimic": joint["mimic"] | {"joint": joints[joint["mimic"]["joint"]]}} if "mimic" in joint else {}
        tables.append(joint | ends | rule | {"name": joints[joint["name"]]})
    loops = [loop | {"bodies": [bodies[name] for name in loop["bodies"]]} for loop in read.tables.get("loops", [])]
    document = {
        "format": 2,
        "name": "robot",
        "title": "A robot",
        "run": {"duration": 1.0, "samples": 3},
        "bodies": [body | {"name": bodies[body["name"]]} for body in read.tables["bodies"]],
        "joints": tables,
        "loops": loops,
    }
    return build_mechanism(MechanismTable.model_validate(document))


def disagreement(read: Read, compiled: mujoco.MjModel) -> dict[str, float]:
    """Return the largest differences of terms of a case from those of MuJoCo, relative to the largest entry of the term.

    read: of the file without its equalities. compiled: the same file as MuJoCo compiles it.
    """
    model = robot_model(mechanism(read), "robot")
    frictionless = replace(model, joints=tuple(replace(joint, friction=0.0) for joint in model.joints))
    states = seeded_states(frictionless, 3, 1)
    assert read.gravity is not None
    truth = terms_at(frictionless, states, read.gravity)
    differences = dict.fromkeys(("mass_matrix", "gravity", "bias", "passive"), 0.0)
    for state, terms in zip(states, truth, strict=True):
        for name, (one, other) in _terms(compiled, state, terms).items():
            # Forces that are zero but for rounding are compared with those of an acceleration of 1.
            least = 0.0 if name == "passive" else np.abs(terms.mass_matrix).max(initial=0.0)
            scale = max(np.abs(one).max(initial=0.0), np.abs(other).max(initial=0.0), float(least))
            if scale:
                differences[name] = max(differences[name], float(np.abs(one - other).max() / scale))
    return differences


def _terms(compiled: mujoco.MjModel, state: RobotState, terms: Any) -> dict[str, tuple[Any, Any]]:
    data = mujoco.MjData(compiled)
    data.qpos[:] = [part for values in state.positions.values() for part in values]
    data.qvel[:] = [part for values in state.velocities.values() for part in values]
    mujoco.mj_kinematics(compiled, data)
    mujoco.mj_comPos(compiled, data)
    mujoco.mj_tendon(compiled, data)
    mujoco.mj_crb(compiled, data)
    full, bias = np.zeros((compiled.nv, compiled.nv)), np.zeros(compiled.nv)
    for row, unit in zip(full, np.eye(compiled.nv), strict=True):
        mujoco.mj_mulM(compiled, data, row, unit)
    mujoco.mj_fwdVelocity(compiled, data)
    passive = data.qfrc_spring + data.qfrc_damper
    mujoco.mj_rne(compiled, data, 0, bias)
    data.qvel[:] = 0
    mujoco.mj_fwdVelocity(compiled, data)
    weight = np.zeros(compiled.nv)
    mujoco.mj_rne(compiled, data, 0, weight)
    return {
        "mass_matrix": (np.array(terms.mass_matrix, float), full),
        "gravity": (np.array(terms.gravity_force, float), weight),
        "bias": (np.array(terms.coriolis_force + terms.gravity_force, float), bias),
        "passive": (np.array(terms.passive_force, float), passive),
    }

"""Run a whole scene in MuJoCo as its compiler makes it from a file: with contacts, tendons, actuators and limits.

The state of each sample is evaluated in a second `MjData`, so that nothing but `mj_step` acts on the first.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import lru_cache
from itertools import combinations, product

import mujoco
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, EngineReset, Method
from bodycheck.adapters.file_motion import (
    Controls,
    FileFacts,
    FileMotion,
    FileRun,
    MotionRefused,
    Names,
    Sticks,
    nudged,
    strides,
)
from bodycheck.adapters.mujoco import options
from bodycheck.adapters.mujoco.robots import loaded
from bodycheck.adapters.mujoco.stepping import WARNINGS, quiet, refuse_warnings
from bodycheck.adapters.robot_numbers import vector
from bodycheck.adapters.robot_reading import RobotFile
from bodycheck.reference.trajectory import Array

#: The options of methods, which have the names of the fields of MuJoCo's options that they set, and the types of their values.
SETTINGS: dict[str, type[int] | type[float]] = {"iterations": int, "tolerance": float}

#: The largest number of steps in one call of MuJoCo, between which it is checked for warnings.
STEPS_PER_CALL = 4096

#: The part of a time step by which an instant of controls may be late because of rounding.
ROUNDED = 1e-6

#: The part of an actuator's range from its end within which the actuator counts as saturated.
SATURATED = 1e-9


def file_facts(file: RobotFile) -> FileFacts:
    """Return the contents of a file on which a run depends, as `FileMotions.file_facts` does."""
    return facts_of(compiled(file.path), options.available())


def facts_of(model: mujoco.MjModel, methods: Sequence[str]) -> FileFacts:
    """Return the facts of a compiled model, for an engine with these of MuJoCo's integrators."""
    names = options.available()
    stated = names[model.opt.integrator]
    others = [name for name in methods if name != stated]
    return FileFacts(
        method=Method(stated, float(model.opt.timestep)),
        methods=(stated, *others),
        actuators=tuple(model.actuator(index).name or f"actuator{index}" for index in range(model.nu)),
        keyframes=tuple(model.key(index).name or f"keyframe{index}" for index in range(model.nkey)),
        conserves=_conserves(model),
        driven=bool(model.nu) and not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ACTUATION),
        friction=bool(np.any(model.dof_frictionloss) or np.any(model.tendon_frictionloss)),
        options=SETTINGS,
        settings={name: float(getattr(model.opt, name)) for name in SETTINGS},
    )


def run_file(file: RobotFile, run: FileRun) -> FileMotion:
    """Return the motion of a scene, as `FileMotions.run_file` does."""
    with chosen(compiled(file.path), run.method) as model, quiet():
        data = started(model, run)

        def step(count: int) -> None:
            at = data.time
            mujoco.mj_step(model, data, count)
            refuse_warnings(data, max(at, data.time))

        return recorded(model, data, run, step)


@contextmanager
def chosen(model: mujoco.MjModel, method: Method) -> Iterator[mujoco.MjModel]:
    """Provide a model with the options of a method, which it loses at the end. Raises `MotionRefused`."""
    before = (model.opt.integrator, model.opt.timestep, *(getattr(model.opt, name) for name in SETTINGS))
    try:
        _set(model, method)
        yield model
    finally:
        model.opt.integrator, model.opt.timestep = before[:2]
        for name, value in zip(SETTINGS, before[2:], strict=True):
            setattr(model.opt, name, value)


@lru_cache(maxsize=1)
def compiled(path: str) -> mujoco.MjModel:
    """Return the compiled model of a file. Raises `ModelRefused`."""
    return loaded(path)


def _set(model: mujoco.MjModel, method: Method) -> None:
    """Set the options of a model. Raises `MotionRefused` for an option or an integrator that there is not."""
    names = options.available()
    if method.integrator not in names:
        raise MotionRefused(f"MuJoCo has no integrator {method.integrator!r}; there are: {', '.join(names)}")
    model.opt.integrator, model.opt.timestep = names.index(method.integrator), method.timestep
    for key, value in method.options:
        if key not in SETTINGS:
            raise MotionRefused(f"{method.name}: there is no option {key!r} for files; allowed: {', '.join(SETTINGS)}")
        try:
            setattr(model.opt, key, SETTINGS[key](value))
        except ValueError as error:
            raise MotionRefused(f"{method.name}: read {value!r} as {key}; allowed: a number") from error


def _conserves(model: mujoco.MjModel) -> bool:
    """Return whether nothing in a scene can take energy away or add any."""
    touches = bool(np.any(model.geom_contype | model.geom_conaffinity) or model.npair) and not (
        model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    )
    loses = [
        *(model.dof_damping, model.dof_frictionloss, model.tendon_damping, model.tendon_frictionloss),
        *(model.jnt_limited, model.tendon_limited, model.body_gravcomp),
    ]
    constant = model.nu + model.neq + model.nflex + model.nmocap == 0
    fluid = model.opt.density or model.opt.viscosity
    return constant and not touches and not fluid and not any(np.any(values) for values in loses)


def started(model: mujoco.MjModel, run: FileRun) -> mujoco.MjData:
    """Return the data of the start of a run. Raises `MotionRefused` for a keyframe that there is not."""
    data = mujoco.MjData(model)
    names = [model.key(index).name or f"keyframe{index}" for index in range(model.nkey)]
    if run.keyframe and run.keyframe not in names:
        raise MotionRefused(f"there is no keyframe {run.keyframe!r}; there are: {', '.join(names) or 'none'}")
    if names:
        mujoco.mj_resetDataKeyframe(model, data, names.index(run.keyframe) if run.keyframe else 0)
        data.time = 0.0
    if run.nudged:
        data.qpos[:], data.qvel[:] = nudged(data.qpos), nudged(data.qvel)
    return data


def _columns(model: mujoco.MjModel, controls: Controls) -> list[int]:
    """Return the index of the actuator of each column. Raises `MotionRefused` for an actuator that there is not."""
    names = [model.actuator(index).name or f"actuator{index}" for index in range(model.nu)]
    if unknown := [name for name in controls.names if name not in names]:
        raise MotionRefused(f"there is no actuator {unknown[0]!r}; there are: {', '.join(names) or 'none'}")
    return [names.index(name) for name in controls.names]


def recorded(model: mujoco.MjModel, data: mujoco.MjData, run: FileRun, step: Callable[[int], None]) -> FileMotion:
    """Return the motion of a scene from the state of its data.

    step: a function that makes a number of steps with the controls of the data, and puts the state after them into the data. It
    raises `EngineDiverged` and `EngineReset`.
    """
    seen, timestep = mujoco.MjData(model), run.method.timestep
    columns = [] if run.controls is None else _columns(model, run.controls)
    changes = [] if run.controls is None else [(round(at / timestep + 0.5 - ROUNDED), row) for at, row in _rows(run.controls)]
    recorder, done, wall_time, ended, reset = _Recorder(model, seen), 0, 0.0, "", False
    for stride in strides(run.times, timestep):
        goal = done + stride
        try:
            while done < goal or (changes and changes[0][0] <= done):
                while changes and changes[0][0] <= done:
                    data.ctrl[columns] = changes.pop(0)[1]
                count = min(goal, changes[0][0] if changes else goal, done + STEPS_PER_CALL) - done
                start = time.perf_counter()
                if count:
                    step(count)
                wall_time += time.perf_counter() - start
                done += count
        except EngineReset as error:
            ended, reset = str(error), True
        except EngineDiverged as error:
            ended = str(error)
        if not ended and not (np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all()):
            ended = f"its state is not finite at t = {data.time:.6g} s"
        if ended:
            break
        recorder.record(data)
    warned = {name: int(data.warning[kind].number) for name, kind in WARNINGS.items() if data.warning[kind].number}
    return recorder.motion(run.times, done, wall_time, ended, reset, warned)


def _rows(controls: Controls) -> Iterator[tuple[float, Array]]:
    yield from zip(controls.times.tolist(), controls.values, strict=True)


class _Recorder:
    """Evaluates states in a data of its own, and keeps what is compared."""

    def __init__(self, model: mujoco.MjModel, seen: mujoco.MjData) -> None:
        self.model, self.seen = model, seen
        self.state = np.empty(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_INTEGRATION))
        moving = [body for body in range(1, model.nbody) if model.body_weldid[body]]
        self.bodies = np.array(moving, int)
        self.positions: list[Array] = []
        self.quaternions: list[Array] = []
        self.joints: list[Array] = []
        self.energies: list[Array] = []
        self.regimes: list[frozenset[str]] = []
        self.iterations = 0
        self.conserves = _conserves(model)

    def record(self, data: mujoco.MjData) -> None:
        model, seen = self.model, self.seen
        mujoco.mj_getState(model, data, self.state, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_setState(model, seen, self.state, mujoco.mjtState.mjSTATE_INTEGRATION)
        mujoco.mj_forward(model, seen)
        self.positions.append(seen.xipos[self.bodies].copy())
        self.quaternions.append(seen.xquat[self.bodies].copy())
        self.joints.append(seen.qpos.copy())
        if self.conserves:
            mujoco.mj_energyPos(model, seen)
            mujoco.mj_energyVel(model, seen)
            self.energies.append(seen.energy.copy())
        self.regimes.append(frozenset(_acting(model, seen)))
        self.iterations = max(self.iterations, int(np.max(data.solver_niter, initial=0)))

    def motion(self, times: Array, steps: int, wall_time: float, ended: str, reset: bool, warned: dict[str, int]) -> FileMotion:
        model, count = self.model, len(self.joints)
        qpos = np.array(self.joints).reshape(count, model.nq)
        kinds = {int(kind): np.flatnonzero(model.jnt_type == kind) for kind in range(4)}
        free, ball, slide, hinge = (model.jnt_qposadr[kinds[int(kind)]] for kind in _KINDS)
        flat = np.zeros((len(slide), count, 3))
        flat[..., 0] = qpos[:, slide].T
        return FileMotion(
            t=times[:count],
            position=np.array(self.positions).reshape(count, len(self.bodies), 3).swapaxes(0, 1),
            quaternion=np.array(self.quaternions).reshape(count, len(self.bodies), 4).swapaxes(0, 1),
            angles=qpos[:, hinge].T,
            turns=_parts(qpos, [*(free + 3), *ball], 4),
            slides=np.concatenate([_parts(qpos, list(free), 3), flat]),
            energy=np.array(self.energies).reshape(count, 2).T if self.conserves else None,
            regimes=tuple(self.regimes),
            steps=steps,
            wall_time=wall_time,
            ended=ended,
            reset=reset,
            warnings=warned | {"iterations": self.iterations},
            names=Names(
                tuple(_body(model, body) for body in self.bodies.tolist()),
                _joints(model, kinds[int(mujoco.mjtJoint.mjJNT_HINGE)]),
                _joints(model, [*kinds[int(mujoco.mjtJoint.mjJNT_FREE)], *kinds[int(mujoco.mjtJoint.mjJNT_BALL)]]),
                _joints(model, [*kinds[int(mujoco.mjtJoint.mjJNT_FREE)], *kinds[int(mujoco.mjtJoint.mjJNT_SLIDE)]]),
            ),
            sticks=tuple(_sticks(model, body) for body in self.bodies.tolist()),
        )


_KINDS = (mujoco.mjtJoint.mjJNT_FREE, mujoco.mjtJoint.mjJNT_BALL, mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE)


def _parts(qpos: Array, firsts: list[int], count: int) -> Array:
    """Return consecutive columns of states (n, nq) as an array (k, n, count), by the indices of their first columns (k,)."""
    return np.array([qpos[:, first : first + count] for first in firsts]).reshape(len(firsts), len(qpos), count)


def _acting(model: mujoco.MjModel, data: mujoco.MjData) -> Iterator[str]:
    """Yield in words the contacts, the active limits and the saturated actuators of a state."""
    pairs = model.geom_bodyid[data.contact.geom[data.contact.exclude == 0]] if data.ncon else np.empty((0, 2), int)
    for one, other in sorted({tuple(sorted(pair)) for pair in pairs.tolist()}):
        yield f"contact of {_body(model, one)} and {_body(model, other)}"
    limits = {int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT): "joint", int(mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON): "tendon"}
    for kind, index in zip(data.efc_type.tolist(), data.efc_id.tolist(), strict=True):
        if kind in limits:
            name = (model.joint if limits[kind] == "joint" else model.tendon)(index).name
            yield f"limit of {limits[kind]} {name or index}"
    forces, ranges = data.actuator_force, model.actuator_forcerange
    for index in np.flatnonzero(model.actuator_forcelimited):
        if min(abs(forces[index] - ranges[index])) <= SATURATED * float(np.ptp(ranges[index])):
            yield f"saturation of actuator {model.actuator(int(index)).name or index}"


def _joints(model: mujoco.MjModel, joints: Iterable[int]) -> tuple[str, ...]:
    """Return the names of joints. A free joint, which other engines do not name, has the name of its body."""
    free = int(mujoco.mjtJoint.mjJNT_FREE)
    return tuple(
        _body(model, int(model.jnt_bodyid[joint])) if model.jnt_type[joint] == free else str(model.joint(int(joint)).name)
        for joint in joints
    )


def _sticks(model: mujoco.MjModel, body: int) -> Sticks:
    """Return the lines by which pictures show a body.

    They are the axes of its capsules and cylinders, the edges of its boxes, and lines from its joint to the bodies that it
    carries, or to its centre of mass.
    """
    lines = [line for geom in np.flatnonzero(model.geom_bodyid == body).tolist() for line in _of_geom(model, geom)]
    start = model.jnt_pos[model.body_jntadr[body]] if model.body_jntnum[body] else np.zeros(3)
    ends = [model.body_pos[child] for child in np.flatnonzero(model.body_parentid == body)]
    lines += [(start, end) for end in ends or ([] if lines else [model.body_ipos[body]])]
    centre = model.body_ipos[body]
    return tuple((vector(one - centre), vector(other - centre)) for one, other in lines)


def _of_geom(model: mujoco.MjModel, geom: int) -> list[tuple[Array, Array]]:
    """Return the lines (m) that show a geom, in the frame of its body."""
    size, at, axes = model.geom_size[geom], model.geom_pos[geom], np.empty(9)
    mujoco.mju_quat2Mat(axes, model.geom_quat[geom])
    turn = axes.reshape(3, 3)
    match int(model.geom_type[geom]):
        case mujoco.mjtGeom.mjGEOM_CAPSULE | mujoco.mjtGeom.mjGEOM_CYLINDER:
            half = turn[:, 2] * size[1]
            return [(at - half, at + half)]
        case mujoco.mjtGeom.mjGEOM_BOX:
            corners = [np.array(signs) for signs in product((-1, 1), repeat=3)]
            edges = [(one, other) for one, other in combinations(corners, 2) if np.abs(one - other).sum() == 2]
            return [(at + turn @ (one * size), at + turn @ (other * size)) for one, other in edges]
        case _:
            return []


def _body(model: mujoco.MjModel, body: int) -> str:
    return str(model.body(body).name) or f"body {body}" if body else "the world"

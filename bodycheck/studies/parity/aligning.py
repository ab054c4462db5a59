"""The terms of an engine in the order and conventions of the file, and the truth for the same velocities."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bodycheck.reference.robots.dynamics import terms_at, velocity_labels
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.state import RobotState
from bodycheck.reference.scene import Vector
from bodycheck.reference.trajectory import Array
from bodycheck.studies.parity import conventions
from bodycheck.studies.parity.conventions import Convention, Given, in_world, written
from bodycheck.studies.parity.matching import Match
from bodycheck.studies.parity.quantities import FORCES
from bodycheck.studies.parity.stacks import Stack, stacked, times, transposed, values


@dataclass(frozen=True, eq=False)
class Motion:
    """The states, and the n compared velocities at them with their accelerations and the efforts on them, each (s, n)."""

    states: tuple[RobotState, ...]
    velocities: Array
    accelerations: Array
    efforts: Array

    def at(self, states: Sequence[int]) -> "Motion":
        """Return the motion at some of the states, given by their indices."""
        indices = list(states)
        some = tuple(self.states[index] for index in indices)
        return Motion(some, self.velocities[indices], self.accelerations[indices], self.efforts[indices])


def truth_of(model: RobotModel, states: Sequence[RobotState], gravity: Vector) -> Stack:
    """Return the terms of a model at states, with all velocities of its joints."""
    return stacked(terms_at(model, states, gravity))


def motion(match: Match, states: Sequence[RobotState]) -> Motion:
    """Return the compared velocities at states, with accelerations and efforts. Joints that the engine lacks are left out."""
    labels = match.labels
    return Motion(
        tuple(states),
        values(states, labels, lambda state: state.velocities),
        values(states, labels, lambda state: state.accelerations),
        values(states, labels, lambda state: state.efforts),
    )


def reduced(truth: Stack, match: Match, motion_compared: Motion) -> Stack:
    """Return the terms for the compared velocities, from the terms for all velocities of the file's model.

    If joints that follow others have no separate velocities, the accelerations are recomputed from the other terms.
    """
    expand = match.expansion
    if expand.shape[0] == expand.shape[1]:
        return truth
    forces: dict[str, Any] = {name: None if (force := getattr(truth, name)) is None else force @ expand for name in FORCES}
    mass = None if truth.mass_matrix is None else expand.T @ truth.mass_matrix @ expand
    jacobians = {name: jacobian @ expand for name, jacobian in truth.jacobians.items()}
    small = replace(truth, mass_matrix=mass, jacobians=jacobians, **forces)
    return replace(small, forward_dynamics=accelerations(small, motion_compared.efforts))


def accelerations(terms: Stack, efforts: Array) -> Array | None:
    """Return the accelerations (s, n) that follow from efforts (s, n) and the other terms; None if a term is missing.

    They are NaN at states where the mass matrix cannot be inverted.
    """
    known = (terms.mass_matrix, terms.gravity_force, terms.coriolis_force, terms.passive_force)
    if any(part is None for part in known):
        return None
    mass, gravity, coriolis, passive = (np.asarray(part) for part in known)
    forces = efforts + passive - coriolis - gravity
    solved = np.full(forces.shape, np.nan)
    for index, (matrix, force) in enumerate(zip(mass, forces, strict=True)):
        root = np.sqrt(np.abs(np.diag(matrix)))
        if np.all(np.isfinite(matrix)) and np.all(root > 0):
            try:
                solved[index] = np.linalg.solve(matrix / np.outer(root, root), force / root) / root
            except np.linalg.LinAlgError:
                continue
    return solved


def selected(engine: Stack, columns: Sequence[int]) -> Stack:
    """Return an engine's terms for some of its velocities alone, in the order given."""
    places = list(columns)
    vectors: dict[str, Any] = {name: None if (term := getattr(engine, name)) is None else term[:, places] for name in FORCES}
    mass = None if engine.mass_matrix is None else engine.mass_matrix[:, places][:, :, places]
    return replace(
        engine, mass_matrix=mass, jacobians={name: term[:, :, places] for name, term in engine.jacobians.items()}, **vectors
    )


def places(match: Match) -> dict[str, list[int]]:
    """Return the indices of the velocities of each joint that has several velocities, by the name of the joint."""
    by_joint: dict[str, list[int]] = {}
    for index, (name, _) in enumerate(match.labels):
        by_joint.setdefault(name, []).append(index)
    return {name: indices for name, indices in by_joint.items() if len(indices) > 1}


def convention_of(engine: Stack, truth: Stack, match: Match, probes: Motion) -> Convention:
    """Return the conventions of an engine, which are determined once for a robot, at probe states that are not compared.

    An error of an engine at a compared state is therefore never mistaken for a convention, even if it equals a conversion.

    engine: its terms at the probes, in its own conventions for the velocities that are compared, in the order of the file.
    truth: the truth for these velocities at the probes.
    """
    convention = conventions.find(match.bodies, places(match), probes.states, engine, truth)
    conversion = _conversion(match, probes, convention)
    if conversion is None:
        return convention
    efforts = _nearest(_forward(engine, probes, conversion), truth.forward_dynamics)
    accelerations_given = _nearest(_inverse(engine, probes, conversion), truth.inverse_dynamics)
    return replace(convention, efforts=efforts, accelerations=accelerations_given)


def aligned(engine: Stack, truth: Stack, match: Match, motion_compared: Motion, convention: Convention) -> Stack:
    """Return an engine's terms in the conventions of the file.

    engine: its terms in its own conventions for the velocities that are compared, in the order of the file.
    truth: the truth for these velocities.
    """
    turned = _turned(engine, match, motion_compared, convention)
    centres = {link.name: np.asarray(link.center_of_mass, np.float64) for link in match.bodies.links}
    jacobians = {
        name: in_world(
            jacobian, turned.poses.get(name, truth.poses[name]), centres.get(name, np.zeros(3)), convention.jacobians
        )
        for name, jacobian in turned.jacobians.items()
        if name in truth.poses
    }
    return replace(turned, jacobians=jacobians)


@dataclass(frozen=True, eq=False)
class _Conversion:
    """The matrices (s, n, n) that convert velocities of the file to those of an engine.

    drift (s, n): the derivatives of the matrices times the velocities, which are added to converted accelerations.
    """

    matrix: Array
    drift: Array


def _conversion(match: Match, motion_compared: Motion, convention: Convention) -> _Conversion | None:
    """Return the conversion of velocities of the file to those of an engine; None if they are the same."""
    joints = {name: form for name, form in convention.joints.items() if form != conventions.Written()}
    if not joints:
        return None
    matrix, change = _matrices(match, motion_compared, joints)
    return _Conversion(matrix, times(change, motion_compared.velocities))


def _turned(engine: Stack, match: Match, motion_compared: Motion, convention: Convention) -> Stack:
    """Return terms for the velocities of the file, from terms for the velocities of an engine."""
    conversion = _conversion(match, motion_compared, convention)
    if conversion is None:
        return engine
    matrix, drift = conversion.matrix, conversion.drift
    back = transposed(matrix)
    vectors: dict[str, Any] = {
        name: None if (force := getattr(engine, name)) is None else times(back, force) for name in FORCES
    }
    mass, coriolis = engine.mass_matrix, vectors["coriolis_force"]
    if mass is not None and coriolis is not None:
        coriolis = coriolis + times(back, times(mass, drift))
    forward, inverse = (readings(engine, motion_compared, conversion) for readings in (_forward, _inverse))
    return replace(
        engine,
        mass_matrix=None if mass is None else back @ mass @ matrix,
        jacobians={name: jacobian @ matrix for name, jacobian in engine.jacobians.items()},
        **(
            vectors
            | {
                "coriolis_force": coriolis,
                "forward_dynamics": forward.get(convention.efforts),
                "inverse_dynamics": inverse.get(convention.accelerations),
            }
        ),
    )


def _matrices(match: Match, motion_compared: Motion, how: Mapping[str, conventions.Written]) -> tuple[Array, Array]:
    """Return the matrices (s, n, n) that convert velocities of the file to those of an engine, and their derivatives."""
    count, n = motion_compared.velocities.shape
    matrix, change = np.tile(np.eye(n), (count, 1, 1)), np.zeros((count, n, n))
    for name, form in how.items():
        block = np.ix_(range(count), places(match)[name], places(match)[name])
        matrix[block], change[block] = written(match.bodies, name, motion_compared.states, form)
    return matrix, change


def _forward(engine: Stack, motion_compared: Motion, conversion: _Conversion) -> dict[Given, Array]:
    """Return an engine's accelerations, converted to the velocities of the file, for each form of its efforts.

    The engine may take efforts converted to its own velocities, or as in the state. Empty if it has no accelerations.
    """
    if engine.forward_dynamics is None:
        return {}
    back = np.asarray(np.linalg.inv(conversion.matrix), np.float64)
    readings: dict[Given, Array] = {"converted": np.asarray(engine.forward_dynamics)}
    if engine.mass_matrix is not None:
        missing = times(transposed(back), motion_compared.efforts) - motion_compared.efforts
        readings["as in the state"] = readings["converted"] + _solved(engine.mass_matrix, missing)
    return {given: times(back, reading - conversion.drift) for given, reading in readings.items()}


def _inverse(engine: Stack, motion_compared: Motion, conversion: _Conversion) -> dict[Given, Array]:
    """Return an engine's efforts, converted to the velocities of the file, for each form of its accelerations.

    The engine may take accelerations converted to its own velocities, with or without the derivative of the conversion, or as
    in the state. Empty if it has no efforts.
    """
    if engine.inverse_dynamics is None:
        return {}
    inverse, wanted = np.asarray(engine.inverse_dynamics), motion_compared.accelerations
    readings: dict[Given, Array] = {"converted": inverse}
    if engine.mass_matrix is not None:
        without = times(conversion.matrix, wanted)
        right = without + conversion.drift
        readings["converted without its derivative"] = inverse + times(engine.mass_matrix, right - without)
        readings["as in the state"] = inverse + times(engine.mass_matrix, right - wanted)
    return {given: times(transposed(conversion.matrix), reading) for given, reading in readings.items()}


def _nearest(readings: Mapping[Given, Array], truth: Array | None) -> Given:
    """Return the form whose reading at probe states is nearest to the truth; the first form if there is no truth."""
    if truth is None or not readings:
        return next(iter(readings), "converted")
    errors = {given: float(np.max(np.abs(reading - truth), initial=0.0)) for given, reading in readings.items()}
    return min(errors, key=lambda given: errors[given] if np.isfinite(errors[given]) else np.inf)


def _solved(mass: Array, forces: Array) -> Array:
    """Return the accelerations (s, n) that forces (s, n) add; NaN where the mass matrix cannot be inverted."""
    try:
        return np.asarray(np.linalg.solve(mass, forces[..., None]))[..., 0]
    except np.linalg.LinAlgError:
        return np.full(forces.shape, np.nan)


def model_terms(model: RobotModel, match: Match, motion_compared: Motion, gravity: Vector) -> Stack:
    """Return the terms of a changed model of the engine's bodies, for the velocities that are compared.

    The joints of the model that move must be those of the file, in any order.
    """
    full = truth_of(model, motion_compared.states, gravity)
    labels, wanted = velocity_labels(model), velocity_labels(match.model)
    ordered = selected(full, [labels.index(label) for label in wanted])
    terms = reduced(ordered, match, motion_compared)
    if np.array_equal(motion_compared.efforts, values(motion_compared.states, match.labels, lambda state: state.efforts)):
        return terms
    return replace(terms, forward_dynamics=accelerations(terms, motion_compared.efforts))

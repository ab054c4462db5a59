"""What an engine computes in the order and conventions of the file, and the truth for the same velocities."""

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
from bodycheck.studies.parity.conventions import Convention, in_world, written
from bodycheck.studies.parity.matching import Match
from bodycheck.studies.parity.quantities import FORCES
from bodycheck.studies.parity.stacks import Stack, stacked, times, transposed, values


@dataclass(frozen=True, eq=False)
class Motion:
    """The states of the n velocities that are compared, each (s, n). Efforts are those that act on these velocities."""

    states: tuple[RobotState, ...]
    velocities: Array
    accelerations: Array
    efforts: Array

    def at(self, states: Sequence[int]) -> "Motion":
        """Return some of the states, by their places."""
        own = list(states)
        some = tuple(self.states[place] for place in own)
        return Motion(some, self.velocities[own], self.accelerations[own], self.efforts[own])


def truth_of(model: RobotModel, states: Sequence[RobotState], gravity: Vector) -> Stack:
    """Return the terms of a model at states, with all velocities of its joints."""
    return stacked(terms_at(model, states, gravity))


def motion(found: Match, states: Sequence[RobotState]) -> Motion:
    """Return the states of the velocities that are compared. An engine has no efforts of a joint that it does not have."""
    labels = found.labels
    return Motion(
        tuple(states),
        values(states, labels, lambda state: state.velocities),
        values(states, labels, lambda state: state.accelerations),
        values(states, labels, lambda state: state.efforts),
    )


def reduced(truth: Stack, found: Match, asked: Motion) -> Stack:
    """Return terms for the velocities that are compared, from those for all velocities of the model of the file.

    The accelerations follow from the other terms where joints that follow others have no velocity of their own.
    """
    expand = found.expansion
    if expand.shape[0] == expand.shape[1]:
        return truth
    forces: dict[str, Any] = {name: None if (own := getattr(truth, name)) is None else own @ expand for name in FORCES}
    mass = None if truth.mass_matrix is None else expand.T @ truth.mass_matrix @ expand
    jacobians = {name: jacobian @ expand for name, jacobian in truth.jacobians.items()}
    small = replace(truth, mass_matrix=mass, jacobians=jacobians, **forces)
    return replace(small, forward_dynamics=accelerations(small, asked.efforts))


def accelerations(terms: Stack, efforts: Array) -> Array | None:
    """Return the accelerations (s, n) under efforts (s, n) with the other terms; None if one is missing.

    They are NaN at states where the mass matrix cannot be inverted.
    """
    known = (terms.mass_matrix, terms.gravity_force, terms.coriolis_force, terms.passive_force)
    if any(part is None for part in known):
        return None
    mass, gravity, coriolis, passive = (np.asarray(part) for part in known)
    forces = efforts + passive - coriolis - gravity
    found = np.full(forces.shape, np.nan)
    for place, (matrix, force) in enumerate(zip(mass, forces, strict=True)):
        root = np.sqrt(np.abs(np.diag(matrix)))
        if np.all(np.isfinite(matrix)) and np.all(root > 0):
            try:
                found[place] = np.linalg.solve(matrix / np.outer(root, root), force / root) / root
            except np.linalg.LinAlgError:
                continue
    return found


def selected(engine: Stack, columns: Sequence[int]) -> Stack:
    """Return an engine's terms for some of its velocities alone, in the order given."""
    places = list(columns)
    vectors: dict[str, Any] = {name: None if (own := getattr(engine, name)) is None else own[:, places] for name in FORCES}
    mass = None if engine.mass_matrix is None else engine.mass_matrix[:, places][:, :, places]
    return replace(
        engine, mass_matrix=mass, jacobians={name: own[:, :, places] for name, own in engine.jacobians.items()}, **vectors
    )


def places(found: Match) -> dict[str, list[int]]:
    """Return the places of the velocities of each joint that has several."""
    by_joint: dict[str, list[int]] = {}
    for place, (name, _) in enumerate(found.labels):
        by_joint.setdefault(name, []).append(place)
    return {name: own for name, own in by_joint.items() if len(own) > 1}


def aligned(engine: Stack, truth: Stack, found: Match, asked: Motion) -> tuple[Stack, Convention]:
    """Return an engine's terms in the conventions of the file, and the conventions that it has.

    engine: its terms in its own conventions for the velocities that are compared, in the order of the file.
    truth: the truth for these velocities.
    """
    convention = conventions.find(found.bodies, places(found), asked.states, engine, truth)
    turned = _turned(engine, truth, found, asked, convention)
    centres = {link.name: np.asarray(link.center_of_mass, np.float64) for link in found.bodies.links}
    jacobians = {
        name: in_world(own, turned.poses.get(name, truth.poses[name]), centres.get(name, np.zeros(3)), convention.jacobians)
        for name, own in turned.jacobians.items()
        if name in truth.poses
    }
    return replace(turned, jacobians=jacobians), convention


def _turned(engine: Stack, truth: Stack, found: Match, asked: Motion, convention: Convention) -> Stack:
    """Return terms for the velocities of the file, from terms for the velocities of an engine."""
    how = {name: own for name, own in convention.joints.items() if own != conventions.Written()}
    if not how:
        return engine
    matrix, change = _matrices(found, asked, how)
    back = transposed(matrix)
    drift = times(change, asked.velocities)  # what the derivative of the matrix adds to accelerations
    vectors: dict[str, Any] = {name: None if (own := getattr(engine, name)) is None else times(back, own) for name in FORCES}
    mass, coriolis, forward, inverse = engine.mass_matrix, vectors["coriolis_force"], engine.forward_dynamics, None
    if mass is not None and coriolis is not None:
        coriolis = coriolis + times(back, times(mass, drift))
    if forward is not None:
        forward = _forward(engine, asked, matrix, drift, truth)
    if engine.inverse_dynamics is not None:
        inverse = _inverse(engine, asked, matrix, drift, truth)
    return replace(
        engine,
        mass_matrix=None if mass is None else back @ mass @ matrix,
        jacobians={name: own @ matrix for name, own in engine.jacobians.items()},
        **(vectors | {"coriolis_force": coriolis, "forward_dynamics": forward, "inverse_dynamics": inverse}),
    )


def _matrices(found: Match, asked: Motion, how: Mapping[str, conventions.Written]) -> tuple[Array, Array]:
    """Return the matrices (s, n, n) that make velocities of an engine of those of the file, and their derivatives."""
    count, n = asked.velocities.shape
    matrix, change = np.tile(np.eye(n), (count, 1, 1)), np.zeros((count, n, n))
    for name, own in how.items():
        block = np.ix_(range(count), places(found)[name], places(found)[name])
        matrix[block], change[block] = written(found.bodies, name, asked.states, own)
    return matrix, change


def _forward(engine: Stack, asked: Motion, matrix: Array, drift: Array, truth: Stack) -> Array:
    """Return accelerations in the velocities of the file, under the efforts of the states.

    An engine may have been given the efforts as they are in the state, or converted to its own velocities: whichever is nearer
    to the truth is taken.
    """
    forward = np.asarray(engine.forward_dynamics)
    back = np.asarray(np.linalg.inv(matrix), np.float64)
    converted = [forward]
    if engine.mass_matrix is not None:
        missing = times(transposed(back), asked.efforts) - asked.efforts
        converted.append(forward + _solved(engine.mass_matrix, missing))
    return _nearest([times(back, own - drift) for own in converted], truth.forward_dynamics)


def _inverse(engine: Stack, asked: Motion, matrix: Array, drift: Array, truth: Stack) -> Array:
    """Return the efforts for the accelerations of the states, in the velocities of the file.

    An engine may have been given the accelerations as they are in the state, or converted to its own velocities with or
    without the derivative of the conversion: whichever is nearest to the truth is taken.
    """
    inverse, back = np.asarray(engine.inverse_dynamics), transposed(matrix)
    converted = [inverse]
    if engine.mass_matrix is not None:
        right = times(matrix, asked.accelerations) + drift
        given = (times(matrix, asked.accelerations), asked.accelerations)
        converted += [inverse + times(engine.mass_matrix, right - own) for own in given]
    return _nearest([times(back, own) for own in converted], truth.inverse_dynamics)


def _nearest(candidates: Sequence[Array], truth: Array | None) -> Array:
    """Return the candidate that is nearest to the truth; the first if there is no truth."""
    if truth is None:
        return candidates[0]
    errors = [float(np.max(np.abs(own - truth), initial=0.0)) for own in candidates]
    finite = [error if np.isfinite(error) else np.inf for error in errors]
    return candidates[finite.index(min(finite))]


def _solved(mass: Array, forces: Array) -> Array:
    """Return the accelerations (s, n) that forces (s, n) add; NaN where the mass matrix cannot be inverted."""
    try:
        return np.asarray(np.linalg.solve(mass, forces[..., None]))[..., 0]
    except np.linalg.LinAlgError:
        return np.full(forces.shape, np.nan)


def model_terms(model: RobotModel, found: Match, asked: Motion, gravity: Vector) -> Stack:
    """Return the terms of a changed model of the engine's bodies, for the velocities that are compared.

    The joints of the model that move must be those of the file, in any order.
    """
    full = truth_of(model, asked.states, gravity)
    own, wanted = velocity_labels(model), velocity_labels(found.model)
    ordered = selected(full, [own.index(label) for label in wanted])
    terms = reduced(ordered, found, asked)
    if np.array_equal(asked.efforts, values(asked.states, found.labels, lambda state: state.efforts)):
        return terms
    return replace(terms, forward_dynamics=accelerations(terms, asked.efforts))

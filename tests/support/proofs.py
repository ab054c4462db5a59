"""Certificates of truths with a proof alone, and scenes of one body."""

from typing import Any

import numpy as np

from bodycheck.reference.certified import Certificate, proved
from bodycheck.reference.exact.start import defined_scene
from bodycheck.reference.proof.enclosure import Enclosure
from bodycheck.reference.scene import Definition, Plane, Scene, Solid, State
from bodycheck.reference.truths import Truth


def certificate_of(found: Truth, enclosure: Enclosure) -> Certificate:
    """The certificate of a truth with a proof, without a cross-check."""
    return proved(Certificate(found, {}, np.zeros(1), 0, others=False, faults=(), growth=None), enclosure)


def one_body(
    solid: Solid, position: Any, velocity: Any, spin: Any, plane: Plane | None = None, *, gravity: float = 9.81, **rest: Any
) -> Scene:
    """A solid, its state along the axes of the world, and its surroundings."""
    base = defined_scene(Definition(solid, rotation=tuple(map(float, spin))), solid.shape)
    start = State(tuple(map(float, position)), base.initial.quaternion, tuple(map(float, velocity)), tuple(map(float, spin)))
    return Scene(base.body, start, gravity, plane, definition=base.definition, **rest)

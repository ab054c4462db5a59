"""The record of an engine: its integrators, what it can model, its settings and its methods, as data.

The module `contract` has all of these names too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from bodycheck.adapters.method import KINDS, Kind, Option

#: What a method is for users: the one that they get if they choose nothing, or the one that the documentation recommends.
Role = Literal["default", "recommended"]

#: The properties that may differ between scenes that an engine steps together: the body (mass, moments, axes, shape), gravity.
Varied = Literal["body", "gravity"]


@dataclass(frozen=True)
class Integrator:
    """An integrator of an engine.

    Parameters
    ----------
    name
        The name that the engine itself uses.
    order
        The order of the error in the time step, on smooth motion, that the engine or a textbook claims; None if neither does.
    evaluations
        The number of evaluations of the accelerations in one step; None if it is not known.
    kinds
        The kinds of scene for which the integrator is offered; empty if the installed release lacks it.
    options
        The options of the integrator by their keys.
    demonstrates
        What the integrator demonstrates, as a phrase, if it exists for demonstration only; empty for all other integrators.
    refuses
        Why scenes of some kinds, which are among `kinds`, are `unsupported`: a predicate whose subject is the integrator.
    """

    name: str
    order: int | None = None
    evaluations: int | None = None
    kinds: frozenset[Kind] = KINDS
    options: Mapping[str, Option] = field(default_factory=dict)
    demonstrates: str = ""
    refuses: Mapping[Kind, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Usage:
    """A method with all its settings, as the authors of an engine mean users to have it.

    Parameters
    ----------
    method
        The spelling of the method, with all options for step control, substeps, relaxation and solvers that it needs.
    timestep
        The time step (s); of a method with error control the largest step. None if a method with error control has its usual
        largest step; see `Engine.largest_step`.
    page
        The address of the page of the engine's documentation, or of its source, that shows or recommends the method.
    reads_timestep
        Whether the engine takes the time step from a robot's file that states one.
    """

    method: str
    timestep: float | None
    page: str
    reads_timestep: bool = False


@dataclass(frozen=True)
class Engine:
    """The properties of an engine that do not depend on a scene.

    Parameters
    ----------
    name
        The name by which bodycheck finds the adapter.
    distribution, version
        The package that installs the engine, as pip names it, and the engine's own version.
    integrators
        All integrators that the adapter knows.
    models
        The requirements that the engine can model: for scenes the field names of
        `bodycheck.reference.requirements.Requirements`, and for mechanisms the names in
        `bodycheck.reference.requirements.MechanismRequirements`.
    variants
        Spellings of methods with options, keyed by kind of scene. If the user names no method, they are run in addition to the
        integrators, and after them; an integrator that is to come after methods with options is named among these.
    precision, device
        The precision and the device of the engine's arithmetic.
    batch
        The number of scenes per call of `prepare` from which batching pays off; 1 if the engine steps one scene at a time. An
        engine whose `batch` is larger accepts any number of scenes that differ only in their initial states and in the
        properties that `varies` names.
    varies
        The properties that may differ between such scenes in addition to their initial states; see `Adapter.prepare`.
    defaults
        The engine's own defaults of "integrator", "timestep" and "tolerance", with values and units, such as
        {"timestep": "0.002 s"}; keys for which the engine has no default are left out.
    roles
        The methods behind the aliases `default` and `recommended`, keyed by role and kind of scene. The default is what a user
        of the engine's quick start gets, and the recommended method is what its documentation recommends.
    soft
        The requirements of mechanisms that the engine models by springs and dampers, so that a part of the error does not
        vanish with the time step; the values name the options that change them.
    largest_step
        The engine's own limit (s) on the steps of methods with error control; None if it has none.
    combines
        How the engine makes the coefficients of a pair from those of its two bodies, keyed by "friction" and "restitution",
        such as "product" or "larger of the two"; empty if pairs have coefficients of their own, or it has no contacts here.
    reads
        When the adapter can read sensors of the engine: after a step, and also after the engine's own function that computes
        all quantities of the present state; empty if it cannot.
    """

    name: str
    distribution: str
    version: str
    integrators: tuple[Integrator, ...]
    models: frozenset[str]
    variants: Mapping[Kind, tuple[str, ...]] = field(default_factory=dict)
    precision: Literal["float64", "float32"] = "float64"
    device: Literal["cpu", "cuda"] = "cpu"
    batch: int = 1
    varies: frozenset[Varied] = frozenset()
    defaults: Mapping[str, str] = field(default_factory=dict)
    roles: Mapping[Role, Mapping[Kind, Usage]] = field(default_factory=dict)
    soft: Mapping[str, str] = field(default_factory=dict)
    largest_step: float | None = None
    combines: Mapping[str, str] = field(default_factory=dict)
    reads: tuple[Literal["step", "forward"], ...] = ()

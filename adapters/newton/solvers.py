"""Newton's solvers of rigid bodies, by the names of the methods that use them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from newton import solvers

from bodycheck.adapters.contract import KINDS, Kind, Method, Option, Range, choice
from bodycheck.adapters.mujoco import contact

#: A coordinate (rad or m) that no joint reaches, by which Newton says that a joint has no limit.
FAR = 1e10

#: The time-stepping schemes of the solver that passes a model to MuJoCo Warp, as Newton spells them.
OF_MUJOCO = ("euler", "rk4", "implicit", "implicitfast", "discrete")

ON_PLANE: frozenset[Kind] = frozenset({"plane"})

#: The kinds of scene of the solvers that are not offered for mechanisms, for the reasons in the docstring of the package.
ONE_BODY: frozenset[Kind] = KINDS - {"mechanism"}

#: Why a solver is `unsupported` for bodies that roll, bounce or bear each other.
NOT_TRIED: Mapping[Kind, str] = {"contact": "is not given bodies that touch; Newton's solvers MuJoCo and XPBD are"}

#: The name of the attribute of a body that sets its damping for `SolverSteel`.
STEEL_DAMPING = "steel:rigid_body_angular_damping"

#: The attribute of a joint that sets the impedance of a limit for MuJoCo, and the smallest impedance that MuJoCo allows. With
#: Newton's own impedance of 0.95 a limit would have the inertia of the joint twenty times while it pushes.
LIMIT_IMPEDANCE, SOFTEST = "mujoco:solimplimit", (1e-4, 1e-4, 1e-3, 0.5, 1.0)


@dataclass(frozen=True)
class Solver:
    """A solver of Newton.

    Parameters
    ----------
    make
        Returns the solver of a model for a method, with keyword arguments of Newton's class in addition.
    order, evaluations
        As for `Integrator`.
    kinds
        The kinds of scene for which the solver is offered.
    options
        The options of its methods.
    refuses
        As for `Integrator`.
    collides
        Whether Newton's collision detection runs before each step; if not, the solver has its own collision detection.
    own_passive_forces
        Whether drag is one of the solver's own passive forces, which it evaluates with the accelerations, at each stage of a
        step. If not, drag is an external force, which is computed at the start of a step and held through it.
    lacks
        The features of mechanisms that the solver does not model, or ignores; see `Engine.models`.
    observables
        The observables that the solver fills in its steps, by Newton's names.
    """

    make: Callable[..., Any]
    order: int | None = 1
    evaluations: int | None = 1
    kinds: frozenset[Kind] = KINDS
    options: Mapping[str, Option] = field(default_factory=dict)
    refuses: Mapping[Kind, str] = field(default_factory=dict)
    collides: bool = True
    own_passive_forces: bool = False
    lacks: frozenset[str] = frozenset()
    observables: frozenset[str] = frozenset()


def keeps_damping(method: Method) -> bool:
    """Return whether a method keeps Newton's own damping."""
    return method.option("settings") == "engine"


def mujoco(scheme: str) -> Solver:
    """Return the solver that passes a model to MuJoCo Warp, with one of MuJoCo Warp's integrators."""
    stages = 4 if scheme == "rk4" else 1

    def make(model: Any, method: Method, **chosen: Any) -> Any:
        impratio = method.option("impratio")
        chosen |= {"cone": method.option("cone"), "impratio": None if impratio is None else float(impratio)}
        return solvers.SolverMuJoCo(model, integrator=scheme, **chosen)

    return Solver(
        make,
        stages,
        stages,
        options={key: contact.OPTIONS[key] for key in ("cone", "impratio")},
        collides=False,
        own_passive_forces=True,
        lacks=frozenset({"rigid stops"}),
        observables=solvers.SolverMuJoCo.SUPPORTED_OBSERVABLES,
    )


def kamino(scheme: str, kinds: frozenset[Kind], **chosen: Any) -> Solver:
    """Return the solver Kamino with one of its schemes; the option `dynamics_solver` selects how it solves for contacts."""

    def make(model: Any, method: Method) -> Any:
        config = {"integrator": scheme, "dynamics_solver": method.option("dynamics_solver") or "padmm", **chosen}
        return solvers.SolverKamino(model, solvers.SolverKamino.Config(**config))

    return Solver(
        make,
        kinds=kinds,
        refuses=NOT_TRIED,
        options={"dynamics_solver": choice("padmm", "dvi", "lox", kinds=ON_PLANE)},
        collides=not chosen.get("use_collision_detector"),
        observables=solvers.SolverKamino.SUPPORTED_OBSERVABLES,
    )


def xpbd(model: Any, method: Method, **chosen: Any) -> Any:
    """Return the solver XPBD; its two factors of relaxation of joints are those of the method, or Newton's own."""
    if (iterations := method.option("iterations")) is not None:
        chosen["iterations"] = int(iterations)
    if (relaxation := method.option("relaxation")) is not None:
        chosen |= {"joint_linear_relaxation": float(relaxation), "joint_angular_relaxation": float(relaxation)}
    return solvers.SolverXPBD(model, **chosen)


def steel(model: Any, method: Method) -> Any:
    """Return the solver Steel, with the limits of joints if there are any: by default it has none."""
    limits = np.abs([model.joint_limit_lower.numpy(), model.joint_limit_upper.numpy()])
    return solvers.SolverSteel(model, enable_joint_limits=bool((limits < FAR).any()))


SOLVERS: dict[str, Solver] = {
    "SemiImplicit": Solver(
        lambda model, method: solvers.SolverSemiImplicit(model, **({} if keeps_damping(method) else {"angular_damping": 0.0})),
        kinds=ONE_BODY,
        refuses=NOT_TRIED,
        options={"settings": choice("engine")},
    ),
    "Featherstone": Solver(
        lambda model, method: solvers.SolverFeatherstone(model),
        refuses=NOT_TRIED,
        lacks=frozenset({"joint friction", "rigid stops"}),
        observables=solvers.SolverFeatherstone.SUPPORTED_OBSERVABLES,
    ),
    "XPBD": Solver(
        xpbd,
        options={
            "iterations": Option("an integer of at least 1", numbers=((Range(1, whole=True),),)),
            "relaxation": Option(
                "a factor for the joints' impulses above 0 and at most 1", numbers=((Range(0, 1, above=True),),)
            ),
        },
        lacks=frozenset({"armature", "joint damping", "joint springs", "joint friction", "massless bodies", "elastic stops"}),
        observables=solvers.SolverXPBD.SUPPORTED_OBSERVABLES,
    ),
    "VBD": Solver(
        lambda model, method: solvers.SolverVBD(model),
        kinds=ONE_BODY,
        refuses=NOT_TRIED,
        observables=solvers.SolverVBD.SUPPORTED_OBSERVABLES,
    ),
    "Steel": Solver(
        steel,
        refuses=NOT_TRIED,
        options={"settings": choice("engine")},
        lacks=frozenset({"joint springs", "joint friction", "elastic stops"}),
        observables=solvers.SolverSteel.SUPPORTED_OBSERVABLES,
    ),
    "Kamino-euler": kamino("euler", ONE_BODY),
    "Kamino-moreau": kamino("moreau", ON_PLANE, use_collision_detector=True),
    **{f"MuJoCo-{scheme}": mujoco(scheme) for scheme in OF_MUJOCO},
}

#: Spellings of methods with options that are run in addition to the integrators: the methods with Newton's damping (DAMPED),
#: and all methods by kind of scene (VARIANTS), XPBD without relaxation of joints beside XPBD with it.
DAMPED = ("SemiImplicit:settings=engine", "Steel:settings=engine")
VARIANTS: dict[Kind, tuple[str, ...]] = {
    "flight": DAMPED,
    "drag": DAMPED,
    "plane": (*DAMPED, "Kamino-euler:dynamics_solver=dvi", "Kamino-euler:dynamics_solver=lox"),
    "mechanism": ("XPBD:relaxation=1",),
}

"""The adapter of Simbody by OpenSim: the model of a scene, and the loop of its steps."""

import math
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from importlib import metadata
from typing import Any

import numpy as np
import opensim

from bodycheck.adapters.contract import (
    KINDS,
    Engine,
    EngineDiverged,
    Integrator,
    Method,
    SceneUnsupported,
    Simulation,
    Strides,
    choice,
    single,
    states,
)
from bodycheck.adapters.quiet import no_stderr
from bodycheck.adapters.simbody import INSTALLATION
from bodycheck.adapters.simbody.attitude import coordinates, poses, use_quaternions
from bodycheck.adapters.simbody.contact import add_contact
from bodycheck.adapters.stepping import Normalised
from bodycheck.reference.inertia import inertia_tensor
from bodycheck.reference.kinematics import conjugate, normalise, rotate
from bodycheck.reference.scene import Plane, Scene
from bodycheck.reference.trajectory import Array

# OpenSim writes what each call has done to stdout and to a file in the working directory.
opensim.Logger.setLevelString("Off")
opensim.Logger.removeFileSink()

#: The integrator that Simbody has from SUNDIALS. It writes its errors to standard error, and is offered in flight only.
CPODES = "CPodes"

#: Simbody's integrators by their names in OpenSim's `Manager`, with the orders that Simbody's documentation claims and the
#: numbers of evaluations of the accelerations in one step.
CLAIMS: dict[str, tuple[int | None, int | None]] = {
    "ExplicitEuler": (1, 1),
    "SemiExplicitEuler2": (1, 2),
    "Verlet": (2, None),
    "RungeKutta2": (2, 2),
    "RungeKutta3": (3, 3),
    "RungeKuttaMerson": (4, 5),
    "RungeKuttaFeldberg": (5, 6),
    CPODES: (None, None),
}

#: The most steps in one call. CPodes complains on stderr after 500 if it is not given one.
STEP_LIMIT = 2**31 - 1

#: What the names of integrators begin with in `Manager`.
PREFIX = "IntegratorMethod_"


def integrators() -> tuple[Integrator, ...]:
    """Return the integrators of the installed release."""
    here = [name.removeprefix(PREFIX) for name in dir(opensim.Manager) if name.startswith(PREFIX)]
    known = sorted(here, key=lambda name: [*CLAIMS, name].index(name))
    options = {"settings": choice("engine")}
    flight = KINDS - {"plane"}
    return tuple(
        Integrator(name, *CLAIMS.get(name, (None, None)), kinds=flight if name == CPODES else KINDS, options=options)
        for name in known
    )


engine = Engine(
    name="simbody",
    distribution=INSTALLATION.distribution,
    version=metadata.version(INSTALLATION.distribution),
    integrators=integrators(),
    models=frozenset({"gravity", "translation", "rotation", "contact", "friction", "drag"}),
    variants={"flight": tuple(f"{own.name}:settings=engine" for own in integrators())},
)


#: The functions of OpenSim that steps call from Python.
calls = ((opensim.Manager, "integrate"),)


def contact_law(scene: Scene, method: Method) -> Plane | None:
    """Return the friction law of the contacts, rigid corners; None for a scene without a plane."""
    return None if scene.plane is None else replace(scene.plane, law="corners", pressure="balanced")


def contact_load(scene: Scene, method: Method, steps: int) -> None:
    """Return None: within a step the force of a contact has several values."""


@dataclass
class Simbody:
    """A model of one scene, stepped by OpenSim's manager.

    Attributes
    ----------
    manager, model
        OpenSim's manager, and its model. They are destroyed in this order, because the manager uses the model to its end.
    timestep
        The time step (s).
    quaternions
        Whether the coordinates have a quaternion.
    drag
        The coefficient of drag (kg/m).
    actuators
        The forces on the coordinates x, y and z; none without drag.
    complains
        Whether the integrator writes on stderr in C what it also says in an exception.
    taken
        The number of steps taken.
    """

    manager: Any
    model: Any
    timestep: float
    quaternions: bool
    drag: float
    actuators: Sequence[Any]
    complains: bool
    taken: int = 0

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, 1, 13) after each of n strides, as `Simulation.advance` does; quaternions have any norm."""
        with no_stderr() if self.complains else nullcontext():
            return self._advance(strides)

    def _advance(self, strides: Strides) -> Array:
        seen = np.empty((len(strides), 13))
        for place, stride in enumerate(strides.tolist()):
            try:
                self._stride(stride)
            except RuntimeError as error:
                seen[place] = self._seen()
                # Before it are the C++ function and the place in its source.
                words = " ".join(str(error).split())
                signal = EngineDiverged(f"Simbody: {words.partition('SimTK Exception')[2].partition(': ')[2] or words}")
                signal.states = single(self._rows(seen[: place + 1]))
                raise signal from error
            seen[place] = self._seen()
        return single(self._rows(seen))

    def _stride(self, steps: int) -> None:
        if steps and not self.actuators:
            self.manager.integrate((self.taken + steps) * self.timestep)
            self.taken += steps
        for _ in range(steps if self.actuators else 0):
            now = self.manager.getState()
            self._hold_drag(now)
            # Simbody adds up times like this; at another time it would interpolate, and drag in an interpolated state is lost.
            self.manager.integrate(now.getTime() + self.timestep)
            self.taken += 1

    def _hold_drag(self, now: Any) -> None:
        """Let the drag at the current state act until it is set again."""
        velocity = now.getU().to_numpy()[3:].tolist()
        slowing = -self.drag * math.hypot(*velocity)
        for actuator, speed in zip(self.actuators, velocity, strict=True):
            actuator.setOverrideActuation(now, slowing * speed)
        self.model.realizeAcceleration(now)  # the next step begins with these accelerations

    def _seen(self) -> Array:
        now = self.manager.getState()
        return np.concatenate([now.getQ().to_numpy(), now.getU().to_numpy()])

    def _rows(self, seen: Array) -> Array:
        position, attitude = poses(seen[:, :7], self.quaternions)
        return states(position, attitude, seen[:, 10:], rotate(conjugate(normalise(attitude)), seen[:, 7:10]))


def prepare(scenes: Sequence[Scene], method: Method) -> Simulation:
    """Return the simulation of one scene, as `Adapter.prepare` does."""
    (scene,) = scenes
    model, actuators = described(scene)
    quaternions = method.option("settings") != "engine"
    state = started(scene, model, quaternions)
    for actuator in actuators:
        actuator.overrideActuation(state, True)
    manager = opensim.Manager(model)
    manager.setIntegratorMethod(getattr(opensim.Manager, PREFIX + method.integrator))
    manager.setIntegratorFixedStepSize(method.timestep)
    manager.setIntegratorInternalStepLimit(STEP_LIMIT)
    for records in (manager.setWriteToStorage, manager.setPerformAnalyses, manager.setRecordStatesTrajectory):
        records(False)
    manager.initialize(state)
    complains = method.integrator == CPODES
    return Normalised(Simbody(manager, model, method.timestep, quaternions, scene.drag, actuators, complains))


def described(scene: Scene) -> tuple[Any, list[Any]]:
    """Return OpenSim's model of a scene, and its forces on the coordinates x, y and z, which there are only with drag.

    Raises `SceneUnsupported` if OpenSim refuses the body, or has no such contact.
    """
    inertia = inertia_tensor(scene.body)
    entries = [float(inertia[row, column]) for row, column in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    model = opensim.Model()
    model.setGravity(opensim.Vec3(0.0, 0.0, -scene.gravity))
    try:
        body = opensim.Body("body", scene.body.mass, opensim.Vec3(0.0), opensim.Inertia(*entries))
    except RuntimeError as error:
        raise SceneUnsupported(f"OpenSim refuses the body: {' '.join(str(error).split())}") from error
    joint = opensim.FreeJoint("joint", model.getGround(), body)
    model.addBody(body)
    model.addJoint(joint)
    if scene.plane is not None:
        add_contact(model, body, scene, scene.plane)
    actuators = []
    for axis in range(3) if scene.drag else ():
        actuators.append(opensim.CoordinateActuator(joint.getCoordinate(3 + axis).getName()))
        actuators[-1].setName(f"drag_{axis}")
        model.addForce(actuators[-1])
    return model, actuators


def started(scene: Scene, model: Any, quaternions: bool) -> Any:
    """Return a model's state at the initial state of a scene, with quaternions or with angles."""
    state = model.initSystem()
    if quaternions:
        use_quaternions(model, state)
    initial = scene.initial
    spin = rotate(np.array(initial.quaternion), np.array(initial.angular_velocity))
    q, u = state.updQ(), state.updU()
    for place, number in enumerate(coordinates(initial, quaternions)):
        q.set(place, number)
    for place, number in enumerate([*spin.tolist(), *initial.velocity]):
        u.set(place, number)
    return state

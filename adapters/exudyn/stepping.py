"""Settings of Exudyn's solvers, the loop over strides of fixed steps, which are taken in C++, and steps with error control."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np

from bodycheck.adapters.contract import EngineDiverged, Method, SceneUnsupported, Strides, Work, single
from bodycheck.adapters.stepping import Controlled
from bodycheck.reference.trajectory import Array

#: Exudyn's solvers that take explicit steps.
EXPLICIT = ("ExplicitEuler", "ExplicitMidpoint", "RK33", "RK44", "RK67", "ODE23", "DOPRI5", "VelocityVerlet")

#: Exudyn's solvers that estimate the error of a step.
CONTROLLED = ("ODE23", "DOPRI5")

#: A tolerance of the error of a step so large that every step meets it: a solver that adapts its step takes the largest step.
NO_TOLERANCE = 1e100


@dataclass
class Stepper:
    """A simulation of one body or of a mechanism.

    Parameters
    ----------
    container, system
        Exudyn's system and the container that owns it.
    solver, settings
        The initialised solver with its settings.
    seen
        Returns a copy of the numbers (k,) that describe the current state.
    rows
        Converts the numbers (n, k) of n states to rows (n, 13) in the columns of `Simulation.advance`, or (n, bodies, 13).
    timestep
        The time step (s); with error control the largest step.
    taken
        The number of steps taken so far.
    """

    container: "exudyn.SystemContainer"
    system: "exudyn.MainSystem"
    solver: Any
    settings: "exudyn.SimulationSettings"
    seen: Callable[[], Array]
    rows: Callable[[Array], Array]
    timestep: float
    taken: int = 0

    def advance(self, strides: Strides) -> Array:
        """Return the states (1, n, bodies, 13) after each of n strides, as `Simulation.advance` does."""
        seen = []
        for stride in strides.tolist():
            failed = self.failed(stride) if stride else None
            seen.append(self.seen())
            if failed is not None:
                signal = EngineDiverged(failed)
                signal.states = single(self.rows(np.array(seen)))
                raise signal
        return single(self.rows(np.array(seen)))

    def failed(self, steps: int) -> str | None:
        """Take a number of steps, at least one. Return the solver's message if it fails, else None."""
        iteration, adaptive = self.solver.it, self.settings.timeIntegration.adaptiveStep
        # The loop ends after the first step that reaches the end time. If Exudyn may change steps, it shortens the last step to
        # end there. If steps are fixed, the end time is set back by half a step, so that rounding adds or omits no step.
        iteration.startTime = self.taken * self.timestep
        self.taken += steps
        iteration.endTime = (self.taken if adaptive else self.taken - 0.5) * self.timestep
        return self.solve()

    def restart(self) -> None:
        """Let the solver begin again at the initial state, whose accelerations it keeps, for forces that are new."""
        self.solver.InitializeSolver(self.system, self.settings)

    def solve(self) -> str | None:
        """Take steps until the end time of the solver. Return the solver's message if it fails, else None."""
        try:
            if self.solver.SolveSteps(self.system, self.settings):
                return None
        except Exception as error:  # Exudyn raises exceptions of several types
            return f"Exudyn stops: {' '.join(str(error).split())}"
        return f"Exudyn's solver fails: {' '.join(self.solver.GetErrorString().split())}"

    def at(self, time: float) -> Array:
        """Step with error control to a time (s), where a step ends, and return the numbers that describe the state.

        Raises `EngineDiverged`.
        """
        iteration = self.solver.it
        if time > iteration.currentTime:
            iteration.endTime = time
            failed = self.solve()
            self.taken += iteration.currentStepIndex - 1  # the index of the next step; Exudyn counts from the last call on
            if failed is not None:
                raise EngineDiverged(failed)
            iteration.initialStepSize = iteration.currentStepSize  # or the next call would begin with the largest step
        return self.seen()

    def work(self) -> Work:
        """Return the work of the solver so far. Exudyn does not count the evaluations of an explicit solver."""
        return Work(self.taken, self.solver.it.rejectedAutomaticStepSizeSteps, None)


def settings(method: Method, constrained: bool, impacts: bool = False) -> "exudyn.SimulationSettings":
    """Return the settings with which a solver takes the steps of a method, writes no file and prints nothing.

    `constrained` says whether the system has algebraic constraints. Exudyn's documentation requires a spectral radius below 1
    for constraints on positions, so that it is 1 only without constraints. `impacts` says whether bodies hit each other or a
    plane. Exudyn then halves steps in which the iterations for the states of contacts do not converge.
    """
    simulation = exudyn.SimulationSettings()
    simulation.solution.file.write = False
    time = simulation.timeIntegration
    time.verboseMode = 0
    time.numberOfSteps, time.endTime = 1, method.timestep
    time.automaticStepSize = method.accuracy is not None
    tolerance = NO_TOLERANCE if method.accuracy is None else method.accuracy
    time.absoluteTolerance = time.relativeTolerance = tolerance  # equal, as Exudyn's defaults are
    time.explicit.computeEndOfStepAccelerations = False  # no step depends on them
    if method.option("settings") != "engine":
        # Modified Newton keeps a Jacobian over many steps, until the end of a stride: states would depend on the sampling.
        time.newton.useModifiedNewton = False
        time.adaptiveStep = impacts
        if not constrained:
            time.generalizedAlpha.spectralRadius = 1.0
    time.solverType = getattr(exudyn.DynamicSolverType, method.integrator)
    if method.integrator == "TrapezoidalIndex2":
        # Exudyn's own function for this solver sets these flags.
        time.generalizedAlpha.useNewmark = time.generalizedAlpha.useIndex2Constraints = True
    return simulation


def solver(method: Method) -> Any:
    """Return Exudyn's solver of a method."""
    return exudyn.MainSolverExplicit() if method.integrator in EXPLICIT else exudyn.MainSolverImplicitSecondOrder()


def initialised(
    container: "exudyn.SystemContainer",
    system: "exudyn.MainSystem",
    method: Method,
    seen: Callable[[], Array],
    rows: Callable[[Array], Array],
    redundant: bool = False,
    impacts: bool = False,
) -> Stepper | Controlled:
    """Return the simulation of a complete system, with an initialised solver, and with error control if the method has it.

    Parameters
    ----------
    container, system, method, seen, rows
        See `Stepper`.
    redundant
        Whether constraints may depend on each other, so that the solver must accept a singular Jacobian.
    impacts
        Whether bodies hit each other or a plane.

    Raises
    ------
    SceneUnsupported
        If Exudyn refuses the system.
    """
    system.Assemble()
    constrained = len(system.systemData.GetAECoordinates()) > 0
    chosen, engine_solver = settings(method, constrained, impacts), solver(method)
    if redundant:
        chosen.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
        chosen.linearSolver.ignoreSingularJacobian = True
    try:
        refusal = "" if engine_solver.InitializeSolver(system, chosen) else engine_solver.GetErrorString()
    except exudyn.exudynCPP.ModelError as error:  # explicit solvers raise it if there are constraints
        refusal = str(error).partition(" [Python file")[0]
    if refusal:
        raise SceneUnsupported(f"Exudyn refuses the model: {' '.join(refusal.split())}")
    stepper = Stepper(container, system, engine_solver, chosen, seen, rows, method.timestep)
    return stepper if method.accuracy is None else Controlled(method.timestep, stepper.at, rows, stepper.work)

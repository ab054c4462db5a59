"""Compare a step of Pinocchio's rigid contact through the adapter with a script that builds the contacts in every step.

The script computes where the corners are and makes models, data and solver for the contacts there, as an engine with collision
detection does. Its solver has no warm start. The script is timed twice with the same tolerance: with the solver's other
settings at their defaults, where a step of the adapter must cost at most 0.4 times as much; and with the adapter's settings,
which isolates the saving by keeping the contacts and by the warm start.

All are timed in one process, alternately. The printed ratios are those of neighbouring turns, so that they do not depend on a
drift of the machine's speed. Run: python benchmarks/pinocchio_contact.py
"""

import statistics
import time

import numpy as np
import pinocchio as pin

from bodycheck.adapters import registry
from bodycheck.adapters.contract import Method
from bodycheck.adapters.pinocchio.contact import solver_settings
from bodycheck.reference.inertia import principal_moments
from bodycheck.reference.scene import Body, Brick, Plane, Scene, State
from bodycheck.reference.trajectory import Array

TURNS = 15
TIMESTEP_S = 0.002
STEPS = 150

MASS, GRAVITY, FRICTION = 1.2, 9.81, 0.5
BRICK = Brick((0.1, 0.2, 0.05))
MOMENTS = principal_moments(BRICK, MASS)
HEIGHT = BRICK.semi_axes[2]

#: Initial velocity (m/s) and spin (rad/s), by the name of the motion.
MOTIONS = {
    "straight slide": ((2.0, 0.0, 0.0), 0.0),
    "pure spin": ((0.0, 0.0, 0.0), 10.0),
    "slide and spin": ((2.0, 0.0, 0.0), 10.0),
    "at rest": ((0.0, 0.0, 0.0), 0.0),
}

#: Largest difference of the final positions (m). The loads on four corners are not unique; those that a solver finds without a
#: warm start deflect a curling brick by 1 cm.
AGREEMENT_M = 2e-2


def naive(initial: State, tuned: bool) -> Array:
    """Return the final position (3,), m, with new contacts in each step; tuned: use the adapter's solver settings."""
    model = pin.Model()
    model.gravity.linear[:] = 0.0, 0.0, -GRAVITY
    slide = model.addJoint(0, pin.JointModelTranslation(), pin.SE3.Identity(), "translation")
    joint = model.addJoint(slide, pin.JointModelSpherical(), pin.SE3.Identity(), "rotation")
    model.appendBodyToJoint(joint, pin.Inertia(MASS, np.zeros(3), np.diag(MOMENTS)), pin.SE3.Identity())
    data = model.createData()
    speed = GRAVITY * TIMESTEP_S
    settings = solver_settings(BRICK, initial, speed)
    if not tuned:
        defaults = pin.ADMMSolverSettings()
        settings.rho_init, settings.admm_update_rule = defaults.rho_init, defaults.admm_update_rule
    w, *vector = initial.quaternion
    q, v = np.array([*initial.position, *vector, w]), np.array([*initial.velocity, *initial.angular_velocity])
    a, b, c = BRICK.semi_axes
    for _ in range(STEPS):
        v = v + TIMESTEP_S * pin.aba(model, data, q, v, np.zeros(6))
        pin.computeJointJacobians(model, data, q)
        models, datas, gaps = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData(), []
        for x, y in ((a, b), (-a, b), (-a, -b), (a, -b)):
            corner = pin.SE3(np.eye(3), np.array([x, y, -c]))
            place = data.oMi[joint].act(corner).translation.copy()
            gaps.append(place[2])
            place[2] = 0.0
            contact = pin.PointContactConstraintModel(model, 0, pin.SE3(np.eye(3), place), joint, corner)
            contact.setFriction(FRICTION)
            models.append(pin.ConstraintModel(contact))
            datas.append(models[-1].createData())
        for contact, state in zip(models, datas, strict=True):
            contact.calc(model, data, state)
        jacobian = pin.getConstraintsJacobian(model, data, models, datas)
        response = pin.computeMinverse(model, data, q) @ jacobian.T
        drift = jacobian @ v
        drift[2::3] += np.array(gaps) / TIMESTEP_S
        result = pin.ADMMSolverResult()
        delassus = pin.DelassusOperatorDense(MASS * (jacobian @ response))
        pin.ADMMConstraintSolver(12).solve(delassus, drift / speed, models, datas, settings, result)
        v = v + response @ (MASS * speed * result.retrieveConstraintImpulses())
        q = pin.integrate(model, q, TIMESTEP_S * v)
    return q[:3]


def main() -> None:
    adapter = registry.load("pinocchio")
    print(f"Pinocchio {adapter.engine.version}, four contacts, {STEPS} steps of {TIMESTEP_S} s; median of {TURNS} turns, range")
    for name, (velocity, spin) in MOTIONS.items():
        state = State((0.0, 0.0, HEIGHT), velocity=velocity, angular_velocity=(0.0, 0.0, spin))
        scene = Scene(Body(MASS, MOMENTS, BRICK), state, GRAVITY, Plane(FRICTION, "corners"))
        times = []
        for _ in range(TURNS):
            simulation = adapter.prepare([scene], Method.parse("admm", TIMESTEP_S))
            instants, ends = [time.perf_counter()], []
            for tuned in (False, True):
                ends.append(naive(state, tuned))
                instants.append(time.perf_counter())
            row = simulation.advance(np.array([STEPS]))[0, 0, 0]
            instants.append(time.perf_counter())
            assert np.abs(row[:3] - ends).max() < AGREEMENT_M, name
            times.append(np.diff(instants) / STEPS)
        first, same, ours = np.array(times).T
        print(f"{name}: {statistics.median(ours) * 1e6:.1f} us per step")
        for script, cost in (("script", first), ("with the adapter's settings", same)):
            ratios = ours / cost
            print(f"  {script:27} {statistics.median(cost) * 1e6:5.1f} us, adapter / script ", end="")
            print(f"{statistics.median(ratios):.3f} ({ratios.min():.3f} - {ratios.max():.3f})")


if __name__ == "__main__":
    main()

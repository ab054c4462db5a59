"""The adapter of Exudyn, a C++ engine of flexible multibody dynamics that computes in double precision.

The module `engine` is the adapter, `formulations` has the coordinates of the body's rotation, `stepping` has the settings and
the loop of the solvers, and `contact` has the contacts of a brick. A call takes many steps in C++.

The integrators are Exudyn's dynamic solvers: explicit Runge-Kutta methods (`ExplicitEuler`, `ExplicitMidpoint`, `RK33`, `RK44`,
`RK67`, `ODE23`, `DOPRI5`) and `VelocityVerlet`, and the implicit `GeneralizedAlpha`, which is Exudyn's default, and
`TrapezoidalIndex2`. `ODE23` and `DOPRI5` choose their steps by default, and here with the option `accuracy`, which is both the
relative and the absolute tolerance, since Exudyn's defaults of the two are equal (1e-8). The time step is then the largest
step, and a step ends at each sample. Exudyn does not count evaluations. No implicit solver has error control ("no automatic
step size for implicit solvers available"). On a plane the option is missing, because the stiffness of contacts depends on the
time step; so does the speed below which dry friction of a joint is proportional to the velocity. `DVERK6` is in Exudyn's list,
but no solver of 1.13 accepts it. Generalized alpha with `useNewmark` is the trapezoidal rule, and so is generalized alpha with
a spectral radius of 1: their states were the same, so that Newmark is not a separate method. Exudyn calls `VelocityVerlet` a
method of order 2 under development; rotation and drag depend on velocities, and with them its order is 1.

The option `formulation` selects the coordinates of the rotation:

- `RotVecLG`, the rotation vector on the Lie group (Holzinger, Arnold and Gerstmayr 2023, doi 10.21203/rs.3.rs-2715112/v1); the
  default here with all solvers. The velocities are the angular velocity in the body frame. A body at rest that starts to turn
  by less than 1e-8 rad a step does not turn at all, because of how Exudyn composes rotations.
- `EP`, Euler parameters, with their norm as an algebraic constraint, for implicit solvers alone; the default of Exudyn's own
  functions that create bodies, and here with `settings=engine`. `GeneralizedAlpha` keeps the norm in every step.
  `TrapezoidalIndex2` constrains only the rate of the norm, so that the norm drifts.
- `Rxyz`, angles about x, y and z. In gimbal lock errors are of order one, or the solver stops.

The linear velocity is in the world frame. Euler parameters are normalised here; the other formulations have no quaternions.
Drag is a force that Exudyn evaluates in every stage of a step, so that every solver keeps its order; a Python function computes
it, which takes most of the time of a step.

The halving of steps in which Newton's method fails and adaptive steps are switched off. Numerical damping of `GeneralizedAlpha`
is switched off (the spectral radius is 1) if the system has no algebraic constraints. With them it is Exudyn's default (0.9),
because Exudyn's documentation says: "for position-level constraints (index 3), spectralRadius must be < 1". Such constraints
are links that are welded, jointed bodies, loops, and the norm of Euler parameters. `GeneralizedAlpha:settings=engine` has
Exudyn's defaults: Euler parameters, a spectral radius of 0.9, halved steps, modified Newton, and on a plane friction that is
proportional to the velocity below 1 mm/s. In all other methods this speed is the smallest speed for which no step reverses the
sliding, and Newton's method is full instead of modified. Exudyn computes the Jacobian of the modified method again whenever it
is called again, so that states depend on where they are sampled, by 3e-4 rad in 10 s of the flip at 10 ms. The tolerances of
Newton's method are Exudyn's, and limit implicit solvers to errors of some 1e-6 rad in a second.

Each link has a node at the origin of its frame. Links are welded by Exudyn's generic joint with all axes locked, which is a
constraint: explicit solvers refuse it. `GeneralizedAlpha` applies it to positions, and `TrapezoidalIndex2` to velocities. In
both, the constraint costs an error of second order.

A mechanism is a kinematic tree in the coordinates of its joints (module `kinematic_trees`) if its joints are turning, sliding,
planar, universal and fixed joints that connect all bodies to the world. All solvers step it, with armature, springs, damping
and efforts, and each has its claimed order on the scenes here, except `VelocityVerlet`, which is of order 1 if forces depend on
velocities. Dry friction is proportional to the velocity below a speed that vanishes with the step, so that a joint under load
creeps instead of being held. Every other mechanism, with ball joints or free bodies, consists of bodies that constraints hold
together (`jointed_bodies`). Implicit solvers step it with order 2; it has no armature and no dry friction. A loop is a
constraint too: on positions in `GeneralizedAlpha`, where its gap is rounding, and on velocities in `TrapezoidalIndex2`, where
the gap grows with the square of the step. Loops may be redundant, so the solver is set to accept a singular Jacobian.

A brick that lies on a plane has a `GeneralContact` at its four corners; the module `contact` describes its stiffness. A
cylinder has no contact. Spheres and bricks that touch in any other way have contacts of spheres (module `touching`), in the
implicit solvers alone. There, the halving of steps is left on.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation("exudyn")

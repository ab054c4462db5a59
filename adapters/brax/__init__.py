"""The adapter of Brax, a JAX engine whose authors no longer develop its physics, in double precision on the CPU.

The methods are the pipelines of Brax, each of which has one integrator:

- `generalized` computes accelerations in the coordinates of a free joint and takes a semi-implicit Euler step. The inverse of
  the mass matrix is updated by ten Newton-Schulz iterations, the engine's default. Contacts are those of MuJoCo's pyramidal
  cones, solved by a hundred steps of projected gradients. These do not converge for coefficients of friction below some 0.2,
  with which a body is braked too little.
- `positional` is position-based dynamics: velocities are differences of positions over a step.
- `spring` resolves contacts by impulses in the velocities.

Bodies that touch in any other way than flat on a level plane are not modelled: the authors of Brax no longer develop its
physics.

The pipeline `mjx` is not offered, because it calls the step of MJX, which has its own adapter.

`positional` and `spring` have no gyroscopic torque: without a torque they keep the angular velocity constant in the world
frame, so that a body tumbles like a sphere, and their attitude does not converge as the time step becomes small. `positional`
computes the angular velocity from the sine of half the rotation of a step, so that it decays. Its friction compares an impulse
with a speed, so that friction grows with the mass of the body and agrees with Coulomb's law for a single mass only. Both
pipelines compute the impulse of each contact as if it were the only one, and apply the mean of these impulses.

Brax reads MuJoCo's XML, also for robot models (module `robots`), and edits it before MuJoCo compiles it. It has damping,
sleeping and substeps only if a model sets them. The models here set none of them, so that there is no method with other
settings. Double precision (JAX_ENABLE_X64) shows the error of the schemes; without it, Brax computes in single precision,
JAX's default.

A pipeline accepts no external forces except the forces of actuators of joints. Gravity is an argument of a step. For a single
body, a force at the centre of mass is equivalent to a change of gravity, so drag is added to gravity.

The positions, attitudes and velocities of links are all in the world frame; the initial angular velocity, a coordinate of the
free joint, is in the body frame. All pipelines normalise the quaternion in each step. Brax does not model the contact of a
cylinder with a plane. It gives no warnings: a run that diverges ends with states that are NaN.

A single link may have its centre of mass and its principal axes anywhere. Several links are refused: Brax copies the XML
elements of a body without a joint into its parent without changing their poses, and MuJoCo refuses a body with two elements of
inertia. If the centre of mass is off the origin, the acceleration of `generalized` contains the error of its inverse of the
mass matrix, which is above rounding at time steps of a few milliseconds, and below rounding at smaller time steps.

Mechanisms are for `generalized`: trees of revolute, prismatic, universal and planar joints, of first order, with damping and
springs at the start of a step; the module `mechanisms` describes how they are built. A slide on a body that turns is refused,
because Brax moves the body along a rotating axis but computes inertia and forces with a fixed one. The other pipelines enforce
joints by iterations.

The module `sensing` reads what a state has for sensors.

Several scenes are stepped together (`jax.vmap`); their states differ from the states of each scene alone by rounding.

XLA compiles the steps for each pipeline and kind of scene when the first simulation of this kind is built in a process, which
takes seconds. The compiled code is kept in the engine's environment.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation(
    "brax",
    variables={
        "JAX_PLATFORMS": "cpu",
        "JAX_ENABLE_X64": "true",
        "JAX_COMPILATION_CACHE_DIR": "{environment}/jax-cache",
    },
    modules=("brax", "jax", "mujoco"),
)

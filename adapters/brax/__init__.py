"""The adapter of Brax, a JAX engine whose authors no longer develop its physics, in double precision on the CPU.

The methods are the pipelines of Brax, each of which has one integrator:

- `generalized` computes accelerations in the coordinates of a free joint and takes a semi-implicit Euler step. The inverse of
  the mass matrix is updated by ten Newton-Schulz iterations, the engine's default. Contacts are those of MuJoCo's pyramidal
  cones, solved by a hundred steps of projected gradients. These do not converge for coefficients of friction below some 0.2,
  with which a body is braked too little.
- `positional` is position-based dynamics: velocities are differences of positions over a step.
- `spring` resolves contacts by impulses in the velocities.

The pipeline `mjx` is not among them, because it calls the step of MJX, which has an adapter of its own.

`positional` and `spring` know no gyroscopic torque: they keep the angular velocity in the world frame where there is no
torque, so that a body tumbles like a sphere, and their attitude does not converge as the time step becomes small. In
`positional` the rate is taken from the sine of half the turn of a step, and decays. Its friction compares an impulse with a
speed, so that it grows with the mass of the body, and is that of Coulomb's law for one mass alone. Both pipelines compute the
impulse of each contact as if it were the only one, and apply their mean.

Brax reads MuJoCo's XML, robot models too (the module `robots`), which it edits before MuJoCo compiles it. It has no damping,
no sleeping and no substeps unless a model asks for them, and none is asked for, so that there is no method with other
settings. Double precision (JAX_ENABLE_X64) shows the error of the schemes; Brax is used in the single precision of JAX
otherwise.

A pipeline takes no force from outside except those of actuators of joints. Gravity is an argument of a step, and for one body a
force at the centre of mass is a change of gravity, so drag is given to a step in that way.

The positions, attitudes and velocities of links are all in the world frame; the angular velocity at the start, in the
coordinates of a free joint, is in the body frame. All pipelines normalise the quaternion in each step. Brax models no contact
of a cylinder with a plane. It gives no warnings: a run that diverges ends in states that are not numbers.

One link may have its centre of mass and its principal axes anywhere. Several are refused: Brax moves the content of a body
without a joint into its parent as text, where two elements of inertia are one too many for MuJoCo, and it moves none of
them. The acceleration of `generalized` then contains the error of its inverse of the mass matrix, which with a centre of
mass off the origin is above rounding at time steps of a few milliseconds, and below it with smaller ones.

Mechanisms are for `generalized`: trees of revolute, prismatic, universal and planar joints, of first order, with damping and
springs at the start of a step; the module `mechanisms` says with what. A slide on a body that turns is refused, since Brax
moves the body along an axis that turns and computes with one that does not. The other pipelines hold joints by iterations.

Several scenes are stepped together (`jax.vmap`), and differ from each alone by roundings.

XLA compiles the steps of each pipeline and kind of scene, which takes seconds, when the first simulation of that sort is built
in a process. The code is kept in the engine's environment.
"""

from bodycheck.adapters.installation import Installation

#: What the engine is installed from.
INSTALLATION = Installation(
    "brax",
    variables={
        "JAX_PLATFORMS": "cpu",
        "JAX_ENABLE_X64": "true",
        "JAX_COMPILATION_CACHE_DIR": "{environment}/jax-cache",
    },
    modules=("brax", "jax", "mujoco"),
)

"""The adapter of MJX, which is MuJoCo written in JAX, in double precision on the CPU.

The module `engine` is the adapter, whose parts for either precision are in `adapter`. `simulation` and `touching` build and
step models, `compiled` has the loop of steps that JAX compiles, and `sensing` reads MJX's sensors. The adapter in single
precision, `bodycheck.adapters.mjx32`, shares these modules: JAX fixes its precision when a process begins, so that each
precision is a separate engine.

MJX reads MuJoCo's model. The XML is that of the adapter of MuJoCo, with a free joint for a body in flight, and MuJoCo's own
contact for a body on a plane. The methods are the integrators of MJX:

- `Euler` is semi-implicit Euler in the velocities of the free joint.
- `RK4` is the classical Runge-Kutta scheme, whose final rotation follows the mean of the velocities of the stages. For a
  tumbling body it is of fourth order in the angular velocity and of second order in the attitude, as MuJoCo's RK4 was before
  version 4.
- `implicitfast` treats damping and actuators implicitly. A body without them takes the same steps as with `Euler`, because the
  derivative of the gyroscopic torque, which MuJoCo includes, is not part of MJX.

Nothing has to be switched off: MJX has no damping, no sleeping, no limits of speed and no substeps of its own, so that there is
no method with other settings. The parameters of contact are the engine's own.

Drag is a force (`xfrc_applied`) that is computed at the start of each step and kept for the step, also by RK4, so that
every method is of first order with drag. This order is that of the adapter, not of MJX, which has no callback for forces
that depend on the state of a stage, as MuJoCo and MuJoCo Warp have. MJX evaluates its own forces in every stage.
`drag=fluid` selects MuJoCo's fluid model as in the adapter of MuJoCo; MJX does not have it with `implicitfast`.

A free joint has the position and the velocity of the centre of mass in the world frame, a quaternion w x y z, and the angular
velocity in the body frame. MJX normalises the quaternion in each step. It gives no warnings: a run that diverges ends with
states that are NaN.

Links are those of the adapter of MuJoCo, which compiles the model.

Bodies that touch in any other way than flat on a level plane are those of the adapter of MuJoCo (module `touching`). MJX has
rows for all contacts of all pairs of shapes in every step, so that several bodies take long to compile and to step. It refuses
pairs of a cylinder and a brick. The torque of a push beside the centre of mass is computed at the start of each step.

Mechanisms are those of the adapter of MuJoCo; MuJoCo computes the poses of bodies from MJX's coordinates. `RK4` is of fourth
order on hinges and slides, and of second order on ball joints. Damping is that at the end of a step with `Euler` and
`implicitfast`. A loop is as soft as MuJoCo's default constraint: its gap does not vanish with the time step. It lacks the
centripetal and Coriolis acceleration that MuJoCo 3.7.0 added to this constraint. Compiling the steps of a mechanism takes a
minute or more.

MuJoCo's compiler reads robot models. The module `robots` reads the numbers that MJX keeps, and finds the models that it
refuses.

Several scenes are stepped together (`jax.vmap`); their states differ from the states of each scene alone by rounding. The steps
are compiled again for each number of scenes.

XLA compiles the steps for each integrator and kind of scene when the first simulation of this kind is built in a process, which
takes seconds. The compiled code is kept in the engine's environment.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine.
INSTALLATION = Installation(
    "mujoco-mjx",
    variables={
        "JAX_PLATFORMS": "cpu",
        "JAX_ENABLE_X64": "true",
        "JAX_COMPILATION_CACHE_DIR": "{environment}/jax-cache",
    },
    modules=("jax", "mujoco"),
)

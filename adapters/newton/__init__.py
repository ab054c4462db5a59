"""The adapter of Newton, whose solvers run on the CPU device of NVIDIA's Warp, in single precision.

The module `engine` is the adapter, `solvers` lists Newton's solvers of rigid bodies, and `sensing` reads sensors. A step is
recorded once as a graph of kernels, which Warp replays in C++ (`bodycheck.adapters.mujoco_warp.graphs`).

The methods have the names of the solvers without the word `Solver`:

- `SemiImplicit`, `XPBD`, `VBD`: each body has six coordinates. Euler's semi-implicit method; XPBD and VBD add to it their
  iterations for contacts and joints, 2 and 10 by default. XPBD has them as the option `iterations`, and the option `relaxation`
  sets both of its factors for the impulses of joints.
- `Featherstone`, `Steel`: a tree of joints, here one free joint. Euler's semi-implicit method.
- `Kamino-euler`, `Kamino-moreau`: the solver Kamino with one of its schemes. The option `dynamics_solver` selects how it solves
  for contacts, by default `padmm`. Moreau's scheme needs Kamino's own collision detection, which cannot be built without a pair
  of shapes: it is offered only on a plane.
- `MuJoCo-euler`, `-rk4`, `-implicit`, `-implicitfast`, `-discrete`: the model is passed to MuJoCo Warp, in the version that
  Newton requires. Newton 1.8 requires 3.17, in which `rk4` is of second order, as it was in MuJoCo before 4.0.

Style3D and ImplicitMPM move particles, not rigid bodies, and the coupled solvers consist of the solvers above.

Bodies that roll, bounce or bear each other are for the solvers MuJoCo and XPBD; the module `touching` describes their contacts.

Several scenes are worlds of one model. With every solver except `lox`, the states of each scene are to the last bit the same as
if it were alone. With `lox`, scenes affect each other, so that they are stepped one after another.

The damping of rotation that `SemiImplicit` and `Steel` have by default, 0.05 / s, is switched off; `settings=engine` keeps it.
`Featherstone` accepts the same argument but ignores it, and the other solvers do not have it. Nothing else has to be switched
off: speeds are not limited, no body sleeps, and there are no substeps. The stiffness, the damping and the regularised friction
of contacts are Newton's own.

Two solvers have limits that are visible in the cases. VBD computes velocities from differences of poses: a rotation w loses the
fraction (w h)^2 / 12 in each step h, and far from the origin, where single precision has few digits for a difference of
positions, errors grow when the time step gets smaller. After a fall of 8 s they are 3 m with h = 2 ms, and 12 m with 1 ms.
Featherstone loses the digits of the rotation of a free body far from the origin, for a cause that is not known: the spin of a
brick is wrong in the second digit at 100 m and NaN at 300 m, and the brick of the case `free-brick`, which falls, ends as NaN
after 7.5 s.

Links are joined by fixed joints. Users may merge links before (`ModelBuilder.collapse_fixed_joints`); the adapter does not.
`SemiImplicit` holds a fixed joint by springs and dampers: light links need time steps below a millisecond, and then move as one
body only to some milliradians, however small the time step. `XPBD` does not conserve the angular momentum of two welded links:
it scales the impulse of a joint by 0.7 and the torque of this impulse by 0.4 (`joint_linear_relaxation`,
`joint_angular_relaxation`), whatever the time step. `relaxation=1` sets both to 1; what is then lost falls with the step. `VBD`
and `Kamino` hold the joint by iterations, with an error that vanishes with the time step. `Featherstone` and `Steel` remove the
joint's degrees of freedom and step the velocity of the first link's centre of mass; the solver of MuJoCo steps the velocity of
the origin of the first link's frame. If this point is not the centre of mass of the whole body, steps have an error of the
scheme's order, even without forces. With `settings=engine`, `Steel` damps the rotation of two links about the centre of mass of
the first link, which changes their momentum.

Mechanisms are for the solvers in the coordinates of joints, `Featherstone`, `Steel` and the MuJoCo solvers, all of first order
except `MuJoCo-rk4`, and for `XPBD`, whose relaxation takes energy from joints at any time step. Bodies are added in the order
of their joints, depth first: `Featherstone` of 1.8 reads the inertia of a joint's body by the number of the joint, so that
bodies in another order have each other's inertias. Newton's importers have this order too, by default. `Featherstone` has no
dry friction of joints, `Steel` has neither dry friction nor springs, and `XPBD` has neither of them, nor armature or damping.
`Featherstone` and `Steel` evaluate damping at the start of a step. The other solvers are not offered for mechanisms:
`SemiImplicit` holds joints by springs and diverged with steps of 4 ms, and `VBD` and `Kamino` were not tried. Loops are not
modelled.

With `relaxation=1` the velocities of a chain of joints jump at some instant, whatever the time step, and earlier where the
frames of joints are turned in their parents; with Newton's own factors they do not (claim `newton/xpbd_chain`).

When Newton finalises a model it checks and corrects masses and inertias, which the adapter switches off
(`skip_validation_inertia`): its bodies have the inertias of the case, also where one moment is nearly the sum of the others.
What Newton does to the inertias of robot models by default is in the module `robots` and in the results of `bodycheck parity`.

Drag is one of the passive forces of the MuJoCo solvers, which evaluate it at each stage of a step. For the other solvers it is
a force on the centre of mass that is computed from the state at the beginning of a step and held through it, so that their
order against drag is that of the adapter. On a plane, Newton's collision detection runs before each step, except for MuJoCo and
Moreau's scheme.

A pose of Newton is position and quaternion x y z w; a twist is the velocity of the centre of mass and then the angular
velocity, both in the world frame. Kamino's quaternion drifts from norm 1 by some 1e-8 in a step, and is normalised here; all
other solvers normalise it themselves.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine. Compiling the kernels of all solvers takes minutes, so they are kept.
INSTALLATION = Installation(
    "newton", extras=("sim",), variables={"WARP_CACHE_PATH": "{environment}/warp-cache"}, modules=("newton", "warp")
)

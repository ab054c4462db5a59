"""The adapter of MuJoCo Warp, which computes MuJoCo's steps in single precision by the compiled kernels of NVIDIA's Warp.

The module `engine` is the adapter, and `graphs` records the kernels that a step starts as a graph, which Warp replays in C++.
The module `sensing` reads its sensors. All runs on the CPU device of Warp.

The methods are the integrators of MuJoCo Warp, which have MuJoCo's names. A scene is the same MJCF as in the adapter of MuJoCo,
compiled by the MuJoCo that is installed with it. Nothing has to be switched off: the MJCF has no damping, and by default MuJoCo
Warp neither limits speeds nor lets bodies sleep, so there is no method with the engine's own settings.

Drag is a kernel that is added to MuJoCo's own passive forces, so that every integrator evaluates it with all other forces. A
body on a plane touches it by MuJoCo's soft contact, with the options of the adapter of MuJoCo except pads and noslip. MuJoCo
Warp raises a tolerance of the constraint solver below 1e-6 to this value, and has no reset after a bad state: such a run ends
with states that are not numbers.

Bodies that touch in any other way than flat on a level plane are those of the adapter of MuJoCo; the module `touching` reserves
the memory for their contacts, and adds pushes to the passive forces.

Links are those of the adapter of MuJoCo, which compiles the model.

Coordinates and frames are MuJoCo's: position (world), quaternion w x y z, velocity (world), angular velocity (body). MuJoCo
Warp normalises the quaternion in every step, to the rounding of single precision.

MuJoCo's compiler reads robot models. The module `robots` returns the numbers that MuJoCo Warp keeps, and the terms that it
computes.

Mechanisms, including loops, are those of the adapter of MuJoCo. MuJoCo computes the poses of bodies from the coordinates after
a step.
"""

from bodycheck.adapters.installation import Installation

#: The packages that install the engine. Compiling the kernels of the first model takes up to a minute, so they are kept.
INSTALLATION = Installation(
    "mujoco-warp", variables={"WARP_CACHE_PATH": "{environment}/warp-cache"}, modules=("mujoco", "mujoco_warp", "warp")
)

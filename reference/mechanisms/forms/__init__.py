"""Motions of mechanisms in closed form: nothing is integrated, so that every instant has the same cost and the same accuracy.

- `choice`: open this first. `form_of` returns the closed form of a mechanism, if there is one.
- `oscillator`: one joint with armature, damping, spring, constant effort and dry friction.
- `../driven/`: one joint with a controller or with stops.
- `pendulum`: the compound pendulum at any amplitude.
- `parallelogram`: linkages of parallelograms, which move as one pendulum.
- `ball`: a body on a ball joint, which is free of torque or a top. `top`: Lagrange's top and the spherical pendulum.
- `carlson`: the elliptic integral of the third kind in the wide type.
- `momentum`: the centre of mass of a chain that floats freely, and its momenta.
- `ground`: the rigid body that each joint on the world carries.
- `motion`: the result of a closed form, with bounds of its errors.
"""

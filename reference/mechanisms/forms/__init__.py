"""Motions of mechanisms in closed form: nothing is integrated, so that every instant has the same cost and the same accuracy.

- `choice`: open this first. `form_of` gives the closed form of a mechanism that has one.
- `oscillator`: one joint with armature, damping, spring, constant effort and dry friction.
- `pendulum`: the compound pendulum at any amplitude.
- `parallelogram`: linkages of parallelograms, which move as one pendulum.
- `ball`: a body on a ball joint, which feels no torque or is a top. `top`: Lagrange's top and the spherical pendulum.
- `carlson`: the elliptic integral of the third kind in the wide type.
- `momentum`: the centre of mass of a chain that floats freely, and its momenta.
- `ground`: what each joint on the world carries, and its inertia.
- `motion`: the motion that a form gives, with its bounds.
"""

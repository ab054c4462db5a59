"""Texts of case files of mechanisms."""

#: A cart on a rail, and a pole that is hinged to it.
CART_POLE = """\
format = 2
name = "cart-pole"
title = "A pole on a cart"

[[bodies]]
name = "cart"
mass = 2.3
inertia = [0.1, 0.1, 0.1]

[[bodies]]
name = "pole"
mass = 0.4
center_of_mass = [0.0, 0.0, 0.35]
inertia = [0.016, 0.017, 0.001]

[[joints]]
name = "rail"
type = "prismatic"
child = "cart"
axis = [1.0, 0.0, 0.0]
initial = {position = 0.0, velocity = 0.5}

[[joints]]
name = "pin"
type = "revolute"
parent = "cart"
child = "pole"
position = [0.0, 0.0, 0.1]
axis = [0.0, 1.0, 0.0]
armature = 0.0
damping = 0.0
stiffness = 0.0
rest = 0.0
friction = 0.0
effort = 0.0
initial = {position = 0.3, velocity = 0.0}

[scene]
gravity = 9.81

[run]
duration = 4.0
samples = 81
"""

#: Every type of joint and every way to give an inertia: chains from the world and from a free body, and a loop.
ALL_JOINTS = """\
format = 2
name = "all-joints"
title = "All that the grammar of mechanisms has"
source = "nobody"
tags = ["mechanism"]

[[bodies]]
name = "brick"
shape = "brick"
semi_axes = [0.1, 0.2, 0.3]
mass = 1.0
center_of_mass = [0.0, 0.0, -0.3]

[[bodies]]
name = "parts"
parts = [
    {shape = "sphere", radius = 0.1, mass = 1.0, position = [0.5, 0.0, 0.0]},
    {shape = "cylinder", radius = 0.1, half_length = 0.2, mass = 2.0, euler_zxz = [0.0, 1.0, 0.0]},
]

[[bodies]]
name = "particles"
particles = [{mass = 1.0, position = [0.0, 0.0, 1.0]}, {mass = 1.0, position = [0.0, 1.0, 0.0]}]

[[bodies]]
name = "tensor"
mass = 1.0
inertia = [[1.0, 0.1, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1.0]]

[[bodies]]
name = "point"
mass = 0.5
center_of_mass = [0.0, 0.0, 0.5]
inertia = [0, 0, 0]

[[bodies]]
name = "hub"
shape = "sphere"
radius = 0.2
mass = 3

[[bodies]]
name = "satellite"
shape = "cylinder"
radius = 0.5
half_length = 0.1
mass = 5.0
initial = {position = [5.0, 0.0, 1.0], euler_zxz = [0.1, 0.2, 0.3], euler_rates = [0.0, 0.1, 1.0], velocity = [0.0, 1.0, 0.0]}

[[bodies]]
name = "boom"
shape = "ellipsoid"
semi_axes = [0.1, 0.1, 0.5]
mass = 0.3

[[joints]]
name = "universal"
type = "universal"
child = "brick"
position = [1.0, 2.0, 3.0]
quaternion = [0.8, 0.0, 0.6, 0.0]
initial = {position = [0.2, -0.4], velocity = [1.0, 2.0]}

[[joints]]
name = "ball"
type = "spherical"
parent = "brick"
child = "parts"
damping = 0.01
initial = {quaternion = [0.6, 0.0, 0.8, 0.0], velocity = [0.1, 0.2, 0.3]}

[[joints]]
name = "sheet"
type = "planar"
parent = "world"
child = "particles"
euler_zxz = [0.0, 0.5, 0.0]
initial = {position = [0.1, 0.2, 0.3], velocity = [1.0, -1.0, 0.5]}

[[joints]]
name = "float"
type = "free"
child = "tensor"
initial = {position = [1.0, 0.0, 0.0], quaternion = [1, 0, 0, 0], velocity = [0.0, 0.0, 1.0], linear = [0.5, 0.0, 0.0]}

[[joints]]
name = "weld"
type = "fixed"
parent = "tensor"
child = "hub"
position = [0.0, 0.3, 0.0]

[[joints]]
name = "hinge"
type = "revolute"
parent = "hub"
child = "point"
axis = [0.0, 3.0, 4.0]
friction = 0.01

[[joints]]
name = "slide"
type = "prismatic"
parent = "satellite"
child = "boom"
axis = [0.0, 0.0, 2.0]
stiffness = 10.0
rest = 0.1
armature = 0.2
damping = 0.5
effort = -0.3

[scene]
gravity = 1.6

[run]
duration = 1.0
samples = 11
"""

#: A parallelogram of three bars on the ground, closed by a loop.
FOUR_BAR = """\
format = 2
name = "four-bar"
title = "A parallelogram"
bodies = [
    {name = "left", mass = 1.0, center_of_mass = [0.0, 0.0, 0.5], inertia = [0.1, 0.1, 0.0]},
    {name = "top", mass = 1.0, center_of_mass = [0.5, 0.0, 0.0], inertia = [0.0, 0.1, 0.1]},
    {name = "right", mass = 1.0, center_of_mass = [0.0, 0.0, 0.5], inertia = [0.1, 0.1, 0.0]},
]
loops = [{bodies = ["top", "right"], points = [[1, 0, 0], [0, 0, 1]]}]
run = {duration = 1.0, samples = 11}

[[joints]]
name = "a"
type = "revolute"
child = "left"
axis = [0, 1, 0]
initial = {position = 0.3, velocity = 1.0}

[[joints]]
name = "b"
type = "revolute"
parent = "left"
child = "top"
position = [0, 0, 1]
axis = [0, 1, 0]
initial = {position = -0.3, velocity = -1.0}

[[joints]]
name = "c"
type = "revolute"
child = "right"
position = [1, 0, 0]
axis = [0, 1, 0]
initial = {position = 0.3, velocity = 1.0}
"""

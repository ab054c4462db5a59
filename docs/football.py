"""Print the tables of docs/football.md: the effect of a wobble on a football. Run: python docs/football.py"""

import math
from dataclasses import replace

import numpy as np

from bodycheck import load, truth
from bodycheck.reference.chapter.wobble import cone_angle, largest_wobble
from bodycheck.reference.kinematics import rotate

WOBBLES_RAD_S = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0)

#: Relative differences between the two cross moments.
CROSS_MOMENT_EXCESSES = (0.0, 0.001, 0.01, 0.03, 0.1)


def main() -> None:
    case = load("football-spiral")
    spin = case.scene.initial.angular_velocity[2]
    a, b, c = case.scene.body.moments

    print("| wobble, rad/s | angle between axis and angular momentum | largest swing of the axis in flight |")
    print("| --- | --- | --- |")
    for wobble in WOBBLES_RAD_S:
        state = replace(case.scene.initial, angular_velocity=(wobble, 0.0, spin))
        flight = truth(replace(case, scene=replace(case.scene, initial=state))).trajectory
        axis = rotate(flight.quaternion, np.tile([0.0, 0.0, 1.0], (len(flight), 1)))
        swing = math.degrees(np.arccos(np.clip(axis @ axis[0], -1, 1)).max())
        print(f"| {wobble:g} | {math.degrees(cone_angle((a, b, c), spin, wobble)):.1f}° | {swing:.1f}° |")

    print()
    print("| one cross moment larger by | wobble that ends the spiral, rad/s | as a multiple of the spin |")
    print("| --- | --- | --- |")
    for excess in CROSS_MOMENT_EXCESSES:
        limit = largest_wobble((a * (1 + excess), b, c), spin)
        print(
            f"| {excess:.1%} | {limit:.1f} | {limit / spin:.2f} |"
            if math.isfinite(limit)
            else f"| {excess:.1%} | none does | – |"
        )


if __name__ == "__main__":
    main()

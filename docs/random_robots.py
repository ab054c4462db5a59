"""Write random robots as URDF files: branched chains of links, about a third of them welded, each in a frame of its own.

Run: python docs/random_robots.py FOLDER [--turned]

With --turned, the inertia of each link is written along axes that are turned against the frame of the link.
"""

import argparse
from pathlib import Path
from random import Random

from bodycheck.robots.urdf_text import urdf
from tests.support.robot_trees import random_rotation, random_tree

#: The number of robots, the most joints of one, and the seed.
ROBOTS, MOST_JOINTS, SEED = 100, 30, 23


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--turned", action="store_true")
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    random, turns = Random(SEED), Random(SEED + 1)
    for number in range(ROBOTS):
        robot = random_tree(random, random.randint(1, MOST_JOINTS))
        axes = {link.name: random_rotation(turns) for link in robot.links} if asked.turned else {}
        (asked.folder / f"tree-{number:03}.urdf").write_text(urdf(robot, axes), "utf-8")


if __name__ == "__main__":
    main()

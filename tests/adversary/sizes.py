"""How many attacks `make slow` makes. Each is a variable of the environment, which `make slow NAME=number` sets."""

import os
from itertools import pairwise

#: Case files to load, of which the accepted ones get a truth; case files to run; folders and baselines to damage; kills;
#: truths to judge, of mechanisms with dry friction, trees as robots have them, driven mechanisms, sensors of trees,
#: bodies that touch, spheres that hit each other, and bodies between fingers.
DEFAULTS = {
    "FILES": 100_000,
    "RUNS": 2_000,
    "FOLDERS": 1_000,
    "KILLS": 100,
    "MECHANISMS": 500,
    "TREES": 300,
    "DRIVEN": 200,
    "SENSORS": 200,
    "CONTACTS": 500,
    "IMPACTS": 300,
    "GRIPS": 100,
}

#: The seed of the first attack.
SEED = int(os.environ.get("SEED") or 1)

Batch = tuple[int, int]


def size(name: str) -> int:
    """How many attacks of a kind are asked for."""
    return int(os.environ.get(name) or DEFAULTS[name])  # make passes on what is not set as an empty text


def batches(name: str, count: int = 8) -> list[Batch]:
    """First seeds and numbers of attacks of at most so many tests, which together make all that are asked for."""
    edges = [round(size(name) * part / count) for part in range(count + 1)]
    return [(SEED + low, high - low) for low, high in pairwise(edges) if high > low]

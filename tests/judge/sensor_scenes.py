"""Sensors of each type that a tree can have, drawn from a seed, and the verdicts on the truths of their readings."""

import random
import tomllib
from pathlib import Path
from typing import Any

import bodycheck
from bodycheck.reference.sensors.truth import sensor_truth
from tests.judge import sensors, tree_scenes
from tests.judge.documents import written
from tests.judge.numerals import exact
from tests.judge.verdicts import Claim, Verdict, truth_of, verdict

#: The types with a place and axes.
MOUNTED = ("accelerometer", "gyroscope", "velocimeter")


def drawn(seed: int) -> tuple[str, str]:
    """Return the kind and the text of the case of a seed: a tree with a sensor of each type on each of two parts."""
    kind, text = tree_scenes.drawn(seed)
    chance = random.Random(f"sensors {seed}")
    document = tomllib.loads(text)
    tables: list[dict[str, Any]] = []
    for number in range(2):
        body = chance.choice(document["bodies"])["name"]
        for name in MOUNTED:
            place = {"position": tree_scenes.vector(chance, 0.5), "quaternion": tree_scenes.quaternion(chance)}
            tables.append({"name": f"{name}-{number}", "type": name, "body": body, **(place if number else {})})
        tables.append({"name": f"wrench-{number}", "type": "force_torque", "joint": chance.choice(document["joints"])["name"]})
    moving = [joint["name"] for joint in document["joints"] if joint["type"] != "fixed"]
    tables.append({"name": "effort", "type": "joint_effort", "joint": chance.choice(moving)})
    return kind, f"{text}\n{written({'sensors': tables})}"


def judge(seed: int, folder: Path) -> Verdict:
    """Return the verdict on the readings of the sensors of a seed."""
    kind, text = drawn(seed)
    truth = truth_of(text, folder)
    if isinstance(truth, str):
        return Verdict(seed, kind, 0.0, refused=truth)
    case = bodycheck.load(folder / "judged.case.toml")
    expected = sensors.readings(text, exact(truth.trajectory.t.tolist()))
    claims = []
    for sensor, true in zip(case.sensors, sensor_truth(truth, case.sensors), strict=True):
        if true.reason:
            return Verdict(seed, kind, 0.0, refused=f"{sensor.name}: {true.reason}")
        for index, reading in enumerate(expected[sensor.name]):
            for column, value, printed, bound in zip(
                sensor.columns, reading, true.values[index], true.bounds[index], strict=True
            ):
                what = f"{column} at instant {index}"
                claims.append(Claim(what, float(abs(exact(float(printed)) - value)), float(bound)))
    return verdict(seed, kind, claims)

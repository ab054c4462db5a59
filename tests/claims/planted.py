"""A record of a claim about a stone that falls in MuJoCo, in which tests plant faults."""

from pathlib import Path

RECORD = """\
sentence = "A stone falls {error} m too far with Euler, in a run that is {status}."
engine = "mujoco"
releases = ["4.0.0"]
kind = "default"
command = "bodycheck run CASE --engine mujoco --integrator Euler"
[wordings]
short = "0.001 m"
[values.error]
value = 9.81e-4
unit = "m"
shown = ".2e"
tolerance = 0.01
table = "results.csv"
row = {engine = "mujoco", integrator = "Euler", timestep = 0.002}
column = "position_error"
[values.status]
value = "ok"
table = "results.csv"
column = "status"
script = false
[[documentation]]
address = "https://mujoco.readthedocs.io"
says = "semi-implicit Euler"
[cause]
text = "The velocity of the end of a step is used for the whole step."
experiment = "The error is proportional to the step."
against = ["a", "b"]
"""

SCRIPT = '''\
"""Print by how much (m) a stone falls too far in 0.1 s."""

import mujoco

BODY = '<worldbody><body><freejoint/><geom size="0.1"/></body></worldbody>'
model = mujoco.MjModel.from_xml_string(f'<mujoco><option timestep="0.002"/>{BODY}</mujoco>')
data = mujoco.MjData(model)
mujoco.mj_step(model, data, 50)
print("error", -data.qpos[2] - 9.81 * 0.1**2 / 2)
'''

CASE = """\
format = 1
name = "stone"
title = "Stone that falls"
source = "exact"
[body]
shape = "sphere"
radius = 0.1
mass = 1.0
[initial]
velocity = [0.0, 0.0, 0.0]
[scene]
gravity = 9.81
[run]
duration = 0.1
samples = 11
"""


def plant(folder: Path, record: str = RECORD, script: str | None = SCRIPT) -> Path:
    """Write a record, its script unless that is None, and the case of its command, and return the path of the record."""
    (folder / "mujoco").mkdir(exist_ok=True)
    (case := folder / "stone.case.toml").write_text(CASE, "utf-8")
    path = folder / "mujoco" / "planted.toml"
    path.write_text(record.replace("CASE", str(case)), "utf-8")
    if script is not None:
        path.with_suffix(".py").write_text(script, "utf-8")
    return path

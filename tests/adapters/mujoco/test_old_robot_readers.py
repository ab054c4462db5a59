"""What releases of MuJoCo misread in robot models."""

import json
from pathlib import Path

import numpy as np
import pytest

from bodycheck.environments import environments, making
from bodycheck.environments.environments import Unobtainable
from tests.support.robot_texts import LIMIT, MIMIC, link, robot, written

#: Prints the last body of each of some files with its centre of mass and inertia, and the joints that mimic another one.
READ = """
import json, sys
from bodycheck.adapters.mujoco.robots import read_robot
from bodycheck.adapters.robot_reading import RobotFile
found = []
for path in sys.argv[1:]:
    reading = read_robot(RobotFile(path, "urdf"), [], (0.0, 0.0, -9.81))
    body = reading.bodies[-1]
    found.append([body.center_of_mass, body.inertia, [joint.name for joint in reading.joints if joint.mimic]])
print(json.dumps(found))
"""

QUARTER = "1.5707963267948966"
BODY = '<inertial><origin xyz="1 0 0" rpy="{turn} 0 0"/><mass value="1"/><inertia {inertia}/></inertial>'
ROUND = 'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"'
LONG = 'ixx="1" iyy="2" izz="3" ixy="0" ixz="0" iyz="0"'
HINGE = f'<joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{LIMIT}</joint>'
WELD = (
    f'<joint name="weld" type="fixed"><parent link="arm"/><child link="hand"/><origin xyz="0 0 0" rpy="0 0 {QUARTER}"/></joint>'
)

#: A body whose inertia is turned by its origin, one on which a turned one is welded, and a joint that mimics another one.
FILES = {
    "inertia": robot(link("base", ""), link("arm", BODY.format(turn=QUARTER, inertia=LONG)), HINGE),
    "weld": robot(link("base", ""), link("arm", ""), link("hand", BODY.format(turn=0, inertia=ROUND)), HINGE, WELD),
    "mimic": MIMIC,
}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "turns_inertia", "turns_welds", "mimics"),
    [("3.2.0", False, True, False), ("3.3.7", False, False, False), ("3.17.0", True, True, True)],
)
def test_a_release_reads_what_it_reads(
    version: str, turns_inertia: bool, turns_welds: bool, mimics: bool, tmp_path: Path
) -> None:
    try:
        environment = environments.obtain("mujoco", version)
    except Unobtainable as error:
        pytest.skip(str(error))
    folders = {name: tmp_path / name for name in FILES}
    for folder in folders.values():
        folder.mkdir()
    paths = [written(text, folders[name]).path for name, text in FILES.items()]
    done = making.run(environment.python, ["-c", READ, *paths], None, 60.0)
    assert done.returncode == 0, done.stderr
    (_, inertia, _), (center, _, _), (_, _, mimicking) = json.loads(done.stdout)
    # Releases before 3.14 find principal axes to about a millionth.
    np.testing.assert_allclose(inertia[:3], [1, 3, 2] if turns_inertia else [1, 2, 3], rtol=0, atol=1e-5)
    np.testing.assert_allclose(center, [0, 1, 0] if turns_welds else [1, 0, 0], rtol=0, atol=1e-9)
    assert mimicking == (["second"] if mimics else [])

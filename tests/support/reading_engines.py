"""Engines that read robot models, or fail to, for `tests.support.planted_engines`."""

from tests.support import ROOT

#: What engines do that read the file by bodycheck's own reader.
READS = f"""
import sys
sys.path.append({str(ROOT)!r})
from pathlib import Path
from bodycheck.reference.robots.model import with_joint
from bodycheck.robots import urdf
from tests.support.engine_readings import reading
def model_of(file):
    return urdf.read(Path(file.path).read_bytes(), "robot").model
"""

#: Engines, by their names.
ENGINES = {
    "faithful": READS + "def read_robot(file, states, gravity):\n    return reading(model_of(file), states)",
    "heavy": READS + "def read_robot(file, states, gravity):\n"
    "    return reading(with_joint(model_of(file), 'elbow', armature=0.1), states)",
    "picky": "from bodycheck.adapters.robot_reading import ModelRefused\n"
    "def read_robot(file, states, gravity):\n    raise ModelRefused('joint elbow is not to my taste')",
    "mjcf-only": "from bodycheck.adapters.robot_reading import FormatUnknown\n"
    "def read_robot(file, states, gravity):\n    raise FormatUnknown('there is no reader of URDF')",
    "dying": "import os\ndef read_robot(file, states, gravity):\n    os._exit(3)",
    "hanging": "import time\ndef read_robot(file, states, gravity):\n    time.sleep(600)",
    "illiterate": "",
    "overwriting": READS + "def read_robot(file, states, gravity):\n    model = model_of(file)\n"
    "    for path in Path(file.path).parent.iterdir():\n        path.write_bytes(b'<robot/>')\n"
    "    Path(file.path).with_name('more').mkdir()\n    return reading(model, states)",
    "segfaulting": "import os, signal\ndef read_robot(file, states, gravity):\n    os.kill(os.getpid(), signal.SIGSEGV)",
    "broken": "def read_robot(file, states, gravity):\n    return None.bodies",
    "brief": READS + "def read_robot(file, states, gravity):\n    return reading(model_of(file), states[1:])",
}

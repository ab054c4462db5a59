"""Judge truths: `python -m tests.judge mechanisms|contacts|impacts|gripping|rolling|trees|driven|sensors FIRST_SEED COUNT`."""

import sys
import tempfile
from pathlib import Path

from tests.judge import (
    contact_scenes,
    driven_scenes,
    gripping_scenes,
    impact_scenes,
    mechanism_scenes,
    rolling_scenes,
    sensor_scenes,
    tree_scenes,
)
from tests.judge.verdicts import judged

DRAWS = {
    "mechanisms": mechanism_scenes.judge,
    "contacts": contact_scenes.judge,
    "impacts": impact_scenes.judge,
    "gripping": gripping_scenes.judge,
    "rolling": rolling_scenes.judge,
    "trees": tree_scenes.judge,
    "driven": driven_scenes.judge,
    "sensors": sensor_scenes.judge,
}

if __name__ == "__main__":
    name, first, count = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        judged(DRAWS[name], int(first), int(count), Path(folder))

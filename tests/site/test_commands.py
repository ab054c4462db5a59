"""The commands that reproduce rows are commands of bodycheck, and name what the row is about."""

import shlex
from typing import Any

import pytest

from bodycheck.commands.command_line import app
from bodycheck.site.commands import MAKERS, command
from bodycheck.site.submissions.submission import Row
from bodycheck.site.submissions.tables import TABLES
from tests.site import submissions
from tests.site.submissions import CONTACT, FREE, submission

OWN = "a-case-of-ones-own"


def told(table: str, *rows: Row, **tables: list[Row]) -> str:
    """The command of the first row of a table."""
    own = submissions.case_files.load("free-brick").text.replace('name = "free-brick"', f'name = "{OWN}"')
    named = {f"{name}.csv": there for name, there in tables.items()}
    cases = {OWN: own} if any(row.get("case") == OWN for row in rows) else {}
    source = submission({table: list(rows), **named}, cases)
    row = source.tables[table][0]
    return command(source, table, row).replace(str(row.get("case")), str(rows[0].get("case")))


COMMANDS: list[tuple[str, Row, str]] = [
    ("results.csv", submissions.run(), f"run {FREE} --engine mujoco@4.0.0 --integrator Euler --timestep 0.002"),
    (
        "results.csv",
        submissions.run(integrator="Euler:cone=elliptic,solref=0.02 1", engine="mujoco@3.2.0", version="3.2.0"),
        f"run {FREE} --engine mujoco@3.2.0 --integrator 'Euler:cone=elliptic,solref=0.02 1' --timestep 0.002",
    ),
    (
        "results.csv",
        submissions.run(case=OWN, timestep=1e-5),
        f"run {OWN}.case.toml --engine mujoco@4.0.0 --integrator Euler --timestep 1e-05",
    ),
    (
        "tradeoff.csv",
        submissions.tradeoff(0.001),
        f"tradeoff {FREE} --engine mujoco@4.0.0 --integrator Euler --timestep 0.001",
    ),
    (
        "tradeoff.csv",
        submissions.tradeoff(0.001, batch=100),
        f"tradeoff {FREE} --engine mujoco@4.0.0 --integrator Euler --timestep 0.001 --batch 100",
    ),
    (
        "releases.csv",
        submissions.release("3.2.0"),
        f"releases mujoco 3.2.0 --case {FREE} --integrator Euler --timestep 0.002",
    ),
    (
        "changes.csv",
        submissions.change(),
        f"releases mujoco 3.17.0 4.0.0 --case {FREE} --integrator RK4 --timestep 0.001",
    ),
    ("contact.csv", submissions.contact(), f"run {CONTACT} --engine mujoco@4.0.0 --integrator Euler --timestep 0.002"),
    ("parity.csv", submissions.parity(), "parity panda --engine mujoco@4.0.0"),
    ("parity.csv", submissions.parity(model="my arm.urdf"), "parity 'my arm.urdf' --engine mujoco@4.0.0"),
    ("parity.csv", submissions.parity(engine="file", version=""), "parity panda"),
    ("audit.csv", submissions.audit(), "audit mujoco@4.0.0 --integrator Euler --timestep 0.002"),
    (
        "ensemble.csv",
        submissions.ensemble(),
        "ensemble ensemble-of-bricks --engine mujoco@4.0.0 --integrator Euler --timestep 0.002 --members 1000",
    ),
]


@pytest.mark.parametrize(("table", "row", "words"), COMMANDS)
def test_a_command_names_what_its_row_is_about(table: str, row: Row, words: str) -> None:
    assert told(table, row) == f"bodycheck {words}"


@pytest.mark.parametrize(("table", "row"), [(table, row) for table, row, _ in COMMANDS])
def test_the_command_line_understands_the_command(table: str, row: Row) -> None:
    _, *words = shlex.split(told(table, row))
    function, bound, unused = app.parse_known_args(words)[:3]
    assert not unused
    assert function.__name__ == words[0]
    assert bound.arguments


def test_what_comes_from_several_time_steps_names_them_all() -> None:
    steps = [submissions.tradeoff(step) for step in (0.004, 0.002, 0.001)]
    other = submissions.tradeoff(0.5, integrator="RK4")
    assert told("orders.csv", submissions.order(), tradeoff=[*steps, other]) == (
        f"bodycheck tradeoff {FREE} --engine mujoco@4.0.0 --integrator Euler --timestep 0.004 --timestep 0.002 --timestep 0.001"
    )
    runs = [submissions.run(case=CONTACT, timestep=step) for step in (0.001, 0.002)]
    assert told("attribution.csv", submissions.attribution(), results=runs) == (
        f"bodycheck run {CONTACT} --engine mujoco@4.0.0 --integrator Euler --timestep 0.002 --timestep 0.001"
    )


def test_the_name_of_a_file_is_no_option() -> None:
    row: dict[str, Any] = {"model": "--out=x", "engine": "mujoco", "version": "4.0.0"}
    assert shlex.join(MAKERS["parity.csv"](row)) == "parity ./--out=x --engine mujoco@4.0.0"


def test_an_engine_whose_version_is_none_of_python_is_named_without_it() -> None:
    row = submissions.run(engine="simbody", version="4.5-beta_x")
    assert "--engine simbody --integrator" in told("results.csv", row)


def test_every_table_has_commands() -> None:
    assert MAKERS.keys() == TABLES.keys()

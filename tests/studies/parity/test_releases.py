"""Which release changed what a file means."""

from dataclasses import replace

from bodycheck.studies.parity.releases import changes
from bodycheck.studies.parity.rows import Compared, ParityRow, row
from bodycheck.studies.parity.study import Parity

AGREES = Compared("agrees", "inertia", "arm", "1.0", "1.0", 0.0, 0.0)
TURNED = replace(AGREES, status="differs", engine_value="2.0", cause="inertia-turned")


def release(version: str, *found: Compared) -> tuple[ParityRow, ...]:
    return tuple(row("robot", f"engine@{version}", version, one) for one in found)


def test_a_change_is_told_where_it_begins_and_where_it_ends() -> None:
    rows = [*release("1.0", AGREES), *release("1.1", TURNED), *release("1.2", TURNED), *release("1.3", AGREES)]
    found = changes([Parity("robot", "robot.urdf", tuple(rows))])
    assert [(one.before, one.after, one.subject, one.cause) for one in found] == [
        ("engine@1.0", "engine@1.1", "arm", "inertia-turned"),
        ("engine@1.2", "engine@1.3", "arm", "inertia-turned"),
    ]
    assert [(one.engine_value_was, one.engine_value) for one in found] == [("1.0", "2.0"), ("2.0", "1.0")]


def test_a_release_that_begins_to_refuse_a_file_is_one_change() -> None:
    rows = [*release("1.0", AGREES, TURNED), *release("1.1", Compared("refused", None, "model", "too heavy"))]
    (change,) = changes([Parity("robot", "robot.urdf", tuple(rows))])
    assert (change.quantity, change.status, change.engine_value) == (None, "refused", "too heavy")

"""The pages of robots: what agrees is counted, what does not is listed with its cause, and versions stay apart."""

import re
from html import unescape

import pytest

from bodycheck.site import links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.pages import robots
from bodycheck.site.submissions.packing import condensed
from tests.site import submissions as made

DRAKE = {"engine": "drake", "version": "1.51.1"}
FILE = {"engine": "file", "version": "1.0"}
BULLET = {"engine": "pybullet", "version": "3.2.7"}

#: A joint whose damping an engine ignores.
DAMPING = {"quantity": "damping", "subject": "joint1", "status": "differs", "cause": "damping-ignored"}

#: A row about the whole file.
WHOLE = {"quantity": None, "subject": "model", "truth_value": None}

ROWS = [
    *(made.parity(subject=f"link{k}", relative=k % 4 * 1e-16) for k in range(1, 8)),
    made.parity(**DAMPING, engine_value="0", truth_value="0.5", difference=0.5, relative=1.0),
    made.parity(quantity="damping", subject="joint2"),
    made.parity(**WHOLE, status="not-modelled", engine_value="drake reads no such file", **DRAKE),
    made.parity(**WHOLE, status="refused", engine_value="no inertial", **BULLET),
    made.parity(
        engine="file", version="1.0", status="differs", quantity="inertia", subject="link3", engine_value="has no inertia"
    ),
]


def files(*submissions: list[dict[str, object]], **told: object) -> dict[str, str]:
    sources = [
        made.submission({"parity.csv": rows}, day=f"2026-01-0{day}", **told) for day, rows in enumerate(submissions, start=1)
    ]
    return {one.path: one.content.decode() for one in robots.pages(made.catalogued(*sources))}


def text(page: str) -> str:
    return " ".join(unescape(re.sub("<[^>]+>", " ", page)).split())


@pytest.fixture(scope="module")
def page() -> str:
    return files(ROWS, command=["bodycheck", "parity", "/home/me/panda.urdf", "--states", "10"])[links.robot("panda")]  # type: ignore[arg-type]


def test_what_agrees_is_counted_and_what_differs_is_listed(page: str) -> None:
    shown = text(page)
    # The columns are drake, mujoco and pybullet.
    assert "mass – the engine, or its adapter, does not model it = agrees with the file 3e-16 ⊘" in shown
    assert "≠ differs from the file 1, up to 1 ⊘" in shown
    assert "mujoco 4.0.0: 1 row" in shown
    assert "damping joint1 differs 0 0.5 0.5 1 damping ignored row" in shown
    assert page.count("link5") == 0


def test_refused_and_not_modelled_are_told_apart(page: str) -> None:
    shown = text(page)
    assert "drake 1.51.1 – does not read it: drake reads no such file" in shown
    assert "pybullet 3.2.7 ⊘ refuses the file: no inertial" in shown
    assert "mujoco 4.0.0 ≠ differs; damping ignored: joint1 (damping 0 instead of 0.5)" in shown


def test_readings_without_an_answer_are_counted_apart_from_refusals() -> None:
    answers = {"drake": "crashed", "newton": "timeout", "mujoco": "adapter-fault", "pybullet": "refused"}
    rows = [made.parity(**WHOLE, engine=name, version="1.0", status=status) for name, status in answers.items()]
    found = files(rows)
    page = text(found[links.robot("panda")])
    for told in ("✗ crashes on the file", "◷ does not finish the file", "† has no reading", "⊘ refuses the file"):
        assert told in page
    for status in answers.values():
        assert f'class="{status}"' in found[links.ROBOTS]


def test_a_file_that_no_engine_has_read_is_a_page() -> None:
    row = made.parity(**WHOLE, engine="file", version=None, status="unreadable", engine_value="panda.urdf: is not XML")
    page = text(files([row])[links.robot("panda")])
    assert "panda.urdf: is not XML" in page
    assert "No engine has read the file." in page


def test_faults_of_the_file_and_the_command_are_there(page: str) -> None:
    shown = text(page)
    assert "link3: has no inertia" in shown
    assert "bodycheck parity panda.urdf" in shown
    assert "/home/me" not in page


def test_older_versions_are_folded_and_the_newest_one_counts() -> None:
    before = [made.parity(version="3.17.0", status="differs", quantity="mass", cause="mass", relative=0.5)]
    found = files(before, [made.parity()])
    page = found[links.robot("panda")]
    newest, _, older = page.partition("<summary>Other versions</summary>")
    assert "3.17.0" not in newest
    assert "1, up to 0.5" in text(older)
    assert "agrees with the file" in text(found[links.ROBOTS])
    assert "≠ differs from the file 1" not in text(found[links.ROBOTS])


def test_the_list_has_a_row_for_each_robot_and_a_column_for_each_engine() -> None:
    page = files([*ROWS, made.parity(model="ur5")])[links.ROBOTS]
    heads = text(page.partition("<thead>")[2].partition("</thead>")[0])
    assert heads == "Robot drake mujoco pybullet Faults of the file"
    rows = [text(row) for row in re.findall(r"<tr>.*?</tr>", page.partition("<tbody>")[2], re.DOTALL)]
    assert [row.split()[0] for row in rows] == ["panda", "ur5"]
    assert "≠ differs from the file 1" in rows[0]
    assert rows[1].count("nothing is known") == 2


def test_a_site_without_robots_says_how_to_compare_one() -> None:
    catalogue: Catalogue = made.catalogued(made.submission([made.run()]))
    (only,) = robots.pages(catalogue)
    assert only.path == links.ROBOTS
    assert "bodycheck parity FILE" in only.content.decode()


def test_of_what_agrees_the_largest_difference_stays_for_each_quantity() -> None:
    head = ["model", "engine", "version", "status", "quantity", "subject", "relative"]
    rows = [
        head,
        ["panda", "mujoco", "4", "agrees", "mass", "a", "1e-16"],
        ["panda", "mujoco", "4", "agrees", "mass", "b", "3e-16"],
        ["panda", "mujoco", "4", "agrees", "mass", "c", ""],
        ["panda", "mujoco", "4", "differs", "mass", "d", "1"],
        ["panda", "mujoco", "4", "differs", "mass", "e", "1"],
        ["panda", "mujoco", "3", "agrees", "mass", "f", "0"],
        ["panda", "mujoco", "4", "agrees", "parent", "g", ""],
        ["panda", "mujoco", "4", "agrees", "parent", "h", ""],
        ["ur5", "mujoco", "4", "not-modelled", "", "model", ""],
    ]
    kept = condensed(rows)
    assert kept[0] == head
    assert [row[5] for row in kept[1:]] == ["b", "d", "e", "f", "g", "model"]
    assert condensed(kept) == kept
    # What is no such table is for others to judge.
    for other in ([], [["model"]], [head, ["panda"]]):
        assert condensed(other) == other


def test_long_lists_are_cut_and_say_so() -> None:
    many = [
        made.parity(quantity="mass", status="differs", subject=f"link{k}", cause="mass", relative=0.1)
        for k in range(robots.MOST_LISTED + 5)
    ]
    shown = text(files(many)[links.robot("panda")])
    assert f"mujoco 4.0.0: {robots.MOST_LISTED + 5} rows" in shown
    assert f"the first {robots.MOST_LISTED} rows" in shown
    assert f"link{robots.MOST_LISTED + 4} " not in shown.partition("What does not agree")[2]

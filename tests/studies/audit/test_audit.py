"""The audit as a study and a command: its table, its exit codes, flights that are repeated, and probes that give no answer."""

import csv
import json
from collections.abc import Iterator
from dataclasses import fields, replace
from pathlib import Path

import pytest

from bodycheck.adapters.contract import Engine, Integrator, Method, Usage, choice
from bodycheck.studies.audit import classes, nondeterminism, study
from bodycheck.studies.audit.probe import OF_LONG_RUNS, Finding
from bodycheck.studies.audit.probes import long_run
from bodycheck.studies.audit.rows import PROPERTIES, Row
from bodycheck.studies.audit.wording import sentences, without_findings
from tests.support.commands import bodycheck
from tests.support.planted_engines import plant
from tests.support.processes import calls_here
from tests.support.wording import facts

#: The properties that are looked for without being asked for. The integrators of these engines are offered for all scenes.
USUAL = [name for name in PROPERTIES if name not in OF_LONG_RUNS]

#: An engine that is stepped by semi-implicit Euler, up to how it spoils the state from which it starts.
STEPPED = """
import os
import numpy as np
from dataclasses import replace
from bodycheck.adapters.contract import single
from bodycheck.reference.requirements import Requirements

engine = replace(RECORD, models=frozenset(Requirements.__annotations__))

class Stepped:
    def __init__(self, scene, timestep):
        self.scene, self.h = scene, timestep
        start = scene.initial
        self.state = np.array([*start.position, *start.quaternion, *start.velocity, *start.angular_velocity])

    def step(self):
        row, h, moments = self.state, self.h, np.array(self.scene.body.moments)
        spin = row[10:] + h * np.cross(moments * row[10:], row[10:]) / moments
        velocity = row[7:10] - [0, 0, h * self.scene.gravity]
        turn = np.concatenate([[0.0], spin])
        w, x, y, z = row[3:7]
        product = np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ turn
        quaternion = row[3:7] + 0.5 * h * product
        quaternion /= np.linalg.norm(quaternion)
        self.state = np.concatenate([row[:3] + h * velocity, quaternion, velocity, spin])

    def advance(self, strides):
        rows = []
        for stride in strides.tolist():
            for _ in range(stride):
                self.step()
            rows.append(self.state.copy())
        return single(np.array(rows))

def prepare(scenes, method):
    simulation = Stepped(scenes[0], method.timestep)
    spoil(simulation)
    return simulation
"""

CLEAN = STEPPED + "\ndef spoil(simulation):\n    pass\n"

#: Its record names the method that its users get by default.
WITH_DEFAULT = (
    CLEAN
    + """
from bodycheck.adapters.contract import Usage

usage = Usage(engine.integrators[0].name, 0.002, "https://example.org")
engine = replace(engine, roles={"default": {"flight": usage}})
"""
)

RANDOM = STEPPED + "\ndef spoil(simulation):\n    simulation.state[0] += 1e-6 * np.random.default_rng().random()\n"

KEEPING = STEPPED + "\nKEPT = []\n\ndef spoil(simulation):\n    simulation.state[8] += 1e-7 * len(KEPT)\n    KEPT.append(1)\n"

#: Its numbers depend on its process, and are the same whenever it is asked there.
ELSEWHERE = STEPPED + "\ndef spoil(simulation):\n    simulation.state[10] += 1e-9 * os.getpid()\n"

#: Dies in the flight of the light body that the probe of nondeterminism makes in between.
DYING = STEPPED + "\ndef spoil(simulation):\n    if simulation.scene.body.mass == 0.4:\n        os._exit(7)\n"


@pytest.fixture
def planted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Engines that are stepped in the same way, four of which are spoilt, and few of the probes, which others test."""
    monkeypatch.setattr(study, "PROBES", {name: study.PROBES[name] for name in ("time-base", "energy")})
    monkeypatch.setattr(classes, "TRIALS", classes.TRIALS[:1])
    engines = {"clean": CLEAN, "random": RANDOM, "keeping": KEEPING, "elsewhere": ELSEWHERE, "dying": DYING}
    engines["with_default"] = WITH_DEFAULT
    plant(tmp_path / "engines", engines)
    monkeypatch.syspath_prepend(tmp_path / "engines")


@pytest.fixture
def here() -> Iterator[None]:
    with calls_here():
        yield


def rows_of(text: str) -> dict[tuple[str, str], dict[str, object]]:
    """The rows of a document by engine and property; of several about one property the last."""
    return {(row["engine"], row["property"]): row for row in json.loads(text)}


def test_json_has_the_rows_of_the_table_with_every_property(planted: None, here: None, tmp_path: Path) -> None:
    done = bodycheck("audit", "clean", "--json", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    with (tmp_path / "out" / "audit.csv").open(newline="") as file:
        table = list(csv.reader(file))
    assert table[0] == [field.name for field in fields(Row)]
    assert ",".join(table[0]) == ("engine,version,integrator,timestep,property,value,unit,expected,status,probe,attitude_error")
    assert table[1:] == [["" if value is None else str(value) for value in row.values()] for row in told]
    assert list(dict.fromkeys(row["property"] for row in told)) == USUAL
    with (tmp_path / "out" / "classes.csv").open(newline="") as file:
        assert {row["engine"] for row in csv.DictReader(file)} == {"clean"}
    # What the method does to the flip stands with its findings alone.
    assert all((row["attitude_error"] is not None) == (row["status"] in ("default", "deviates")) for row in told)


def test_very_many_steps_are_taken_only_if_asked_for(
    planted: None, here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "PROBES", {})
    monkeypatch.setattr(long_run, "STEPS", 1000)
    monkeypatch.setattr(classes, "TRIALS", ())
    done = bodycheck("audit", "with_default", "--long", "--json", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    rows = rows_of(done.stdout)
    assert [name for _, name in rows] == [*USUAL, *OF_LONG_RUNS]
    assert {rows["with_default", name]["probe"] for name in OF_LONG_RUNS} == {"long-run: 1000 steps"}
    assert bodycheck("report", tmp_path / "out").returncode == 0


def test_a_report_is_written_again_from_what_was_saved(planted: None, here: None, tmp_path: Path) -> None:
    assert bodycheck("audit", "clean", "random", "--quiet", "--out", tmp_path / "out").returncode == 0
    page = (tmp_path / "out" / "report.md").read_text("utf-8")
    (tmp_path / "out" / "report.md").unlink()
    assert bodycheck("report", tmp_path / "out").returncode == 0
    assert (tmp_path / "out" / "report.md").read_text("utf-8") == page
    table = tmp_path / "out" / "audit.csv"
    table.write_text(
        "".join(line for line in table.read_text("utf-8").splitlines(keepends=True) if not line.startswith("random,")), "utf-8"
    )
    damaged = bodycheck("report", tmp_path / "out")
    assert (damaged.returncode, damaged.stdout) == (2, "")
    assert "audit.csv does not list the same methods as audit.jsonl" in damaged.stderr


def test_flights_that_are_repeated_show_what_is_random_or_kept(planted: None, here: None) -> None:
    done = bodycheck("audit", "clean", "random", "keeping", "--json")
    assert done.returncode == 0, done.stderr
    found = {engine: row for (engine, name), row in rows_of(done.stdout).items() if name == "nondeterminism"}
    assert (found["clean"]["status"], found["clean"]["value"]) == ("none", 0.0)
    # Each has one integrator, which is what its users get.
    assert {found[name]["status"] for name in ("random", "keeping")} == {"default"}
    assert 0 < float(str(found["random"]["value"])) < 1.0
    # The velocity keeps its error of 1e-7 m/s for each flight that the process made before, of which there are a few.
    assert float(str(found["keeping"]["value"])) >= 1e-7


def test_in_worker_processes_one_may_die_and_others_may_differ(
    planted: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(classes, "TRIALS", ())
    done = bodycheck("audit", "dying", "elsewhere", "--json", "--jobs", 2, "--out", tmp_path / "out")
    assert done.returncode == 1
    assert "dying step: the probe nondeterminism gave no answer: its process exited with code 7" in done.stderr
    assert "exited with code 7" in (tmp_path / "out" / "report.md").read_text("utf-8")
    rows = rows_of(done.stdout)
    lost = rows["dying", "nondeterminism"]
    assert lost["status"] == "not-probed"
    assert "its process exited with code 7" in str(lost["probe"])
    assert [name for engine, name in rows if engine == "dying"] == USUAL
    assert rows["dying", "time-base"]["status"] == "none"
    assert rows["elsewhere", "nondeterminism"]["status"] == "default"
    assert "in another process" in str(rows["elsewhere", "nondeterminism"]["probe"])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("cleen",), "there is no engine 'cleen'"),
        (("clean", "--integrator", "RK4"), "no engine has an integrator 'RK4'"),
        (("clean", "--timestep", "0"), "must be positive"),
        (("clean", "--timestep", "soon"), "soon"),
        (("clean", "--columns", "values"), "there is no column 'values'"),
    ],
)
def test_bad_input_is_refused(planted: None, here: None, arguments: tuple[str, ...], told: str) -> None:
    done = bodycheck("audit", *arguments)
    assert (done.returncode, done.stdout) == (2, "")
    assert told in done.stderr


def test_an_interrupted_audit_resumes_and_makes_no_probe_again(
    planted: None, here: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = bodycheck("audit", "clean", "--json", "--out", tmp_path / "out")
    journal = tmp_path / "out" / study.RECORDS
    *lines, _ = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines))  # without its footer
    monkeypatch.setattr(study, "make", None)
    monkeypatch.setattr(classes, "measure", None)
    again = bodycheck("audit", "clean", "--json", "--out", tmp_path / "out")
    assert "resuming the interrupted audit" in again.stderr
    assert again.stdout == whole.stdout


SETTLED = Integrator("euler", options={"settings": choice("engine")})


@pytest.mark.parametrize(
    ("spelling", "name", "precision", "defaults", "usual", "status"),
    [
        ("euler", "angular-damping", "float64", {}, "rk4", "deviates"),
        ("euler:settings=engine", "angular-damping", "float64", {}, "rk4", "default"),
        ("euler", "angular-damping", "float64", {"angular-damping": "0.05 1/s"}, "rk4", "default"),
        # The settings of this integrator can be switched off, and are: it is not what a user gets.
        ("euler", "angular-damping", "float64", {"integrator": "euler"}, "euler:settings=engine", "deviates"),
        ("rk4", "energy-per-turn", "float64", {}, "rk4", "default"),
        ("rk4", "energy-per-turn", "float64", {"integrator": "rk4"}, "euler:settings=engine", "deviates"),
        ("rk4", "single-precision", "float32", {}, "euler:settings=engine", "default"),
        ("rk4", "single-precision", "float64", {}, "euler:settings=engine", "deviates"),
    ],
)
def test_what_users_get_without_asking_is_a_default(
    spelling: str, name: str, precision: str, defaults: dict[str, str], usual: str, status: str
) -> None:
    engine = Engine(
        *("toy", "toy", "1.0", (SETTLED, Integrator("rk4")), frozenset()),
        precision=precision,  # type: ignore[arg-type]
        defaults=defaults,
        roles={"default": {"flight": Usage(usual, 0.002, "https://example.org")}},
    )
    method = Method.parse(spelling, 0.002)
    assert study.status_of(engine, method, Finding(name, "probe", "found", 1.0)) == status  # type: ignore[arg-type]
    assert study.status_of(engine, method, Finding(name, "probe", "none")) == "none"  # type: ignore[arg-type]


def test_a_flight_that_ends_in_no_number_differs_without_a_size() -> None:
    steady, lost = [[1.0] * 13], [[float("nan")] * 13]
    same = nondeterminism.judged({"first": lost, "at once": lost})
    other = nondeterminism.judged({"first": steady, "at once": lost})
    assert (same.verdict, other.verdict, other.value) == ("none", "found", None)
    assert nondeterminism.judged({"first": steady, "at once": "it refuses"}).verdict == "not-probed"


def test_sentences_tell_defaults_and_deviations_apart_with_their_sizes() -> None:
    def row(integrator: str, name: str, value: float | None, unit: str, status: str, probe: str, error: float) -> Row:
        return Row("toy", "1.0", integrator, 0.002, name, value, unit, "0", status, probe, error)  # type: ignore[arg-type]

    form = "representation: two welded links: differs, and vanishes with the time step"
    told = sentences(
        [
            row("euler:settings=engine", "angular-damping", 0.0499, "1/s", "default", "damping", 2.0),
            row("euler", "energy-per-turn", 0.0035, "", "deviates", "energy", 1.5),
            row("heun", "energy-per-turn", -2e-5, "", "deviates", "energy", 0.25),
            row("heun", "representation", 1e-3, "m", "deviates", f"{form} with order 2.0", 0.25),
            row("euler", "representation", 2e-3, "m", "deviates", f"{form} with order 1.0", 1.5),
            row("rk4", "sleeping", None, "", "none", "sleeping", 0.0),
        ]
    )
    names = ("euler:settings=engine", "euler", "heun", "rk4", "two welded links", "vanishes", "does not vanish", "1/s")
    assert [(one.status, one.property, facts(one.text, *names)) for one in told] == [
        ("deviates", "energy-per-turn", ["-2e-5", "0.0035", "0", "euler", "heun", "0.25", "1.5"]),
        (
            *("deviates", "representation"),
            ["two welded links", "vanishes", "0.001", "0.002", "0", "heun", "euler", "0.25", "1.5"],
        ),
        ("default", "angular-damping", ["0.0499", "1/s", "0", "euler:settings=engine", "2"]),
    ]


def test_an_engine_without_any_answer_is_not_said_to_have_nothing() -> None:
    row = Row("one", "1.0", "Euler", 0.002, "sleeping", None, "", "", "not-probed", "rest: it gave up", None)
    assert without_findings([row]) == "No probe gave an answer."
    assert without_findings([row, replace(row, status="none")]) == "Nothing was found that mechanics does not have."

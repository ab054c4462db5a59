"""A large site: 20 engines by 100 scenes, each with three methods on two dates."""

from collections.abc import Iterator
from typing import Any

from bodycheck.casefile import case as case_files
from bodycheck.results import records
from bodycheck.results.records import HeaderRecord
from bodycheck.site import catalogue
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.submissions.submission import Row, Submission
from tests.site import submissions

ENGINES, SCENES = 20, 100

#: The scene that all scenes are copies of.
ORIGINAL = "free-brick"

METHODS = ("Euler", "implicit", "RK4")


def large(engines: int = ENGINES, scenes: int = SCENES) -> Catalogue:
    """The catalogue of a large site. Every verdict is in it, and every fifth run changes from date to date."""
    text = case_files.load(ORIGINAL).text
    names = [f"scene-{place}" for place in range(scenes)]
    cases = {name: text.replace(f'name = "{ORIGINAL}"', f'name = "{name}"') for name in names}
    found = []
    for number in range(engines):
        for later in (False, True):
            engine, version = f"engine{number}", f"{1 + later}.0"
            told = submissions.header(f"2026-0{1 + later}-01", {engine: version})
            header = records.typed(HeaderRecord, told)
            rows = tuple(_rows(names, number, engine, version))
            found.append(Submission(f"{2 * number + later:020x}", header, {"results.csv": rows}, cases))
    return catalogue.catalogued(sorted(found, key=lambda one: one.header.started), ())


def _rows(names: list[str], number: int, engine: str, version: str) -> Iterator[Row]:
    """The rows of an engine. Of some scenes there is none, and the endings of the others differ."""
    columns = submissions.run().keys()
    for place, name in enumerate(names):
        for method, integrator in enumerate(METHODS):
            told: dict[str, Any] = {"case": name, "engine": engine, "version": version, "integrator": integrator}
            size = 10.0 ** -((place + 3 * number + 4 * method) % 14)
            turn = (place + number) % 10
            if turn == 0:
                continue
            if turn == 1:
                row = submissions.ended("unsupported", f"{engine} does not model rolling", **told)
            elif turn == 2:
                row = submissions.ended("diverged", "the state is not finite", **told)
            elif turn == 5:
                row = submissions.ended("unsupported", f"{engine} refuses the model: no inertia", **told)
            elif turn == 6:
                row = submissions.broken(**told, attitude_error=size)
            else:
                changed = 2.0 if version == "2.0" and turn in (3, 4) else 1.0
                row = submissions.run(**told, attitude_error=size * changed)
            yield {column: row.get(column) for column in columns | {"reason", "passed"}}

"""Print the table of docs/sensors.md: what the sensors of engines read, joined over the shipped cases with sensors.

Run: python docs/sensors.py [ENGINE …]
"""

import argparse
import re
from collections.abc import Iterator, Sequence

import bodycheck
from bodycheck.adapters import registry
from bodycheck.judging.sensors.rows import SensorRow
from bodycheck.studies.sensors.rows import Line, lines

#: The methods of engines whose default has damping of their own, no steps of fixed length, or no sensors of joints.
METHODS = {
    "dart": "semi-implicit-euler",
    "exudyn": "GeneralizedAlpha",
    "newton": "MuJoCo-euler",
    "pybullet": "multibody",
    "rapier": "symplectic-euler",
    "sapien": "TGS",
    "simbody": "RungeKuttaMerson",
}

#: The time step (s), and the scene whose errors in MuJoCo are those of its contacts; the sensors of contacts alone count there.
STEP, SLIDING = 0.002, "sensor-block-on-ramp"

#: The names of scenes after a part of a note.
SCENES = re.compile(r" \(sensor-[^)]*\)")

HEAD = ("engine, method", "sensor", "after a step", "after forward", "at a reset", "sign", "frame", "age", "source", "note")


def rows_of(engine: str) -> Sequence[SensorRow]:
    """Return the rows of the sheet of an engine."""
    method = METHODS.get(engine)
    rows = bodycheck.sensors(engine, integrator=method or (), timestep=STEP if method else ()).rows
    return [row for row in rows if row.case != SLIDING or row.type == "contact_force"]


def figure(value: float | None) -> str:
    """Return a number with one digit; a dash for a number that is not known."""
    return "–" if value is None else f"{value:.0e}"


def either(step: str, forward: str) -> str:
    """Return what is identified after a step, and after the engine's forward pass if it differs."""
    return step if forward in ("", step) else f"{step or '–'} → {forward}"


def cells(step: Line, forward: Line | None) -> Sequence[str]:
    """Return the cells of a type of sensor of an engine."""
    after = forward or step
    conventions = (either(getattr(step, name), getattr(after, name)) for name in ("sign", "frame", "age_steps", "source"))
    shown = (
        f"{step.engine} {step.integrator}",
        step.type,
        figure(step.error),
        "" if forward is None else figure(forward.error),
    )
    return (*shown, figure(step.reset), *conventions, SCENES.sub("", step.note))


def table_of(engine: str) -> Iterator[Sequence[str]]:
    """Yield the rows of the table of an engine."""
    joined = {(line.integrator, line.type, line.read): line for line in lines(rows_of(engine))}
    for (integrator, kind, read), line in joined.items():
        if read == "step" and (line.error is not None or line.sign):
            yield cells(line, joined.get((integrator, kind, "forward")))


def main(arguments: list[str] | None = None) -> None:
    """Print the table for some engines."""
    parser = argparse.ArgumentParser(description="Print the table of docs/sensors.md.")
    parser.add_argument("engines", nargs="*", metavar="ENGINE", help="engines; all that are installed, without any")
    asked = parser.parse_args(arguments).engines or registry.names()
    print(f"| {' | '.join(HEAD)} |\n| {' | '.join(['---'] * len(HEAD))} |")
    for engine in asked:
        for row in table_of(engine):
            print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()

"""The tables on the page of a scene: bodies, joints, the initial state, and the truth with its error bounds."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bodycheck.reference.bodies import bodies, initial
from bodycheck.reference.mechanisms.exact import nearest_inertia
from bodycheck.reference.mechanisms.mechanism import WORLD, AnyScene, Joint, Mechanism
from bodycheck.reference.scene import Scene as OneBody
from bodycheck.reference.truths import NoTruth
from bodycheck.reports.quantities import QUANTITIES, number, vector, within
from bodycheck.reports.runs.scenes import ACTING, Fact, Told, describe
from bodycheck.results import truth_records
from bodycheck.site.catalogue import Entry, Scene
from bodycheck.site.submissions.submission import Submission


@dataclass(frozen=True)
class Grid:
    """A table of texts whose first column has the names of the rows.

    Parameters
    ----------
    title
        The title for readers.
    heads
        The heads of the columns, with units.
    rows
        The texts.
    """

    title: str
    heads: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def grids(scene: AnyScene) -> tuple[Grid, ...]:
    """Return the tables of a scene: its bodies, its initial state, and its joints."""
    joints = (_joints(scene),) if isinstance(scene, Mechanism) and scene.joints else ()
    return _bodies(scene), _start(scene), *joints


def facts(scene: Scene, sources: Sequence[Submission]) -> tuple[Fact, ...]:
    """Return the facts of a scene.

    Parameters
    ----------
    scene
        The scene, whose runs give the error bounds of the truth.
    sources
        Submissions, the newest first. The first submission that records how the truth was computed is used.
    """
    record = next((own for one in sources if (own := one.tracks.truths.get(scene.name)) is not None), None)
    if record is None:
        return describe(scene.case, ())
    if "reason" in record:
        return describe(scene.case, (NoTruth(record["reason"]),))
    ways = truth_records.ways(record)
    known = [run.get("truth_error") for run in scene.runs if run.get("truth_error") is not None]
    return describe(scene.case, (Told(**ways, error=max(known, default=math.nan)),))


def bounds(runs: Sequence[Entry]) -> Grid:
    """Return a table of the largest error bound of the truth over the runs, for each quantity that they measured."""
    rows = []
    for quantity in QUANTITIES.values():
        known = [run.get(quantity.bound_name) for run in runs if quantity.bounded and run.get(quantity.bound_name) is not None]
        measured = any(run.get(quantity.name) is not None for run in runs)
        if known and measured:
            rows.append((quantity.title, within(max(known), 2), quantity.unit or "relative"))
    return Grid("The largest error of the truth itself at any instant", ("Quantity", "Bound", "Unit"), tuple(rows))


def _bodies(scene: AnyScene) -> Grid:
    if isinstance(scene, OneBody):
        row = ("body", number(scene.body.mass), *map(number, scene.body.moments))
        return Grid("Body", ("Name", "Mass, kg", *(f"Moment about {axis}, kg m²" for axis in "IJK")), (row,))
    rows = []
    for body in scene.bodies:
        found = nearest_inertia(body)
        rows.append((body.name, number(found.mass), vector(found.centre), *map(number, found.tensor)))
    inertia = (f"{axes}, kg m²" for axes in ("xx", "yy", "zz", "xy", "xz", "yz"))
    heads = ("Name", "Mass, kg", "Centre of mass, m", *inertia)
    return Grid("Bodies, and their inertia about the centre of mass", heads, tuple(rows))


def _start(scene: AnyScene) -> Grid:
    state = initial(scene)
    states = (state.position, state.quaternion, state.velocity, state.angular_velocity)
    rows = [(body.name, *(vector(values[i, 0].tolist()) for values in states)) for i, body in enumerate(bodies(scene))]
    heads = ("Position, m", "Attitude, w x y z", "Velocity, m/s", "Angular velocity in the body, rad/s")
    return Grid("State at t = 0, of the centre of mass", ("Name", *heads), tuple(rows))


def _joints(mechanism: Mechanism) -> Grid:
    def row(joint: Joint) -> tuple[str, ...]:
        parent = "the world" if joint.parent == WORLD else mechanism.bodies[joint.parent].name
        acting = ", ".join(f"{name} {number(getattr(joint, name))}" for name in ACTING if getattr(joint, name))
        start = ", ".join(map(number, joint.start)) or "0"
        velocity = ", ".join(map(number, joint.start_velocity)) or "0"
        child = mechanism.bodies[joint.child].name
        return joint.name, joint.type, child, parent, vector(joint.axis), start, velocity, acting or "nothing"

    heads = ("Name", "Type", "Body", "Hangs on", "Axis", "Start, rad or m", "Rate, rad/s or m/s", "Acts in it, SI units")
    return Grid("Joints", heads, tuple(map(row, mechanism.joints)))

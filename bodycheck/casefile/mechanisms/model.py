"""The table `[model]` of a case file: a robot model, URDF or MJCF, instead of `[[bodies]]` and `[[joints]]`.

The model is a regular file in the folder of the case file. When the case is loaded, what was read of the model is appended to
the text of the case as `[model.stored]`; see `stored`.
"""

import copy
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path as FilePath
from typing import Any

from pydantic import ValidationError

from bodycheck.casefile.formats import is_mechanism
from bodycheck.casefile.mechanisms import stored
from bodycheck.casefile.mechanisms.control_faults import unusable
from bodycheck.casefile.mechanisms.grammar import IGNORED, MAX_BODIES, USED, StoredTable
from bodycheck.casefile.mechanisms.signal_files import resolved
from bodycheck.casefile.raw_values import mapping, numbers, tables_of
from bodycheck.casefile.robot_notes import JointRange, RobotNotes, TendonRange
from bodycheck.casefile.robots.tables import doubles
from bodycheck.casefile.toml_positions import Path
from bodycheck.errors import BadInput
from bodycheck.reference.exact.rotations import attitude
from bodycheck.reference.mechanisms.mechanism import AnyScene, Mechanism
from bodycheck.reference.mechanisms.rest import is_at_rest
from bodycheck.reference.scene import EulerAngles
from bodycheck.robots import elements
from bodycheck.suggestion import did_you_mean, first_names

#: The name of a file, without a folder.
FILE_NAME = re.compile(r"(?!\.)[^/\\:\0\r\n]{1,100}")

#: The path of the key with the name of the model.
FILE: Path = ("model", "file")

#: The table of the start of a free base, and its keys by the keys of the start of a free joint.
BASE: Path = ("initial", "base")
BASE_KEYS = {"position": "position", "quaternion": "quaternion", "linear": "velocity", "velocity": "angular_velocity"}


@dataclass(frozen=True)
class Expanded:
    """The document of a case file with the bodies and joints of its model.

    Attributes
    ----------
    document
        The document with the tables of the model; the document of the file if it has no model, or its model cannot be read.
    faults
        The faults of the table and of the model, as pairs of path and message.
    base
        The index of the joint of the free base; None if there is none.
    timestep
        The time step (s) that the file of the model states; None if it states none.
    notes
        The notes on the model; None if the bodies and joints do not come from a model.
    controllers
        The number of controllers of the case file itself, which come before those of the model.
    stops_until
        The time (s) from which on rigid stops no longer act; None if they always act.
    """

    document: dict[str, Any]
    faults: tuple[tuple[Path, str], ...] = ()
    base: int | None = None
    timestep: float | None = None
    notes: RobotNotes | None = None
    controllers: int = 0
    stops_until: float | None = None

    def in_the_file(self, path: Path, message: str) -> tuple[Path, str]:
        """Return the path in the case file, and the message, of a fault in the document."""
        if self.notes is None:
            return path, message
        match path:
            case ("joints", int(index), "initial", str(key), *rest) if index == self.base and self._is_of_base(key):
                return (*BASE, BASE_KEYS[key], *rest), message
            case ("joints", int(index), "initial", *rest):
                return ("initial", "joints", self._name("joints", index), *rest), message
            case (("bodies" | "joints" | "loops") as tables, int(index), *rest):
                name = elements.quoted(self._name(tables, index))
                key = ".".join(str(part + 1 if isinstance(part, int) else part) for part in rest)
                return FILE, f"{SINGLE[tables]} {name}: {key and key + ': '}{message}"
            case ("controllers", int(index), *rest) if index >= self.controllers:
                name = elements.quoted(str(mapping(self.document["controllers"][index]).get("joint")))
                return FILE, f"controller of the joint {name}: {'.'.join(map(str, rest))}: {message}"
            case (("bodies" | "joints" | "loops"), *_):
                return FILE, message
        return path, message

    def _is_of_base(self, key: str) -> bool:
        return BASE_KEYS.get(key) in mapping(mapping(self.document.get("initial")).get("base"))

    def _name(self, tables: str, index: int) -> str:
        return str(mapping(self.document[tables][index]).get("name", index + 1))


#: What one table of an array is called.
SINGLE = {"bodies": "body", "joints": "joint", "loops": "loop"}


def with_model(
    text: str, document: dict[str, Any], folder: FilePath, packages: Sequence[FilePath] = (), follow: bool = False
) -> tuple[str, tuple[tuple[Path, str], ...]]:
    """Return the text of a case file with what was read of its model, and no faults; or the text alone, and faults.

    The text is returned as it is, without faults, if the file names no model, or has what was read of it.

    Parameters
    ----------
    text, document
        The text of the case file, and its document.
    folder
        The folder of the case file.
    packages
        Folders that the user named, in which the model may name files.
    follow
        Whether the model may be a symbolic link, because the user named it.
    """
    table = mapping(document.get("model"))
    name = table.get("file")
    if not is_mechanism(document) or "stored" in table or not isinstance(name, str):
        return text, ()
    if not FILE_NAME.fullmatch(name):
        return text, ((FILE, "must be the name of a file in the folder of this one"),)
    try:
        tomllib.loads(f"{text}{stored.MARK}")
    except tomllib.TOMLDecodeError:  # after an inline table
        return text, ((FILE, "is not in a table of its own; write it below a line [model]"),)
    from bodycheck.casefile.mechanisms import model_reading  # what is stored is read without the readers of robots' files

    try:
        return stored.appended(text, model_reading.stored_of_file(folder / name, packages, follow, **choice(document))), ()
    except BadInput as error:
        return text, tuple((FILE, line) for line in str(error).splitlines())
    except ValueError:
        return text, ((FILE, "has a number that is too large"),)


def choice(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of `Choice` in a raw document with `[model]`, except `files`; invalid values count as absent."""
    table = mapping(document.get("model"))
    ignore, use, keyframe = table.get("ignore"), table.get("use"), table.get("keyframe")
    names = [table.get("joint") for table in tables_of(document, "controllers", MAX_BODIES)]
    return {
        "ignore": frozenset(word for word in IGNORED if word in ignore) if isinstance(ignore, list) else frozenset(),
        "use": frozenset(word for word in USED if word in use) if isinstance(use, list) else frozenset(),
        "driven": frozenset(name for name in names if isinstance(name, str)),
        "base": "free" if table.get("base") == "free" else "fixed",
        "keyframe": keyframe if isinstance(keyframe, str) or (type(keyframe) is int and keyframe >= 0) else None,
        "upright": table.get("upright") is True,
    }


def expanded(document: dict[str, Any], refused: Sequence[tuple[Path, str]] = ()) -> Expanded:
    """Return the document of a case file with the bodies and joints of its model, which are stored in it.

    The document may have other faults. refused: why the model, or files of signals, were not read.
    """
    document, unread = resolved(document)
    refused = refused or unread
    table = mapping(document.get("model"))
    if "model" not in document or not is_mechanism(document):
        return Expanded(document, tuple(refused))
    both = tuple(((name,), "[model] is given too; give only one") for name in ("bodies", "joints", "loops") if name in document)
    file = table.get("file")
    if both or refused or not isinstance(file, str):
        return Expanded(document, (*both, *refused))
    if not isinstance(table.get("stored"), dict):
        return Expanded(document, ((FILE, "is read only where a case file is loaded from its folder"),))
    try:
        read = StoredTable.model_validate(table["stored"])
        if read.text is not None:
            from bodycheck.casefile.mechanisms import model_reading

            read = StoredTable.model_validate(model_reading.stored_of_text(read.text, file, **choice(document)))
    except ValidationError:  # reported with the faults of the grammar
        return Expanded(document)
    except BadInput as error:
        return Expanded(document, tuple((FILE, line) for line in str(error).splitlines()))
    return _started(document, read, file)


def _started(document: dict[str, Any], read: StoredTable, file: str) -> Expanded:
    """Return a document with the tables of a model, whose joints get the initial states that the document states."""
    bodies, joints, loops = copy.deepcopy((list(read.bodies), list(read.joints), list(read.loops)))
    names = [str(joint.get("name")) for joint in joints]
    initial = mapping(document.get("initial"))
    starts = mapping(initial.get("joints"))
    for joint, name in zip(joints, names, strict=True):
        if name in starts:
            joint["initial"] = mapping(joint.get("initial")) | copy.deepcopy(mapping(starts[name]))
    faults = [*_unknown(starts, names)]
    base = names.index(read.base) if read.base in names else None
    if "base" in initial:
        faults += _of_base(starts, None if base is None else names[base])
        if base is not None:
            joints[base]["initial"] = mapping(joints[base].get("initial")) | _base_start(mapping(initial["base"]))
    of_joints = tuple(JointRange(each.joint, each.lower, each.upper) for each in read.ranges)
    of_tendons = (TendonRange(each.name, each.terms, each.lower, each.upper) for each in read.tendons)
    direct = "limits" in choice(document)["ignore"]  # ranges are stops where they can be
    left_out = _without_stops(joints, direct)
    notices, advice = read.notices, 'ignore = ["limits"] leaves this range out'
    if not direct:
        faults += [(FILE, f"joint {elements.quoted(each.name)}: its range: {why}; {advice}") for each, why in left_out]
    else:
        notices = (*notices, *_left_out(left_out))
        of_joints = (*of_joints, *(each for each, why in left_out if why == COUPLED))
    stated = document.get("controllers", [])
    controllers = [*stated, *_of_model(read, stated)] if isinstance(stated, list) else stated
    tables = {"bodies": bodies, "joints": joints, "loops": loops, "controllers": controllers}
    return Expanded(
        {**document, **{name: table for name, table in tables.items() if table or name in ("bodies", "joints")}},
        tuple(faults),
        base,
        read.timestep,
        RobotNotes(file, read.without, notices, (*of_joints, *of_tendons), read.touching),
        len(stated),
        read.stops_until,
    )


def _without_stops(joints: Sequence[dict[str, Any]], direct: bool) -> list[tuple[JointRange, str]]:
    """Remove the stops of joints that cannot have them, and return their ranges, each with the reason.

    direct: whether stops that the reference does not model are removed, too.
    """
    rules = [(str(joint.get("name")), joint["mimic"].get("joint")) for joint in joints if isinstance(joint.get("mimic"), dict)]
    coupled = {name for pair in rules for name in pair} if direct else set()
    reasons = []
    for joint in joints:
        if "limits" not in joint:
            continue
        limits, name, fault = mapping(joint["limits"]), str(joint.get("name")), unusable(joint)
        if fault is not None:
            (key, *_), why = fault
            why = f"{key} {limits.get(str(key))!r} {why}"
        elif name in coupled:
            why = COUPLED
        else:
            continue
        del joint["limits"]
        reasons.append((JointRange(name, limits.get("lower"), limits.get("upper")), why))
    return reasons


def _left_out(ranges: Sequence[tuple[JointRange, str]]) -> Iterator[str]:
    """Yield a notice for each reason for which ranges of joints are no stops."""
    for why in dict.fromkeys(why for _, why in ranges):
        names = [each.name for each, other in ranges if other == why]
        if len(names) == 1:
            yield f"The range of the joint {names[0]} is left out: {why}."
        else:
            yield f"The ranges of {len(names)} joints ({', '.join(first_names(names))}) are left out: {why}."


def _of_model(read: StoredTable, stated: Sequence[Any]) -> list[dict[str, Any]]:
    """Return the controllers of a model for the joints that have no controller among those of the case file itself."""
    taken = [mapping(table).get("joint") for table in stated]
    return [copy.deepcopy(table) for table in read.controllers if table.get("joint") not in taken]


def _unknown(initial: Mapping[str, Any], joints: list[str]) -> Iterator[tuple[Path, str]]:
    for name, start in initial.items():
        if name not in joints:
            listed = ", ".join(joints[:20]) + (", …" if len(joints) > 20 else "")
            yield ("initial", "joints", name), f"the model has no such joint; allowed: {listed}{did_you_mean(name, joints)}"
        elif not isinstance(start, dict):
            yield ("initial", "joints", name), "should be a table"


def _of_base(joints: Mapping[str, Any], base: str | None) -> Iterator[tuple[Path, str]]:
    """Yield the faults of a table `[initial.base]` beside other tables.

    joints: the tables `[initial.joints]`. base: the name of the joint of the free base; None if there is none.
    """
    if base is None:
        yield BASE, 'the base of the model is fixed; base = "free" in [model] lets it float'
    elif base in joints:
        yield BASE, f"[initial.joints.{base}] is given too, which is the joint of the base; give only one"


def _base_start(start: Mapping[str, Any]) -> dict[str, Any]:
    """Return the table `initial` of the joint of a free base."""
    table = {key: copy.deepcopy(start[name]) for key, name in BASE_KEYS.items() if name in start}
    if (angles := numbers(start.get("euler_zxz"), 3)) is not None:
        table["quaternion"] = doubles(attitude(EulerAngles(*angles)))
    return table


#: Why a range of a joint that follows another, or is followed, is left out where a robot's file is a case.
COUPLED = "stops of joints that follow others or are followed are not modelled"

#: The notice on a scene without motion.
NOTHING_MOVES = "Nothing moves in this scene: it starts at rest in an equilibrium."


def with_scene(notes: RobotNotes, scene: AnyScene) -> RobotNotes:
    """Return the notes on a model with a notice if nothing moves in the scene that was made of it."""
    if isinstance(scene, Mechanism) and is_at_rest(scene):
        return replace(notes, notices=(NOTHING_MOVES, *notes.notices))
    return notes


def standalone(document: Mapping[str, Any]) -> dict[str, Any]:
    """Return the document of a case file with its numbers instead of the files that it names, if these can be read."""
    expansion = expanded(dict(document))
    files = ("signals",) if expansion.notes is None else ("signals", "model", "initial")
    return {name: value for name, value in expansion.document.items() if name not in files}

"""Print the tables of docs/robots.md on parity from the results of `bodycheck parity --out FOLDER`.

Run: python docs/robots.py FOLDER

The first table has a row for each engine, the second the robots of each cause, the third those that engines refuse, and the
fourth what is wrong with the files themselves. The last line counts the files that state what no body can have.
"""

import argparse
import csv
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

#: The rows of parity.csv.
Rows = Sequence[Mapping[str, str]]

#: What differs from robot to robot in the words of engines: names, places in files, and numbers of joints.
NAMED = re.compile(r"(['\"])[^'\"]*\1")
PLACE = re.compile(r"^\S+:\d+: (error: )?")
NUMBER = re.compile(r"\b(joint|id) \d+")

#: An element of a file, which Markdown would take for its own.
ELEMENT = re.compile(r"<[^>]*>")

#: What engines say besides a reason: where, and for whom.
BESIDES = re.compile(r"( Element name .*| The static bodies of the spec .*| The following argument types .*)$")

#: The quantities of bodies and joints that may be impossible.
OF_BODIES = ("mass", "center_of_mass", "inertia", "armature", "damping", "friction")

#: Most characters of the reason of an engine.
LONGEST = 110


def short(model: str) -> str:
    """The name of a robot, without the folders in which files of the same name are."""
    return re.sub(r"_(simple_)?description/.*", "", model)


def listed(names: Iterable[str]) -> str:
    """Names in order, separated by commas."""
    return ", ".join(sorted(names, key=str.lower))


def counted(rows: Rows) -> dict[str, dict[str, str]]:
    """Return the result of each engine for each model: agrees, differs, or the status of the whole file."""
    found: dict[str, dict[str, str]] = defaultdict(dict)
    for row in rows:
        if row["engine"] != "file":
            before = found[row["engine"]].setdefault(row["model"], "agrees")
            if not row["quantity"]:
                found[row["engine"]][row["model"]] = row["status"]
            elif row["status"] == "differs" and before == "agrees":
                found[row["engine"]][row["model"]] = "differs"
    return found


def engine_rows(rows: Rows) -> Iterator[str]:
    """The first table: how many robots each engine reads as their files say."""
    versions = {row["engine"]: row["version"] for row in rows}
    yield "| engine | agrees | differs | refused | takes a file without links | does not read URDF |"
    yield "| --- | --- | --- | --- | --- | --- |"
    for engine, models in sorted(counted(rows).items()):
        said = list(models.values())
        words = ("agrees", "differs", "refused", "accepted-unphysical", "not-modelled")
        yield f"| {engine} {versions[engine]} | {' | '.join(str(said.count(word)) for word in words)} |"


def cause_rows(rows: Rows) -> Iterator[str]:
    """The second table: the robots of each cause, with engines that have the same ones in one row."""
    models: dict[tuple[str, str], set[str]] = defaultdict(set)
    for row in rows:
        if row["status"] == "differs":
            models[row["cause"], row["engine"]].add(short(row["model"]))
    engines: dict[tuple[str, frozenset[str]], list[str]] = defaultdict(list)
    for (cause, engine), own in sorted(models.items()):
        engines[cause, frozenset(own)].append(engine)
    yield "| cause | engines | number | robots |"
    yield "| --- | --- | --- | --- |"
    for (cause, own), names in engines.items():
        yield f"| {cause} | {', '.join(names)} | {len(own)} | {listed(own)} |"


def reason(text: str) -> str:
    """The reason of an engine without what differs from robot to robot."""
    text = NUMBER.sub(r"\1 …", NAMED.sub("'…'", PLACE.sub("", BESIDES.sub("", text))))
    text = re.sub(r"^(\w*Error|StopIteration): ?", r"\1: ", text).strip(" :")
    text = re.sub(r"\(mjtGeom\.\w+, mjtGeom\.\w+\)", "(two shapes)", text)
    return text if len(text) <= LONGEST else f"{text[:LONGEST].rstrip()} …"


def refusal_rows(rows: Rows) -> Iterator[str]:
    """The third table: the reasons of engines; those about the same robots are in one row."""
    models: dict[str, set[str]] = defaultdict(set)
    engines: dict[str, set[str]] = defaultdict(set)
    for row in rows:
        if row["status"] == "refused" and row["engine"] != "file":
            told = reason(row["engine_value"])
            models[told].add(short(row["model"]))
            engines[told].add(row["engine"])
    merged: dict[frozenset[str], list[str]] = defaultdict(list)
    for told, own in models.items():
        merged[frozenset(own)].append(told)
    yield "| robots | engines and their reasons |"
    yield "| --- | --- |"
    for names, reasons in sorted(merged.items(), key=lambda item: listed(item[0]).lower()):
        by = "; ".join(f"{listed(engines[told])}: “{told}”" for told in sorted(reasons, key=lambda told: listed(engines[told])))
        yield f"| {listed(names)} | {by} |"


def file_rows(rows: Rows) -> Iterator[str]:
    """The fourth table: what the specification refuses in the files, and what no body can have."""
    links: dict[str, dict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        if row["engine"] == "file":
            told = ELEMENT.sub(r"`\g<0>`", NAMED.sub("'…'", PLACE.sub("", row["engine_value"])))
            links[told][short(row["model"])].append(row["subject"])
    alike: dict[str, list[str]] = defaultdict(list)
    for told, by_model in links.items():
        alike["; ".join(_of_models(by_model))].append(told)
    yield "| robots and their links or joints | what is wrong |"
    yield "| --- | --- |"
    for subjects, texts in alike.items():
        yield f"| {subjects} | {'; '.join(texts)} |"


def impossible_files(rows: Rows) -> Iterator[str]:
    """The number of files that state what no body can have."""
    models = {row["model"] for row in rows}
    impossible = {row["model"] for row in rows if row["engine"] == "file" and row["quantity"] in OF_BODIES}
    yield f"{len(impossible)} of {len(models)} files state values that no body can have."


def _of_models(by_model: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Robots with their links; those with the same links together."""
    same: dict[tuple[str, ...], list[str]] = defaultdict(list)
    for model, subjects in by_model.items():
        same[tuple(subjects)].append(model)
    for subjects, models in same.items():
        named = ", ".join(subjects) if len(subjects) <= 4 else f"{', '.join(subjects[:3])} and {len(subjects) - 3} more"
        yield f"{listed(models)}: {named}"


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="Print the tables of docs/robots.md.")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="the results of bodycheck parity")
    path = parser.parse_args(arguments).folder / "parity.csv"
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    parts = (engine_rows, cause_rows, refusal_rows, file_rows, impossible_files)
    print("\n\n".join("\n".join(part(rows)) for part in parts))


if __name__ == "__main__":
    main()

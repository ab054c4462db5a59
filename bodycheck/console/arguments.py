"""Load the cases and engines that a command names, and check paths and numbers of the command line."""

import os
import sys
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bodycheck.casefile.robot_notes import Ignored
from bodycheck.errors import BadInput, Failed
from bodycheck.files import writing
from bodycheck.suggestion import did_you_mean

if TYPE_CHECKING:
    from bodycheck.adapters.contract import Engine, Method
    from bodycheck.casefile.case import Case, Fault
    from bodycheck.results.unchecked import Absence
    from bodycheck.running.named import Decision, Named


@dataclass(frozen=True)
class Robots:
    """The way in which files of robots are read that are given in the place of cases. The command line shows these texts.

    Attributes
    ----------
    package_path
        A folder in which packages of robots are found. May be given several times.
    ignore
        What is left out of a robot's file that is given in the place of a case. May be given several times.
    """

    package_path: tuple[Path, ...] = ()
    ignore: tuple[Ignored, ...] = ()


#: The options of a command that has none of them.
AS_THEY_ARE = Robots()

#: The largest number of scenes in a batch. Their models and states need some gigabytes in some engines.
MOST_SCENES = 100_000


def case_names(cases: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names of shipped cases and paths of files that CASE arguments stand for; by default, all shipped cases.

    Raises `BadInput` if a folder or a pattern stands for no case file. Each returned name or path is itself a valid argument.
    """
    from bodycheck.casefile.case import shipped
    from bodycheck.casefile.finding import named

    return named(cases, shipped()) if cases else shipped()


def load_case(argument: str, robots: Robots = AS_THEY_ARE) -> "Case":
    """Load the one case that an argument stands for. Raises `CaseFaults`, and `BadInput` if it stands for several cases."""
    names = case_names((argument,))
    if len(names) > 1:
        raise BadInput(f"{argument}: stands for {len(names)} cases, of which one is needed: {names[0]}, {names[1]}, …")
    (case,) = load_cases(names, robots)
    return case


def load_cases(cases: tuple[str, ...], robots: Robots = AS_THEY_ARE) -> "list[Case]":
    """Load the cases that CASE arguments stand for; by default, all shipped cases.

    Raises `CaseFaults` with the faults of all files, and `BadInput` if a folder or a pattern stands for no case file.
    """
    from bodycheck.casefile.case import CaseFaults

    loaded = read_cases(cases, robots)
    if loaded.faults:
        raise CaseFaults(loaded.faults)
    return loaded.cases


@dataclass(frozen=True)
class Loaded:
    """The cases that arguments stand for.

    Attributes
    ----------
    cases, names
        The cases, and the names or paths from which they were loaded.
    faults
        The faults of all files that are no cases.
    """

    cases: "list[Case]"
    names: tuple[str, ...]
    faults: "tuple[Fault, ...]"


def read_cases(cases: tuple[str, ...], robots: Robots = AS_THEY_ARE) -> Loaded:
    """Load the cases that CASE arguments stand for, by default all shipped cases; files with faults are left out.

    robots: the way in which robots' files are read.

    Raises `CaseFaults` with the faults of all files if no case is left, and `BadInput` if a folder or a pattern stands for no
    case, or there is no robot's file for `--ignore`.
    """
    from bodycheck.casefile.case import CaseFaults, Fault
    from bodycheck.casefile.robots import loading

    meant = case_names(cases)
    robot_names = loading.names(meant)
    if robots.ignore and not robot_names:
        raise BadInput(
            f"--ignore {robots.ignore[0]}: is for files of robots in the place of cases; a case file says so by the key ignore "
            "of its table [model]"
        )
    loaded: dict[str, tuple[Case, str]] = {}
    faults: list[Fault] = []
    for argument in meant:
        try:
            case = loading.load(argument, packages=robots.package_path, ignore=robots.ignore, name=robot_names.get(argument))
        except CaseFaults as error:
            faults += error.faults
            continue
        if case.name in loaded:
            faults.append(Fault(argument, f"another of these cases also has the name {case.name!r}"))
        else:
            loaded[case.name] = case, argument
    if faults and not loaded:
        raise CaseFaults(tuple(faults))
    return Loaded([case for case, _ in loaded.values()], tuple(name for _, name in loaded.values()), tuple(faults))


def tell_left_out(loaded: Loaded) -> None:
    """Print to stderr the faults of all files that are left out."""
    if loaded.faults:
        print("bodycheck: files with faults are left out:", *loaded.faults, sep="\n", file=sys.stderr)


@dataclass(frozen=True)
class Engines:
    """The engines that a command can use, and the engines that it cannot use.

    Attributes
    ----------
    records
        The records of the engines by name.
    missing
        The reasons why installed engines cannot be used, by their names.
    broken
        The missing engines that fail when they are imported.
    named
        The engines and methods that the user named.
    """

    records: "dict[str, Engine]"
    missing: dict[str, str]
    broken: frozenset[str]
    named: "Named"

    def absence(self, name: str) -> "Absence | None":
        """Return why an engine cannot be used; None if it can, or if the user named others."""
        from bodycheck.results.unchecked import Absence
        from bodycheck.running import engines

        if name in self.records or (self.named.engine and name not in self.missing):
            return None
        fault = engines.faults([name])[name]
        return Absence(fault.reason, fault.broken)

    def failed(self, cases: "Iterable[Case]" = ()) -> bool:
        """Return whether a named engine fails or, if none is named, an engine for which a case has expectations."""
        expected = {expectation.engine for case in cases for expectation in case.expectations}
        return bool(self.broken if self.named.engine else self.broken & expected)

    def check_planned(self, cases: "Sequence[Case]", planned: "Iterable[tuple[str, Method]]") -> None:
        """Print on stderr which engines have no method of a named alias, and check what is planned.

        Raises `BadInput` as `bodycheck.running.named.check_planned` does.
        """
        from bodycheck.running import named, roles

        named.check_planned(self.named, self.records, planned)
        for why in roles.lacking(cases, self.records, self.named.integrator):
            print(f"bodycheck: left out: {why}", file=sys.stderr)

    def decided(
        self,
        rows: "Iterable[Mapping[str, Any]]",
        cases: "Iterable[Case]" = (),
        failed: bool = False,
        measured: "Collection[str] | None" = None,
        batch: tuple[int, ...] = (),
    ) -> "Decision":
        """Return the decision on a command that used these engines; for the arguments see `bodycheck.running.named`.

        cases: the cases of the command. An engine for which one of them has expectations must not fail.
        """
        from bodycheck.running import named

        statuses = named.MEASURED if measured is None else measured
        asked, has_failed = replace(self.named, batch=batch), failed or self.failed(cases)
        return named.decide(asked, rows, has_failed, self.missing, statuses, self.records)


def load_engines(
    names: tuple[str, ...], expected: "Mapping[str, bool] | None" = None, integrators: tuple[str, ...] = ()
) -> Engines:
    """Return the named engines, each `NAME` or `NAME@VERSION`. None is imported here.

    If none is named, return all installed engines, and the releases for which a case has expectations.

    Parameters
    ----------
    names
        The engines that the user named.
    expected
        Releases of engines, each `NAME@VERSION`, for which a case has expectations, and whether their absence is tolerated.
    integrators
        The spellings of the methods that the user named.

    Raises
    ------
    BadInput
        A named engine, or an expected engine whose absence is not tolerated, is unknown or not installed, no engine can be
        used, or a named engine has none of the named methods.
    Failed
        All named engines fail.
    """
    from bodycheck.adapters import registry
    from bodycheck.running import engines, named

    releases = expected or {}
    needed = names or [name for name, tolerated in releases.items() if not tolerated]
    wanted = tuple(dict.fromkeys(names or (*registry.names(), *releases)))
    for name in wanted:
        check_engine(name)
    records, faults = engines.describe(wanted)
    if lacking := next((fault for name, fault in faults.items() if name in needed and not fault.broken), None):
        raise BadInput(lacking.reason)
    missing = {name: fault.reason for name, fault in faults.items() if fault.broken or _should_be_there(name)}
    for reason in missing.values():
        print(f"bodycheck: {reason}; continuing without it", file=sys.stderr)
    if not records:
        raise Failed("no engine can be used") if names else BadInput("no engine can be used")
    asked = named.Named(engine=names, integrator=integrators)
    named.check(asked, records)
    return Engines(
        records=records,
        missing=missing,
        broken=frozenset(name for name, fault in faults.items() if fault.broken),
        named=asked,
    )


def _should_be_there(name: str) -> bool:
    """Return whether an engine that cannot be imported is installed with bodycheck, or its adapter does not state it."""
    from bodycheck.adapters import registry
    from bodycheck.adapters.engine_name import EngineName

    asked = EngineName.parse(name)
    source = registry.known_installation(asked.adapter)
    return asked.version is None and (source is None or registry.installed(asked.adapter) is not None)


def check_engine(name: str) -> None:
    """Raise `BadInput` for the name of an engine, with or without a version, that has no adapter. It need not be installed."""
    from bodycheck.adapters import registry
    from bodycheck.adapters.engine_name import EngineName

    adapter, known = EngineName.parse(name).adapter, registry.names()
    if adapter not in known:
        raise BadInput(f"there is no engine {adapter!r}; there are: {', '.join(known)}{did_you_mean(adapter, known)}")


def files_of(cases: "list[Case]", names: tuple[str, ...]) -> dict[str, Path]:
    """Return the files of cases, by the name of the case, without shipped cases.

    `names` are the names that `case_names` returned, from which `load_cases` loaded the cases.
    """
    from bodycheck.casefile.case import shipped

    given = zip(cases, names, strict=True)
    return {case.name: Path(name) for case, name in given if name not in shipped()}


def check_writable(option: str, path: Path | None) -> None:
    """Raise `BadInput` if the file that an option names cannot be written. This is checked before a long run."""
    if path is not None and (path.is_dir() or not path.parent.is_dir()):
        raise BadInput(f"{option} {path}: {'is a folder' if path.is_dir() else f'there is no folder {path.parent}'}")


def check_has_folder(figures: tuple[str, ...], out: Path | None) -> None:
    """Raise `BadInput` if plots are requested without a folder to write them into."""
    if figures and out is None:
        raise BadInput(f"--figures {figures[0]}: needs --out, the folder to write into")


def folder_for(folders: tuple[Path, ...], out: Path | None) -> Path:
    """Return the folder for the report of the results in some folders.

    Raises `BadInput` if there is no folder, or if several are given without `--out` or with one of them as `--out`.
    """
    if not folders:
        raise BadInput("report: give at least one folder of results")
    if out is None and len(folders) > 1:
        raise BadInput("report: give --out, the folder for the report of several folders")
    if out is not None and len(folders) > 1 and out.resolve() in {folder.resolve() for folder in folders}:
        raise BadInput(f"--out {out}: is one of the folders to be compared; its own report must not be overwritten")
    return folders[0] if out is None else out


def make_folder(option: str, path: Path | None) -> None:
    """Make the folder that an option names; do nothing if it is None. Raises `BadInput` if the folder cannot be made."""
    if path is not None:
        try:
            writing.make_folder(path)
        except writing.NotWritten as error:
            raise BadInput(f"{option}: the folder cannot be made: {error}") from error


def batch_sizes(option: str, texts: Iterable[str]) -> tuple[int, ...]:
    """Return the numbers of scenes in the texts of an option, each number once, in ascending order.

    A text contains one number, or several separated by commas. Raises `BadInput` for anything but whole numbers from 1 to
    `MOST_SCENES`.
    """
    sizes = set()
    for text in texts:
        for part in text.split(","):
            number = int(part) if part.strip().isdecimal() and part.isascii() else 0
            if not 1 <= number <= MOST_SCENES:
                allowed = f"whole numbers from 1 to {MOST_SCENES}, with commas between them"
                raise BadInput(f"{option} {text}: read {part.strip()!r}; allowed: {allowed}")
            sizes.add(number)
    return tuple(sorted(sizes))


def processes(jobs: int | None) -> int:
    """Return the number of processes to use; if it is None, the number of processors. Raises `BadInput` if below 1."""
    if jobs is not None and jobs < 1:
        raise BadInput(f"--jobs {jobs}: must be at least 1")
    return jobs or os.cpu_count() or 1

"""Convert the arguments of the Python interface to the form of the command line, with the same messages for bad ones."""

from collections.abc import Iterable, Sequence
from numbers import Real
from pathlib import Path
from typing import TypeAlias

from bodycheck import conversion
from bodycheck.casefile.case import Case, load, parse_stored, shipped
from bodycheck.casefile.mechanisms.grammar import IGNORED
from bodycheck.console.arguments import AS_THEY_ARE, Robots, case_names, load_case, load_cases, processes
from bodycheck.console.ran import Given
from bodycheck.errors import BadInput

#: The name of a shipped case, a path of a case file, a folder or a pattern, or a case that was loaded.
OneCase: TypeAlias = str | Path | Case

#: One or several cases.
Cases: TypeAlias = OneCase | Iterable[OneCase]

#: A description of the values that are accepted as a case.
A_CASE = "a name, a path or what bodycheck.load returns"

#: One or several names, such as names of engines.
Names: TypeAlias = str | Iterable[str]

#: One or several numbers, such as time steps (s).
Numbers: TypeAlias = float | Iterable[float]


def listed(cases: Cases) -> tuple[OneCase, ...]:
    """Return one or several cases as a tuple. Raises `BadInput` for anything that is no case."""
    each = (cases,) if isinstance(cases, str | Path | Case) else _several("CASE", cases, f"{A_CASE}, or several")
    for one in each:
        if not isinstance(one, str | Path | Case):
            raise BadInput(f"Invalid value for CASE: read {one!r}; allowed: {A_CASE}.")
    return tuple(one for one in each if isinstance(one, str | Path | Case))


def robots(package_path: object, ignore: Names) -> Robots:
    """Return the way in which robots' files are read. Raises `BadInput` for a word that leaves nothing out."""
    words = names("--ignore", ignore)
    if unknown := [word for word in words if word not in IGNORED]:
        raise BadInput(f"Invalid value for --ignore: read {unknown[0]!r}; allowed: {', '.join(IGNORED)}.")
    return Robots(paths("--package-path", package_path), tuple(word for word in IGNORED if word in words))


def of_robots(robots: Robots) -> dict[str, list[str]]:
    """Return the way in which robots' files are read as options for `command`."""
    return {"package_path": list(map(str, robots.package_path)), "ignore": list(robots.ignore)}


def given_cases(each: Sequence[OneCase], robots: Robots = AS_THEY_ARE) -> Given:
    """Return the cases that arguments stand for; all shipped cases if there are no arguments.

    robots: the way in which robots' files are read, but not those of cases that were loaded.

    Raises `CaseFaults` with the faults of all files, and `BadInput` for a folder or a pattern that stands for no case file, for
    two different cases with the same name, and for a case that was changed after it was loaded.
    """
    loaded = [one for one in each if isinstance(one, Case)]
    texts = [str(one) for one in each if not isinstance(one, Case)]
    for case in loaded:
        _check_unchanged(case)
    meant = case_names(tuple(texts)) if texts or not loaded else ()
    if robots.ignore and not meant:
        raise BadInput(f"--ignore {robots.ignore[0]}: is an argument of bodycheck.load for a case that is loaded")
    read = load_cases(meant, robots) if meant else []
    of_files = Given.of(read, meant)
    known = of_files.shipped | {case.name for case in loaded if _is_shipped(case)}
    return Given(_distinct([*read, *loaded]), of_files.files, known)


def one_case(case: OneCase, robots: Robots = AS_THEY_ARE) -> Case:
    """Return the one case that an argument stands for. Raises as `given_cases`, and `BadInput` for several cases."""
    (one,) = listed((case,))
    if not isinstance(one, Case):
        return load_case(str(one), robots)
    (given,) = given_cases((one,), robots).cases
    return given


def names(option: str, given: Names) -> tuple[str, ...]:
    """Return one or several names as a tuple. For anything else, raise `BadInput` that names the option."""
    each = (given,) if isinstance(given, str) else _several(option, given, "a text, or several")
    return tuple(conversion.name(option, value) for value in each)


def numbers(option: str, given: Numbers) -> tuple[float, ...]:
    """Return one or several numbers as a tuple. For anything else, raise `BadInput` that names the option."""
    each = (given,) if isinstance(given, str | Real) else _several(option, given, "a number, or several")
    return tuple(conversion.number(option, value) for value in each)


def path(option: str, given: object) -> Path | None:
    """Return a path, or None for None. For anything else, raise `BadInput` that names the option."""
    if given is None or isinstance(given, str | Path):
        return None if given is None else Path(given)
    raise BadInput(f'Invalid value for {option}: unable to convert "{given}" into Path.')


def paths(option: str, given: object) -> tuple[Path, ...]:
    """Return one or several paths as a tuple. For anything else, raise `BadInput` that names the option."""
    each = (given,) if isinstance(given, str | Path) else _several(option, given, "a path, or several")
    return tuple(one for one in (path(option, value) for value in each) if one is not None)


def jobs_of(given: object) -> int:
    """Return the number of processes; for None, the number of processors. Raises `BadInput` unless it is at least 1."""
    return processes(None if given is None else conversion.whole_number("--jobs", given))


def command(function: str, cases: Sequence[OneCase], **options: object) -> list[str]:
    """Return the call of a function of the interface as text, for the header of its results. Empty options are left out."""
    shown = [repr(one.name if isinstance(one, Case) else str(one)) for one in cases]
    if len(shown) != 1:
        shown = [f"[{', '.join(shown)}]"] if shown else []
    options_given = [f"{name}={value!r}" for name, value in options.items() if value not in (None, (), [], "", False)]
    return [f"bodycheck.{function}({', '.join([*shown, *options_given])})"]


def _several(option: str, given: object, allowed: str) -> tuple[object, ...]:
    if not isinstance(given, Iterable):
        raise BadInput(f"Invalid value for {option}: read {given!r}; allowed: {allowed}.")
    return tuple(given)


def _distinct(cases: list[Case]) -> list[Case]:
    """Return cases without repetitions. Raises `BadInput` for two different cases with the same name."""
    by_name: dict[str, Case] = {}
    for case in cases:
        if by_name.setdefault(case.name, case) != case:
            raise BadInput(f"{case.name}: another of these cases also has the name {case.name!r}")
    return list(by_name.values())


def _check_unchanged(case: Case) -> None:
    """Raise `BadInput` for a case that differs from the text of its file: results store the text, and are read with it."""
    if parse_stored(case.text, case.name) != case:
        raise BadInput(
            f"{case.name}: was changed after it was loaded; a study stores the text of the case file, so that the change must "
            "be made there (bodycheck.simulate runs changed cases)"
        )


def _is_shipped(case: Case) -> bool:
    return case.name in shipped() and load(case.name) == case

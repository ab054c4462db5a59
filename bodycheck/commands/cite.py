"""The command `bodycheck cite`.

The imports are inside the functions, so that `--help` answers at once.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from bodycheck.console import arguments
from bodycheck.console.options import Json
from bodycheck.errors import OK, BadInput

if TYPE_CHECKING:
    from bodycheck.casefile.case import Case

Sources = Annotated[
    tuple[str, ...],
    Parameter(help="A CASE whose source is cited. May be given several times. Default: all shipped cases."),
]

#: The year of this release.
YEAR = 2026

#: Characters that LaTeX takes for commands, and how they are written. BibTeX counts braces with a backslash before them too.
ESCAPED = {
    **{character: f"\\{character}" for character in "&%$#_"},
    "{": r"{\textbraceleft}",
    "}": r"{\textbraceright}",
    "\\": r"{\textbackslash}",
    "~": r"{\textasciitilde}",
    "^": r"{\textasciicircum}",
}


@dataclass(frozen=True)
class Citation:
    """An entry of a bibliography.

    Attributes
    ----------
    kind
        What is cited.
    name
        The name of the engine with its version, or of the case or the publication.
    bibtex
        The entry.
    """

    kind: Literal["bodycheck", "engine", "source"]
    name: str
    bibtex: str


def cite(*engines: str, case: Sources = (), json: Json = False) -> int:
    """Print how to cite bodycheck, engines, and the sources of cases, as BibTeX.

    An engine is cited by the publication that its authors ask for, with its version. The source of a case is cited by the
    publication that it names, or else in its own words, which are left out of shipped cases. Exit codes: 0 success; 2 bad input
    or usage.

    Parameters
    ----------
    engines
        Engines, each `NAME` or `NAME@VERSION`. Default: all installed engines.
    """
    from bodycheck.console import terminal

    citations = [_own(), *_of_engines(engines), *_of_sources(arguments.load_cases(arguments.case_names(case)))]
    if json:
        terminal.print_json([asdict(citation) for citation in citations])
    else:
        print("\n\n".join(citation.bibtex for citation in citations))
    return OK


def _own() -> Citation:
    """Return the citation of bodycheck in the version that runs."""
    from importlib.metadata import metadata

    described = metadata("bodycheck")
    addresses = dict(line.split(", ", 1) for line in described.get_all("Project-URL") or ())
    fields = {
        "author": "{The bodycheck developers}",
        "title": f"bodycheck: {_escaped(described['Summary'])}",
        "year": str(YEAR),
        "note": f"Version {_escaped(described['Version'])}",
        "howpublished": f"\\url{{{addresses['Repository']}}}",
    }
    return Citation("bodycheck", "bodycheck", _entry("misc", "bodycheck", fields))


def _of_engines(names: Sequence[str]) -> Iterator[Citation]:
    """Yield the citations of engines; if none is named, of those that are installed. Raises `BadInput` for an unknown one."""
    from bodycheck.adapters import registry
    from bodycheck.adapters.engine_name import EngineName
    from bodycheck.running import engines as installed

    asked = {name: EngineName.parse(name) for name in names}
    for name, engine in asked.items():
        if engine.adapter not in registry.names():
            known = ", ".join(registry.names())
            raise BadInput(f"cite {name}: there is no engine {engine.adapter!r}; allowed: {known}")
    records, _ = installed.describe(names or registry.names())
    versions = {name: record.version for name, record in records.items()}
    for name in names or versions:
        adapter, version = EngineName.parse(name).adapter, EngineName.parse(name).version or versions.get(name)
        yield Citation("engine", f"{adapter}@{version}" if version else adapter, _of_engine(adapter, version))


def _of_engine(adapter: str, version: str | None) -> str:
    """Return the entry of an engine: that of its adapter, or for an adapter of another package the name alone."""
    from importlib import resources

    note = {} if version is None else {"note": f"Version {_escaped(version)}"}
    file = resources.files("bodycheck.adapters") / adapter / "citation.bib"
    if not file.is_file():
        return _entry("misc", adapter, {"title": f"{{{_escaped(adapter)}}}", **note})
    lines = file.read_text("utf-8").strip().removesuffix("}")
    return lines + "".join(f"  {key} = {{{value}}},\n" for key, value in note.items()) + "}"


def _of_sources(cases: "Sequence[Case]") -> Iterator[Citation]:
    """Yield the citations of the sources of cases, each publication once."""
    from bodycheck.casefile.case import shipped

    publications, names = _publications(), frozenset(shipped())
    cited: dict[str, Citation] = {}
    for case in cases:
        keys = [key for key, (words, _) in publications.items() if words in case.source]
        for key in keys:
            cited[key] = Citation("source", key, publications[key][1])
        if not keys and case.source and case.name not in names:
            fields = {"title": _escaped(case.title or case.name), "note": f"Source of the case: {_escaped(case.source)}"}
            cited[f"case {case.name}"] = Citation("source", case.name, _entry("misc", case.name, fields))
    yield from cited.values()


def _publications() -> dict[str, tuple[str, str]]:
    """Return the words of sources that stand for publications, and their entries, by the key of the entry."""
    import tomllib
    from importlib import resources

    tables = tomllib.loads((resources.files("bodycheck.cases") / "sources.toml").read_text("utf-8"))
    return {key: (table["words"], table["bibtex"].strip()) for key, table in tables.items()}


def _entry(kind: str, key: str, fields: Mapping[str, str]) -> str:
    return f"@{kind}{{{key},\n" + "".join(f"  {name} = {{{value}}},\n" for name, value in fields.items()) + "}"


def _escaped(text: str) -> str:
    """Return a text as LaTeX, on one line."""
    return re.sub(r"[{}&%$#_\\~^]", lambda match: ESCAPED[match[0]], " ".join(text.split()))

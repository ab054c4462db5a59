"""The report of contact: settings of engines, properties of their contacts, and the figures of each scene."""

from collections import Counter
from collections.abc import Mapping, Sequence

from bodycheck.casefile.content import Case
from bodycheck.reports.finding import Finding
from bodycheck.reports.notices import of_header
from bodycheck.reports.quantities import QUANTITIES, count, listing, number
from bodycheck.reports.study import Part, StudyReport
from bodycheck.reports.tables import Entry, Table
from bodycheck.results.header import Header
from bodycheck.studies.contact.rows import ContactRow, PropertyRow, Setting, SettingRow, Sheet, method_in_words
from bodycheck.studies.contact.wording import COLUMNS, law

#: The names of the parts with the settings and with the properties of contacts.
OF_SETTINGS, OF_PROPERTIES = "settings", "properties"

#: The groups of scenes in words.
GROUPS = {"plane": "sliding flat", "contact": "touching", "impact": "bouncing"}

#: Explanations for readers.
READING = (
    "“Defaults” is the default method of the engine, which a user of its quick start gets: its integrator, time step and "
    "contact settings. A library without a stepper has none. “Recommended” is what the engine's documentation recommends, if "
    "it recommends anything. “Best” is the best method that a search found, one for all scenes of a group: it changes the "
    "integrator, each option and the time step, first one by one and then together, and compares the largest errors of the "
    "position in a few short scenes. It is best in the mean; in a single figure another method can be better. In scenes of "
    "more than 50 000 steps it has the time step of the defaults.",
    "The error of a setting is the geometric mean over the scenes of the search of its largest error of the position, relative "
    "to that of the first setting of the engine. “Law given” is what the engine was handed in the place of the friction and "
    "the restitution of the case.",
    "Properties are measured by probes, which are short motions whose outcome is known. A ball is asked to keep half of its "
    "speed in an impact without gravity and friction, also with a quarter of the time step; the value is the mean over the "
    "instant of the impact within a step. A ball bounces where it keeps at least half of that. Energy of an impact: relative "
    "change in the impact of two boxes with a restitution of 1. Depth: of a ball at rest; if it grows with the mass, the plane "
    "is a spring. Asleep below: speed below which a rolling ball suddenly rests. Creep: of a box on a ramp on which nine "
    "tenths of the friction should hold it. Viscous below: speed below which friction is less than nine tenths of Coulomb's "
    "law. Anisotropy: 1 minus the ratio of the smallest to the largest friction over four directions. In mechanics, a ball "
    "keeps 0.5, and all others are 0.",
    "“In mechanics” is the exact value of what a figure measures the error of, such as the instant of an impact; it is 0 for "
    "what should not be at all, such as creep. A dash means that there is no value.",
)


def present(header: Header, cases: Mapping[str, Case], sheet: Sheet, reasons: Mapping[tuple[str, str], str]) -> StudyReport:
    """Return the contents of the report.

    Parameters
    ----------
    header
        The header of the results, with versions, machine and command.
    cases
        The cases, by name.
    sheet
        The rows of the study.
    reasons
        The reasons why default methods did not complete a case, by the names of engine and case.
    """
    scenes = {name: [row for row in sheet.figures if row.scene == name] for name in cases}
    return StudyReport(
        title="Contact: rolling, bouncing, resting, tipping",
        headline=f"{count(len(cases), 'scene')} in {count(len({row.engine for row in sheet.figures}), 'engine')}",
        header=header,
        notices=tuple(of_header(header)),
        findings=tuple(findings(sheet, reasons)),
        parts=(
            *((_overview(cases, sheet.figures),) if len({row.engine for row in sheet.figures}) > 1 else ()),
            *((_settings(sheet.settings),) if sheet.settings else ()),
            *((_properties(sheet.properties),) if sheet.properties else ()),
            *(_scene(cases[name], rows, reasons) for name, rows in scenes.items()),
        ),
        reading=READING,
    )


def findings(sheet: Sheet, reasons: Mapping[tuple[str, str], str]) -> list[Finding]:
    """Return sentences about the contacts of each engine, and about all engines: the best settings, and the largest faults."""
    sentences = []
    for engine in dict.fromkeys(row.engine for row in sheet.properties):
        of_engine = [row for row in sheet.properties if row.engine == engine]
        first = of_engine[0].setting
        before = f"{'At its defaults' if first == 'defaults' else 'At the best settings'}, {law(_of(of_engine, first))[:-1]} ("
        sentences.append(Finding(engine, before, OF_PROPERTIES, ")."))
    better = [row for row in sheet.settings if row.setting == "best" and row.error is not None and row.error < 1]
    if better:
        gains = dict.fromkeys(row.engine for row in better)
        texts = [f"{engine} ({_smallest(better, engine)})" for engine in gains]
        before = (
            "In the mean, the largest errors of the position at the best settings that were found, relative to those of the "
            f"first setting of each engine: {listing(texts)}, see "
        )
        sentences.append(Finding("Best settings", before, OF_SETTINGS, "."))
    for figure, said in (
        ("creep", "At their defaults, bodies that should rest creep at up to"),
        ("energy_gain", "At their defaults, the energy grows by up to this part of the largest energy:"),
    ):
        worst = _worst(sheet.figures, figure)
        if worst:
            sizes = [f"{number(row.value, 3)}{f' {row.unit}' if figure == 'creep' else ''} ({row.engine})" for row in worst]
            before = f"{said} {listing(sizes)}; the largest is in "
            sentences.append(Finding(QUANTITIES[figure].title, before, worst[0].scene, "."))
    lacking = Counter(engine for engine, _ in reasons)
    if lacking:
        numbers = [f"{engine} {count(amount, 'scene')}" for engine, amount in lacking.items()]
        first_case = next(iter(reasons))[1]
        before = f"Scenes that are not completed at the defaults: {listing(numbers)}. Each scene has the reasons, for example "
        sentences.append(Finding("Not completed", before, first_case, "."))
    return sentences


def _of(rows: Sequence[PropertyRow], setting: Setting) -> list[PropertyRow]:
    return [row for row in rows if row.setting == setting]


def _smallest(rows: Sequence[SettingRow], engine: str) -> str:
    """Return the errors of the best settings of an engine by group, in words."""
    return ", ".join(f"{number(row.error, 2)} {GROUPS[row.group]}" for row in rows if row.engine == engine)


def _worst(rows: Sequence[ContactRow], figure: str) -> list[ContactRow]:
    """Return the row of each engine with the largest value of a figure at its defaults, the largest first."""
    worst: dict[str, ContactRow] = {}
    for row in rows:
        largest = worst[row.engine].value if row.engine in worst else 0.0
        if row.figure == figure and row.setting == "defaults" and (row.value or 0.0) > (largest or 0.0):
            worst[row.engine] = row
    return sorted(worst.values(), key=lambda row: -(row.value or 0.0))


def _overview(cases: Mapping[str, Case], rows: Sequence[ContactRow]) -> Part:
    """Return the part with one row for each scene and one column for each engine: the errors of the position at defaults."""
    engines = tuple(dict.fromkeys(row.engine for row in rows))
    first: dict[tuple[str, str], ContactRow] = {}
    best: dict[tuple[str, str], float | None] = {}
    for row in rows:
        if row.figure in ("", "position_error"):
            first.setdefault((row.scene, row.engine), row)
            if row.setting == "best":
                best[row.scene, row.engine] = row.value

    def cell(scene: str, engine: str) -> Entry:
        row = first.get((scene, engine))
        if row is None:
            return Entry("–")
        meaning = f"best: {number(best.get((scene, engine)), 2)}"
        return Entry(number(row.value, 2), row.value, meaning) if row.figure else Entry("no", meaning=row.status)

    table = Table(
        columns=("Scene", *engines),
        numeric=(False, *(True,) * len(engines)),
        rows=tuple((Entry(name, link=name), *(cell(name, engine) for engine in engines)) for name in cases),
        failed=(False,) * len(cases),
        notes=(
            "“no”: the engine does not complete the scene; the scene has the reason. An engine without a default has the first "
            "of its other settings.",
        ),
        keys=1,
    )
    return Part("overview", "Overview", (), (), (("Largest error of the position at the defaults, m", table),))


def _settings(rows: Sequence[SettingRow]) -> Part:
    """Return the part that lists the settings of all engines."""
    columns = ("Engine", "Setting", "Scenes", "Method", "Step, ms", "Error, relative", "Law given")
    cells = tuple(
        (
            Entry(row.engine),
            Entry(row.setting),
            Entry(GROUPS[row.group]),
            Entry(row.integrator),
            Entry(f"{1e3 * row.timestep:.4g}", row.timestep),
            Entry(number(row.error, 3), row.error),
            Entry(row.contact_terms),
        )
        for row in rows
    )
    numeric = (False, False, False, False, True, True, False)
    table = Table(columns, numeric, cells, (False,) * len(cells), ())
    return Part(OF_SETTINGS, "Settings", (), (), (("Settings of engines", table),))


def _properties(rows: Sequence[PropertyRow]) -> Part:
    """Return the part with the properties of contacts: a row and a sentence for each engine and its different settings."""
    by_setting: dict[tuple[str, Setting], list[PropertyRow]] = {}
    for row in rows:
        by_setting.setdefault((row.engine, row.setting), []).append(row)
    alike: dict[tuple[str, tuple[tuple[str, float], ...]], list[Setting]] = {}
    for (engine, setting), of_setting in by_setting.items():
        methods = tuple(dict.fromkeys((row.integrator, row.timestep) for row in of_setting))
        alike.setdefault((engine, methods), []).append(setting)
    cells, sentences = [], []
    for (engine, _), settings in alike.items():
        measured, words = by_setting[engine, settings[0]], ", ".join(settings)
        values = {(row.property, row.condition): row for row in measured}
        cells.append((Entry(engine), Entry(words), *(_measured(values.get(column.key)) for column in COLUMNS)))
        sentences.append(f"{engine} ({words}): {law(measured)}")
    columns = ("Engine", "Setting", *(column.title for column in COLUMNS))
    table = Table(columns, (False, False, *(True,) * len(COLUMNS)), tuple(cells), (False,) * len(cells), ())
    return Part(OF_PROPERTIES, "Properties of contacts", tuple(sentences), (), (("Properties of contacts", table),))


def _measured(row: PropertyRow | None) -> Entry:
    return Entry("–") if row is None else Entry(number(row.value, 3), row.value, row.note)


def _scene(case: Case, rows: Sequence[ContactRow], reasons: Mapping[tuple[str, str], str]) -> Part:
    """Return the part of one scene: a row for each engine and method, with all figures."""
    ran = [row for row in rows if row.figure]
    why: dict[str, list[str]] = {}
    for (engine, name), reason in reasons.items():
        if name == case.name:
            why.setdefault(_without_name(reason, engine), []).append(engine)
    texts = (f"{', '.join(engines)}: {reason}." for reason, engines in why.items())
    return Part(
        name=case.name,
        title=case.name,
        texts=(f"{case.title}.", *([case.source] if case.source else []), *texts),
        charts=(),
        tables=(("Figures", _figures(ran)),) if ran else (),
    )


def _without_name(reason: str, engine: str) -> str:
    """Return a reason without the name and the version of its engine, so that engines with the same reason share it."""
    words = reason.split(" ", 2)
    return words[2] if len(words) == 3 and words[0] == engine else reason


def _figures(rows: Sequence[ContactRow]) -> Table:
    """Return the table of a scene. Settings with the same method share a row, and the last row has the exact values."""
    shown = list(dict.fromkeys(row.figure for row in rows))
    methods: dict[tuple[str, str], dict[str, float | None]] = {}
    settings: dict[tuple[str, str], dict[Setting, None]] = {}
    exact: dict[str, float | None] = {}
    for row in rows:
        assert row.timestep is not None  # a run with figures has a method
        key = row.engine, method_in_words(row.integrator, row.timestep)
        methods.setdefault(key, {})[row.figure] = row.value
        settings.setdefault(key, {})[row.setting] = None
        exact[row.figure] = row.truth
    cells = tuple(
        (
            Entry(engine),
            Entry(", ".join(settings[engine, method])),
            *(Entry(number(values.get(name), 3), values.get(name)) for name in shown),
        )
        for (engine, method), values in methods.items()
    )
    return Table(
        columns=("Engine", "Setting", *(QUANTITIES[name].label for name in shown)),
        numeric=(False, False, *(True,) * len(shown)),
        rows=cells,
        failed=(False,) * len(cells),
        notes=(),
        footer=(Entry("In mechanics"), Entry(""), *(Entry(number(exact[name], 3), exact[name]) for name in shown)),
    )

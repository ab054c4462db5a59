"""The sources of the documentation: its configuration, its table of contents and the pages that are generated.

The built documentation is tested in test_site.py.
"""

import posixpath
import re
import runpy
from html import unescape
from pathlib import Path

import pytest
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.highlighting import PygmentsBridge

import bodycheck
from bodycheck.casefile import authoring
from bodycheck.commands.command_line import COMMANDS, app
from bodycheck.figures.columns import COLUMNS, FIGURES, LIMIT_COLUMNS
from bodycheck.studies import registry
from docs.extensions import (
    case_grammar,
    code_lines,
    command_line,
    formulas,
    generated,
    moved,
    python_interface,
    result_columns,
    versions,
)
from tests.support import ROOT

DOCS = ROOT / "docs"

#: All pages by their names, which are their paths without the ending.
PAGES = {
    str(path.relative_to(DOCS).with_suffix("")): path
    for path in sorted([*DOCS.rglob("*.md"), *DOCS.rglob("*.ipynb")])
    if not any(part.startswith((".", "_")) for part in path.relative_to(DOCS).parts)
}

CONTENTS = re.compile(r"^```\{toctree\}\n(.*?)^```", re.MULTILINE | re.DOTALL)


def listed(page: str) -> list[str]:
    """The pages in the tables of contents of a page, in their order."""
    entries = "\n".join(CONTENTS.findall(PAGES[page].read_text("utf-8"))).splitlines()
    names = [entry for entry in entries if entry and not entry.startswith(":")]
    return [posixpath.normpath(posixpath.join(posixpath.dirname(page), name)) for name in names]


def listed_below(page: str) -> list[str]:
    """The pages in the tables of contents of a page and of those in them."""
    return [name for each in listed(page) for name in (each, *listed_below(each))]


def test_the_configuration_loads() -> None:
    configuration = runpy.run_path(str(DOCS / "conf.py"))
    assert configuration["release"] == bodycheck.__version__
    for extension in configuration["extensions"]:
        if extension.startswith("docs."):
            assert (ROOT / f"{extension.replace('.', '/')}.py").is_file()


def test_every_page_is_in_one_table_of_contents() -> None:
    assert sorted(listed_below("index")) == sorted(set(PAGES) - {"index"})


def test_the_navigation_has_few_links() -> None:
    """It has the pages of the front page, beside every page."""
    assert len(listed("index")) <= 25


def test_every_page_is_three_steps_from_the_readme() -> None:
    """From the README to the front page, to a page in its table of contents, and to one in the contents of that page."""
    readme = set(re.findall(r"\]\(docs/([\w/-]+)\.(?:md|ipynb)", (ROOT / "README.md").read_text("utf-8")))
    assert "index" in readme
    first = listed("index")
    assert set(PAGES) - {"index"} <= readme | set(first) | {name for page in first for name in listed(page)}


def test_the_address_of_a_page_that_was_joined_leads_to_its_text() -> None:
    for old, new in moved.MOVED.items():
        page, _, part = new.partition("#")
        assert old not in PAGES
        text = PAGES[page].read_text("utf-8")
        titles = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
        assert not part or part in {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}, new
    assert 'href="../howto/gate-ci.html#baselines"' in moved.page("old/ci", "howto/gate-ci#baselines")


def test_lines_of_code_have_elements_and_keep_their_text() -> None:
    bridge = PygmentsBridge("html")
    bridge.formatter = code_lines.LineFormatter
    html = bridge.highlight_block("a = 1  # one\n\nb = 2", "python")
    assert html.count('<span class="line">') == 3
    assert unescape(re.sub(r"<[^>]*>", "", html)).strip("\n") == "a = 1  # one\n\nb = 2"


@pytest.mark.parametrize("page", sorted(generated.PAGES))
def test_a_generated_page_has_a_place_for_its_text(page: str) -> None:
    assert generated.PAGES[page]() in generated.filled(page, PAGES[page].read_text("utf-8"))


def test_a_page_without_the_place_is_refused() -> None:
    with pytest.raises(ValueError, match=r"docs/reference/columns\.md has no line"):
        generated.filled("reference/columns", "# Columns\n")


def test_a_page_that_is_not_generated_stays_as_it_is() -> None:
    assert generated.filled("truth", generated.MARKER) == generated.MARKER


def test_the_reference_has_every_command_with_its_options_and_exit_codes() -> None:
    page = command_line.page()
    names = dict(command_line.commands())
    assert len(names) >= len(COMMANDS) + 3
    assert {"run", "engines", "engines add", "engines remove", "engines check"} <= names.keys()
    sections = dict(re.findall(r"^#{2,3} bodycheck ([a-z ]+)\n(.*?)(?=^##|\Z)", page, re.MULTILINE | re.DOTALL))
    assert sections.keys() == names.keys()
    for name, command in names.items():
        assert "xit code" in sections[name], name
        for argument in command.assemble_argument_collection(default_parameter=app.default_parameter):
            if argument.show:
                assert f"{{option}} {argument.names[0]}" in sections[name], (name, argument.names)


def test_every_option_is_explained() -> None:
    for name, command in command_line.commands():
        for argument in command_line.arguments(command):
            assert argument.parameter.help, f"bodycheck {name}: {argument.names[0]}"


def test_the_reference_has_every_key_of_case_files() -> None:
    page = case_grammar.page()
    sections = dict(re.findall(r"^\(case-(\w+)\)=\n(.*?)(?=^\(case-|\Z)", page, re.MULTILINE | re.DOTALL))
    keys = list(case_grammar.keys())
    assert len(keys) > 100
    for table, key in keys:
        assert f"`{key}`" in sections[table.lower()], (table, key)
    assert set(re.findall(r"\(#case-(\w+)\)", page)) <= sections.keys()


def test_a_key_has_its_unit_limits_and_default() -> None:
    page = case_grammar.page()
    assert "| **`duration`** | number > 0 | s |" in page
    assert "| **`samples`** | integer from 2 to 100001 |" in page
    assert "| `gravity` | number ≥ 0 | m/s^2 | `0.0` | along -z |" in page
    assert "| **`semi_axes`** | 3 × number > 0 | m |  | half-lengths along I, J, K |" in page
    assert '"enum"' in authoring.schema()
    assert '`"ok"` or `"unsupported"`' in page


def test_the_reference_has_every_column() -> None:
    page = result_columns.page()
    limits = {column.name for column in LIMIT_COLUMNS}
    for column in COLUMNS.values():
        # The limits and margins of all figures are described at once.
        assert column.name in limits or f"`{column.name}`" in page


def test_the_reference_has_every_column_of_studies() -> None:
    page = result_columns.page()
    described = set(LIMIT_COLUMNS) | set(FIGURES.values())  # at once, with those of results
    for study in registry.STUDIES:
        for table in registry.part(study, "rows").TABLES:
            section = page.partition(f"### {table.file}\n")[2].partition("\n### ")[0]
            for column in table.columns:
                assert column in described or column.name.endswith("_allowance") or f"`{column.name}`" in section, column


def test_every_figure_has_a_formula_that_can_be_displayed() -> None:
    assert formulas.FORMULAS.keys() == FIGURES.keys()
    for formula in formulas.FORMULAS.values():
        assert tex2mathml(formula).startswith("<math")


def test_the_reference_has_every_public_name() -> None:
    named = {name for names in python_interface.TOPICS.values() for name in names}
    assert named == set(bodycheck.__all__) - {"__version__"} == set(bodycheck.HOMES)


def built(folder: Path, version: str, *pages: str) -> None:
    """The folder of a version as a build leaves it."""
    for page in pages:
        path = folder / version / f"{page}.html"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    (folder / version / versions.FILE_NAME).write_text(versions.script({version: pages}))


def test_versions_that_are_put_together_know_each_other(tmp_path: Path) -> None:
    for version in ("0.9.0", "0.10.0", "main"):
        built(tmp_path, version, "index", "howto/gate-ci", *(["new"] if version == "main" else []))
    assert versions.join(tmp_path) == ["0.10.0", "0.9.0", "main"]
    scripts = {(tmp_path / version / versions.FILE_NAME).read_text() for version in ("0.9.0", "0.10.0", "main")}
    assert scripts == {
        versions.script(
            {
                "0.10.0": ["howto/gate-ci", "index"],
                "0.9.0": ["howto/gate-ci", "index"],
                "main": ["howto/gate-ci", "index", "new"],
            }
        )
    }
    assert 'url=0.10.0/index.html"' in (tmp_path / "index.html").read_text()


@pytest.mark.parametrize(("name", "text"), [(None, "no version"), ("<b>", "no name of a version")])
def test_a_folder_without_versions_is_refused(tmp_path: Path, name: str | None, text: str) -> None:
    if name is not None:
        built(tmp_path, name, "index")
    with pytest.raises(ValueError, match=text):
        versions.join(tmp_path)

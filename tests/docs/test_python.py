"""The guide to the Python interface, and its notebook: every block and every cell runs, and says what it is said to."""

import ast
import json
import re
from collections.abc import Iterator
from typing import Any

import pytest

from tests.support import ROOT
from tests.support.processes import calls_here

NOTEBOOK = ROOT / "docs" / "studies.ipynb"


@pytest.fixture(scope="module", autouse=True)
def _processes() -> Iterator[None]:
    with calls_here():
        yield


def executed(source: str, names: dict[str, Any]) -> Any:
    """The value of the last expression of a cell, as a notebook shows it; None if the cell ends with no expression."""
    *statements, last = ast.parse(source).body
    if not isinstance(last, ast.Expr):
        exec(source, names)
        return None
    exec(compile(ast.Module(statements, []), "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names)


def test_the_notebook_runs() -> None:
    """In this process, and not by Jupyter, which would bring a hundred packages for what is done here in ten lines."""
    notebook = json.loads(NOTEBOOK.read_text("utf-8"))
    assert notebook["nbformat"] == 4
    names: dict[str, Any] = {}
    shown = []
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []  # numbers in a file grow old
            value = executed("".join(cell["source"]), names)
            for representation in ("_repr_html_", "_repr_png_"):
                if hasattr(value, representation):
                    assert getattr(value, representation)()
                    shown.append((type(value).__name__, representation))
    assert shown == [
        ("RunResults", "_repr_html_"),
        ("DataFrame", "_repr_html_"),
        ("Plot", "_repr_png_"),
        ("RecommendResults", "_repr_html_"),
        ("Plot", "_repr_png_"),
    ]
    # Euler's method is of order 1 in the position, whose error in uniform gravity has no further term.
    errors = names["errors"]
    assert errors[0.004] / errors[0.002] == pytest.approx(2, rel=0.01)
    assert names["advice"].best.error <= 1e-3
    # The same run again, in the same version on the same machine.
    assert names["largest"]["attitude_error"] == names["advice"].best.error


def test_the_blocks_of_the_guide_run(capsys: pytest.CaptureFixture[str]) -> None:
    loop, single = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "reference" / "python.md").read_text("utf-8"), re.DOTALL)
    exec(loop, {})
    steps, errors = zip(*(map(float, line.split()) for line in capsys.readouterr().out.splitlines()), strict=True)
    assert steps == (0.004, 0.002, 0.001)
    assert errors[0] > errors[1] > errors[2] > 0
    exec(single, {})
    assert 0 < float(capsys.readouterr().out) < errors[2]

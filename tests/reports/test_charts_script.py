"""The script of the charts, a file of the package, is the one that the libraries give, with their licence."""

import shutil
import subprocess
from pathlib import Path

import pytest

from bodycheck import errors
from bodycheck.console import options
from bodycheck.reports import plot_files
from docs import charts_script
from tests.support.commands import bodycheck


def test_the_script_is_that_of_the_libraries() -> None:
    """Of the release of vl-convert in `constraints.txt`; `python docs/charts_script.py` renews the file."""
    assert charts_script.FILE.read_text("utf-8") == charts_script.script()


@pytest.mark.skipif(shutil.which("node") is None, reason="needs Node.js, which executes the script")
def test_the_script_defines_what_pages_call(tmp_path: Path) -> None:
    program = (
        f"globalThis.window = globalThis;\n{charts_script.FILE.read_text('utf-8')}\nconsole.log(typeof window.vegaEmbed);\n"
    )
    (tmp_path / "script.mjs").write_text(program, "utf-8")
    done = subprocess.run(["node", str(tmp_path / "script.mjs")], capture_output=True, text=True, check=True)
    assert done.stdout == "function\n"


def test_plots_as_files_ask_for_what_draws_them(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Before anything runs; a report needs nothing of it."""
    monkeypatch.setitem(__import__("sys").modules, "vl_convert", None)
    monkeypatch.setattr(options, "find_spec", lambda name: None)
    done = bodycheck("run", "free-brick", "--out", "results", "--figures", "svg", folder=tmp_path)
    assert (done.returncode, done.stderr) == (2, "--figures needs vl-convert: pip install 'bodycheck[figures]'\n")
    assert not (tmp_path / "results").exists()
    with pytest.raises(errors.BadInput, match="a plot as a file needs vl-convert"):
        plot_files.rendered({}, "svg")

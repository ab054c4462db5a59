"""Type checkers and editors resolve every import: on a checkout, with an editable install, and with a wheel."""

import ast
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import jedi
import pytest

from tests.support import ROOT
from tests.support.distributions import build_wheel

#: Folders of a checkout that hold Python files. The links in `bodycheck/` lead to the last three.
FOLDERS = ("bodycheck", "tests", "docs", "benchmarks", "reference", "adapters", "reports")

#: What a user of the package writes.
SCRIPT = (
    "from bodycheck.casefile.case import Case\nfrom bodycheck.adapters.contract import Engine\ncase: Case\nreveal_type(Case)\n"
)


def import_lines() -> list[str]:
    """Return every import statement of the checkout once, except those of the miniature engines."""
    found = set()
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*.py"):
            if path.parent.name != "miniature":
                tree = ast.parse(path.read_text("utf-8"))
                found |= {ast.unparse(node) for node in ast.walk(tree) if isinstance(node, ast.Import | ast.ImportFrom)}
    return sorted(line for line in found if "miniature import" not in line and "__future__" not in line)


def unresolved(folder: Path, *extra_paths: Path) -> list[str]:
    """Return the imports of the Python files in a folder that basedpyright does not resolve, as file: message."""
    config = {"typeCheckingMode": "off", "reportMissingImports": "error"}
    (folder / "pyrightconfig.json").write_text(json.dumps(config | {"extraPaths": list(map(str, extra_paths))}))
    command = [sys.executable, "-m", "basedpyright", "--outputjson", "--pythonpath", sys.executable, "--project", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    report = json.loads(done.stdout)
    assert report["summary"]["filesAnalyzed"] > 0
    faults = [fault for fault in report["generalDiagnostics"] if fault["severity"] == "error"]
    return [f"{Path(fault['file']).name}: {fault['message']}" for fault in faults]


def test_every_import_of_the_checkout_resolves(tmp_path: Path) -> None:
    lines = import_lines()
    assert sum(line.startswith("from bodycheck.") for line in lines) > 500
    (tmp_path / "every_import.py").write_text("\n".join(lines) + "\n")
    (tmp_path / "planted.py").write_text("from bodycheck.casefile.no_such_module import Case\n")
    (fault,) = unresolved(tmp_path, ROOT)
    assert fault.startswith("planted.py")
    assert "no_such_module" in fault


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the contents of the wheel, as an ordinary install has them."""
    folder = tmp_path_factory.mktemp("site")
    zipfile.ZipFile(build_wheel(tmp_path_factory.mktemp("wheel"))).extractall(folder)
    return folder


@pytest.mark.parametrize("install", ["editable", "wheel"])
def test_a_script_elsewhere_sees_types_and_definitions(install: str, unpacked: Path, tmp_path: Path) -> None:
    paths = [unpacked] if install == "wheel" else []
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    assert unresolved(tmp_path, *paths) == []
    environment = os.environ | {"MYPYPATH": os.pathsep.join(map(str, paths))}
    command = [sys.executable, "-m", "mypy", "--no-incremental", "--follow-imports=silent", str(script)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert "import-not-found" not in done.stdout
    assert "import-untyped" not in done.stdout
    assert "bodycheck.casefile.case.Case" in done.stdout
    project = jedi.Project(tmp_path, added_sys_path=list(map(str, paths)))
    (name,) = jedi.Script(SCRIPT, path=script, project=project).goto(1, 40, follow_imports=True)
    assert (name.full_name, name.type) == ("bodycheck.casefile.case.Case", "class")

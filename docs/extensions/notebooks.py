"""The processes that execute notebooks: they import this checkout, and no settings of the user's IPython."""

import os
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parents[2]

#: Kernels warn that other users of the machine could read what is sent to them.
SETTINGS = "c.IPKernelApp.log_level = 'ERROR'\n"


def setup(app: Sphinx) -> dict[str, Any]:
    """Set the variables that the processes inherit."""
    app.connect("builder-inited", _prepare)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def _prepare(app: Sphinx) -> None:
    folder = Path(app.doctreedir).resolve() / "ipython"
    (folder / "profile_default").mkdir(parents=True, exist_ok=True)
    (folder / "profile_default" / "ipython_kernel_config.py").write_text(SETTINGS, "utf-8")
    os.environ["IPYTHONDIR"] = str(folder)
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH"))))

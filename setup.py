"""Name the folders of the rooms where `bodycheck/` has no links to them, as in a checkout without symbolic links.

Everything else about the distribution is in pyproject.toml.
"""

import sys
from pathlib import Path

from setuptools import find_packages, setup
from setuptools.command.build_py import build_py

#: The sub-packages of bodycheck that are top-level folders of the repository.
ROOMS = ("adapters", "cases", "reference", "reports")

#: Those without a link. Without symbolic links, git writes a file with the address of the folder in its place.
UNLINKED = tuple(room for room in ROOMS if not Path("bodycheck", room).is_dir())


class BuildWithoutLinks(build_py):
    """The build of a checkout without links."""

    def finalize_options(self) -> None:
        super().finalize_options()
        if getattr(self, "editable_mode", False):
            sys.exit(
                "error: an editable install needs symlinks, and this checkout has none: run git config core.symlinks true and "
                "git checkout -f -- bodycheck (on Windows in the developer mode), or install it without --editable"
            )
        for room in UNLINKED:
            self.packages += [f"bodycheck.{room}", *(f"bodycheck.{room}.{name}" for name in find_packages(room))]
            self.package_dir[f"bodycheck.{room}"] = room


setup(cmdclass={"build_py": BuildWithoutLinks} if UNLINKED else {})

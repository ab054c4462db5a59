"""Pages are checked for accessibility by axe, whose rules follow the WCAG 2.2."""

from typing import Any

import pytest

#: Axe reads no styles by itself, which the pages do not allow.
OPTIONS = {"resultTypes": ["violations"], "preload": False}

#: The impacts of violations that no page may have.
BARRED = ("serious", "critical")


def check(page: Any) -> None:
    """Fail with all serious and critical violations of an open page (Playwright's Page), each with up to three elements."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is not installed")
    found = axe.Axe().run(page, options=OPTIONS).response["violations"]
    told = [
        f"{one['id']} ({one['impact']}): {one['help']}: {node['html'][:160]}"
        for one in found
        if one["impact"] in BARRED
        for node in one["nodes"][:3]
    ]
    assert not told, "\n".join(told)

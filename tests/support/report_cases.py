"""The cases of which reports in tests are made."""

import json
import re

from bodycheck.casefile.case import Case, load, parse

FLIP, FLIGHT, SLIDE = "intermediate-axis-flip", "projectile", "sliding-brick"

#: A word that is longer than any line.
LONG = "x" * 10_000

#: The first table of the flip in a report, for Playwright.
TABLE = f"#case-{FLIP} table.sortable >> nth=0"

BROKEN = """
[[expect]]
engine = "mujoco"
integrator = "Euler"
timestep = 0.002
attitude_error = 1e-12
"""


def two_seconds(name: str, **strings: str) -> Case:
    """A shipped case over two seconds and without its expectations, some of its strings replaced."""
    text = re.sub(r"duration = .*", "duration = 2.0", load(name).text.partition("[[expect]]")[0])
    text = re.sub(r"samples = .*", "samples = 1001", text)
    for key, value in strings.items():
        quoted = json.dumps(value, ensure_ascii=False)
        text = re.sub(rf"^{key} = .*", lambda _, line=f"{key} = {quoted}": line, text, count=1, flags=re.MULTILINE)
    return parse(text, name)

"""An upgrade of an engine as submissions: RK4 becomes better and Euler worse, one run ends in another way."""

from typing import Any

from bodycheck.site.catalogue import Catalogue
from tests.site import submissions as make

#: The releases.
OLD, NEW = "3.17.0", "4.0.0"

#: Every table about an engine besides its runs.
STUDIES = {
    "orders.csv": [make.order(scheme="semi-implicit Euler", order=1.01)],
    "contact.csv": [make.contact(), make.contact(setting="best", value=1e-5)],
    "audit.csv": [make.audit(), make.audit(property="substeps", status="none", value=None)],
    "ensemble.csv": [make.ensemble()],
    "parity.csv": [make.parity(), make.parity(status="differs", quantity="damping", cause="damping-ignored")],
}


def catalogue(*more: Any, order: bool = True) -> Catalogue:
    """The runs of two releases, and a study of releases about the later one."""
    before = [
        make.run(version=OLD, attitude_error=2.0),
        make.run(version=OLD, integrator="RK4", attitude_error=1e-4),
        make.run(version=OLD, case=make.CONTACT, position_error=0.25),
        make.ended("diverged", version=OLD, case=make.MECHANISM),
    ]
    after = [
        make.run(version=NEW, attitude_error=2.0),
        make.run(version=NEW, integrator="RK4", attitude_error=5e-9),
        make.run(version=NEW, case=make.CONTACT, position_error=0.5),
        make.run(version=NEW, case=make.MECHANISM),
        make.run(version=NEW, integrator="discrete"),
    ]
    sent = [
        make.submission(before, day="2026-01-01", environments={"mujoco": {"mujoco==3.17.0": "0" * 64}}),
        make.submission(after, day="2026-01-02"),
    ]
    if order:
        sent.append(make.submission({"changes.csv": [make.change(scheme_before="A", scheme_after="B")]}, day="2026-01-03"))
    return make.catalogued(*sent, *more)

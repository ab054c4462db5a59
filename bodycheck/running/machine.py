"""The machine's fingerprint: what a measured time depends on."""

import os
import platform
from pathlib import Path

#: Factor by which the speed of one machine may change from one hour to the next.
SPEED_TOLERANCE = 1.25


def fingerprint() -> dict[str, str]:
    """System, processor and Python, in words; a speed measured on one fingerprint says little of another."""
    return {
        "system": platform.platform(),
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "python": platform.python_version(),
    }


def _processor() -> str:
    """The model of the processor where the system tells it, with its architecture."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    fields = dict(line.replace("\t", "").split(": ", 1) for line in lines if ": " in line)
    named = [fields.get("model name", platform.processor())]
    if {"cpu family", "model", "stepping"} <= fields.keys():
        named.append(f"family {fields['cpu family']} model {fields['model']} stepping {fields['stepping']}")
    return ", ".join([*filter(None, named), platform.machine()])

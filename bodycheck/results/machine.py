"""Describe the machine, on which measured times depend."""

import os
import platform
from pathlib import Path


def fingerprint() -> dict[str, str]:
    """Return a description of system, processor and Python; times are comparable only between equal fingerprints."""
    return {
        "system": platform.platform(),
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "python": platform.python_version(),
    }


def _processor() -> str:
    """Return the model of the processor, if the system reports it, and its architecture."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    fields = dict(line.replace("\t", "").split(": ", 1) for line in lines if ": " in line)
    named = [fields.get("model name", platform.processor())]
    if {"cpu family", "model", "stepping"} <= fields.keys():
        named.append(f"family {fields['cpu family']} model {fields['model']} stepping {fields['stepping']}")
    return ", ".join([*filter(None, named), platform.machine()])

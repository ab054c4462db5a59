"""Each folder beside this file has the tests of one engine, which are collected where that engine is installed."""

from pathlib import Path

from bodycheck.adapters import registry

HERE = Path(__file__).parent

collect_ignore = [name for name in registry.names() if (HERE / name).is_dir() and registry.installed(name) is None]

"""Trials of all kinds but kills, in one process, for the default tests, whose time is short."""

from pathlib import Path

from tests.adversary import ensembles, loading, runs, saved


def any_kind(seed: int, folder: Path) -> str:
    """The trial of a seed: most are of case files, which are fast."""
    match seed % 50:
        case 0:
            return runs.run_of_a_file(seed, folder)
        case 1:
            return saved.report_of_damage(seed, folder)
        case 2:
            return ensembles.command_on_damage(seed, folder)
        case place if place < 10:
            return saved.diff_of_damage(seed, folder)
        case _:
            return loading.truth_of_a_file(seed, folder)

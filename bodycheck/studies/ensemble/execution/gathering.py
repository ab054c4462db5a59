"""Gather an ensemble whose chunks were carried out by several jobs, in one folder or in several."""

from collections.abc import Sequence
from pathlib import Path

from bodycheck.errors import BadFolder, BadInput
from bodycheck.files import writing
from bodycheck.results import versions
from bodycheck.studies.ensemble import header as headers
from bodycheck.studies.ensemble.execution import result_tables
from bodycheck.studies.ensemble.header import EnsembleHeader


def gather(folders: Sequence[Path], out: Path, jobs: int = 1) -> Path:
    """Make the tables of an ensemble from the chunks in some folders, and return the folder of the tables.

    Parameters
    ----------
    folders
        The folders that jobs with `--shard` wrote.
    out
        The folder for the tables, which may be one of these.
    jobs
        The number of processes in which truths are compared with witnesses.

    Raises
    ------
    BadFolder
        If a folder has no chunks of an ensemble or those of another one, members are missing, or a file is damaged.
    BadInput
        If no folder is given.
    """
    if not folders:
        raise BadInput("gather: give the folders that the jobs wrote")
    heads = {folder: headers.read(folder) for folder in folders}
    head = heads[folders[0]]
    for folder, other in heads.items():
        if other["complete"]:
            raise BadFolder(f"{folder}: complete already; give the folders of jobs that carried out a share of the chunks")
        _refuse_other(folders[0], head, folder, other)
    writing.make_folder(out)
    headers.begin(out, head, result_tables.case_of(head))
    result_tables.compact(out, head, list(dict.fromkeys(folder.resolve() for folder in folders)), jobs)
    return out


def _refuse_other(first: Path, head: EnsembleHeader, folder: Path, other: EnsembleHeader) -> None:
    """Raise `BadFolder`, saying what is different, if two folders are not of the same ensemble."""
    if other["identity"] == head["identity"]:
        return
    try:
        versions.check(_versions(head), _versions(other), f"{folder}: it")
    except versions.OtherVersion as error:
        raise BadFolder(str(error).replace("this command", str(first))) from error
    named = {"case": "case", "text": "text of the case", "members": "number of members", "shares": "methods or engines"}
    different = next((words for key, words in named.items() if other.get(key) != head.get(key)), "drawn numbers or limits")
    raise BadFolder(f"{folder}: is not of the same ensemble as {first}: the {different} differ")


def _versions(head: EnsembleHeader) -> dict[str, str]:
    return {"bodycheck": head["bodycheck"], **head["packages"], **head["engines"]}

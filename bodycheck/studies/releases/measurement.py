"""The program that the study of releases runs in the environment of each release.

`python -m bodycheck.studies.releases.measurement` reads questions from its input. It prints each answer as soon as it is known,
and keeps it in the cache, so that a later study can use the answers of an interrupted study.
"""

import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bodycheck.adapters import offers, registry
from bodycheck.adapters.contract import Engine, Method
from bodycheck.adapters.roles import LACKING, alias
from bodycheck.casefile import case
from bodycheck.casefile.content import Case
from bodycheck.environments import contents, user_cache
from bodycheck.errors import BadInput
from bodycheck.files.temporary import temporary_folder
from bodycheck.judging import judgement
from bodycheck.judging.baselines import baseline
from bodycheck.processes.failures import crash
from bodycheck.results.records import is_lost
from bodycheck.running import campaign
from bodycheck.running.plan import Task, plan
from bodycheck.studies.releases.questions import Answer, Question, failed, question_of, text_of
from bodycheck.studies.tradeoff import study as tradeoff


def main() -> None:
    """Read a JSON object from the standard input, and print the answers to its questions, one line of JSON each.

    The object has the entries `engine` and `jobs`, `folders` and `contents`, which are the folders of packages of this
    environment and the digest of their contents, and `questions`, which are pairs of a question and the name of its answer in
    the cache.
    """
    request = json.load(sys.stdin)
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as stdout:
        os.dup2(2, 1)  # keep the output of engines out of stdout
        for asked, name in request["questions"]:
            answer = _answer(request["engine"], question_of(asked), request["jobs"])
            if not answer.lost and contents.of_folders(map(Path, request["folders"])) == request["contents"]:
                user_cache.keep(name, text_of(answer))
            print(text_of(answer), file=stdout, flush=True)


def _answer(engine: str, question: Question, jobs: int) -> Answer:
    try:
        record = registry.load(engine).engine
        loaded = case.parse_stored(question.text, question.name)
        offered = offers.offered(record, loaded.scene)
        lacking = _lacking(record, question.integrators)
    except Exception as error:  # any exception of an engine becomes the answer
        return failed(crash(error))
    tasks = _tasks(question, loaded, engine, record, lacking)
    if not tasks:
        return Answer(offered, lacking)
    head = campaign.header(sys.argv, {engine: record}, {})
    with temporary_folder() as folder, campaign.results(tasks, folder, head, jobs) as results:
        verdicts = judgement.judge(results)
        lost = any(map(is_lost, results.records))
        if question.kind == "figures":
            return Answer(offered, lacking, rows=tuple(map(_plain, baseline.rows(results, verdicts, jobs))), lost=lost)
        return Answer(offered, lacking, orders=tuple(tradeoff.orders(results, verdicts, {engine: record})), lost=lost)


def _lacking(engine: Engine, integrators: Sequence[str]) -> dict[str, str]:
    """Return the reasons why the release does not have some of the given methods, by the spelling of the method."""
    reasons: dict[str, str] = {}
    for spelling in integrators:
        if (role := alias(spelling)) is not None:
            reasons |= {} if engine.roles.get(role) else {spelling: f"{engine.name} {LACKING[role]}"}
            continue
        try:
            offers.check(engine, Method.parse(spelling, 0.0))
        except BadInput as error:
            reasons[spelling] = str(error)
    return reasons


def _tasks(question: Question, loaded: Case, engine: str, record: Engine, lacking: Mapping[str, str]) -> Sequence[Task]:
    """Return the tasks of a question that the release can run."""
    there = [name for name in question.integrators if name not in lacking]
    if question.integrators and not (there and offers.chosen(record, loaded.scene, there)):
        return ()
    make = plan if question.kind == "figures" else tradeoff.plan
    return make([loaded], {engine: record}, there, question.timesteps)


def _plain(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row without its empty columns."""
    return {name: value for name, value in row.items() if value is not None}


if __name__ == "__main__":
    main()

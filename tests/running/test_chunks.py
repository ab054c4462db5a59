"""Chunks: how an ensemble is cut, what is left of it, and how the members that make a call fail are found."""

import random
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from datetime import date
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, cast

import pytest

from bodycheck import load
from bodycheck.adapters.method import Method
from bodycheck.processes.failures import Crashed, TimedOut
from bodycheck.running.members import chunks
from bodycheck.running.members.chunk_workers import ChunkWorkers, in_halves, limit_of
from bodycheck.running.members.chunks import Chunk, Share, Work
from bodycheck.running.members.executors.own import Own
from tests.support.cases import shortened

SHARE = Share("engine", "1.0", (Method.parse("step", 0.002),), (0.002,))


def work(size: int, block: int = 10) -> Work:
    return Work("id", "", SimpleNamespace(size=size), block, 1, {}, date(2026, 1, 1), 300.0, 1 << 32)


def members(pieces: list[Chunk]) -> list[int]:
    return [member for piece in pieces for block in piece.blocks for member in block]


@pytest.mark.parametrize("size", [1, 9, 10, 11, 95, 100])
@pytest.mark.parametrize("blocks", [1, 3, 100])
def test_chunks_have_each_member_once_in_the_same_blocks(size: int, blocks: int) -> None:
    found = chunks.cut(work(size), SHARE, blocks)
    assert members(found) == list(range(size))
    assert {block for chunk in found for block in chunk.blocks} == {
        range(first, min(first + 10, size)) for first in range(0, size, 10)
    }
    assert [chunk.number for chunk in found] == list(range(len(found)))


def test_what_is_left_are_the_blocks_that_are_not_done() -> None:
    chance = random.Random(1)
    for _ in range(50):
        (chunk,) = chunks.cut(work(chance.randint(1, 99)), SHARE, 100)
        done = {block.start for block in chunk.blocks if chance.random() < 0.5}
        pieces = list(chunks.left(chunk, done))
        assert members(pieces) == [member for block in chunk.blocks if block.start not in done for member in block]
        assert all(later.first > earlier.first + earlier.count for earlier, later in pairwise(pieces))
        assert {piece.number for piece in pieces} <= {chunk.number}


def test_the_block_of_a_long_case_is_small_enough_for_memory_and_time() -> None:
    short, long = shortened(load("free-brick"), 0.2, 11), shortened(load("free-brick"), 10.0, 1001)
    assert chunks.block_size(short, [0.002]) == chunks.BLOCK_SIZES[0]
    for case, step in ((long, 0.002), (long, 1e-5), (replace(long, samples=100_000), 0.002)):
        size = chunks.block_size(case, [0.01, step])
        assert size in chunks.BLOCK_SIZES
        assert size == 1 or size * case.samples <= chunks.MOST_STATES
        assert size == 1 or size * case.duration / step <= chunks.MOST_STEPS


@pytest.mark.parametrize("count", [1, 2, 7, 1000])
def test_halving_finds_all_that_fail_and_nothing_else(count: int) -> None:
    chance = random.Random(count)
    bad = {place for place in range(count) if chance.random() < 0.01} | {chance.randrange(count)}
    asked: list[tuple[int, int]] = []

    def attempt(first: int, last: int) -> list[int] | Crashed | TimedOut:
        asked.append((first, last))
        mine = [place for place in range(first, last) if place in bad]
        if mine:
            return Crashed("died") if mine[0] % 2 else TimedOut(limit_of(last - first, count, 100.0))
        return list(range(first, last))

    parts = in_halves(attempt, 0, count)
    assert [place for places, _ in parts for place in places] == list(range(count))
    assert {place for places, result in parts if not isinstance(result, list) for place in places} == bad
    # One that fails is the reason of at most two calls for each time that its part is halved.
    assert len(asked) <= 1 + 2 * len(bad) * (count - 1).bit_length()
    # A single thing has the time of a whole call.
    assert all(result.limit == 100.0 for _, result in parts if isinstance(result, TimedOut))


def test_nothing_is_done_after_the_receipts_are_closed() -> None:
    threads = threading.active_count()
    done: list[Chunk] = []

    def perform(chunk: Any, workers: ChunkWorkers) -> Any:
        workers.check()
        while chunk > 100:  # however busy the machine is, the rest is not done before the end
            time.sleep(0.01)
            workers.check()
        done.append(chunk)
        return chunk

    receipts = Own(2)(perform, cast(Sequence[Chunk], range(100_000)))
    next(receipts)
    receipts.close()
    assert threading.active_count() == threads
    assert len(done) <= 101

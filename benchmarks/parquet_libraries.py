"""What libraries for Parquet files cost, and what damaged files do to them. Run, in an environment with what is to be compared:

    pip install pyarrow arro3-core arro3-io duckdb
    python benchmarks/parquet_libraries.py [FILES]

For each library: MB on disk, processor time of its import and of reading a trajectory of 1001 instants, and the outcomes of
FILES (2000 by default) damaged files, which PyArrow has written: read, refused with an exception, or ended the process. A
process reads up to 100 files, one after the other.
"""

import importlib
import io
import random
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

#: The distributions of each library, and its modules.
LIBRARIES = {
    "pyarrow": (("pyarrow",), "pyarrow, pyarrow.parquet"),
    "arro3": (("arro3-core", "arro3-io"), "arro3.core, arro3.io"),
    "duckdb": (("duckdb",), "duckdb"),
}

#: Damaged files that one process reads; a process that ends reads no more.
EACH = 100


def reader(library: str) -> Callable[[bytes], Any]:
    """Return the function with which a library reads all columns in the content of a Parquet file."""
    if library == "pyarrow":
        return lambda content: pq.ParquetFile(pa.BufferReader(content)).read(use_threads=False)
    if library == "arro3":
        arro3 = importlib.import_module("arro3.io")  # not installed with bodycheck

        return lambda content: arro3.read_parquet(content, batch_size=1 << 16).read_all()
    import duckdb

    connection = duckdb.connect(":memory:", config={"threads": 1})
    place = Path("damaged.parquet").absolute()

    def read(content: bytes) -> Any:
        place.write_bytes(content)  # it reads no buffers
        return connection.execute("SELECT * FROM read_parquet(?)", [str(place)]).fetchnumpy()

    return read


def trajectory(instants: int, compression: str = "lz4", dictionary: bool = False) -> bytes:
    """Return the content of a file with the columns of a trajectory, and of texts and numbers of which half are missing."""
    numbers = np.random.default_rng(0).normal(size=(13, instants))
    columns = {"t": np.arange(instants) * 0.01, **{f"c{index}": row for index, row in enumerate(numbers)}}
    others = {"text": ["abc"] * instants, "half": [1 if index % 2 else None for index in range(instants)]}
    options: dict[str, Any] = {
        "compression": compression,
        "use_dictionary": dictionary,
        "row_group_size": max(20, instants // 3),
    }
    content = io.BytesIO()
    pq.write_table(pa.table({**columns, **others}), content, **options)
    return content.getvalue()


def damaged(chance: random.Random, content: bytes) -> bytes:
    """Return a file with one to five changes: another byte, a lost one or an inserted one."""
    changed = bytearray(content)
    for _ in range(chance.choice([1, 1, 2, 5])):
        first = 0 if chance.random() < 0.4 else max(0, len(changed) - 1500)  # the end describes the rest
        place, byte = chance.randrange(first, len(changed)), bytes([chance.randrange(256)])
        changed[place : place + chance.choice([0, 1, 1, 1, 1])] = chance.choice([b"", byte, byte, byte, byte])
    return bytes(changed)


def attack(library: str, seed: int) -> None:
    """Read damaged files, and print a line for each when it has been read."""
    read, chance = reader(library), random.Random(seed)
    files = [trajectory(50, compression, dictionary) for compression in ("lz4", "zstd", "none") for dictionary in (False, True)]
    for _ in range(EACH):
        try:
            read(damaged(chance, chance.choice(files)))
            print("read", flush=True)
        except BaseException:  # a panic of Rust is no Exception
            print("refused", flush=True)


def measured(library: str, files: int) -> str:
    """Return a line about a library."""
    distributions, modules = LIBRARIES[library]
    paths = [path.locate() for name in distributions for path in metadata.files(name) or ()]
    size = sum(Path(path).stat().st_size for path in paths if Path(path).is_file())
    imported, bare = (
        min(_seconds(lambda code=code: subprocess.run([sys.executable, "-c", code], check=True)) for _ in range(5))
        for code in (f"import {modules}", "pass")
    )
    read, content = reader(library), trajectory(1001)
    read(content)
    times = [_seconds(lambda: read(content)) for _ in range(50)]
    outcomes: Counter[str] = Counter()
    for seed in range(files // EACH):
        command = [sys.executable, __file__, "--attack", library, str(seed)]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        outcomes += Counter(done.stdout.split())
        outcomes["ended the process"] += done.returncode != 0
    told = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.items())
    return f"{library}: {size / 1e6:.0f} MB, import {(imported - bare) * 1e3:.0f} ms, read {min(times) * 1e3:.2f} ms; {told}"


def _seconds(action: Callable[[], Any]) -> float:
    """Return the processor time (s) of an action and of the processes that it starts and waits for."""
    import resource

    def used() -> float:
        children = resource.getrusage(resource.RUSAGE_CHILDREN)
        return time.process_time() + children.ru_utime + children.ru_stime

    before = used()
    action()
    return used() - before


if __name__ == "__main__":
    if sys.argv[1:2] == ["--attack"]:
        attack(sys.argv[2], int(sys.argv[3]))
    else:
        for each in LIBRARIES:
            print(measured(each, int(sys.argv[1]) if sys.argv[1:] else 2000), flush=True)

"""The command line with closed streams, with pipes that nobody reads, and interrupted before it is imported."""

import os
import subprocess
import sys

import pytest

#: Starts the command line with its arguments, as the installed script does.
START = "import sys\nsys.argv[0] = 'bodycheck'\nfrom bodycheck.__main__ import main\nmain()"

#: Raises an exception, to be filled in, when the command line imports what it is made of.
FAILING = """
import sys

class Failing:
    def find_spec(self, name, path, target=None):
        if name == "cyclopts":
            raise {}

sys.meta_path.insert(0, Failing())
"""


@pytest.mark.parametrize("closed", [(0,), (1,), (2,), (1, 2), (0, 1, 2)])
def test_a_closed_stream_changes_neither_the_exit_code_nor_the_other_streams(closed: tuple[int, ...]) -> None:
    redirections = " ".join(f"{number}>&-" if number else "<&-" for number in closed)
    command = ["sh", "-c", f'exec "$0" -c "$1" cases {redirections}', sys.executable, START]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert ("free-brick" in done.stdout) is (1 not in closed)


@pytest.mark.parametrize("arguments", [("cases",), ("truth", "projectile"), ("--help",), ("schema",)])
def test_a_pipe_without_a_reader_ends_a_command_without_a_traceback(arguments: tuple[str, ...]) -> None:
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run([sys.executable, "-c", START, *arguments], stdout=write, stderr=subprocess.PIPE, text=True)
    os.close(write)
    assert (done.returncode, done.stderr) == (141, "")


@pytest.mark.parametrize(
    ("raised", "code", "told"),
    [
        ("KeyboardInterrupt", 130, "bodycheck: interrupted"),
        ("ImportError('no room for a library')", 2, "bodycheck: cannot start: ImportError: no room for a library"),
        ("MemoryError('full')", 2, "bodycheck: cannot start: MemoryError: full"),
    ],
)
def test_what_happens_while_the_command_line_is_imported_is_told_in_one_line(raised: str, code: int, told: str) -> None:
    command = [sys.executable, "-c", FAILING.format(raised) + START, "cases"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (code, "", f"{told}\n")

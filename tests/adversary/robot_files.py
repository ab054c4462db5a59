"""Folders of robot files, many of them damaged: each file has its rows, and the command ends and tells as it should."""

import csv
import os
import re
from pathlib import Path
from random import Random
from xml.sax.saxutils import quoteattr

from bodycheck.errors import BAD_INPUT, FAILED, OK
from bodycheck.robots.mjcf_text import mjcf
from bodycheck.robots.urdf_text import urdf
from tests.support.commands import Done, bodycheck
from tests.support.robot_trees import random_tree

#: The files of a folder.
FILES = 12

#: What replaces numbers and names.
NUMBER = re.compile(r'(?<=[" ])-?[0-9.]+(?:e[-+]?[0-9]+)?(?=[" ])')
NUMBERS = (
    "nan",
    "inf",
    "1e308",
    "-1e308",
    "1e309",
    "1e101",
    "1e-308",
    "0",
    "-1",
    "1e3",
    "1_000",
    "0x10",
    "１",
    "",
    "1 2",
    "9" * 2500,
)
NAMES = (
    *("e\u0301", "\u05d0\u05d1", "a" * 501, "b" * 100_000, "<script>alert(1)</script>", "::error::x", "\u202ex", "x\ty"),
    *("model", "world", "", "a/b", "me@example.org", "/home/me/robot", "=1+1", "&amp;", "javascript:x"),
)
WHOLE = ("", "\0\1", "<robot/>", "<mujoco/>", "<package/>", '<robot name="r"><link name="a"/></robot>', "<a>" * 300)


def parity_of_a_folder(seed: int, folder: Path) -> str:
    """What is wrong with the comparison of a folder and with its submission; empty if nothing is."""
    random, robots = Random(seed), folder / "robots"
    for index in range(FILES):
        path = robots / random.choice((f"r{index}", f"d{index % 3}/robot", f"d{index % 3}/deep/model"))
        path = path.with_name(path.name + random.choice((".urdf", ".xml", ".mjcf")))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(_damaged(random).encode("utf-16" if random.random() < 0.03 else "utf-8"))
    os.mkfifo(robots / "pipe.urdf")
    (robots / "outside.urdf").symlink_to("/etc/passwd")
    done = bodycheck("parity", robots, folder / "none.urdf", "--engine", "mujoco", "--states", "2", "--out", folder / "out")
    if done.returncode == BAD_INPUT:
        return "" if "agrees" not in done.stdout else done.stderr
    return _wrong(done, robots, folder)


def _damaged(random: Random) -> str:
    """The text of a random robot with up to two faults."""
    text = random.choice((urdf, mjcf))(random_tree(random, random.randint(1, 4), types=("revolute", "prismatic", "fixed")))
    for _ in range(random.choice((0, 1, 1, 2))):
        match random.randrange(6):
            case 0 | 1 if numbers := list(NUMBER.finditer(text)):
                number = random.choice(numbers)
                text = f"{text[: number.start()]}{random.choice(NUMBERS)}{text[number.end() :]}"
            case 2:
                name = random.choice(re.findall(r'name="([^"]*)"', text) or ["a"])
                text = text.replace(f'"{name}"', quoteattr(random.choice(NAMES)))
            case 3:
                text = text[: random.randrange(len(text) + 1)]
            case 4:
                lines = text.splitlines()
                line = random.randrange(len(lines)) if lines else 0
                text = "\n".join([*lines[:line], *lines[line : line + 1] * random.choice((0, 2, 600)), *lines[line + 1 :]])
            case _:
                text = random.choice(WHOLE)
    return text


def _wrong(done: Done, robots: Path, folder: Path) -> str:
    rows = list(csv.DictReader((folder / "out" / "parity.csv").read_text("utf-8").splitlines()))
    models, unread = {row["model"] for row in rows}, {row["model"] for row in rows if row["status"] == "unreadable"}
    skipped = re.search(r"robots' files: (.*)", done.stderr)
    told = re.search(r"bodycheck: (\d+) of (\d+) files cannot be read", done.stderr)
    names = [path for path in robots.rglob("*") if not path.is_dir()]
    checks = {
        "the exit code": done.returncode == FAILED,
        "a trace or a warning": "Traceback" not in done.stderr and "Warning" not in done.stderr,
        "the files that cannot be read": told is not None and int(told[1]) == len(unread) and int(told[2]) == len(models),
        "a file without a row": skipped is not None or len(models) == len(names) + 1,
        "an unexplained difference without a fault of the file": not {
            row["model"] for row in rows if row["engine"] == "mujoco" and row["status"] == "differs"
        }
        - {row["model"] for row in rows if row["engine"] == "file"},
        "the submission": bodycheck("submit", folder / "out", "--out", folder / "out.zip").returncode == OK,
    }
    return "; ".join(check for check, holds in checks.items() if not holds)

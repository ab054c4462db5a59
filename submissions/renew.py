"""Make the submissions in this folder again, which the public site of results is made of, and the table in README.md.

    python submissions/renew.py              all of them
    python submissions/renew.py dart audit   those with these names, or of these engines
    python submissions/renew.py --newest     a run of the newest release of each engine of which there is none yet
    python submissions/renew.py --releases   the lists of the releases of engines, by which the site checks versions
    python submissions/renew.py --table      only the table

Raw results go to build/results, where an interrupted command resumes.
"""

import json
import subprocess
import sys
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from bodycheck.adapters import registry
from bodycheck.casefile.case import shipped
from bodycheck.errors import BadInput
from bodycheck.site import released
from bodycheck.site.submissions import gathering

HERE = Path(__file__).resolve().parent
RAW = HERE.parent / "build" / "results"
RELEASED = HERE.parent / "bodycheck" / "site" / released.FILE
BODYCHECK = (sys.executable, "-m", "bodycheck")

#: The releases of each engine that are run with all cases that come with bodycheck. The last is the newest one that bodycheck
#: installs. It is run under the plain name of its engine, of which cases expect something.
RELEASES = {
    "mujoco": ("3.2.0", "3.3.7", "3.7.0", "3.10.0", "3.13.0", "3.17.0", "4.0.0"),
    "pinocchio": ("2.7.0", "3.4.0", "3.9.0", "4.1.0"),
    "dart": ("6.20.0",),
    "drake": ("1.51.1",),
    "exudyn": ("1.13.6",),
    "pybullet": ("3.2.7",),
    "rapier": ("0.36.1",),
    "sapien": ("3.0.3",),
    "simbody": ("4.6",),
    "newton": ("1.8.0",),
    "mujoco_warp": ("4.0.0",),
    "brax": ("0.14.2",),
    "mjx": ("3.17.0",),
    "mjx32": ("3.17.0",),
}

#: Engines that compile each case, and the cases for which they take longer than a run may.
COMPILING, TOO_LONG = ("mjx", "mjx32"), ("chain-10", "chain-20")

#: The cases in which releases are followed.
FLIPS = ("--case", "osrf-boxes-complex", "--case", "intermediate-axis-flip")


def cases_of(engine: str) -> tuple[str, ...]:
    """Return the cases that an engine runs; none stands for all that come with bodycheck."""
    return tuple(name for name in shipped() if name not in TOO_LONG) if engine in COMPILING else ()


#: The commands by the names of their submissions.
COMMANDS: dict[str, tuple[str, ...]] = {
    **{
        f"{name}-{one}": ("run", *cases_of(name), "--engine", name if one == versions[-1] else f"{name}@{one}")
        for name, versions in RELEASES.items()
        for one in versions
    },
    "tradeoff": ("tradeoff", "osrf-boxes-complex", "intermediate-axis-flip", "double-pendulum"),
    "contact": ("contact",),
    "audit": ("audit",),
    "ensemble": ("ensemble", "ensemble-of-bricks", "--engine", "mujoco", "--engine", "pinocchio"),
    **{
        f"releases-{name}": ("releases", name, *RELEASES[name], *FLIPS, "--timestep", "0.001")
        for name in ("mujoco", "pinocchio")
    },
}

#: Most characters of a command in the table.
LONGEST = 150

#: The lines of README.md between which the table stands.
BEGIN, END = "<!-- table: begin -->", "<!-- table: end -->"


def made(name: str, command: tuple[str, ...]) -> bool:
    """Run a command, and pack what it found, if it was carried out. A failed run is a result like others."""
    print(f"{name}: bodycheck {' '.join(command)}", flush=True)
    done = subprocess.run([*BODYCHECK, *command, "--quiet", "--out", RAW / name], check=False)
    if done.returncode in (0, 1):
        done = subprocess.run([*BODYCHECK, "submit", RAW / name, "--out", HERE / f"{name}.zip"], check=False)
    return done.returncode == 0


def newest() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Yield a run of the newest release of each engine that can be installed here, unless it is there already."""
    for engine in registry.names():
        subprocess.run([*BODYCHECK, "engines", "add", engine], check=False)
    listed = subprocess.run([*BODYCHECK, "engines", "--json"], check=True, capture_output=True, text=True)
    for one in json.loads(listed.stdout):
        name = f"{one['name']}-{one['version']}"
        if one["name"] in registry.names() and not (HERE / f"{name}.zip").exists():
            yield name, ("run", *cases_of(one["name"]), "--engine", one["name"])


def table() -> Iterator[str]:
    """Yield the lines of the table of README.md."""
    yield from ("| file | what | started | machine | kB |", "| --- | --- | --- | --- | ---: |")
    for path in sorted(HERE.glob("*.zip")):
        source = gathering.read(path)
        size = round(path.stat().st_size / 1000)
        command = source.command if len(source.command) <= LONGEST else f"{source.command[: LONGEST - 1]}…"
        told = (path.name, f"`{command.replace('`', '´')}`", source.date, source.machine.replace("<", "‹"), str(size))
        yield f"| {' | '.join(text.replace('|', '¦') for text in told)} |"  # what strangers write ends no cell


def main(arguments: list[str]) -> int:
    """Make what the arguments ask for, and the table; return the exit code, which is 1 if anything could not be made."""
    if arguments in (["--newest"], ["--releases"]):
        RELEASED.write_text(released.listing(datetime.now(UTC).date().isoformat()), "utf-8")
    if arguments == ["--newest"]:
        asked = dict(newest())
    elif arguments in (["--table"], ["--releases"]):
        asked = {}
    else:
        asked = {
            name: command
            for name, command in COMMANDS.items()
            if not arguments or {name, name.partition("-")[0]} & set(arguments)
        }
        if not asked:
            raise SystemExit(f"read {' '.join(arguments)}; allowed: --newest, --table, {', '.join(COMMANDS)}, --releases")
    failed = [name for name, command in asked.items() if not made(name, command)]
    readme = HERE / "README.md"
    before, _, rest = readme.read_text().partition(BEGIN)
    readme.write_text("\n".join([f"{before}{BEGIN}", *table(), f"{END}{rest.partition(END)[2]}"]))
    if failed:
        print(f"not made: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except BadInput as error:
        raise SystemExit(str(error)) from error

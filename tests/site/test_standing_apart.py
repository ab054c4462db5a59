"""No submission takes the place of another one, and the same submissions make the same site."""

import json
import zipfile
from pathlib import Path

import pytest

from bodycheck.casefile import case as case_files
from bodycheck.casefile.mechanisms.stored import file_text
from bodycheck.site import build, catalogue, links
from bodycheck.site.catalogue import Catalogue
from bodycheck.site.submissions import archive, contents, gathering, packing
from bodycheck.site.submissions.submission import Submission
from tests.site import submissions as made

FLIP = case_files.load(made.FREE).text
OWN = FLIP.replace(f'name = "{made.FREE}"', 'name = "my-case"')

#: The same name for another motion.
OTHER = OWN.replace("duration = 10.0", "duration = 5.0")


def of_case(text: str, **told: object) -> Submission:
    return made.submission([made.run(case="my-case")], cases={"my-case": text}, **told)


def site(found: Catalogue) -> dict[str, bytes]:
    return {file.path: file.content for file in build.files(found)}


@pytest.mark.parametrize("day", ["2020-01-01", "2026-06-01", "2099-01-01"])
def test_cases_of_two_strangers_stay_apart_whatever_their_dates(day: str) -> None:
    assert OTHER != OWN
    mine = of_case(OWN, day="2026-02-01")
    alone, both = made.catalogued(mine), made.catalogued(mine, of_case(OTHER, day=day))
    assert set(alone.scenes) == {"my-case"}
    assert len(both.scenes) == 2
    assert all(name.startswith("my-case.") for name in both.scenes)
    (name,) = (name for name, scene in both.scenes.items() if file_text(scene.case) == OWN)
    assert both.scenes[name].case == alone.scenes["my-case"].case
    here, there = (
        [{**entry.row, "case": ""} for entry in runs] for runs in (both.scenes[name].runs, alone.scenes["my-case"].runs)
    )
    assert here == there
    assert both.runs["mujoco", name] == both.scenes[name].runs
    assert both.submissions[0].header.without_method.keys() == alone.submissions[0].header.without_method.keys()


def test_a_case_has_no_name_of_a_page_of_the_site() -> None:
    (name,) = made.catalogued(
        made.submission([made.run(case="index")], cases={"index": OWN.replace("my-case", "index")})
    ).scenes
    assert links.scene(name) != "scenes/index.html"


def test_the_same_file_of_two_strangers_is_one_case() -> None:
    found = made.catalogued(of_case(OWN, day="2026-02-01"), of_case(OWN, day="2026-03-01"))
    (scene,) = found.scenes.values()
    assert len(scene.runs) == 2
    assert not scene.shipped


def test_a_changed_title_or_expectation_of_a_shipped_case_changes_nothing_on_the_site() -> None:
    title = case_files.load(made.FREE).title
    changed = FLIP.replace(title, "Buy this")
    assert changed != FLIP
    found = made.catalogued(made.submission([made.run()], cases={made.FREE: changed}, day="2020-01-01"))
    assert found.scenes[made.FREE].case.title == title
    assert found.scenes[made.FREE].shipped


def test_the_reasons_of_a_submission_are_of_its_own_engines() -> None:
    told = {"mujoco": {made.CONTACT: "mujoco has no method"}, "dart": {made.CONTACT: "dart is bad"}}
    found = made.catalogued(made.submission([made.run()], without_method=told))
    assert set(found.without_method) == {("mujoco", made.CONTACT)}


def test_a_copy_in_another_form_is_the_same_submission(tmp_path: Path) -> None:
    """With another spelling of submission.json, another order of files, a comment and other dates."""
    folder = made.write_folder(tmp_path / "folder", {"results.csv": [made.run()]})
    packed = packing.contents(folder)
    (tmp_path / "honest.zip").write_bytes(archive.zipped(packed))
    with zipfile.ZipFile(tmp_path / "copy.zip", "w", zipfile.ZIP_STORED) as stream:
        for name, content in sorted(packed.files.items(), reverse=True):
            stream.writestr(name, content)
        stream.writestr(archive.MANIFEST, json.dumps(json.loads(contents.manifest(packed)), indent=7))
        stream.comment = b"copied"
    found, left_out = gathering.gathered([tmp_path])
    assert not left_out
    assert [source.key for source in found] == [gathering.read(folder).key]


def test_the_same_submissions_make_the_same_bytes(tmp_path: Path) -> None:
    """From folders and from zip files, in other places and in another order."""
    days = ("2026-01-01", "2026-02-01", "2026-03-01")
    older = [made.write_folder(tmp_path / "a" / day, {"results.csv": [made.run()]}, made.header(day)) for day in days]
    (tmp_path / "b").mkdir()
    newer = [tmp_path / "b" / f"{place}.zip" for place in range(3)]
    for folder, path in zip(older, reversed(newer), strict=True):
        path.write_bytes(archive.zipped(packing.contents(folder)))
    first, second = (site(catalogue.catalogued(*gathering.gathered(paths))) for paths in (older, [tmp_path / "b"]))
    assert list(first) == list(second)
    assert first == second


def test_no_two_pages_have_one_name_where_capitals_do_not_count() -> None:
    """Nor has any page a name that stands for a device."""
    names = ["con", "nul", "aux", "com1", "index", "errors", "my-case", "my-case.0123456789ab", "a" * 100, "a" * 99]
    paths = [links.engine(name) for name in (*names, "CON", "My-Case", "con-1", "é", "è", "a/b", "a:b")]
    assert len({path.lower() for path in paths}) == len(paths)
    stems = {Path(path).name.partition(".")[0].lower() for path in paths}
    assert not stems & {"con", "nul", "aux", "com1", "prn", ""}

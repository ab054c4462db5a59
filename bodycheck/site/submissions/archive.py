"""Submissions as zip files: equal contents give equal files, and reading has limits for all sizes and numbers."""

import io
import json
import re
import zipfile
import zlib
from typing import Any

from bodycheck.errors import BadInput
from bodycheck.site.submissions.contents import FORMAT, Contents, checked, manifest
from bodycheck.site.submissions.submission import Submission
from bodycheck.site.submissions.tables import TABLES

#: The file with the header and the digests of all other files.
MANIFEST = "submission.json"

#: The most bytes of a zip file, of one file in it, of all files in it, and of submission.json.
MOST_PACKED, MOST_OF_ONE, MOST_OF_ALL, MOST_OF_MANIFEST = 1 << 24, 1 << 25, 1 << 26, 1 << 21

#: The most files in a zip file.
MOST_FILES = 1000

#: The bytes with which the entry of a file in the directory of a zip file begins.
ENTRY = b"PK\x01\x02"

#: The names that files may have.
NAME = re.compile(
    "|".join(
        (
            rf"tables/(?:{'|'.join(map(re.escape, TABLES))})",
            r"cases/[a-z0-9][a-z0-9-]{0,99}\.case\.toml",
            r"tracks\.json",
            r"submission\.json",
        )
    )
)

#: The date of every file in a zip file, so that the same contents give the same bytes: the first date of the format.
DATE = (1980, 1, 1, 0, 0, 0)


def zipped(contents: Contents) -> bytes:
    """Return the bytes of a zip file with submission.json and all files of the contents."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in [(MANIFEST, manifest(contents)), *sorted(contents.files.items())]:
            archive.writestr(zipfile.ZipInfo(name, DATE), content, zipfile.ZIP_DEFLATED, 9)
    return stream.getvalue()


def read(content: bytes) -> Submission:
    """Return the submission in a zip file. Raises `BadInput` if it is not as `zipped` writes it."""
    files = _files(content)
    if MANIFEST not in files:
        raise BadInput(f"has no {MANIFEST}; `bodycheck submit DIR --out FILE.zip` writes such files")
    told = files.pop(MANIFEST)
    header, digests = _told(told)
    found = Contents(header, files)
    if found.digests != digests:
        different = sorted({*digests.items()} ^ {*found.digests.items()}, key=str)[0][0]
        raise BadInput(f"{str(different)[:100]}: is missing, or is not the file that {MANIFEST} names")
    return checked(found)


def _told(content: bytes) -> tuple[dict[str, Any], dict[str, str]]:
    if len(content) > MOST_OF_MANIFEST:
        raise BadInput(f"{MANIFEST}: has {len(content)} bytes; at most {MOST_OF_MANIFEST} are allowed")
    try:
        told = json.loads(content)
        if told["format"] != FORMAT:
            raise BadInput(f"{MANIFEST}: has format {str(told['format'])[:20]}; this version reads format {FORMAT}")
        header, digests = dict(told["header"]), dict(told["files"])
        if not all(isinstance(digest, str) for digest in digests.values()):
            raise ValueError("a digest is no text")
        return header, digests
    except (ValueError, TypeError, KeyError, RecursionError) as error:
        raise BadInput(f"{MANIFEST}: is not as bodycheck writes it") from error


def _files(content: bytes) -> dict[str, bytes]:
    """Return the files in a zip file by name. Raises `BadInput` if a name, a size or the number of files is not allowed."""
    found: dict[str, bytes] = {}
    room = MOST_OF_ALL
    if content.count(ENTRY) > 2 * MOST_FILES:  # checked before the directory is read, since each entry takes memory
        raise BadInput(f"has too many files; at most {MOST_FILES} are allowed")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = archive.infolist()
            if len(entries) > MOST_FILES:
                raise BadInput(f"has {len(entries)} files; at most {MOST_FILES} are allowed")
            for entry in entries:
                if not NAME.fullmatch(entry.filename) or entry.filename in found:
                    raise BadInput(f"has a file {entry.filename[:60]!r}, which bodycheck does not write")
                if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                    raise BadInput(f"{entry.filename}: is compressed in another way than bodycheck does it")
                limit = min(MOST_OF_ONE, room)
                with archive.open(entry) as stream:
                    own = stream.read(limit + 1)
                if len(own) > limit:
                    raise BadInput(f"{entry.filename}: is larger than {limit} bytes, which is the most that is allowed")
                found[entry.filename] = own
                room -= len(own)
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, NotImplementedError, RuntimeError, ValueError) as error:
        raise BadInput(f"is no zip file that can be read: {str(error)[:200]}") from error
    return found

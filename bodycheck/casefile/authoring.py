"""Write new case files, and the JSON Schema by which editors complete and check case files."""

import json
import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from bodycheck.casefile import formats, values
from bodycheck.casefile.case import shipped, shipped_file
from bodycheck.casefile.finding import SUFFIX
from bodycheck.casefile.robot_notes import Ignored
from bodycheck.errors import BadInput
from bodycheck.files import writing

#: The file with the schema, beside the shipped cases; the first line of each case names it for editors.
SCHEMA_FILE = "case.schema.json"

#: The name of draft 07 of JSON Schema.
DRAFT_07 = "http://json-schema.org/draft-07/schema#"

#: The case files that `new` copies, for one body and for a mechanism, and the name of the case in them.
TEMPLATE_FILE = "template.toml"
MECHANISM_TEMPLATE_FILE = "template-mechanism.toml"
TEMPLATE_NAME = "my-case"


def new(name: str, folder: Path, *, mechanism: bool = False) -> Path:
    """Write a commented case file with this name into a folder, and return its path.

    mechanism: whether the case has bodies on joints instead of one body.

    Raises `BadInput` if the name is bad, or the file exists or cannot be written.
    """
    return _written(name, folder, template(mechanism=mechanism))


def new_of_robot(name: str | None, folder: Path, model: Path, body: str | None) -> tuple[Path, str]:
    """Write a commented case file with a body of a robot model into a folder.

    Parameters
    ----------
    name
        The name of the case; if it is None, the name of the body.
    folder
        The folder.
    model
        A URDF or MJCF file.
    body
        The name of the body in the file; it may be None if the file has only one body.

    Returns
    -------
    The path of the case file, and a phrase for the parts of the model that it leaves out.

    Raises
    ------
    BadInput
        As for `new`, and if the body cannot be read from the file.
    """
    from bodycheck.casefile import body_template as robots

    if model.name.endswith(SUFFIX) or (str(model) in shipped() and not model.exists()):
        file = model if model.name.endswith(SUFFIX) else shipped_file(str(model))
        raise BadInput(
            f"--from {model}: is a case; allowed: the file of a robot model, URDF or MJCF. To begin with this case, copy its "
            f"file, {file}, and change its name"
        )
    link = robots.read(model, body)
    text = robots.text(template(), link, model)
    return _written(robots.case_name(link) if name is None else name, folder, text), link.left_out


def new_of_model(name: str | None, folder: Path, model: Path, packages: Sequence[Path], ignore: Sequence[Ignored]) -> Path:
    """Write a case file of a whole robot into a folder, and return its path.

    Its joints have rigid stops at their ranges unless the truth with stops ends before the duration of the case.

    Parameters
    ----------
    name
        The name of the case; if it is None, that of the file.
    folder
        The folder.
    model
        A URDF or MJCF file in the folder: a case names a file beside itself.
    packages, ignore
        Folders in which the file may name files, and what is left out of it on purpose.

    Raises
    ------
    BadInput
        As for `new`, and if the file is in another folder, or is no case.
    """
    from bodycheck.casefile.robots import direct, loading

    if model.resolve().parent != folder.resolve():
        raise BadInput(
            f"--model {model}: must be in the folder of the case file, {folder.resolve()}; run the command in the folder of "
            "the model"
        )
    case = loading.load(model, packages=packages, ignore=ignore)
    named = case.name if name is None else name
    text = direct.text_for_a_case_file(model, packages, ignore, case.name)
    return _written(named, folder, text.replace(f'name = "{case.name}"', f'name = "{named}"', 1))


def _written(name: str, folder: Path, text: str) -> Path:
    """Write the text of the template under another name, and return the path of the file."""
    try:
        TypeAdapter(values.Name).validate_python(name)
    except ValidationError as error:
        most = values.MAX_NAME_LENGTH
        raise BadInput(f"name: read {name!r}; allowed: small letters, digits and hyphens, at most {most}") from error
    path = folder / (name + SUFFIX)
    if os.path.lexists(path):
        raise BadInput(f"{path}: exists already")
    writing.write(path, text.replace(f'name = "{TEMPLATE_NAME}"', f'name = "{name}"', 1).encode("utf-8"))
    return path


def template(*, mechanism: bool = False) -> str:
    """Return the text of the case file that `new` copies, for one body or for a mechanism."""
    file = MECHANISM_TEMPLATE_FILE if mechanism else TEMPLATE_FILE
    return (resources.files("bodycheck.cases") / file).read_text("utf-8")


def schema() -> str:
    """Return the JSON Schema of case files of all formats."""
    any_case = TypeAdapter[Any](Annotated[formats.AnyCaseTable, Field(discriminator="format")])
    whole_schema = {"$schema": _Schema.schema_dialect, "title": "Case file of bodycheck"}
    return json.dumps(whole_schema | any_case.json_schema(schema_generator=_Schema), indent=2, ensure_ascii=False) + "\n"


def draft_07() -> str:
    """Return the JSON Schema of case files in draft 07, which some editors and catalogues of schemas need."""
    return json.dumps({**_in_draft_07(json.loads(schema())), "$schema": DRAFT_07}, indent=2, ensure_ascii=False) + "\n"


def _in_draft_07(part: Any) -> Any:
    """Return a part of a schema in draft 07, in which definitions have another name, and no keyword counts beside `$ref`."""
    if isinstance(part, list):
        return [_in_draft_07(item) for item in part]
    if not isinstance(part, dict):
        return part
    changed = {"definitions" if key == "$defs" else key: _in_draft_07(value) for key, value in part.items()}
    if isinstance(address := changed.get("$ref"), str):
        changed["$ref"] = address.replace("#/$defs/", "#/definitions/")
        if len(changed) > 1:
            changed["allOf"] = [{"$ref": changed.pop("$ref")}]
    return changed


class _Schema(GenerateJsonSchema):
    """A generator of JSON Schema with keywords that all editors support, including those of older drafts."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])  # TOML has no null; an absent key is simply left out

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        json_schema = super().default_schema(schema)
        if (default := json_schema.get("default")) is None or isinstance(default, dict):
            json_schema.pop("default", None)
        return json_schema

    def tuple_schema(self, schema: core_schema.TupleSchema) -> JsonSchemaValue:
        json_schema = super().tuple_schema(schema)
        items: list[Any] = json_schema.pop("prefixItems", [])
        return json_schema | {"items": items[0]} if items else json_schema  # all items of a vector have the same schema

    def tagged_union_schema(self, schema: core_schema.TaggedUnionSchema) -> JsonSchemaValue:
        json_schema = super().tagged_union_schema(schema)
        json_schema.pop("discriminator", None)
        return json_schema

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

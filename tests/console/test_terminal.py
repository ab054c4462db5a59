"""What is printed as JSON is JSON: numbers that it lacks are null."""

import json
import math

import pytest

from bodycheck.console.terminal import print_json


def test_numbers_that_json_lacks_are_null(capsys: pytest.CaptureFixture[str]) -> None:
    print_json({"rows": [{"max": math.inf, "q05": math.nan, "q50": 1e-300, "members": 3}], "ends": (-math.inf, "größte")})
    told = capsys.readouterr().out
    assert told == '{"rows": [{"max": null, "q05": null, "q50": 1e-300, "members": 3}], "ends": [null, "größte"]}\n'
    json.loads(told, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))

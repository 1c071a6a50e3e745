"""The commands that end by themselves: models, show, check, schema."""

import json
import re

import jsonschema
import pytest
import yaml

from emulator import (
    MODELS,
    REPOSITORY,
    USAGE,
    drivemu,
    refused,
)

TCP = ["--tcp", "127.0.0.1:0"]


def test_models():
    done = drivemu("models")
    assert done.returncode == 0
    for name in [*MODELS, "X3EA", "ESS242-Rx1", "YKE2405PR"]:
        assert name in done.stdout, name


@pytest.mark.parametrize("model", MODELS)
def test_show_a_model(model):
    table = drivemu("show", model)
    assert table.returncode == 0, table.stderr
    as_json = drivemu("show", model, "--format", "json")
    assert as_json.returncode == 0, as_json.stderr
    assert json.loads(as_json.stdout)
    markdown = drivemu("show", model, "--format", "markdown")
    assert markdown.returncode == 0, markdown.stderr
    assert re.search(r"^\|( ?:?-+:? ?\|)+$", markdown.stdout, re.MULTILINE), markdown.stdout[:500]
    address = {"hcfa-x": "0x0304", "k-series": "0x0130"}.get(model, "0x001D")
    assert address in table.stdout
    assert address in markdown.stdout


@pytest.mark.parametrize("form", ["table", "markdown", "json"])
def test_show_marks_what_is_assumed(form):
    assert "assumed" in drivemu("show", "hcfa-x", "--format", form).stdout


def test_show_a_row():
    by_name, by_address = drivemu("show", "hcfa-x", "P08.92"), drivemu("show", "hcfa-x", "0x085C")
    assert by_name.returncode == by_address.returncode == 0
    assert by_name.stdout == by_address.stdout
    for fact in ("P08.92", "Homing speed high", "1..3000", "rpm", "500", "7.1"):
        assert fact in by_name.stdout, fact
    assert "assumed" in drivemu("show", "hcfa-x", "P03.04").stdout
    row = drivemu("show", "hcfa-x", "P08.92", "--format", "json")
    assert "P08.92" in json.dumps(json.loads(row.stdout))
    assert drivemu("show", "X3EA", "P08.92").stdout == by_name.stdout


def test_show_what_is_not_there():
    assert "hcfa-x" in refused(drivemu("show", "hcfa-y"), USAGE)
    assert "P99.99" in refused(drivemu("show", "hcfa-x", "P99.99"), USAGE)
    assert "0x0305" in refused(drivemu("show", "hcfa-x", "0x0305"), USAGE)


def test_check_good_files():
    done = drivemu("check", *sorted((REPOSITORY / "models").glob("*.yaml")))
    assert done.returncode == 0, done.stderr


def test_check_tells_every_problem_with_its_place(tmp_path):
    good = (REPOSITORY / "models/hcfa-x.yaml").read_text()
    bad = good.replace("name: Homing speed high", "nam: Homing speed high")
    assert bad != good
    good = bad
    bad = bad.replace("position.actual: P21.07", "position.actual: P21.70")
    assert bad != good
    broken = tmp_path / "broken.yaml"
    broken.write_text(bad)
    done = drivemu("check", REPOSITORY / "models/k-series.yaml", broken)
    assert done.returncode == 2
    said = done.stdout + done.stderr
    where = re.findall(rf"^ *--> {re.escape(str(broken))}:(\d+):\d+$", said, re.MULTILINE)
    assert len(where) == said.count("error: "), said
    line = 1 + bad[: bad.index("nam: Homing")].count("\n")
    assert str(line) in where, said
    assert re.search(r"^ *\| +\^+", said, re.MULTILINE), said
    # The same file fails at the door of `run`.
    assert f"broken.yaml:{line}:" in refused(drivemu("run", broken, *TCP), USAGE)


@pytest.mark.parametrize(
    "text",
    ["", "]", "lines: [", "format: 1\nformat: 1\n", "format: 99\n", "\tformat: 1\n", "- 1\n", "a: &a [*a]\n"],
)
def test_check_survives_anything(tmp_path, text):
    file = tmp_path / "file.yaml"
    file.write_text(text)
    done = drivemu("check", file)
    assert done.returncode == 2
    assert "file.yaml" in done.stdout
    assert "panicked" not in done.stderr


def test_check_a_missing_file(tmp_path):
    assert "missing.yaml" in refused(drivemu("check", tmp_path / "missing.yaml"), USAGE)


@pytest.mark.parametrize("kind", ["model", "bench"])
def test_schema(kind):
    done = drivemu("schema", kind)
    assert done.returncode == 0, done.stderr
    jsonschema.validators.validator_for(json.loads(done.stdout)).check_schema(json.loads(done.stdout))


def as_editors_see_it(value):
    """YAML as JSON: keys are text."""
    match value:
        case dict():
            return {
                key if isinstance(key, str) else str(key): as_editors_see_it(it) for key, it in value.items()
            }
        case list():
            return [as_editors_see_it(it) for it in value]
    return value


def errors(schema, text):
    schema = json.loads(schema)
    validator = jsonschema.validators.validator_for(schema)(schema)
    found = validator.iter_errors(as_editors_see_it(yaml.safe_load(text)))
    return [f"{error.json_path}: {error.message}" for error in found]


@pytest.mark.parametrize("model", MODELS)
def test_schema_of_models_fits_them(model):
    schema = drivemu("schema", "model").stdout
    text = (REPOSITORY / f"models/{model}.yaml").read_text()
    assert errors(schema, text) == []
    assert errors(schema, text.replace("\nline:", "\nlyne:", 1)) != []


def test_schema_of_benches_fits_them():
    schema = drivemu("schema", "bench").stdout
    bench = "lines:\n  - pty: ./cell.tty\n    drives:\n      - {unit: 1, model: hcfa-x, set: {P03.04: 1}}\n"
    assert errors(schema, bench) == []
    assert errors(schema, bench.replace("drives", "drive")) != []


def test_help_and_version():
    for args in (["--help"], ["run", "--help"], ["show", "--help"], ["--version"]):
        done = drivemu(*args)
        assert done.returncode == 0
        assert "drivemu" in done.stdout
    for args in ([], ["no-such-command"], ["schema", "no-such-kind"], ["check"]):
        assert "--help" in refused(drivemu(*args), USAGE)

"""mbpoll: what somebody types to see whether a drive is there."""

import re
import subprocess

import pytest

from emulator import REPOSITORY


def run(command, **kwargs):
    return subprocess.run(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=10,
        **kwargs,
    )


def mbpoll(endpoint, *args, write=()):
    """One poll. Addresses as in the manual, which is what `-0` is for."""
    if endpoint.kind == "tcp":
        where = ["-m", "tcp", "-p", endpoint.port, endpoint.host]
    else:
        it = endpoint.serial_settings
        parity = {"N": "none", "E": "even", "O": "odd"}[it["parity"]]
        where = ["-m", "rtu", "-b", it["baudrate"], "-d", it["bytesize"]]
        where += ["-s", it["stopbits"], "-P", parity, endpoint.path]
    command = ["mbpoll", "-0", "-1", *args, *where]
    if write:
        command += ["--", *write]
    return run([str(word) for word in command])


def values(done):
    """What a read printed: reference -> value."""
    assert done.returncode == 0, done.stdout
    return dict(re.findall(r"^\[(\d+)\]:\s+(\S+)", done.stdout, re.MULTILINE))


@pytest.fixture(params=["pty", "tcp"])
def port(request):
    return ["--pty"] if request.param == "pty" else ["--tcp", "127.0.0.1:0"]


def test_words(emulate, port):
    endpoint = emulate("hcfa-x", *port).endpoint
    done = mbpoll(endpoint, "-r", 0x0304, write=[150])
    assert done.returncode == 0, done.stdout
    assert values(mbpoll(endpoint, "-r", 0x0304)) == {"772": "150"}
    assert values(mbpoll(endpoint, "-r", 0x0304, "-t", "4:hex")) == {"772": "0x0096"}


def test_pair_with_the_low_word_first(emulate, port):
    endpoint = emulate("hcfa-x", *port).endpoint
    done = mbpoll(endpoint, "-r", 0x0806, "-t", "4:int", write=[-10_000])
    assert done.returncode == 0, done.stdout
    assert values(mbpoll(endpoint, "-r", 0x0806, "-t", "4:int")) == {"2054": "-10000"}
    assert values(mbpoll(endpoint, "-r", 0x0806, "-c", 2, "-t", "4:hex")) == {
        "2054": "0xD8F0",
        "2055": "0xFFFF",
    }


def test_pair_with_the_high_word_first(emulate, port):
    endpoint = emulate("yako-closed-loop", *port).endpoint
    assert values(mbpoll(endpoint, "-r", 0x0024, "-t", "4:int", "-B")) == {"36": "5000"}
    assert mbpoll(endpoint, "-r", 0x0019, write=[1]).returncode == 0
    assert values(mbpoll(endpoint, "-r", 0x0024, "-t", "4:int")) == {"36": "5000"}


def test_both_axes_in_one_poll(emulate, port):
    endpoint = emulate("k-series", *port).endpoint
    done = mbpoll(endpoint, "-a", "1,2", "-r", 0x0259)
    assert re.findall(r"^\[601\]:\s+(\d+)", done.stdout, re.MULTILINE) == ["1", "2"], done.stdout


def test_unit_address(emulate, port):
    endpoint = emulate("hcfa-x", "--unit", 17, *port).endpoint
    assert values(mbpoll(endpoint, "-a", 17, "-r", 0x0900)) == {"2304": "17"}


@pytest.mark.parametrize(
    ("address", "value", "says"),
    [
        (0x085C, 3001, "Illegal data value"),
        (0x0305, 1, "Illegal data address"),
        (0x1501, 1, "Illegal data address"),
    ],
)
def test_refusals(emulate, port, address, value, says):
    done = mbpoll(emulate("hcfa-x", *port).endpoint, "-r", address, write=[value])
    assert done.returncode == 1
    assert says in done.stdout


def test_other_functions_are_refused(emulate, port):
    endpoint = emulate("hcfa-x", *port).endpoint
    for table in (0, 1, 3):
        done = mbpoll(endpoint, "-t", table, "-r", 0)
        assert done.returncode == 1
        assert "Illegal function" in done.stdout


MODELS = ["hcfa-x", "k-series", "yako-closed-loop", "yako-open-loop"]


@pytest.mark.parametrize("model", MODELS)
def test_the_suggested_call_works_as_it_is_printed(emulate, port, model):
    emulator = emulate(model, *port)
    (command,) = re.findall(r"mbpoll .*$", emulator.diagnostics, re.MULTILINE)
    done = run(command, shell=True)
    assert done.returncode == 0, f"$ {command}\n{done.stdout}"
    assert re.search(r"^\[\d+\]:\s+\S+", done.stdout, re.MULTILINE), f"$ {command}\n{done.stdout}"
    emulator.logged(r"unit 1 read ")


def test_the_suggested_call_works_in_a_shell_whatever_the_link_is_called(emulate, tmp_path):
    emulator = emulate("hcfa-x", "--pty", tmp_path / "cell 1 (test).tty")
    (command,) = re.findall(r"mbpoll .*$", emulator.diagnostics, re.MULTILINE)
    done = run(command, shell=True)
    assert done.returncode == 0, f"$ {command}\n{done.stdout}"


def test_the_tour_of_the_readme(emulate, tmp_path):
    readme = (REPOSITORY / "README.md").read_text()
    (flags,) = re.findall(r"^In another terminal, .*`(-m rtu .* -1)`", readme, re.MULTILINE)
    steps = re.findall(r"^(-r \d+ \./servo.*?)  +(\S.*)$", readme, re.MULTILINE)
    assert len(steps) >= 5
    emulate("hcfa-x", "--pty", tmp_path / "servo")
    for step, says in steps:
        done = run(f"mbpoll {flags} {step}", shell=True, cwd=tmp_path)
        said = re.sub(r"\s+", " ", done.stdout)
        assert re.sub(r"\s+", " ", says) in said, f"$ {step}\n{done.stdout}"


def test_no_call_is_suggested_that_mbpoll_cannot_make(emulate):
    assert "mbpoll" not in emulate("k-series", "--pty", "--ascii").diagnostics
    assert "mbpoll" not in emulate("hcfa-x", "--rtu-over-tcp", "127.0.0.1:0").diagnostics

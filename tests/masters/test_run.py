"""`drivemu run` as scripts see it: how it begins and ends, the ready file, the link, exit codes."""

import json
import os
import re
import signal
import socket
import stat
import subprocess
import time

import pytest

from emulator import (
    BINARY,
    DEADLINE,
    MODELS,
    NO_ENDPOINT,
    USAGE,
    Emulator,
    drivemu,
    refused,
    until,
)

TCP = ["--tcp", "127.0.0.1:0"]


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_is_a_clean_end_and_takes_the_link_away(emulate, tmp_path, number):
    link = tmp_path / "drive.tty"
    emulator = emulate("hcfa-x", "--pty", link)
    assert link.is_symlink()
    assert emulator.signal(number) == 0
    assert not link.is_symlink()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_may_come_as_soon_as_the_ready_file_is_there(tmp_path, number):
    for attempt in range(10):
        ready, link = tmp_path / f"ready-{attempt}.json", tmp_path / "drive.tty"
        command = [BINARY, "run", "hcfa-x", "--pty", link, "--ready-file", ready]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            end = time.monotonic() + DEADLINE
            while not ready.exists() and time.monotonic() < end:
                pass
            process.send_signal(number)
            assert process.wait(DEADLINE) == 0
        assert not link.is_symlink()


def test_the_end_does_not_wait_for_whoever_should_read_the_log(tmp_path):
    ready = tmp_path / "ready.json"
    command = [BINARY, "run", "hcfa-x", *TCP, "--ready-file", ready]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        try:
            until("the ready file", ready.exists)
            host, port = json.loads(ready.read_text())["endpoints"][0]["addr"].split(":")
            ask = bytes.fromhex("00 00 00 00 00 06 01 03 08 5C 00 03")
            with socket.create_connection((host, int(port)), timeout=2) as client:
                # Far more lines than a pipe takes.
                for _ in range(2000):
                    client.sendall(ask)
                    assert client.recv(100)
            process.send_signal(signal.SIGTERM)
            assert process.wait(5) == 0
        finally:
            process.kill()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_a_conversation_over_tcp(emulate, number):
    emulator = emulate("hcfa-x", *TCP)
    endpoint = emulator.endpoint
    with socket.create_connection((endpoint.host, endpoint.port), timeout=2):
        assert emulator.signal(number) == 0
    # The port is free again.
    emulate("hcfa-x", "--tcp", endpoint.addr)


def test_the_link_leads_to_the_terminal(emulate, tmp_path, instrument):
    link = tmp_path / "drive.tty"
    endpoint = emulate("hcfa-x", "--pty", link).endpoint
    assert stat.S_ISCHR(os.stat(link).st_mode)
    assert instrument(endpoint).read_register(0x0304) == 100
    assert instrument(endpoint, path=link).read_register(0x0304) == 100


def test_the_link_of_a_killed_run_is_replaced(tmp_path, emulate):
    link = tmp_path / "drive.tty"
    Emulator(tmp_path / "killed", "hcfa-x", "--pty", link).kill()
    assert link.is_symlink()
    emulate("hcfa-x", "--pty", link)
    assert stat.S_ISCHR(os.stat(link).st_mode)


def test_a_file_is_not_replaced_by_a_link(tmp_path):
    precious = tmp_path / "drive.tty"
    precious.write_text("precious")
    assert str(precious) in refused(drivemu("run", "hcfa-x", "--pty", precious), NO_ENDPOINT)
    assert not precious.is_symlink()
    assert precious.read_text() == "precious"


def test_a_missing_directory_of_a_link(tmp_path):
    link = tmp_path / "missing" / "drive.tty"
    assert str(link.parent) in refused(drivemu("run", "hcfa-x", "--pty", link), NO_ENDPOINT)


@pytest.mark.parametrize("flag", ["--tcp", "--rtu-over-tcp"])
def test_a_busy_port(busy_port, flag):
    says = refused(drivemu("run", "hcfa-x", flag, f"127.0.0.1:{busy_port}"), NO_ENDPOINT)
    assert str(busy_port) in says


def test_a_missing_serial_port(tmp_path):
    device = tmp_path / "ttyS99"
    assert str(device) in refused(drivemu("run", "hcfa-x", "--serial", device), NO_ENDPOINT)


def test_no_ready_file_without_an_endpoint(tmp_path, busy_port):
    ready = tmp_path / "ready.json"
    done = drivemu("run", "hcfa-x", "--tcp", f"127.0.0.1:{busy_port}", "--ready-file", ready)
    refused(done, NO_ENDPOINT)
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_model():
    assert "did you mean" in refused(drivemu("run", "hcfa-xx"), USAGE)
    says = refused(drivemu("run", "nothing-like-it"), USAGE)
    assert all(model in says for model in MODELS)


@pytest.mark.parametrize(
    ("args", "names"),
    [
        (["--unit", "0"], "unit"),
        (["--unit", "248"], "--unit"),
        (["--unit", "many"], "--unit"),
        (["--set", "P09.11"], "P09.11"),
        (["--set", "P99.99=1"], "P99.99"),
        (["--set", "P08.92=3001"], "1..3000"),
        (["--set", "read_limit=17"], "read_limit"),
        (["--set", "P21.07=5"], "P21.07"),
        (["--baud", "1234"], "1234"),
        (["--parity", "mark"], "--parity"),
        (["--ascii"], "ASCII"),
        (["--seed", "x"], "--seed"),
        (["--no-such-flag"], "--no-such-flag"),
        (["--pty", "--serial", "/dev/ttyS0"], "--serial"),
    ],
)
def test_wrong_usage(args, names):
    assert names in refused(drivemu("run", "hcfa-x", *args), USAGE)


def test_an_address_that_is_none():
    done = drivemu("run", "hcfa-x", "--tcp", "nonsense")
    assert done.returncode in (USAGE, NO_ENDPOINT)
    assert "nonsense" in done.stderr


def test_a_broken_bench(tmp_path):
    bench = tmp_path / "cell.yaml"
    bench.write_text("lines:\n  - pty: auto\n    drives:\n      - {unit: 1, modell: hcfa-x}\n")
    said = refused(drivemu("run", bench), USAGE)
    assert re.search(r"modell: unknown key\n *--> .*cell\.yaml:4:\d+$", said, re.MULTILINE), said


def test_the_ready_file(emulate):
    emulator = emulate("yako-closed-loop", "--seed", 7, "--pty")
    assert emulator.ready["seed"] == 7
    (endpoint,) = emulator.ready["endpoints"]
    assert endpoint["kind"] == "pty"
    assert stat.S_ISCHR(os.stat(endpoint["path"]).st_mode)
    assert endpoint["line"] == "115200-8N1"
    assert endpoint["framing"] == "rtu"
    assert endpoint["units"] == [{"unit": 1, "model": "yako-closed-loop"}]


def test_the_ready_file_of_a_listener(emulate):
    emulator = emulate("k-series", "--seed", 7, *TCP)
    (endpoint,) = emulator.ready["endpoints"]
    assert endpoint["kind"] == "tcp"
    assert re.fullmatch(r"127\.0\.0\.1:[1-9]\d*", endpoint["addr"])
    assert endpoint["units"] == [{"unit": unit, "model": "k-series"} for unit in (1, 2)]


def test_a_stale_ready_file_is_not_believed(tmp_path, busy_port):
    ready = tmp_path / "ready.json"
    ready.write_text("stale")
    drivemu("run", "hcfa-x", "--tcp", f"127.0.0.1:{busy_port}", "--ready-file", ready)
    assert not ready.exists()


@pytest.mark.parametrize(
    ("model", "line"),
    [
        ("hcfa-x", "9600-8N2"),
        ("k-series", "9600-8E1"),
        ("yako-closed-loop", "115200-8N1"),
        ("yako-open-loop", "115200-8N1"),
    ],
)
def test_line_settings_are_those_of_the_model(emulate, model, line):
    assert emulate(model, "--pty").endpoint.line == line


def test_line_settings_are_taken_over_by_the_drive(emulate, instrument):
    endpoint = emulate("hcfa-x", "--pty", "-b", 19200, "-d", 8, "-P", "even", "-s", 1).endpoint
    assert endpoint.line == "19200-8E1"
    assert instrument(endpoint).read_registers(0x0901, 2) == [3, 1]


def test_without_an_argument_it_is_a_stepper_on_a_terminal(emulate):
    endpoint = emulate().endpoint
    assert endpoint.kind == "pty"
    assert [unit["model"] for unit in endpoint.units] == ["yako-closed-loop"]


def test_the_seed_is_printed_and_repeats(emulate):
    first = emulate("hcfa-x", "--pty")
    seed = first.ready["seed"]
    assert f"seed {seed}" in first.diagnostics
    assert emulate("hcfa-x", "--pty", "--seed", seed).ready["seed"] == seed
    assert emulate("hcfa-x", "--pty").ready["seed"] != seed

"""The event log: what it says about a refusal, as text and as JSON."""

import json

import minimalmodbus
import pytest

from emulator import (
    FAILED,
    drivemu,
    refused,
    until,
)

TCP = ["--tcp", "127.0.0.1:0"]


def test_a_refusal_names_the_register_and_the_reason(emulate, instrument):
    emulator = emulate("hcfa-x", "--pty")
    master = instrument(emulator.endpoint)
    with pytest.raises(minimalmodbus.IllegalRequestError):
        master.write_register(0x085C, 3001, functioncode=6)
    emulator.logged(
        r"unit 1 write P08\.92 homing speed high = 3001( rpm)?: refused, range 1\.\.3000 -> exception 03$"
    )
    with pytest.raises(minimalmodbus.IllegalRequestError):
        master.read_register(0x0305)
    emulator.logged(r"unit 1 read 0x0305: refused, 0x0305 is not mapped -> exception 02$")
    with pytest.raises(minimalmodbus.IllegalRequestError):
        master.write_registers(0x1507, [0, 0])
    emulator.logged(r"unit 1 write P21\.07 .*: refused, .* is read-only -> exception 02$")
    master.write_register(0x0304, 150, functioncode=6)
    emulator.logged(r"unit 1 write P03\.04 jog speed = 150")
    master.read_register(0x0304)
    emulator.logged(r"unit 1 read P03\.04 jog speed = 150")


def test_the_log_as_json(emulate, tmp_path, instrument):
    log_file = tmp_path / "log.jsonl"
    emulator = emulate("hcfa-x", "--pty", "--format", "json", "--log-file", log_file)
    master = instrument(emulator.endpoint)
    with pytest.raises(minimalmodbus.IllegalRequestError):
        master.write_register(0x085C, 3001, functioncode=6)
    emulator.logged('"write"')
    emulator.stop()
    events = [json.loads(line) for line in emulator.log.splitlines()]
    (write,) = [event for event in events if event["event"] == "write"]
    assert (write["unit"], write["exception"], write["refused"]) == (1, 3, "range")
    (row,) = write["rows"]
    assert (row["row"], row["address"], row["value"]) == ("P08.92", 0x085C, 3001)
    assert write["text"].startswith("unit 1 write P08.92 homing speed high = 3001")
    assert [event["t"] for event in events] == sorted(event["t"] for event in events)
    # The log file is the same log, whatever standard output is.
    assert log_file.read_text() == emulator.log


def test_the_log_file_beside_the_text(emulate, tmp_path, instrument):
    log_file = tmp_path / "log.jsonl"
    emulator = emulate("k-series", "--pty", "--log-file", log_file)
    master = instrument(emulator.endpoint, unit=2)
    master.write_register(0x0130, 7, functioncode=6)
    emulator.logged("unit 2 write P304 jog speed = 7")
    until("the event", lambda: '"P304"' in log_file.read_text())
    emulator.stop()
    told = [json.loads(line)["text"] for line in log_file.read_text().splitlines()]
    assert [line.split(maxsplit=1)[1] for line in emulator.log.splitlines()] == told


def test_a_log_file_that_cannot_be_written(tmp_path):
    log_file = tmp_path / "missing" / "log.jsonl"
    assert str(log_file) in refused(drivemu("run", "hcfa-x", *TCP, "--log-file", log_file), FAILED)


def test_an_expired_hold_time_is_told(emulate, instrument):
    emulator = emulate("hcfa-x", "--pty", "--set", "P09.05=2", "--set", "P09.11=0")
    emulator.logged(r"unit 1 ready")
    master = instrument(emulator.endpoint)
    master.write_register(0x3607, 2, functioncode=6)
    emulator.logged(r"unit 1 servo on")
    emulator.logged(r"not refreshed for 0\.5 s \(P09\.11\)")
    emulator.logged(r"unit 1 servo off")


def test_an_order_without_effect_says_why_once(emulate, instrument):
    """The commonest beginner's error: the bit is written, and nothing has enabled it."""
    emulator = emulate("hcfa-x", "--pty")
    emulator.logged(r"unit 1 ready")
    master = instrument(emulator.endpoint)
    for _ in range(5):
        master.write_register(0x3607, 2, functioncode=6)
    emulator.logged(r"unit 1 VDI1 bit 1 S_ON has no effect: P09\.05 bit 1 is 0$")
    for _ in range(5):
        assert master.read_register(0x3688) == 0
    emulator.logged(r"unit 1 VDO1 reads 0: P09\.09 is 0$")
    master.write_register(0x0905, 2, functioncode=6)
    emulator.logged(r"unit 1 servo on$")
    emulator.stop()
    assert emulator.log.count("has no effect") == 1
    assert emulator.log.count("reads 0") == 1


def test_an_order_without_effect_as_json(emulate, instrument):
    emulator = emulate("yako-closed-loop", "--pty", "--format", "json")
    master = instrument(emulator.endpoint)
    master.write_register(0x002D, 0x11, functioncode=6)
    master.write_register(0x0027, 1, functioncode=6)
    master.write_register(0x0027, 8, functioncode=6)
    emulator.logged('"no_order"')
    emulator.stop()
    events = [json.loads(line) for line in emulator.log.splitlines()]
    move, modifier = [event for event in events if event["event"] == "no_effect"]
    assert (move["order"], move["action"], move["reason"]) == ("action", "move_start", "servo_off")
    assert move["text"] == "unit 1 move_start has no effect: the servo is off"
    assert (modifier["order"], modifier["row"], modifier["bit"]) == ("bit", "motion_command", 3)
    assert (modifier["reason"], modifier["why"]) == ("no_order", "no command in the same write")

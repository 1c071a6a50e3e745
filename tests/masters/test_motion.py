"""Axes in real time: what masters nobody here wrote see of a motion that they start, watch and end."""

import contextlib
import time

import pytest
from minimalmodbus import BYTEORDER_BIG
from pymodbus.client import ModbusSerialClient

import libmodbus
from emulator import until

REAL_TIME = ["--pty", "--rate", "1"]

# What a busy machine may add to a time that the drive keeps.
SLACK = 2.0


@pytest.fixture
def pymodbus(emulate):
    """Starts a model and gives the emulator and a pymodbus client to it."""
    with contextlib.ExitStack() as at_the_end:

        def start(model, *args):
            emulator = emulate(model, *args, *REAL_TIME)
            endpoint = emulator.endpoint
            client = ModbusSerialClient(endpoint.path, timeout=2, retries=0, **endpoint.serial_settings)
            assert client.connect()
            at_the_end.callback(client.close)
            return emulator, client

        yield start


def signed(word):
    return word - 0x10000 if word & 0x8000 else word


def test_hcfa_jogs_as_long_as_the_master_repeats_itself(pymodbus):
    # 6.1, with P09.11 = 1 s.
    emulator, client = pymodbus("hcfa-x", "--set", "P04.01=0", "--set", "P09.11=1")

    def read(address):
        answer = client.read_holding_registers(address, count=1, device_id=1)
        assert not answer.isError(), answer
        return signed(answer.registers[0])

    def write(address, value):
        answer = client.write_register(address, value, device_id=1)
        assert not answer.isError(), answer

    write(0x0905, 0x0002)
    write(0x0906, 0x000C)
    write(0x0909, 0x0002)
    until("S_RDY", lambda: read(0x3688) == 0x0002)

    def refresh():
        write(0x3607, 0x0002)
        write(0x3608, 0x0004)
        return time.monotonic()

    begin = refresh()
    until("the jog speed", lambda: read(0x1501) == 100)
    while time.monotonic() < begin + 1.5:
        last = refresh()
        assert read(0x1501) == 100
        time.sleep(0.1)
    until("the end of the jog", lambda: read(0x1501) == 0)
    assert 0.9 < time.monotonic() - last < 1.0 + SLACK
    assert [read(0x3607), read(0x3608)] == [0, 0]
    emulator.logged(r"servo on$")
    emulator.logged(r"jogging at 100 rpm$")
    emulator.logged(r"not refreshed for 1 s \(P09\.11\)$")


def test_yako_moves_to_a_position(emulate, instrument):
    # 4.1: absolute, 30 rpm, which is 500 counts a second; ramps of 100 ms.
    emulator = emulate("yako-open-loop", *REAL_TIME)
    master = instrument(emulator.endpoint)

    def position():
        return master.read_long(0x000A, signed=True, byteorder=BYTEORDER_BIG)

    master.write_registers(0x0020, [0, 100, 100, 30, 0, 1000])
    begin = time.monotonic()
    master.write_register(0x0027, 0x0005, functioncode=6)
    midway = until("the middle of the way", lambda: (at := position()) >= 400 and at)
    assert midway < 1000
    assert master.read_register(0x000C, signed=True) == 30
    assert master.read_register(0x0007) == 0b100
    until("in position", lambda: master.read_register(0x0007) == 0b001)
    assert 2.0 < time.monotonic() - begin < 2.1 + SLACK
    assert position() == 1000
    assert master.read_register(0x000C, signed=True) == 0
    emulator.logged(r"moving to 1000$")
    emulator.logged(r"stopped at 1000$")


def test_k_series_jogs_one_axis(emulate):
    # 6.4: 0528H and *2. Axis b jogs, axis A stands.
    emulator = emulate("k-series", *REAL_TIME)
    with contextlib.closing(libmodbus.Master(emulator.endpoint, unit=2)) as master:

        def position():
            low, high = master.read(0x05F2, 2)
            return signed(high) << 16 | low

        master.write(0x0130, 60)
        assert master.read(0x0457) == [0x0090]
        master.write(0x0528, 0x8000)
        assert master.read(0x0457) == [0x00F0]
        master.write(0x0528, 0x8002)
        begin = time.monotonic()
        # S-ST, COIN at its speed, PS-IN, TGON.
        assert master.read(0x0457) == [0x00FC]
        # 10000 counts a second, in reverse.
        until("half a revolution", lambda: position() <= -5000)
        assert 0.4 < time.monotonic() - begin < 0.5 + SLACK
        master.write(0x0528, 0x8000)
        stands = position()
        assert master.read(0x0457) == [0x00F0]
        assert position() == stands
        master.unit = 1
        assert [master.read(0x0457), position()] == [[0x0090], 0]
    emulator.logged(r"unit 2 jogging at -60 rpm$")

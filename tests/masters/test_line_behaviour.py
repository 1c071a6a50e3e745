"""Line behaviour: masters that expect it cope, and those that do not, notice."""

import time

import minimalmodbus
import pytest
from pymodbus.client import ModbusSerialClient
from pymodbus.exceptions import ModbusException

from test_mbpoll import mbpoll, values

JOG_SPEED = 0x0304
# Silence, the drive and seven characters at 9600-8N2.
PACED = 0.014031

BENCH = """
lines:
  - {{pty: auto, {behaviour}, drives: [{{model: hcfa-x}}]}}
"""


@pytest.fixture
def line(emulate, tmp_path):
    """A servo on a pseudo-terminal with this line behaviour."""

    def run(behaviour):
        path = tmp_path / "bench.yaml"
        path.write_text(BENCH.format(behaviour=behaviour))
        return emulate(path)

    return run


@pytest.fixture
def client(request):
    def connect(endpoint, **kwargs):
        settings = endpoint.serial_settings | {"timeout": 1, "retries": 0} | kwargs
        client = ModbusSerialClient(endpoint.path, **settings)
        request.addfinalizer(client.close)
        assert client.connect()
        return client

    return connect


def read(master):
    return master.read_holding_registers(JOG_SPEED, count=1, device_id=1)


def test_mbpoll_waits_for_a_paced_reply(emulate):
    endpoint = emulate("hcfa-x", "--pty", "--pacing", "line").endpoint
    assert values(mbpoll(endpoint, "-r", JOG_SPEED)) == {"772": "100"}


def test_a_paced_reply_is_never_early(emulate, client):
    master = client(emulate("hcfa-x", "--pty", "--pacing", "line").endpoint)
    for _ in range(20):
        asked = time.monotonic()
        assert read(master).registers == [100]
        assert time.monotonic() - asked >= PACED


def test_masters_put_lumps_together(line, client, instrument):
    endpoint = line("chunk: 4ms, pacing: line").endpoint
    master = client(endpoint)
    assert read(master).registers == [100]
    master.close()
    assert instrument(endpoint).read_registers(JOG_SPEED, 1) == [100]
    assert values(mbpoll(endpoint, "-r", JOG_SPEED)) == {"772": "100"}


def test_pymodbus_knows_an_echo(line, client):
    endpoint = line("echo: true").endpoint
    master = client(endpoint, handle_local_echo=True)
    assert [read(master).registers for _ in range(3)] == [[100]] * 3
    assert master.write_register(JOG_SPEED, 7, device_id=1).registers == [7]
    assert read(master).registers == [7]


def test_minimalmodbus_knows_an_echo(line, instrument):
    master = instrument(line("echo: true").endpoint)
    # Without its option it takes the echo for a reply of another length.
    with pytest.raises(minimalmodbus.ModbusException):
        master.read_register(JOG_SPEED)
    # Its reply may still be on the way.
    master.serial.read(64)
    master.handle_local_echo = True
    assert master.read_register(JOG_SPEED) == 100


def test_an_adapter_with_an_echo_on_a_paced_line(line, instrument):
    master = instrument(line("echo: true, chunk: 4ms, pacing: line").endpoint)
    master.handle_local_echo = True
    assert [master.read_register(JOG_SPEED) for _ in range(5)] == [100] * 5


@pytest.mark.parametrize("behaviour", ["chatter: {units: [7, 8], every: 20ms}", "faults: [{do: crowded_line}]"])
def test_nobody_takes_others_for_the_drive(line, client, behaviour):
    emulator = line(behaviour)
    master = client(emulator.endpoint, timeout=0.2)
    seen = set()
    for _ in range(50):
        try:
            answer = read(master)
            seen.add("exception" if answer.isError() else answer.registers[0])
        except ModbusException:
            seen.add("noticed")
            master.close()
            assert master.connect()
    assert 100 in seen and seen <= {100, "noticed"}
    emulator.logged(r"foreign request to unit \d+: ")
    emulator.logged(r"foreign reply from unit \d+: ")

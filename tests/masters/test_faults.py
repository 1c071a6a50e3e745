"""Bad weather on request: what a master makes of it, and what the log says."""

import minimalmodbus
import pytest
from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.exceptions import ModbusIOException

from emulator import USAGE, drivemu, refused
from test_mbpoll import mbpoll, values

TCP = ["--tcp", "127.0.0.1:0"]
JOG_SPEED = 0x0304


@pytest.fixture
def client(request):
    """Opens a pymodbus client that does not try again by itself."""

    def connect(endpoint, timeout=0.3):
        patience = {"timeout": timeout, "retries": 0}
        if endpoint.kind == "tcp":
            client = ModbusTcpClient(endpoint.host, port=endpoint.port, **patience)
        else:
            client = ModbusSerialClient(endpoint.path, **endpoint.serial_settings, **patience)
        request.addfinalizer(client.close)
        assert client.connect()
        return client

    return connect


def reopen(client):
    """Whatever is left of the last answer goes with the old connection."""
    client.close()
    assert client.connect()


def read(client):
    return client.read_holding_registers(JOG_SPEED, count=1, device_id=1)


@pytest.mark.parametrize("kind", ["lose_request", "lose_reply", "bad_crc", "wrong_unit", "truncate"])
def test_pymodbus_gets_no_answer(emulate, client, kind):
    emulator = emulate("hcfa-x", "--pty", "--fault", f"{kind}:count=1")
    master = client(emulator.endpoint)
    with pytest.raises(ModbusIOException):
        read(master)
    emulator.logged(rf"fault {kind}: .* \(hit 1\)$")
    reopen(master)
    assert read(master).registers == [100]


def test_a_lost_reply_was_executed_and_a_lost_request_was_not(emulate, client):
    faults = ["--fault", "lose_reply:function=6,count=1"]
    faults += ["--fault", "lose_request:function=6,skip=1,count=1"]
    master = client(emulate("hcfa-x", *TCP, *faults).endpoint)
    for value, after in [(7, 7), (8, 7)]:
        with pytest.raises(ModbusIOException):
            master.write_register(JOG_SPEED, value, device_id=1)
        reopen(master)
        assert read(master).registers == [after]


def test_exceptions_on_request(emulate, client):
    faults = ["--fault", "busy:count=1", "--fault", "exception:code=4,skip=1,count=1"]
    master = client(emulate("hcfa-x", *TCP, *faults).endpoint)
    assert [read(master).exception_code for _ in range(2)] == [6, 4]
    assert read(master).registers == [100]


def test_a_slow_drive_and_a_master_with_patience(emulate, client):
    endpoint = emulate("hcfa-x", "--pty", "--fault", "delay:ms=500").endpoint
    hasty = client(endpoint, timeout=0.1)
    with pytest.raises(ModbusIOException):
        read(hasty)
    hasty.close()
    assert read(client(endpoint, timeout=5)).registers == [100]


def test_minimalmodbus_tells_a_checksum(emulate, instrument):
    master = instrument(emulate("hcfa-x", "--pty", "--fault", "bad_crc:count=1").endpoint)
    with pytest.raises(minimalmodbus.InvalidResponseError, match="(?i)checksum"):
        master.read_register(JOG_SPEED)
    assert master.read_register(JOG_SPEED) == 100


def test_mbpoll_in_bad_weather(emulate):
    faults = ["--fault", "bad_crc:count=1", "--fault", "split:gap_ms=50"]
    endpoint = emulate("hcfa-x", "--pty", *faults).endpoint
    assert mbpoll(endpoint, "-r", JOG_SPEED, "-o", 0.5).returncode != 0
    assert values(mbpoll(endpoint, "-r", JOG_SPEED)) == {"772": "100"}


def test_a_mistake_is_told_with_a_caret():
    said = refused(drivemu("run", "hcfa-x", "--fault", "lose_reply:evry=10"), USAGE)
    assert "did you mean `every`?" in said and "^^^^" in said


@pytest.mark.parametrize("kind, moved", [("lose_reply", 2000), ("lose_request", 1000)])
def test_the_retries_of_pymodbus_move_twice(emulate, kind, moved):
    """By its own default it repeats what nobody answered, whatever that was."""
    emulator = emulate("yako-closed-loop", *TCP, "--fault", f"{kind}:register=0x0027,count=1", "--rate", 20)
    endpoint = emulator.endpoint
    with ModbusTcpClient(endpoint.host, port=endpoint.port, timeout=0.5) as master:
        assert master.write_registers(0x0024, [0, 1000], device_id=1).registers is not None
        assert not master.write_register(0x0027, 1, device_id=1).isError()
        emulator.logged(rf"stopped at {moved}$")
    assert ("move_start repeated" in emulator.log) == (kind == "lose_reply")

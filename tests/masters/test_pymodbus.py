"""pymodbus: RTU and ASCII on a pseudo-terminal, Modbus TCP, and RTU frames over TCP."""

import asyncio
import threading

import pytest
from pymodbus import FramerType
from pymodbus.client import AsyncModbusTcpClient, ModbusSerialClient, ModbusTcpClient
from pymodbus.exceptions import ModbusIOException

from emulator import until

PORTS = {
    "rtu": ["--pty"],
    "tcp": ["--tcp", "127.0.0.1:0"],
    "rtu-over-tcp": ["--rtu-over-tcp", "127.0.0.1:0"],
}


def client_of(endpoint, framer=FramerType.RTU, timeout=2):
    patience = {"timeout": timeout, "retries": 0}
    match endpoint.kind:
        case "pty" | "serial":
            settings = endpoint.serial_settings
            return ModbusSerialClient(endpoint.path, framer=framer, **settings, **patience)
        case "tcp":
            return ModbusTcpClient(endpoint.host, port=endpoint.port, **patience)
        case "rtu-over-tcp":
            return ModbusTcpClient(endpoint.host, port=endpoint.port, framer=framer, **patience)


@pytest.fixture
def connect():
    """Opens a client to an endpoint; closed after the test."""
    clients = []

    def connect(endpoint, **kwargs):
        client = client_of(endpoint, **kwargs)
        assert client.connect()
        clients.append(client)
        return client

    yield connect
    for client in clients:
        client.close()


@pytest.fixture(params=PORTS)
def master(request, emulate, connect):
    """Starts a model and gives a master to it, over each kind of port in turn."""
    return lambda model, *args: connect(emulate(model, *args, *PORTS[request.param]).endpoint)


def read(client, address, count=1, unit=1):
    answer = client.read_holding_registers(address, count=count, device_id=unit)
    assert not answer.isError(), answer
    return answer.registers


def write(client, address, *words, unit=1):
    if len(words) == 1:
        answer = client.write_register(address, words[0], device_id=unit)
    else:
        answer = client.write_registers(address, list(words), device_id=unit)
    assert not answer.isError(), answer


def code(answer):
    assert answer.isError(), answer
    return answer.exception_code


def test_hcfa_registers(master):
    client = master("hcfa-x")
    write(client, 0x0304, 150)
    assert read(client, 0x0304) == [150]
    write(client, 0x0806, 0x2710, 0x0000)
    assert read(client, 0x0806, 2) == [0x2710, 0x0000]
    assert read(client, 0x1507, 2) == [0, 0]


def test_hcfa_refusals(master):
    client = master("hcfa-x")
    assert code(client.read_input_registers(0x0304)) == 1
    assert code(client.write_registers(0x0806, [1])) == 2
    assert code(client.write_registers(0x1507, [1, 0])) == 2
    assert code(client.read_holding_registers(0x0305)) == 2
    assert code(client.write_register(0x085C, 3001)) == 3
    assert read(client, 0x085C) == [500]


def test_hcfa_memory_windows(master):
    client = master("hcfa-x")
    write(client, 0xE304, 160)
    assert read(client, 0x0304) == [160]
    assert read(client, 0xE304) == [160]


def test_hcfa_servo_on_by_the_master(emulate, connect):
    settings = ["--set", "P09.05=2", "--set", "P09.09=2", "--set", "P09.11=0"]
    client = connect(emulate("hcfa-x", *settings, *PORTS["tcp"]).endpoint)
    until("the drive to be ready", lambda: read(client, 0x3688) == [0x0002])
    write(client, 0x3607, 0x0002)
    assert read(client, 0x3607) == [0x0002]
    until("the end of the hold time", lambda: read(client, 0x3607) == [0x0000])


def test_k_series_stations(master):
    client = master("k-series")
    write(client, 0x0130, 111, unit=1)
    write(client, 0x0130, 222, unit=2)
    assert [read(client, 0x0130, unit=unit) for unit in (1, 2)] == [[111], [222]]
    assert code(client.write_registers(0x0130, [1, 2], device_id=2)) == 1
    assert len(read(client, 0x0000, 20)) == 20
    assert code(client.read_holding_registers(0x0000, count=21)) == 3


def test_k_series_units_move_together(master):
    client = master("k-series", "-a", 40)
    assert [read(client, 0x0259, unit=unit) for unit in (40, 41)] == [[40], [41]]


def test_k_series_fc16_as_an_option(master):
    client = master("k-series", "--set", "fc10=on")
    write(client, 0x0600, 0x5678, 0x1234)
    assert read(client, 0x0600, 2) == [0x5678, 0x1234]


@pytest.mark.parametrize("model", ["yako-closed-loop", "yako-open-loop"])
def test_yako_answers_with_its_own_numbers(master, model):
    client = master(model)
    assert code(client.read_input_registers(0x0000)) == 2
    assert code(client.read_holding_registers(0x0004)) == 3
    assert code(client.write_register(0xFF00, 0xFFFF)) == 4
    assert code(client.read_holding_registers(0x0020, count=17)) == 5
    assert code(client.write_register(0x0007, 0)) == 6
    assert code(client.write_register(0x0021, 2001)) == 7
    assert len(read(client, 0x0060, 16)) == 16


def test_yako_word_order(master):
    client = master("yako-closed-loop")
    write(client, 0x0024, 0x0001, 0x86A0)
    write(client, 0x0019, 1)
    assert read(client, 0x0024, 2) == [0x86A0, 0x0001]


def test_start_values(master):
    client = master("hcfa-x", "--set", "P03.04=77", "--set", "P08.06=-2")
    assert read(client, 0x0304) == [77]
    assert read(client, 0x0806, 2) == [0xFFFE, 0xFFFF]


def test_a_product_name_is_a_model_name(master):
    assert read(master("ESS242-Rx1"), 0x0023) == [60]


@pytest.mark.parametrize("port", ["rtu", "rtu-over-tcp"])
def test_broadcast_is_executed_and_not_answered(emulate, connect, port):
    emulator = emulate("k-series", *PORTS[port])
    client = connect(emulator.endpoint)
    client.write_register(0x0130, 333, device_id=0, no_response_expected=True)
    assert [read(client, 0x0130, unit=unit) for unit in (1, 2)] == [[333], [333]]
    quiet = connect(emulate("k-series", *PORTS[port]).endpoint, timeout=0.2)
    with pytest.raises(ModbusIOException):
        quiet.write_register(0x0130, 444, device_id=0)
    assert [read(quiet, 0x0130, unit=unit) for unit in (1, 2)] == [[444], [444]]


def test_ascii(emulate, connect):
    client = connect(emulate("k-series", "--pty", "--ascii").endpoint, framer=FramerType.ASCII)
    write(client, 0x0130, 0xBEEF, unit=2)
    assert read(client, 0x0130, 2, unit=2) == [0xBEEF, 0]
    assert code(client.write_registers(0x0130, [1, 2])) == 1
    assert code(client.read_holding_registers(0x0000, count=21)) == 3
    assert code(client.write_register(0x0064, 7)) == 3


def test_ascii_over_tcp(emulate, connect):
    emulator = emulate("k-series", "--ascii", "--rtu-over-tcp", "127.0.0.1:0")
    client = connect(emulator.endpoint, framer=FramerType.ASCII)
    write(client, 0x0130, 0xBEEF)
    assert read(client, 0x0130) == [0xBEEF]


def test_reconnecting(emulate, connect):
    for port in PORTS.values():
        endpoint = emulate("yako-open-loop", *port).endpoint
        for value in (41, 42, 43):
            client = connect(endpoint)
            write(client, 0x0021, value)
            assert read(client, 0x0021) == [value]
            client.close()


@pytest.mark.parametrize("port", ["tcp", "rtu-over-tcp"])
def test_two_clients_at_once(emulate, connect, port):
    endpoint = emulate("hcfa-x", *PORTS[port]).endpoint
    wrong = []

    def talk(client, address):
        for value in range(200):
            write(client, address, value)
            if (got := read(client, address)) != [value]:
                wrong.append((address, value, got))

    threads = [
        threading.Thread(target=talk, args=(connect(endpoint), address)) for address in (0x0304, 0x030E)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
        assert not thread.is_alive()
    assert wrong == []


def test_two_clients_share_one_drive(emulate, connect):
    endpoint = emulate("hcfa-x", *PORTS["tcp"]).endpoint
    one, other = connect(endpoint), connect(endpoint)
    write(one, 0x0304, 250)
    assert read(other, 0x0304) == [250]
    one.close()
    write(other, 0x0304, 251)
    assert read(connect(endpoint), 0x0304) == [251]


def test_many_requests_in_flight(emulate):
    endpoint = emulate("hcfa-x", *PORTS["tcp"]).endpoint

    async def talk():
        clients = [AsyncModbusTcpClient(endpoint.host, port=endpoint.port) for _ in range(20)]
        await asyncio.gather(*(client.connect() for client in clients))
        answers = await asyncio.gather(
            *(client.read_holding_registers(0x085C, count=3) for client in clients * 10)
        )
        for client in clients:
            client.close()
        return answers

    answers = asyncio.run(asyncio.wait_for(talk(), 10))
    assert [answer.registers for answer in answers] == [[500, 50, 1000]] * 200


def test_another_unit_is_silence(emulate, connect):
    for port in ("rtu", "rtu-over-tcp"):
        emulator = emulate("hcfa-x", *PORTS[port])
        client = connect(emulator.endpoint, timeout=0.2)
        with pytest.raises(ModbusIOException):
            client.read_holding_registers(0x0304, device_id=9)
        assert read(client, 0x0304) == [100]


def test_a_new_unit_address_counts_from_the_next_request_on(emulate, connect):
    emulator = emulate("hcfa-x", *PORTS["rtu"])
    client = connect(emulator.endpoint, timeout=0.2)
    write(client, 0x0900, 5, unit=1)
    assert read(client, 0x0900, unit=5) == [5]
    with pytest.raises(ModbusIOException):
        client.read_holding_registers(0x0900, device_id=1)
    emulator.logged(r"unit 1.*no reply.*5")


def test_a_drive_at_another_speed_is_deaf(emulate, connect, tmp_path):
    bench = tmp_path / "cell.yaml"
    bench.write_text(
        """\
lines:
  - pty: auto
    drives:
      - {unit: 1, model: hcfa-x}
      - {unit: 2, model: hcfa-x}
"""
    )
    emulator = emulate(bench)
    client = connect(emulator.endpoint, timeout=0.2)
    # The answer to the write leaves at the old speed.
    write(client, 0x0901, 3, unit=1)
    with pytest.raises(ModbusIOException):
        client.read_holding_registers(0x0900, device_id=1)
    emulator.logged(r"unit 1.*no reply.*19200-8N2")
    # Once the other has followed, the line is at the new speed.
    write(client, 0x0901, 3, unit=2)
    assert [read(client, 0x0900, unit=unit) for unit in (1, 2)] == [[1], [2]]


def test_unit_255_is_the_only_drive_on_tcp(emulate, connect):
    client = connect(emulate("yako-closed-loop", *PORTS["tcp"]).endpoint)
    assert read(client, 0x0023, unit=255) == [60]


def test_a_bench_with_two_vendors_on_one_line(emulate, connect, tmp_path):
    bench = tmp_path / "cell.yaml"
    bench.write_text(
        """\
seed: 7
lines:
  - name: cell
    pty: auto
    settings: 19200-8E1
    drives:
      - {unit: 1, model: hcfa-x, machine: {position: 14776585}}
      - {unit: 2, model: yako-closed-loop, set: {accel_time: 200}}
"""
    )
    emulator = emulate(bench)
    assert emulator.ready["seed"] == 7
    assert emulator.endpoint.line == "19200-8E1"
    client = connect(emulator.endpoint)
    assert read(client, 0x1507, 2, unit=1) == [0x7909, 0x00E1]
    assert read(client, 0x0021, unit=2) == [200]
    # Codes of the drives themselves: 19200 baud and 8E1.
    assert read(client, 0x0901, 2, unit=1) == [3, 1]
    assert read(client, 0x0014, 2, unit=2) == [2, 2]

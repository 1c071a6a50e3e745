"""libmodbus: the C library under most Linux masters, over RTU and Modbus TCP."""

import errno

import pytest

from libmodbus import Master, ModbusError

PORTS = {"rtu": ["--pty"], "tcp": ["--tcp", "127.0.0.1:0"]}


@pytest.fixture
def connect():
    """Opens a master at an endpoint; closed after the test."""
    opened = []

    def connect(endpoint, **kwargs):
        opened.append(Master(endpoint, **kwargs))
        return opened[-1]

    yield connect
    for master in opened:
        master.close()


@pytest.fixture(params=PORTS)
def master(request, emulate, connect):
    """Starts a model and gives a master to it, over each kind of port in turn."""
    return lambda model, *args: connect(emulate(model, *args, *PORTS[request.param]).endpoint)


def code(call, *args, **kwargs):
    """The exception code that a call is refused with."""
    with pytest.raises(ModbusError) as refused:
        call(*args, **kwargs)
    assert refused.value.code is not None, refused.value
    return refused.value.code


def test_hcfa(master):
    it = master("hcfa-x")
    it.write(0x0304, 150)
    assert it.read(0x0304) == [150]
    it.write(0x0806, 0x2710, 0x0000)
    assert it.read(0x0806, 2) == [0x2710, 0x0000]
    assert it.read(0x1507, 2) == [0, 0]
    assert code(it.write, 0x0806, 1) == 2
    assert code(it.write, 0x085C, 3001) == 3
    assert it.read(0x085C) == [500]


def test_k_series(master):
    it = master("k-series")
    for unit in (1, 2):
        it.unit = unit
        it.write(0x0130, 100 * unit)
    for unit in (1, 2):
        it.unit = unit
        assert it.read(0x0130) == [100 * unit]
    assert code(it.write, 0x0130, 1, 2) == 1
    assert len(it.read(0x0000, 20)) == 20
    assert code(it.read, 0x0000, 21) == 3
    assert code(it.write, 0x0064, 7) == 3


@pytest.mark.parametrize("model", ["yako-closed-loop", "yako-open-loop"])
def test_yako(master, model):
    it = master(model)
    assert code(it.read, 0x0004) == 3
    assert code(it.read, 0xFF00) == 4
    assert code(it.read, 0x0020, 17) == 5
    assert code(it.write, 0x0007, 0) == 6
    assert code(it.write, 0x0021, 2001) == 7
    it.write(0x0024, 0x0001, 0x86A0)
    it.write(0x0019, 1)
    assert it.read(0x0024, 2) == [0x86A0, 0x0001]


@pytest.mark.parametrize(("model", "refusal"), [("hcfa-x", 1), ("k-series", 1), ("yako-closed-loop", 2)])
def test_functions_that_the_drives_do_not_know(master, model, refusal):
    it = master(model)
    assert code(it.read, 0, table="input_registers") == refusal
    assert code(it.identify) == refusal
    assert code(it.mask, 0x0021, 0, 1) == refusal
    assert code(it.write_and_read, 0x0021, [1], 0x0021, 1) == refusal


def test_broadcast_is_executed_and_not_answered(emulate, connect):
    it = connect(emulate("k-series", "--pty").endpoint, unit=0, timeout=0.2)
    # libmodbus waits for an answer to a broadcast all the same.
    with pytest.raises(ModbusError) as silence:
        it.write(0x0130, 333)
    assert silence.value.errno == errno.ETIMEDOUT
    for unit in (1, 2):
        it.unit = unit
        assert it.read(0x0130) == [333]


def test_another_unit_is_silence(emulate, connect):
    it = connect(emulate("hcfa-x", "--pty").endpoint, unit=9, timeout=0.2)
    with pytest.raises(ModbusError) as silence:
        it.read(0x0304)
    assert silence.value.errno == errno.ETIMEDOUT
    it.unit = 1
    assert it.read(0x0304) == [100]


def test_reopening(emulate, connect):
    for port in PORTS.values():
        endpoint = emulate("yako-open-loop", *port).endpoint
        for value in (41, 42, 43):
            it = connect(endpoint)
            it.write(0x0021, value)
            assert it.read(0x0021) == [value]
            it.close()


def test_two_masters_at_once(emulate, connect):
    endpoint = emulate("hcfa-x", "--tcp", "127.0.0.1:0").endpoint
    one, other = connect(endpoint), connect(endpoint)
    for value in range(100):
        one.write(0x0304, value)
        assert other.read(0x0304) == [value]

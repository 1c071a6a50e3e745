"""minimalmodbus: what a Python script at a workbench does, in RTU and in ASCII."""

import minimalmodbus
import pytest
import serial
from minimalmodbus import (
    BYTEORDER_BIG,
    BYTEORDER_LITTLE_SWAP,
    IllegalRequestError,
    Instrument,
    NegativeAcknowledgeError,
    NoResponseError,
    SlaveDeviceBusyError,
)

# minimalmodbus has no word order as such: this is "low word first, each word high byte first".
LOW_WORD_FIRST = BYTEORDER_LITTLE_SWAP
HIGH_WORD_FIRST = BYTEORDER_BIG


class Masters:
    """Instruments on one serial port, one for each unit."""

    def __init__(self, endpoint, mode=minimalmodbus.MODE_RTU):
        self.port = serial.Serial(endpoint.path, timeout=0.5, **endpoint.serial_settings)
        self.mode = mode

    def __getitem__(self, unit):
        return Instrument(self.port, unit, self.mode)


@pytest.fixture
def masters():
    """Opens the port of an endpoint; closed after the test."""
    opened = []

    def connect(endpoint, mode=minimalmodbus.MODE_RTU):
        opened.append(Masters(endpoint, mode))
        return opened[-1]

    yield connect
    for it in opened:
        it.port.close()


@pytest.fixture
def hcfa(emulate, masters):
    return masters(emulate("hcfa-x", "--pty").endpoint)[1]


@pytest.fixture(params=["rtu", "ascii"])
def k_series(request, emulate, masters):
    """Both axes, in both framings."""
    if request.param == "rtu":
        return masters(emulate("k-series", "--pty").endpoint)
    return masters(emulate("k-series", "--pty", "--ascii").endpoint, minimalmodbus.MODE_ASCII)


@pytest.fixture
def yako(emulate, masters):
    return masters(emulate("yako-closed-loop", "--pty").endpoint)[1]


def test_hcfa_words(hcfa):
    hcfa.write_register(0x0304, 150, functioncode=6)
    assert hcfa.read_register(0x0304) == 150
    hcfa.write_registers(0x030E, [20, 30])
    assert hcfa.read_registers(0x030E, 2) == [20, 30]


def test_hcfa_pair_has_its_low_word_first(hcfa):
    hcfa.write_long(0x0806, -100_000, signed=True, byteorder=LOW_WORD_FIRST)
    assert hcfa.read_long(0x0806, signed=True, byteorder=LOW_WORD_FIRST) == -100_000
    assert hcfa.read_registers(0x0806, 2) == [-100_000 & 0xFFFF, -100_000 >> 16 & 0xFFFF]


def test_hcfa_pair_goes_whole_or_not_at_all(hcfa):
    with pytest.raises(IllegalRequestError, match="data address"):
        hcfa.read_register(0x0806)
    with pytest.raises(IllegalRequestError, match="data address"):
        hcfa.write_register(0x0807, 1, functioncode=6)
    assert hcfa.read_long(0x0806, byteorder=LOW_WORD_FIRST) == 0


def test_hcfa_position(hcfa):
    assert hcfa.read_long(0x1507, signed=True, byteorder=LOW_WORD_FIRST) == 0
    with pytest.raises(IllegalRequestError, match="data address"):
        hcfa.write_long(0x1507, 1, byteorder=LOW_WORD_FIRST)


@pytest.mark.parametrize("value", [0, 3001, 0xFFFF])
def test_hcfa_refuses_a_value_outside_its_range(hcfa, value):
    with pytest.raises(IllegalRequestError, match="data value"):
        hcfa.write_register(0x085C, value, functioncode=6)
    assert hcfa.read_register(0x085C) == 500


def test_hcfa_refuses_a_block_as_a_whole(hcfa):
    # P08.92, P08.93, P08.94: the second value is too large.
    with pytest.raises(IllegalRequestError, match="data value"):
        hcfa.write_registers(0x085C, [600, 301, 2000])
    assert hcfa.read_registers(0x085C, 3) == [500, 50, 1000]


def test_k_series_has_two_stations(k_series):
    k_series[1].write_register(0x0130, 111, functioncode=6)
    k_series[2].write_register(0x0130, 222, functioncode=6)
    assert [k_series[unit].read_register(0x0130) for unit in (1, 2)] == [111, 222]
    assert [k_series[unit].read_register(0x0259) for unit in (1, 2)] == [1, 2]


def test_k_series_knows_no_fc16(k_series):
    with pytest.raises(IllegalRequestError, match="function"):
        k_series[1].write_registers(0x0130, [1, 2])


def test_k_series_reads_twenty_words(k_series):
    assert len(k_series[1].read_registers(0x0000, 20)) == 20
    with pytest.raises(IllegalRequestError, match="data value"):
        k_series[1].read_registers(0x0000, 21)


def test_k_series_refuses_as_printed(k_series):
    with pytest.raises(IllegalRequestError, match="data value"):
        k_series[1].write_register(0x0064, 7, functioncode=6)
    with pytest.raises(IllegalRequestError, match="data address"):
        k_series[1].read_register(0x0700)


def test_broadcast_is_executed_and_not_answered(k_series):
    k_series[0].write_register(0x0130, 333, functioncode=6)
    # minimalmodbus has waited its broadcast delay; an answer would be here by now.
    assert k_series.port.in_waiting == 0
    assert [k_series[unit].read_register(0x0130) for unit in (1, 2)] == [333, 333]


def test_a_refused_broadcast_is_not_answered_either(k_series):
    k_series[0].write_register(0x0064, 7, functioncode=6)
    assert k_series.port.in_waiting == 0
    assert [k_series[unit].read_register(0x0064) for unit in (1, 2)] == [0, 0]


def test_another_unit_is_silence(k_series):
    with pytest.raises(NoResponseError):
        k_series[3].read_register(0x0130)


def test_ascii_with_seven_bits(emulate, masters):
    endpoint = emulate("k-series", "--pty", "--ascii", "-d", 7, "-P", "even", "-s", 1).endpoint
    assert endpoint.line.endswith("-7E1")
    master = masters(endpoint, minimalmodbus.MODE_ASCII)[1]
    master.write_register(0x0130, 0xCAFE, functioncode=6)
    assert master.read_register(0x0130) == 0xCAFE


def test_yako_answers_with_its_own_numbers(yako):
    # The texts are those of the standard numbers: 03, 06 and 07 mean other things to this drive.
    with pytest.raises(IllegalRequestError, match="data value"):
        yako.read_register(0x0004)  # 03: a hole
    with pytest.raises(SlaveDeviceBusyError):
        yako.write_register(0x0007, 1, functioncode=6)  # 06: read only
    with pytest.raises(NegativeAcknowledgeError):
        yako.write_register(0x0021, 2001, functioncode=6)  # 07: outside its range
    assert yako.read_register(0x0021) == 100


def test_yako_turns_its_words_round(yako):
    yako.write_long(0x0024, -70_000, signed=True, byteorder=HIGH_WORD_FIRST)
    yako.write_register(0x0019, 1, functioncode=6)
    assert yako.read_long(0x0024, signed=True, byteorder=LOW_WORD_FIRST) == -70_000


def test_the_port_can_be_opened_again(emulate, masters):
    endpoint = emulate("yako-open-loop", "--pty").endpoint
    for value in (41, 42, 43):
        master = masters(endpoint)
        master[1].write_register(0x0021, value, functioncode=6)
        assert master[1].read_register(0x0021) == value
        master.port.close()

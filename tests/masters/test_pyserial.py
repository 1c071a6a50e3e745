"""pyserial and plain sockets: bytes that no master library would send, and how the line takes them."""

import os
import pty
import socket
import tty

import pytest
import serial

from emulator import crc16, until

# Longer than the silence that ends a frame, and than anything the emulator takes to answer.
SILENCE = 0.2


def frame(text):
    """Hex digits, with the CRC that belongs behind them."""
    body = bytes.fromhex(text)
    return body + crc16(body)


def broken(text):
    """The same with a CRC that does not."""
    good = frame(text)
    return good[:-1] + bytes([good[-1] ^ 0x01])


class Wire:
    """A serial port that tells silence from an answer."""

    def __init__(self, endpoint):
        self.port = serial.Serial(endpoint.path, timeout=2, **endpoint.serial_settings)

    def ask(self, request, answer):
        self.port.write(request)
        assert self.port.read(len(answer)).hex(" ") == answer.hex(" ")

    def ask_in_vain(self, request):
        self.port.write(request)
        self.is_silent()

    def is_silent(self):
        self.port.timeout = SILENCE
        assert self.port.read(1) == b""
        self.port.timeout = 2


@pytest.fixture
def wire():
    """Opens the port of an endpoint; closed after the test."""
    wires = []

    def connect(emulator):
        wires.append(Wire(emulator.endpoint))
        return wires[-1]

    yield connect
    for it in wires:
        it.port.close()


# Frames of the manual, request and answer.
PRINTED = [
    ("01 06 03 04 00 64 C9 A4", "01 06 03 04 00 64 C9 A4"),
    ("01 10 08 06 00 02 04 27 10 00 00 1F 34", "01 10 08 06 00 02 A3 A9"),
    ("01 03 15 01 00 01 D1 C6", "01 03 02 00 00 B8 44"),
    ("01 06 09 05 00 02 1B 96", "01 06 09 05 00 02 1B 96"),
]


@pytest.mark.parametrize(("request_", "answer"), PRINTED)
def test_printed_frames(emulate, wire, request_, answer):
    wire(emulate("hcfa-x", "--pty")).ask(bytes.fromhex(request_), bytes.fromhex(answer))


@pytest.mark.parametrize("model", ["yako-closed-loop", "yako-open-loop"])
def test_yako_answers_a_wrong_crc(emulate, wire, model):
    emulator = emulate(model, "--pty")
    line = wire(emulator)
    line.ask(broken("01 03 00 20 00 01"), frame("01 83 01"))
    emulator.logged(r"CRC.*exception 01")
    line.ask(broken("01 06 00 21 00 C8"), frame("01 86 01"))
    line.ask(frame("01 03 00 21 00 01"), frame("01 03 02 00 64"))
    # Somebody else's broken frame is not ours to answer.
    line.ask_in_vain(broken("02 03 00 20 00 01"))


@pytest.mark.parametrize(
    "args", [["hcfa-x"], ["k-series"], ["yako-closed-loop", "--set", "crc_error=silent"]]
)
def test_others_do_not(emulate, wire, args):
    emulator = emulate(*args, "--pty")
    line = wire(emulator)
    line.ask_in_vain(broken("01 03 00 20 00 01"))
    emulator.logged(r"CRC.*no reply")
    # And the line is in order afterwards: function 17 is known to none of them.
    refusal = "01 91 02" if "yako" in args[0] else "01 91 01"
    line.ask(frame("01 11"), frame(refusal))


def test_k_series_ascii_checksum(emulate, wire):
    emulator = emulate("k-series", "--pty", "--ascii")
    line = wire(emulator)
    line.ask(b":010301300001CA\r\n", b":01030201F405\r\n")
    line.ask_in_vain(b":010301300001CB\r\n")
    emulator.logged(r"LRC")
    # A colon begins a frame whatever came before.
    line.ask(b":0103013:010301300001CA\r\n", b":01030201F405\r\n")


def test_a_frame_byte_by_byte(emulate, wire):
    line = wire(emulate("hcfa-x", "--pty"))
    for byte in frame("01 03 03 04 00 01"):
        line.port.write(bytes([byte]))
        line.port.flush()
    assert line.port.read(7) == frame("01 03 02 00 64")


def test_noise_goes_down_with_its_silence(emulate, wire):
    line = wire(emulate("hcfa-x", "--pty"))
    line.ask_in_vain(bytes.fromhex("FF 00 FF"))
    line.ask(frame("01 03 03 04 00 01"), frame("01 03 02 00 64"))


def test_the_traffic_of_others_is_followed(emulate, wire):
    emulator = emulate("hcfa-x", "--pty")
    line = wire(emulator)
    # Unit 2 is asked and answers; its answer is no request to anybody.
    line.ask_in_vain(frame("02 03 03 04 00 01"))
    line.ask_in_vain(frame("02 03 02 00 64"))
    line.ask(frame("01 03 03 04 00 01"), frame("01 03 02 00 64"))


def test_an_answer_leaves_in_one_piece(emulate):
    endpoint = emulate("hcfa-x", "--rtu-over-tcp", "127.0.0.1:0").endpoint
    with socket.create_connection((endpoint.host, endpoint.port), timeout=2) as client:
        client.sendall(frame("01 03 08 5C 00 03"))
        assert client.recv(1024) == frame("01 03 06 01 F4 00 32 03 E8")


def test_modbus_tcp_keeps_transactions_apart(emulate):
    endpoint = emulate("hcfa-x", "--tcp", "127.0.0.1:0").endpoint
    with socket.create_connection((endpoint.host, endpoint.port), timeout=2) as client:
        ask = "00 00 00 06 01 03 03 04 00 01"
        client.sendall(bytes.fromhex(f"12 34 {ask} AB CD {ask}"))
        answer = "00 00 00 05 01 03 02 00 64"
        expected = bytes.fromhex(f"12 34 {answer} AB CD {answer}")
        got = b""
        while len(got) < len(expected):
            got += client.recv(1024)
        assert got == expected


def test_modbus_tcp_hangs_up_on_another_protocol(emulate):
    emulator = emulate("hcfa-x", "--tcp", "127.0.0.1:0")
    endpoint = emulator.endpoint
    with socket.create_connection((endpoint.host, endpoint.port), timeout=2) as client:
        client.sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert client.recv(1024) == b""
    with socket.create_connection((endpoint.host, endpoint.port), timeout=2) as client:
        client.sendall(bytes.fromhex("00 01 00 00 00 06 01 03 03 04 00 01"))
        assert client.recv(1024)


def test_a_real_port(emulate):
    """Another program's pseudo-terminal stands for a real serial port."""
    master, slave = pty.openpty()
    try:
        tty.setraw(master)
        device = os.ttyname(slave)
        emulator = emulate("yako-closed-loop", "--serial", device)
        assert emulator.endpoint.kind == "serial"
        assert emulator.endpoint.path == device
        assert emulator.endpoint.line == "115200-8N1"
        os.write(master, frame("01 03 00 23 00 01"))
        os.set_blocking(master, False)
        got = bytearray()

        def answered():
            try:
                got.extend(os.read(master, 256))
            except BlockingIOError:
                pass
            return len(got) >= 7

        until("an answer", answered)
        assert bytes(got) == frame("01 03 02 00 3C")
        emulator.stop()
    finally:
        os.close(master)
        os.close(slave)


def test_an_unplugged_port(emulate):
    master, slave = pty.openpty()
    device = os.ttyname(slave)
    emulator = emulate("yako-closed-loop", "--serial", device)
    os.close(master)
    os.close(slave)
    # It says so, and waits for the port to come back.
    until("a word about it", lambda: device in emulator.diagnostics.split("\n", 1)[-1])
    assert emulator.process.poll() is None

"""The wire as it is between programs: what one leaves behind, who has locked it, what others say, where it tears."""

import fcntl
import os
import shutil
import socket
import struct
import subprocess
import termios
import time

import pytest
import serial

from emulator import NO_ENDPOINT, drivemu, refused, until
from test_mbpoll import mbpoll, values
from test_pyserial import frame

JOG_SPEED = 0x0304


def waiting(fd):
    """Bytes that wait to be read."""
    return struct.unpack("i", fcntl.ioctl(fd, termios.FIONREAD, bytes(4)))[0]


def opened(endpoint, **kwargs):
    return serial.Serial(endpoint.path, timeout=2, **endpoint.serial_settings, **kwargs)


def test_the_next_program_does_not_get_the_last_ones_answer(emulate):
    endpoint = emulate("hcfa-x", "--pty").endpoint
    # Not by pyserial, which would clean up by itself.
    terminal = os.open(endpoint.path, os.O_RDWR | os.O_NOCTTY)
    os.write(terminal, frame("01 03 08 5C 00 01"))
    until("the answer", lambda: waiting(terminal) == 7)
    os.close(terminal)
    assert values(mbpoll(endpoint, "-r", JOG_SPEED)) == {"772": "100"}


def test_nor_what_was_held_back_for_it(emulate):
    emulator = emulate("hcfa-x", "--pty", "--fault", "delay:ms=300,count=1")
    endpoint = emulator.endpoint
    terminal = os.open(endpoint.path, os.O_RDWR | os.O_NOCTTY)
    os.write(terminal, frame("01 03 08 5C 00 01"))
    emulator.logged(r"fault delay")
    os.close(terminal)
    with opened(endpoint) as port:
        port.write(frame("01 03 03 04 00 01"))
        assert port.read(7) == frame("01 03 02 00 64")
        # Longer than the delay.
        port.timeout = 0.5
        assert port.read(1) == b""


@pytest.mark.parametrize("function", ["09 08 00 00 12 34", "09 41 01 02 03", "09 2B 0E 01 00", "00 08 00 01 00 00"])
def test_a_request_behind_a_function_without_a_length(emulate, function):
    with opened(emulate("hcfa-x", "--pty").endpoint) as port:
        for pause in (0, 0.001, 0.005):
            port.write(frame(function))
            time.sleep(pause)
            port.write(frame("01 03 03 04 00 01"))
            assert port.read(7) == frame("01 03 02 00 64"), pause


def may_open(path):
    """May a program without special rights open it? Root opens what is locked, so it gives that up."""
    command = ["sh", "-c", ": <> $0", path]
    if os.geteuid() == 0:
        if not shutil.which("setpriv"):
            pytest.skip("root opens whatever is locked, and there is no setpriv")
        command = ["setpriv", "--bounding-set=-sys_admin", "--inh-caps=-sys_admin", *command]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 0 or "busy" in done.stderr, done.stderr
    return done.returncode == 0


def test_a_lock_lives_as_long_as_its_holder(emulate):
    endpoint = emulate("hcfa-x", "--pty").endpoint
    with opened(endpoint) as port:
        fcntl.ioctl(port.fileno(), termios.TIOCEXCL)
        port.write(frame("01 03 03 04 00 01"))
        assert port.read(7) == frame("01 03 02 00 64")
        assert not may_open(endpoint.path)
    until("the lock to go", lambda: may_open(endpoint.path))


def test_a_program_that_was_killed_before_it_sent_a_byte_locks_nobody_out(emulate):
    endpoint = emulate("hcfa-x", "--pty").endpoint
    lock = (
        "import fcntl, os, sys, termios, time\n"
        "port = os.open(sys.argv[1], os.O_RDWR | os.O_NOCTTY)\n"
        "fcntl.ioctl(port, termios.TIOCEXCL)\n"
        "print('locked', flush=True)\n"
        "time.sleep(60)\n"
    )
    command = ["python3", "-c", lock, endpoint.path]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout.readline() == "locked\n"
        assert not may_open(endpoint.path)
        holder.kill()
    until("the lock to go", lambda: may_open(endpoint.path))
    assert values(mbpoll(endpoint, "-r", JOG_SPEED)) == {"772": "100"}


def test_an_adapter_tears_short_answers(emulate, tmp_path):
    bench = tmp_path / "bench.yaml"
    bench.write_text("lines: [{pty: auto, chunk: 16ms, pacing: line, drives: [{model: hcfa-x}]}]")
    endpoint = emulate(bench, "--seed", 1).endpoint
    with opened(endpoint) as port:
        firsts = set()
        for count in range(40):
            # The pause moves the request against the timer of the adapter.
            time.sleep(count % 16 / 1000)
            port.write(frame("01 03 03 04 00 01"))
            answer = port.read(1)
            answer += port.read(waiting(port.fileno()))
            firsts.add(len(answer))
            answer += port.read(7 - len(answer))
            assert answer == frame("01 03 02 00 64")
    assert 7 in firsts and len(firsts) > 2, firsts


def test_the_link_of_a_living_run_is_not_taken(emulate, tmp_path):
    link = tmp_path / "drive.tty"
    emulate("hcfa-x", "--pty", link)
    target = os.readlink(link)
    assert "used by a running drivemu" in refused(drivemu("run", "k-series", "--pty", link), NO_ENDPOINT)
    assert os.readlink(link) == target


def test_a_speed_scan_finds_the_drive_at_one_speed(emulate):
    endpoint = emulate("hcfa-x", "--pty", "--match-baud").endpoint
    found = []
    for baud in (4800, 9600, 19200, 38400, 57600, 115200):
        with serial.Serial(endpoint.path, baud, stopbits=2, timeout=0.2) as port:
            port.write(frame("01 03 03 04 00 01"))
            if port.read(7):
                found.append(baud)
    assert found == [9600]


def test_a_read_of_unit_0_over_tcp(emulate):
    endpoint = emulate("hcfa-x", "--tcp", "127.0.0.1:0").endpoint
    with socket.create_connection((endpoint.host, endpoint.port), timeout=2) as client:
        client.sendall(bytes.fromhex("00 01 00 00 00 06 00 03 03 04 00 01"))
        assert client.recv(100) == bytes.fromhex("00 01 00 00 00 05 00 03 02 00 64")

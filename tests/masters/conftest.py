"""Starts the built program for every test and shows its log when the test fails.

The program is the one that the environment variable DRIVEMU names, else target/debug/drivemu.
"""

import contextlib
import socket

import minimalmodbus
import pytest
import serial

from emulator import BINARY, Emulator


def pytest_report_header():
    return f"drivemu: {BINARY}"


def pytest_sessionstart():
    if not BINARY.is_file():
        pytest.exit(f"no program at {BINARY}: run `cargo build` or set DRIVEMU", returncode=2)


@pytest.fixture
def emulate(request, tmp_path):
    """Starts emulators: `emulate("hcfa-x", "--tcp", "127.0.0.1:0")`. All are stopped after the test."""
    running = request.node.emulators = []
    with contextlib.ExitStack() as at_the_end:

        def start(*args):
            emulator = Emulator(tmp_path / f"run-{len(running)}", *args)
            at_the_end.callback(emulator.kill)
            at_the_end.callback(emulator.stop)
            running.append(emulator)
            return emulator

        yield start


@pytest.fixture
def instrument():
    """Talks to a unit at an endpoint by minimalmodbus; its port is closed after the test."""
    with contextlib.ExitStack() as at_the_end:

        def connect(endpoint, unit=1, path=None):
            settings = endpoint.serial_settings
            port = serial.Serial(str(path or endpoint.path), timeout=0.5, **settings)
            return minimalmodbus.Instrument(at_the_end.enter_context(port), unit)

        yield connect


@pytest.fixture
def busy_port():
    """A TCP port that somebody else listens on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item):
    report = yield
    if report.failed:
        for emulator in getattr(item, "emulators", []):
            report.sections.append(("drivemu", emulator.transcript))
    return report

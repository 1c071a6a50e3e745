"""A running `drivemu`, and the waiting that tests do: always for something, never for a while."""

import json
import os
import re
import signal
import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
BINARY = Path(os.environ.get("DRIVEMU", REPOSITORY / "target/debug/drivemu")).resolve()

MODELS = ["hcfa-x", "k-series", "yako-closed-loop", "yako-open-loop"]

# Exit codes.
FAILED, USAGE, NO_ENDPOINT = 1, 2, 3

# Generous, since nothing waits this long unless something is broken.
DEADLINE = 10.0


def until(what, condition, deadline=DEADLINE):
    """Polls `condition` until it gives something true, and returns that."""
    end = time.monotonic() + deadline
    while True:
        got = condition()
        if got:
            return got
        assert time.monotonic() < end, f"waited {deadline} s for {what}"
        time.sleep(0.005)


def crc16(data):
    """CRC-16 as Modbus has it, written once more so that nothing under test vouches for itself."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0xA001 if crc & 1 else 0)
    return crc.to_bytes(2, "little")


@dataclass(frozen=True)
class Endpoint:
    """Where masters reach a line, as the ready file says."""

    kind: str
    name: str
    framing: str
    units: list
    path: str = None
    link: str = None
    addr: str = None
    line: str = None

    @property
    def host(self):
        return self.addr.rsplit(":", 1)[0]

    @property
    def port(self):
        return int(self.addr.rsplit(":", 1)[1])

    @property
    def serial_settings(self):
        """What to open the port with, as pyserial, and everything built on it, names it.

        A pseudo-terminal has neither parity nor seven data bits, and glibc refuses settings that differ
        from the present ones in nothing else.
        """
        baud, (bytesize, parity, stopbits) = self.line.split("-")
        if self.kind == "pty":
            bytesize, parity = 8, "N"
        return {
            "baudrate": int(baud),
            "bytesize": int(bytesize),
            "parity": parity,
            "stopbits": int(stopbits),
        }


class Emulator:
    """`drivemu run` in the background. Its standard output is the event log."""

    def __init__(self, directory, *args):
        directory.mkdir(parents=True)
        self._stdout, self._stderr = directory / "stdout", directory / "stderr"
        ready = directory / "ready.json"
        self.command = [str(BINARY), "run", *map(str, args), "--ready-file", str(ready)]
        with self._stdout.open("wb") as out, self._stderr.open("wb") as err:
            self.process = subprocess.Popen(
                self.command, cwd=directory, stdin=subprocess.DEVNULL, stdout=out, stderr=err
            )
        try:
            until("the ready file", lambda: ready.exists() or self.process.poll() is not None)
        except AssertionError:
            self.kill()
            raise
        assert ready.exists(), f"ended with {self.process.returncode}\n{self.transcript}"
        # Written atomically: where it is, it is whole.
        self.ready = json.loads(ready.read_text())

    @property
    def endpoint(self):
        (only,) = self.ready["endpoints"]
        return Endpoint(**only)

    @property
    def log(self):
        return self._stdout.read_text()

    @property
    def diagnostics(self):
        return self._stderr.read_text()

    @property
    def transcript(self):
        return f"$ {' '.join(self.command)}\n{self.diagnostics}{self.log}"

    def logged(self, pattern):
        """Waits for a line of the log that matches, and returns it."""

        def find():
            return next((line for line in self.log.splitlines() if re.search(pattern, line)), None)

        return until(f"a log line /{pattern}/", find)

    def signal(self, number):
        """Sends a signal and returns the exit code."""
        self.process.send_signal(number)
        return self.process.wait(DEADLINE)

    def stop(self):
        """Ends the run as a service manager does, unless it has ended, and holds it to its promise."""
        if self.process.poll() is None:
            self.signal(signal.SIGTERM)
        assert "panicked" not in self.diagnostics
        assert self.process.returncode == 0, f"ended with {self.process.returncode}"

    def kill(self):
        self.process.kill()
        self.process.wait(DEADLINE)


def drivemu(*args, **kwargs):
    """Runs a command that ends by itself."""
    return subprocess.run(
        [str(BINARY), *map(str, args)],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        **kwargs,
    )


def refused(done, code):
    """The diagnostics of a command that could not do what it was asked to."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert "panicked" not in done.stderr
    return done.stderr

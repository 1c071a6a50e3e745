"""The C library libmodbus, called through ctypes: every call that fails raises with its errno."""

import ctypes
import ctypes.util
import os

LIBRARY = ctypes.util.find_library("modbus")
assert LIBRARY, "libmodbus is not installed: apt-get install libmodbus-dev"
C = ctypes.CDLL(LIBRARY, use_errno=True)
C.modbus_new_rtu.restype = C.modbus_new_tcp.restype = ctypes.c_void_p
C.modbus_new_rtu.argtypes = [ctypes.c_char_p, ctypes.c_int, ctypes.c_char, ctypes.c_int, ctypes.c_int]
C.modbus_strerror.restype = ctypes.c_char_p

# modbus.h: exception codes of the other side, then errors of its own.
EXCEPTION = 112345678


class ModbusError(OSError):
    """A call failed; `code` is the exception code, if the other side sent one."""

    @property
    def code(self):
        return self.errno - EXCEPTION if EXCEPTION < self.errno <= EXCEPTION + 11 else None


class Master:
    """A `modbus_t`, connected."""

    def __init__(self, endpoint, unit=1, timeout=2.0):
        if endpoint.kind == "tcp":
            self.context = C.modbus_new_tcp(endpoint.host.encode(), endpoint.port)
        else:
            it = endpoint.serial_settings
            settings = it["baudrate"], it["parity"].encode(), it["bytesize"], it["stopbits"]
            self.context = C.modbus_new_rtu(endpoint.path.encode(), *settings)
        assert self.context
        self.unit = unit
        self.call("set_response_timeout", int(timeout), int(timeout % 1 * 1_000_000))
        self.call("connect")

    @property
    def unit(self):
        return self.call("get_slave")

    @unit.setter
    def unit(self, unit):
        self.call("set_slave", unit)

    def read(self, address, count=1, table="registers"):
        words = (ctypes.c_uint16 * count)()
        assert self.call(f"read_{table}", address, count, words) == count
        return list(words)

    def write(self, address, *words):
        if len(words) == 1:
            self.call("write_register", address, words[0])
        else:
            self.call("write_registers", address, len(words), (ctypes.c_uint16 * len(words))(*words))

    def write_and_read(self, write_at, words, read_at, count):
        """Function 23."""
        answer = (ctypes.c_uint16 * count)()
        sent = (ctypes.c_uint16 * len(words))(*words)
        self.call("write_and_read_registers", write_at, len(words), sent, read_at, count, answer)
        return list(answer)

    def mask(self, address, and_mask, or_mask):
        """Function 22."""
        self.call("mask_write_register", address, and_mask, or_mask)

    def identify(self):
        """Function 17."""
        answer = ctypes.create_string_buffer(260)
        self.call("report_slave_id", len(answer), answer)

    def close(self):
        if self.context:
            C.modbus_close(ctypes.c_void_p(self.context))
            C.modbus_free(ctypes.c_void_p(self.context))
        self.context = None

    def call(self, name, *args):
        result = getattr(C, f"modbus_{name}")(ctypes.c_void_p(self.context), *args)
        if result == -1:
            number = ctypes.get_errno() or os.EX_SOFTWARE
            raise ModbusError(number, f"{name}: {C.modbus_strerror(number).decode()}")
        return result

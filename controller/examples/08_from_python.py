"""The same as 07_from_c.c in Python, with the shared library and nothing else:

    python3 08_from_python.py libgauntlet_controller.so tuned.robot.txt < samples.txt
"""
import ctypes
import sys

EVENT = 1


def load_library(name):
    library = ctypes.CDLL(name)
    handle, size = ctypes.c_void_p, ctypes.c_size_t
    counts, motors = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(ctypes.c_int32)
    for function, result, *arguments in [
        ("create", handle, ctypes.c_char_p, size, ctypes.c_char_p, size),
        ("destroy", None, handle),
        ("channel_count", size, handle),
        ("motor_count", size, handle),
        ("tick_rate_hz", ctypes.c_double, handle),
        ("ticks_per_sample", ctypes.c_int, handle),
        ("step", ctypes.c_int, handle, counts, size, motors, size),
        ("reset", ctypes.c_int, handle, motors, size),
    ]:
        declared = getattr(library, "gauntlet_controller_" + function)
        declared.restype, declared.argtypes = result, arguments
    return library


class Controller:
    def __init__(self, library, settings):
        self._library = library
        error = ctypes.create_string_buffer(200)
        self._handle = library.gauntlet_controller_create(
            settings, len(settings), error, len(error))
        if not self._handle:
            raise ValueError(error.value.decode())
        self.channel_count = library.gauntlet_controller_channel_count(self._handle)
        self.motor_count = library.gauntlet_controller_motor_count(self._handle)
        self.ticks_per_sample = library.gauntlet_controller_ticks_per_sample(self._handle)
        self._counts = (ctypes.c_double * self.channel_count)()
        self._motors = (ctypes.c_int32 * self.motor_count)()

    def __del__(self):
        if getattr(self, "_handle", None):
            self._library.gauntlet_controller_destroy(self._handle)

    def reset(self, motor_counts):
        self._motors[:] = motor_counts
        self._library.gauntlet_controller_reset(self._handle, self._motors, self.motor_count)

    def step(self, counts=None):
        """One tick, with a new sample of the glove or without one; the command if one is due."""
        if counts is not None:
            self._counts[:] = counts
        result = self._library.gauntlet_controller_step(
            self._handle, self._counts if counts is not None else None,
            self.channel_count if counts is not None else 0, self._motors, self.motor_count)
        return list(self._motors) if result == EVENT else None


def main(library_name, settings_name):
    with open(settings_name, "rb") as file:
        controller = Controller(load_library(library_name), file.read())
    numbers = iter(sys.stdin.read().split())
    controller.reset([int(next(numbers)) for _ in range(controller.motor_count)])
    samples = list(map(float, numbers))  # read your glove here
    n, every = controller.channel_count, controller.ticks_per_sample
    for row in range(len(samples) // n):
        for tick in range(row * every, (row + 1) * every):
            fresh = tick % every == 0
            command = controller.step(samples[row * n:(row + 1) * n] if fresh else None)
            if command is not None:
                print(tick, *command)  # send them here


if __name__ == "__main__":
    main(*sys.argv[1:])

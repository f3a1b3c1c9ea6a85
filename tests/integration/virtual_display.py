# SPDX-License-Identifier: Apache-2.0
"""A graphical session without a monitor: an X server (Xvfb), a pointer in it (xdotool), and what its screen shows.

The screen is read from the server's own framebuffer file (`-fbdir`, format xwd), so no tool for screenshots is needed.
"""
import os
import pathlib
import shutil
import socket
import struct
import subprocess
import tempfile
import zlib

TOOLS = ("Xvfb", "xdotool")
COLUMNS, ROWS = 1280, 1024
KEPT = os.environ.get("STILLHAND_SCREENSHOTS")  # folder for pictures of the screen
# Of the X protocol, version 11.
INTERN_ATOM, SEND_EVENT, CLIENT_MESSAGE = 16, 25, 33


def missing_tools():
    return [tool for tool in TOOLS if shutil.which(tool) is None]


class VirtualDisplay:
    """One X server on a free display, ended by close()."""

    def __init__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="stillhand-screen-")
        number, write_end = os.pipe()
        self._server = subprocess.Popen(
            # Without -noreset a server resets when its last client leaves, and refuses new clients meanwhile.
            ["Xvfb", "-displayfd", str(write_end), "-screen", "0", f"{COLUMNS}x{ROWS}x24", "-fbdir", self._folder.name,
             "-nolisten", "tcp", "-noreset"], pass_fds=(write_end,), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(write_end)
        with os.fdopen(number) as pipe:
            self.number = pipe.readline().strip()  # "" when the server ended instead
        if not self.number:
            self.close()
            raise AssertionError("Xvfb did not start")
        self._framebuffer = pathlib.Path(self._folder.name) / "Xvfb_screen0"

    @property
    def environment(self):
        return {**os.environ, "DISPLAY": f":{self.number}"}

    def xdotool(self, *words):
        """Runs xdotool to its end; its output, empty when it found nothing."""
        ended = subprocess.run(["xdotool", *(str(word) for word in words)], env=self.environment, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False)
        return ended.stdout

    def window(self, title):
        """Number of the visible window with a title, None while there is none."""
        found = self.xdotool("search", "--onlyvisible", "--name", title).split()
        return int(found[0]) if found else None

    def geometry(self, window):
        """Left, upper edge, width and height of a window [px]."""
        words = dict(line.split("=") for line in self.xdotool("getwindowgeometry", "--shell", window).splitlines())
        return tuple(int(words[name]) for name in ("X", "Y", "WIDTH", "HEIGHT"))

    def pixels(self, row):
        """Brightness of a row of the screen, 0 to 255: the green of each pixel."""
        with self._framebuffer.open("rb") as file:
            first, bytes_per_line = self._rows(file)
            file.seek(first + row * bytes_per_line)
            return file.read(4 * COLUMNS)[1::4]  # blue, green, red, nothing

    @staticmethod
    def _rows(file):
        """Where the first row begins, and the length of each [bytes]."""
        header = struct.unpack(">25I", file.read(100))
        header_size, bits_per_pixel, bytes_per_line, colours = header[0], header[11], header[12], header[19]
        assert bits_per_pixel == 32
        return header_size + 12 * colours, bytes_per_line

    def picture(self, columns, rows):
        """Brightness of the upper left part of the screen, row by row; read at once, so that it is mostly one frame."""
        with self._framebuffer.open("rb") as file:
            first, line = self._rows(file)
            file.seek(first)
            pixels = file.read(rows * line)
        return [pixels[row * line:row * line + 4 * columns][1::4] for row in range(rows)]

    def keep(self, name, columns, rows):
        """Saves the upper left part of the screen as a picture (PNG), if STILLHAND_SCREENSHOTS is set."""
        if not KEPT:
            return
        folder = pathlib.Path(KEPT)
        folder.mkdir(parents=True, exist_ok=True)
        grey = b"".join(b"\0" + row for row in self.picture(columns, rows))  # the first byte of each row: no filter

        def part(kind, content):
            return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
        header = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
        (folder / f"{name}.png").write_bytes(b"\x89PNG\r\n\x1a\n" + part(b"IHDR", header) +
                                             part(b"IDAT", zlib.compress(grey)) + part(b"IEND", b""))

    def press_close_button(self, window):
        """Asks a window to close, as a window manager does when its button is pressed (ICCCM, WM_DELETE_WINDOW)."""
        with socket.socket(socket.AF_UNIX) as connection:
            connection.connect(f"/tmp/.X11-unix/X{self.number}")
            connection.sendall(struct.pack("<BxHHHHxx", ord("l"), 11, 0, 0, 0))
            accepted, _, _, _, length = struct.unpack("<BBHHH", _received(connection, 8))
            _received(connection, 4 * length)
            assert accepted == 1
            protocols, delete = (self._atom(connection, name) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
            event = struct.pack("<BBHII5I", CLIENT_MESSAGE, 32, 0, window, protocols, delete, 0, 0, 0, 0)
            connection.sendall(struct.pack("<BBHII", SEND_EVENT, 0, 11, window, 0) + event)
            self._atom(connection, b"WM_PROTOCOLS")  # answered after the event was passed on

    @staticmethod
    def _atom(connection, name):
        padded = name + bytes(-len(name) % 4)
        connection.sendall(struct.pack("<BBHHxx", INTERN_ATOM, 0, 2 + len(padded) // 4, len(name)) + padded)
        return struct.unpack("<8xI20x", _received(connection, 32))[0]

    def close(self):
        self._server.terminate()
        self._server.wait()
        self._folder.cleanup()


def _received(connection, count):
    answer = b""
    while len(answer) < count:
        part = connection.recv(count - len(answer))
        assert part, "the X server hung up"
        answer += part
    return answer

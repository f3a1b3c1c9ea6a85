# SPDX-License-Identifier: Apache-2.0
"""IIO accelerometers and a bridge ADC that are not there, served by Debian's own iiod.

A folder stands for the kernel: its `bus` is what iiod sees as /sys/bus, its `dev` as /dev, in a mount namespace of its
own. A FIFO is the buffer of each device; who writes samples into it is the device.
"""
import os
import pathlib
import shutil
import signal
import socket
import subprocess

from waiting import wait_for

IIOD = "/usr/sbin/iiod"
START_LIMIT_S = 10.0
# Name of each device, its channels, their format, and what one count is: m/s^2 for an acceleration, mV for a voltage
# (Linux, Documentation/ABI/testing/sysfs-bus-iio).
DEVICES = {"accelerometer": (["accel_y"], "le:s20/32>>12", 3.9e-5), "bridge": (["voltage0"], "le:s24/32>>8", 2.5e-4),
           "three_axes": (["accel_x", "accel_y", "accel_z"], "le:s20/32>>12", 3.9e-5)}
MOUNTED = """
set -e
mount --bind "$1/bus" /sys/bus
touch "$1/dev/null"
mount --bind /dev/null "$1/dev/null"
mount --rbind "$1/dev" /dev
exec $4 "$2" -p "$3"
"""


def missing():
    """Why there is no IIO context here, or ""."""
    if not pathlib.Path(IIOD).is_file():
        return f"no {IIOD}"
    tried = subprocess.run([*unshare(), "mount", "--bind", "/tmp", "/sys/bus"], capture_output=True, text=True, check=False)
    return f"no mount namespace: {tried.stderr.strip()}" if tried.returncode != 0 else ""


def unshare():
    return ["unshare", "--mount"] + (["--map-root-user"] if os.geteuid() != 0 else [])


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class IioContext:
    """iiod and the devices that it serves. `fifos` are the places of their samples, 4 bytes each, little-endian."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.fifos = {}
        for number, (name, (channels, form, scale)) in enumerate(DEVICES.items()):
            self._device(number, name, channels, form, scale)
        self.port = free_port()
        self.uri = f"ip:127.0.0.1:{self.port}"
        self.begin()

    def _device(self, number, name, channels, form, scale):
        device = self.folder / "bus" / "iio" / "devices" / f"iio:device{number}"
        for part in ("scan_elements", "buffer"):
            (device / part).mkdir(parents=True)
        files = {"name": name, "sampling_frequency": 1000, "buffer/enable": 0, "buffer/length": 128,
                 "buffer/watermark": 1, "buffer/data_available": 0}
        for index, channel in enumerate(channels):
            files |= {f"in_{channel}_raw": 0, f"in_{channel}_scale": scale, f"scan_elements/in_{channel}_en": 0,
                      f"scan_elements/in_{channel}_index": index, f"scan_elements/in_{channel}_type": form}
        for file, value in files.items():
            (device / file).write_text(f"{value}\n")
        (self.folder / "dev").mkdir(exist_ok=True)
        self.fifos[name] = self.folder / "dev" / f"iio:device{number}"
        os.mkfifo(self.fifos[name])

    def begin(self):
        self._process = subprocess.Popen([*unshare(), "bash", "-c", MOUNTED, "iiod", str(self.folder), IIOD, str(self.port), self.real_time()],
                                         stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for("iiod", self._answers, START_LIMIT_S)

    @staticmethod
    def real_time():
        """Words before iiod's own. It is a stage of the control path: with ordinary priority its threads wait behind
        every compiler, several times for each sample (services/devices/device_rig/DEVICES.md, IIO devices)."""
        words = ["chrt", "--fifo", "40"]
        return " ".join(words) if subprocess.run([*words, "true"], capture_output=True, check=False).returncode == 0 else ""

    def _answers(self):
        with socket.socket() as one:
            return one.connect_ex(("127.0.0.1", self.port)) == 0

    def end(self):
        self._process.kill()
        self._process.wait()

    def stand_still(self):
        self._process.send_signal(signal.SIGSTOP)

    def close(self):
        self.end()
        shutil.rmtree(self.folder, ignore_errors=True)

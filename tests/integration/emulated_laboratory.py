# SPDX-License-Identifier: Apache-2.0
"""A servo drive and a platform that are not there, for a `stillhand lab --rig devices` (tests/emulators/README.md)."""
import json
import os
import pathlib
import shutil
import socket
import subprocess

from lab_process import BUILD, SOURCE

PROGRAM = BUILD / "tests" / "emulated_laboratory"
PROFILES = SOURCE / "qos" / "profiles.xml"
# Longer than the settings' defaults (20 and 10 ms): on a busy machine other programs hold the processor for up to 55 ms.
WATCHDOG_MS = int(os.environ.get("STILLHAND_WATCHDOG_MS", 100))
MAX_AGE_MS = int(os.environ.get("STILLHAND_MAX_AGE_MS", 80))
# Amplifiers between the simulated sensors and the drive's inputs: tests/emulators/laboratory.cpp.
SENSING = f"""
accel_sensitivity_v_m_s2: {0.1019716 * 0.97:.9f}
accel_x_offset_v: 0
accel_y_offset_v: {1.65 + 0.97 * 0.01:.6f}
accel_z_offset_v: 0
load_cell_sensitivity_v_n: 0.02
load_cell_offset_v: 1.651
adc_range_v: 3.3
"""

# The same behind IIO devices, which give m/s^2 and V (tests/emulators/iio_side.cpp).
SENSING_IIO = f"""
accel_sensitivity_v_m_s2: 1
accel_x_offset_v: 0
accel_y_offset_v: {0.01 / 0.1019716:.6f}
accel_z_offset_v: 0
load_cell_sensitivity_v_n: 0.02
load_cell_offset_v: 0.001
adc_range_v: 20
"""


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def devices_yaml(link, port, uart=False, iio=None, max_age_days=0, **signals):
    """Settings in which every signal is a device's, but those that are given. `iio`: uri of an IIO context."""
    if iio:
        signals = {"acceleration": "iio", "force": "iio"} | signals
    parts = {"acceleration": "drive", "force": "drive", "angle": "drive", "motor": "drive", "platform": "plain_udp"}
    lines = ["signals:"] + [f"  {name}: {part}" for name, part in (parts | signals).items()]
    lines += ["drive:", f"  port: {link}", f"  watchdog_s: {WATCHDOG_MS / 1000}", f"  max_age_ticks: {MAX_AGE_MS}",
              f"  checksum: {'true' if uart else 'false'}"]
    lines += ["platform:", f"  port: {port}", f"  max_age_ticks: {MAX_AGE_MS}", f"  valid_ms: {MAX_AGE_MS}"]
    for group in ("accelerometer", "load_cell") if iio else ():
        lines += [f"{group}:", f"  uri: {iio}", f"  max_age_ticks: {MAX_AGE_MS}"]
    # The amplifiers are known; a test that calibrates asks for it.
    lines += ["calibration:", f"  max_age_days: {max_age_days}"]
    return "\n".join(lines) + "\n"


class EmulatedLaboratory:
    """The emulator's process. `config` is a settings folder, which gets the devices' settings. `iio`: an IioContext."""

    def __init__(self, config, domain=None, uart=False, settings=(), iio=None, **signals):
        self.config = pathlib.Path(config)
        if not self.config.is_dir():
            shutil.copytree(SOURCE / "deploy" / "config", self.config)
        link = self.config.parent / "drive"
        port = free_port()
        (self.config / "devices.yaml").write_text(devices_yaml(link, port, uart, iio and iio.uri, **signals))
        (self.config / "sensing.yaml").write_text(SENSING_IIO if iio else SENSING)
        words = [str(PROGRAM), "--drive-link", str(link), "--platform-port", str(port), "--config", str(self.config)]
        words += ["--domain", str(domain), "--profiles", str(PROFILES)] if domain is not None else []
        words += ["--uart"] if uart else []
        words += ["--accelerometer", str(iio.fifos["accelerometer"]), "--bridge", str(iio.fifos["bridge"])] if iio else []
        for each in settings:
            words += ["--set", each]
        self.process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        ready = self.process.stdout.readline()
        if ready != "ready\n":
            raise AssertionError(f"the emulated laboratory says {ready!r}")

    def order(self, *words):
        print(*words, file=self.process.stdin, flush=True)

    def report(self):
        self.order("report")
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.kill()
        self.process.communicate()

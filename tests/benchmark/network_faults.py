# SPDX-License-Identifier: Apache-2.0
"""What a network that fails does to a session over three machines; the table of deploy/RESULTS.md.

Usage, as root: STILLHAND_BUILD=build python3 tests/benchmark/network_faults.py [--only WORD] [--keep DIR]

Each row is a session of its own over network namespaces (tests/integration/network.py): a pegged trial of 5 s, then 15 s of
condition C, 3 s into which the fault begins. What the motor does is recorded on the rig's own machine by a second
recorder, which no fault of the network reaches; what the screen says is read from its video (Debian's python3-pil).
"""
import argparse
import contextlib
import io
import os
import pathlib
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "integration"))

import network  # noqa: E402
from lab_process import TRIAL_LIMIT_S, LabProcess, hold, next_domain, quick_session  # noqa: E402

TRIAL_S = 15
FAULT_AT_S = 3
END_LIMIT_S = 150.0
FRAMES_PER_S = 60
# The notice's place on the screen of 1024 x 768, and what is bright there.
NOTICE_BOX = (300, 235, 724, 285)
BRIGHT = 150
NOTICE_LEAST_PIXELS = 150
LINK_LOST_LEAST_WIDTH = 150  # HOLD is narrower


@contextlib.contextmanager
def nothing():
    yield


@contextlib.contextmanager
def unplugged(machine, seconds):
    machine.unplug()
    try:
        hold(seconds)
    finally:
        machine.plug_back()
    yield


@contextlib.contextmanager
def powerless(machine):
    machine.switch_off()
    try:
        yield
    finally:
        machine.switch_on()


# (name, machine, context that begins the fault)
FAULTS = (
    [("none", "screen-pc", lambda m: nothing())]
    + [(f"{name}'s cable out for {seconds:g} s", name, lambda m, s=seconds: unplugged(m, s))
       for name in ("screen-pc", "rig-pc") for seconds in (0.2, 2.0, 20.0)]
    + [(f"{name} loses {share:.0%} of its packets", name, lambda m, s=share: m.losing(s))
       for name in ("screen-pc", "rig-pc") for share in (0.01, 0.05, 0.2)]
    + [(f"{name}'s cable at 10 Mbit/s", name, lambda m: m.limited_to(10e6)) for name in ("screen-pc", "rig-pc")]
    + [(f"{name} without power", name, powerless) for name in ("screen-pc", "rig-pc")]
)


def frames(avi):
    """Pictures of a motion-JPEG file, one by one."""
    data = avi.read_bytes()
    at = data.find(b"\xff\xd8\xff")
    while at >= 0:
        end = data.find(b"\xff\xd9", at)
        following = data.find(b"\xff\xd8\xff", end) if end >= 0 else -1
        yield data[at:following if following >= 0 else len(data)]
        at = following


def screen_says(avi):
    """Seconds that LINK LOST stood on the screen; None without a video."""
    if not avi.is_file():
        return None
    from PIL import Image  # noqa: PLC0415: of this benchmark alone
    lost = 0
    for picture in frames(avi):
        box = Image.open(io.BytesIO(picture)).convert("L").crop(NOTICE_BOX)
        bright = box.point(lambda level: 255 if level > BRIGHT else 0)
        extent = bright.getbbox()
        if extent and bright.histogram()[255] > NOTICE_LEAST_PIXELS and extent[2] - extent[0] > LINK_LOST_LEAST_WIDTH:
            lost += 1
    return lost / FRAMES_PER_S


def force_words(rig, cut_ns, end_tick):
    """What the motor did from the fault to the trial's end."""
    if rig is None or not rig["tick"]:
        return "no power, no force"
    behind = [i for i, stamp in enumerate(rig["stamp_ns"]) if stamp >= cut_ns and rig["tick"][i] < end_tick]
    opened = next((i for i in behind if not rig["motor_permitted"][i]), None)
    greatest = max((abs(rig["motor_force_n"][i]) for i in behind), default=0.0)
    if opened is None:
        return f"goes on, at most {greatest:.1f} N"
    last = max((i for i in behind if rig["motor_force_n"][i] != 0.0), default=behind[0])
    if last == behind[-1]:
        return f"NOT ZERO to the trial's end, at most {greatest:.1f} N"
    opened_ms, last_ms = ((rig["stamp_ns"][i] - cut_ns) * 1e-6 for i in (opened, last))
    return f"none from {last_ms:.0f} ms on, the rig's interlock open after {opened_ms:.0f} ms; at most {greatest:.1f} N"


def recorded_words(lab):
    recording = lab.recording(1)
    if not recording["messages"]:
        return "nothing"
    summary = lab.summary() if (lab.out / "summary.json").is_file() else None
    lost = sum(recording["lost_ticks"].values())
    return f"{sum(recording['messages'].values())} messages, {lost} ticks missing" + (
        "" if not recording["damage"] else ", damaged") + ("" if summary else ", no summary")


def ended_words(lab, status):
    if status == 0:
        return "trial completed"
    told = [line for line in lab.errors() if "is marked" in line or "stillhand" in line]
    return f"ended ({status}): " + (told[-1].split("is marked: ")[-1] if told else "nothing said")


def row(lab_network, name, machine, fault, folder):
    domain = next_domain()
    inventory = lab_network.inventory(domain)
    words = [str(word) for word in quick_session(folder / "config")]
    words[words.index("--trial-seconds") + 1] = str(TRIAL_S)
    witness = network.Witness(lab_network["rig-pc"], inventory, domain, folder)
    lab = LabProcess(folder / "run", "--video", *words, domain=domain, start=lab_network[network.HERE].words(),
                     inventory=inventory)
    try:
        lab.wait_for_tick(1, FAULT_AT_S, TRIAL_LIMIT_S)
        cut_ns = lab_network["rig-pc"].clock_ns()
        with fault(lab_network[machine]):
            status = lab.end_status(END_LIMIT_S)
        rig = witness.rig()
        link_lost_s = screen_says(folder / "run" / "screen.avi")
        screen = "no picture left" if link_lost_s is None else f"LINK LOST for {link_lost_s:.1f} s"
        trial = lab.recording(1)["trials"][-1]
        force = force_words(rig, cut_ns, trial["start_tick"] + trial["duration_ticks"])
        return f"| {name} | {force} | {screen} | {recorded_words(lab)} | {ended_words(lab, status)} |"
    finally:
        lab.close()
        witness.close()


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--only", default="", help="rows whose name holds this")
    arguments.add_argument("--keep", type=pathlib.Path, help="folder for the recordings")
    options = arguments.parse_args()
    if reason := network.why_not():
        sys.exit(f"network_faults: {reason}")
    if options.keep and options.keep.exists():
        sys.exit(f"network_faults: --keep {options.keep}: is there already, want a folder that is not")
    lab_network = network.Network(os.getpid())
    try:
        print("| fault | motor force | screen | recorded | session |\n| --- | --- | --- | --- | --- |", flush=True)
        for name, machine, fault in FAULTS:
            if options.only not in name:
                continue
            with tempfile.TemporaryDirectory(prefix="stillhand-") as folder:
                folder = pathlib.Path(folder)
                print(row(lab_network, name, machine, fault, folder), flush=True)
                if options.keep:
                    shutil.copytree(folder, options.keep / name.replace(" ", "_").replace("/", "_"))
    finally:
        lab_network.close()


if __name__ == "__main__":
    main()

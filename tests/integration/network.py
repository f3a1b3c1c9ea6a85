# SPDX-License-Identifier: Apache-2.0
"""A lab of several machines on this one: network namespaces joined by a bridge.

Each machine has an address, a loopback and a /dev/shm of its own; all but the desk, where the test itself runs
`stillhand lab`, have processes, a /tmp, an /etc and a monotonic clock of their own too. Nothing of the network of this
machine is touched. Needs root and namespaces: why_not() says what is missing.
"""
import contextlib
import json
import pathlib
import shutil
import subprocess
import tempfile
import time

from lab_process import BUILD, INSPECT, SERVICES as ALL, STILLHAND

TOOLS = ("ip", "tc", "unshare", "nsenter", "iptables", "mount")
# Services of the lab under test. The loop of sensor, canceller and motor stays on one machine (deploy/README.md).
SERVICES = {
    "rig-pc": ["rig", "sensing", "motion", "cancellation"],
    "screen-pc": ["display", "human_operator"],
}
HERE = "desk"
SERVICES[HERE] = [each for each in (*ALL, "experiment") if each not in sum(SERVICES.values(), [])]
LAB = "test"
KEYS_THERE = f"/etc/stillhand/{LAB}/security"
CLOCKS_APART_S = 1000
# Where the build shows on machines with a /tmp of their own.
BUILD_THERE = "/mnt/stillhand"


def run(*words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(map(str, words))}: {done.stderr.strip()}")
    return done.stdout


def why_not():
    """Why such a lab is not possible here, or ""."""
    missing = [tool for tool in TOOLS if shutil.which(tool) is None]
    if missing:
        return "no " + ", ".join(missing)
    probe = subprocess.run(["unshare", "--net", "--mount", "--ipc", "--pid", "--fork", "--mount-proc", "--time",
                            "--monotonic", "1", "ip", "link", "add", "name", "probe0", "type", "veth", "peer", "name", "probe1"],
                           capture_output=True, text=True, check=False)
    return "no namespaces: " + probe.stderr.strip() if probe.returncode != 0 else ""


class Machine:
    def __init__(self, network, name, number):
        self.network = network
        self.name = name
        self.address = f"10.213.7.{number + 1}"
        self.namespace = f"{network.name}-{number}"
        self.port = f"p{number}"  # the switch's end of its cable
        self.clock_ahead_s = 0 if name == HERE else CLOCKS_APART_S * (number + 1)
        self._init = None
        self._pid = None

    def plug_in(self):
        switch = self.network.switch
        run("ip", "netns", "add", self.namespace)
        run("ip", "-n", switch, "link", "add", self.port, "type", "veth", "peer", "name", "eth0", "netns",
            self.namespace)
        run("ip", "-n", switch, "link", "set", self.port, "master", "lan", "up")
        run("ip", "-n", self.namespace, "address", "add", self.address + "/24", "dev", "eth0")
        run("ip", "-n", self.namespace, "link", "set", "eth0", "up")
        run("ip", "-n", self.namespace, "link", "set", "lo", "up")

    def switch_on(self):
        """Starts its first process: with it the machine has processes and memory of its own."""
        script = "mount -t tmpfs tmpfs /dev/shm; "
        isolation = ["unshare", "--mount", "--ipc", "--fork", "--kill-child"]
        if self.name != HERE:
            isolation += ["--pid", "--mount-proc", "--time", "--monotonic", str(self.clock_ahead_s)]
            script += (f"mount -t tmpfs tmpfs /mnt; mkdir {BUILD_THERE}; mount --bind '{BUILD}' {BUILD_THERE}; "
                       "mkdir /mnt/etc; cp -a /etc/. /mnt/etc; mount --bind /mnt/etc /etc; mount -t tmpfs tmpfs /tmp; ")
        self._init = subprocess.Popen(["ip", "netns", "exec", self.namespace, *isolation, "sh", "-c",
                                       "set -e; " + script + "echo on; exec sleep infinity"],
                                      stdout=subprocess.PIPE, text=True)
        if self._init.stdout.readline() != "on\n":
            raise RuntimeError(f"{self.name} did not start")
        self._pid = self._child_of(self._init.pid)

    @staticmethod
    def _child_of(pid):
        children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
        return int(children[0])

    def words(self):
        """Words before a command that is to run there."""
        words = ["nsenter", f"--target={self._pid}", "--net", "--mount", "--ipc"]
        if self.name != HERE:
            words += ["--pid", "--time"]
        return words

    def run(self, *words, text=None):
        """Runs a command there; returns what it prints."""
        done = subprocess.run([*self.words(), *(str(word) for word in words)], input=text, capture_output=True,
                              text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{self.name}: {' '.join(map(str, words))}: {done.stderr.strip()}")
        return done.stdout

    def give_keys(self, keys):
        """Gives the machine the keys of its services alone, from a folder of deploy/security/make.sh."""
        mine = ["authority.pem", "governance.p7s", *SERVICES[self.name]]
        packed = subprocess.run(["tar", "-C", keys, "-c", *mine], check=True, capture_output=True).stdout
        subprocess.run([*self.words(), "sh", "-c", f"mkdir -p {KEYS_THERE}; tar -C {KEYS_THERE} -x"], check=True, input=packed)

    def clock_ns(self):
        """Its monotonic clock now."""
        return time.monotonic_ns() + self.clock_ahead_s * 1_000_000_000

    def switch_off(self):
        """Switches its power off: every process there is gone at once."""
        if self._init is not None:
            self._init.kill()  # --kill-child: the first process goes with it, and with that all of its namespace
            self._init.wait()
            self._init.stdout.close()
            self._init = None

    def unplug(self):
        run("ip", "-n", self.network.switch, "link", "set", self.port, "down")

    def plug_back(self):
        run("ip", "-n", self.network.switch, "link", "set", self.port, "up")


class Network:
    """The lab; close() leaves nothing of it."""

    def __init__(self, identity):
        """identity: a number that no other lab on this machine has."""
        self.name = f"shn-{identity}"
        self.switch = f"{self.name}-s"
        self.machines = {name: Machine(self, name, number) for number, name in enumerate(SERVICES)}
        self._folder = tempfile.TemporaryDirectory(prefix="stillhand-")
        try:
            self._build()
        except Exception:
            self.close()
            raise

    def _build(self):
        run("ip", "netns", "add", self.switch)
        run("ip", "-n", self.switch, "link", "add", "lan", "type", "bridge", "forward_delay", "0", "mcast_snooping", "0")
        run("ip", "-n", self.switch, "link", "set", "lan", "up")
        for machine in self.machines.values():
            machine.plug_in()
            machine.switch_on()

    def __getitem__(self, name):
        return self.machines[name]

    def inventory(self, domain, before=None, keys=None):
        """File with the lab as `stillhand lab --inventory` reads it.

        before: {machine: further words before a command there}; keys: folder of deploy/security/make.sh.
        """
        lines = [f"lab: {LAB}", f"domain: {domain}", "discovery: peers"]
        lines += [f"security: {keys or 'none'}"]
        lines += ["hosts:"]
        for name, services in SERVICES.items():
            machine = self.machines[name]
            lines += [f"  - name: {name}", f"    address: {machine.address}", f"    services: [{', '.join(services)}]"]
            if name == HERE:
                lines += [f"    prefix: {BUILD}"]
            else:
                start = machine.words() + (before or {}).get(name, [])
                lines += [f"    prefix: {BUILD_THERE}", f"    start: [{', '.join(start)}]"]
        file = pathlib.Path(self._folder.name) / "lab.yaml"
        file.write_text("\n".join(lines) + "\n")
        return file

    def close(self):
        for machine in self.machines.values():
            machine.switch_off()
        for namespace in [machine.namespace for machine in self.machines.values()] + [self.switch]:
            subprocess.run(["ip", "netns", "delete", namespace], capture_output=True, check=False)
        self._folder.cleanup()


class Witness:
    """Records the rig's truth on a machine itself, where no cable reaches it."""

    def __init__(self, machine, inventory, domain, folder):
        self.machine, self.folder = machine, pathlib.Path(folder)
        generated = self.folder / "generated"
        subprocess.run([STILLHAND, "deploy", "generate", inventory, "--out", generated], check=True, capture_output=True)
        machine.run("sh", "-c", "cat > /tmp/profiles.xml", text=(generated / machine.name / "profiles.xml").read_text())
        self.process = subprocess.Popen(
            [*machine.words(), "sh", "-c",
             f"echo $$ > /tmp/witness.pid; exec {BUILD_THERE}/bin/stillhand record --domain {domain} "
             "--topics stillhand/rig_truth --profiles /tmp/profiles.xml --out /tmp/witness.mcap"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def rig(self):
        """Ends it; its recording as inspect_recording prints it, or None if the machine is gone."""
        file = self.folder / "witness.mcap"
        with contextlib.suppress(RuntimeError):
            self.machine.run("sh", "-c", "kill -INT $(cat /tmp/witness.pid)")
        self.process.wait(timeout=30)
        with open(file, "wb") as out:
            copied = subprocess.run([*self.machine.words(), "cat", "/tmp/witness.mcap"], stdout=out,
                                    stderr=subprocess.DEVNULL, check=False)
        with contextlib.suppress(RuntimeError):
            self.machine.run("sh", "-c", "rm -f /tmp/witness* /tmp/profiles.xml")
        if copied.returncode != 0:
            return None
        return json.loads(subprocess.check_output([INSPECT, file, str(10**6)]))["rig"]

    def close(self):
        self.process.kill()
        self.process.wait()

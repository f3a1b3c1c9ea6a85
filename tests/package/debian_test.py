#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Debian packages of a finished build: what they hold, and how they run once dpkg has installed them.

They are installed into a copy of this system (an overlay in memory, in a mount namespace of its own). In the copy the
source tree and the build tree are empty folders: what runs there has nothing but its packages and Debian's. The copy has
every Debian package of this machine, so it cannot show that a dependency is missing; dpkg-shlibdeps finds those.

With `--campaign` a study, a session and a project that links the cores run in the copy.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tests" / "integration"))
import lab_process  # noqa: E402 (found by the line above)
from verb_case import SharedFolderCase  # noqa: E402

BUILD = lab_process.BUILD
CORES = ("signal", "statistics", "admittance_core", "motion_core", "rig_core", "sensing_core", "identification_core", "cancellation_core",
         "diagnosis_core", "clock_core", "display_core", "human_operator_core", "recording_core")
PROGRAMS = {"stillhand", "stillhand-permissions", "stillhand-device_rig", "stillhand-vehicle_motion",
            *(f"stillhand-{service}" for service in lab_process.SERVICES)}
SUBVERBS = {"deploy-generate", "deploy-check",
            *(f"experiment-{verb}" for verb in ("new", "run", "status", "exclude", "unblind", "report",
                                         "export"))}
# Makes the copy of this system at $1 with the packages of $2, and hides $3, $4, ...; then stays until its input ends.
INSTALL = r"""
set -e
root=$1 packages=$2
shift 2
mount -t tmpfs stillhand "$root"
mkdir "$root/above" "$root/work" "$root/system"
mount -t overlay stillhand -o lowerdir=/,upperdir="$root/above",workdir="$root/work" "$root/system"
root=$root/system
mount --rbind /dev "$root/dev"
mount --rbind /proc "$root/proc"
mount -t tmpfs stillhand "$root/tmp"
mkdir "$root/packages"
mount --bind "$packages" "$root/packages"
for hidden in "$@"; do
  if [ -d "$root$hidden" ]; then mount -t tmpfs stillhand "$root$hidden"; fi
done
chroot "$root" sh -c 'dpkg --install --no-triggers /packages/*.deb' >&2
echo installed
cat >/dev/null
"""

# Every header of the package; then each library whole, so that every symbol it needs must be found.
CONSUMER = """cmake_minimum_required(VERSION 3.24)
project(consumer LANGUAGES CXX)
find_package(stillhand 0.1 REQUIRED)
add_executable(consumer main.cpp)
file(WRITE ${CMAKE_BINARY_DIR}/empty.cpp "int main() {}")
foreach(core %s)
  target_link_libraries(consumer PRIVATE stillhand::${core})
  add_executable(all_of_${core} ${CMAKE_BINARY_DIR}/empty.cpp)
  target_link_libraries(all_of_${core} PRIVATE $<LINK_LIBRARY:WHOLE_ARCHIVE,stillhand::${core}>)
endforeach()
"""
MAIN = """%s
#include <cstdio>
int main() {
  stillhand::cancellation::Countermeasure sut{stillhand::cancellation::Config{}};
  std::printf("%%s\\n", sut.has_model() ? "a model" : "no model");
}
"""


def output_of(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True).stdout


def verbs_in(text):
    """The verbs that a help text lists."""
    return set(re.findall(r"^  ([a-z0-9-]+) ", text.partition("\nSubcommands:\n")[2], re.M))


class Packages:
    """Both packages, made once."""

    def __init__(self):
        self._folder = tempfile.TemporaryDirectory(prefix="stillhand-packages-")
        made = pathlib.Path(self._folder.name)
        subprocess.run(["cpack", "-G", "DEB", "--config", BUILD / "CPackConfig.cmake", "-B", made], check=True,
                       stdout=subprocess.DEVNULL, umask=0o077)  # a builder may have any umask
        shutil.rmtree(made / "_CPack_Packages")
        self.folder = made
        self.programs, = made.glob("stillhand_*.deb")
        self.development, = made.glob("libstillhand-dev_*.deb")

    def close(self):
        self._folder.cleanup()


class Installed:
    """A copy of this system with both packages, until close()."""

    def __init__(self, packages):
        self._folder = tempfile.TemporaryDirectory(prefix="stillhand-root-")
        self._root = pathlib.Path(self._folder.name)
        self._errors = tempfile.TemporaryFile("w+")
        self._holder = subprocess.Popen(
            ["unshare", "--mount", "sh", "-c", INSTALL, "sh", str(self._root), str(packages), str(SOURCE), str(BUILD)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, text=True)
        if self._holder.stdout.readline() != "installed\n":
            self._holder.wait()
            self._errors.seek(0)
            self.close()
            raise AssertionError(f"not installed: {self._errors.read()}")
        # The same folder, seen from outside.
        self.root = pathlib.Path(f"/proc/{self._holder.pid}/root{self._root}/system")

    def run(self, *words, user="root", **options):
        """A command in the copy, with nothing of this process's environment."""
        environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LANG": "C.UTF-8", "HOME": "/tmp"}
        inside = ["nsenter", f"--mount=/proc/{self._holder.pid}/ns/mnt", "chroot", f"--userspec={user}",
                  str(self._root / "system")]
        return subprocess.run(inside + [str(word) for word in words], capture_output=True, text=True, check=False,
                              cwd="/", env=environment, stdin=subprocess.DEVNULL, **options)

    def close(self):
        self._holder.stdin.close()
        self._holder.wait()
        self._holder.stdout.close()
        self._folder.cleanup()


def why_not_installed():
    """What is missing for a copy of this system, "" when nothing is."""
    if os.geteuid() != 0:
        return "not root: no overlay of the system to install into"
    script = ("mount -t tmpfs stillhand /mnt && mkdir /mnt/a /mnt/b /mnt/c && "
              "mount -t overlay stillhand -o lowerdir=/,upperdir=/mnt/a,workdir=/mnt/b /mnt/c")
    tried = subprocess.run(["unshare", "--mount", "sh", "-c", script], capture_output=True, text=True, check=False)
    return "" if tried.returncode == 0 else f"no overlay of the system to install into: {tried.stderr.strip()}"


class ContentTest(SharedFolderCase):
    """What the packages hold, unpacked."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.programs = cls.folder / "programs"
        cls.development = cls.folder / "development"
        subprocess.run(["dpkg-deb", "-x", PACKAGES.programs, cls.programs], check=True)
        subprocess.run(["dpkg-deb", "-x", PACKAGES.development, cls.development], check=True)

    def files(self):
        """Every file of both, with its place in the package."""
        for unpacked in (self.programs, self.development):
            for path in unpacked.rglob("*"):
                yield path, path.relative_to(unpacked)

    def test_a_library_or_program_that_is_started_by_name_is_a_dependency(self):
        depends = output_of("dpkg-deb", "--field", PACKAGES.programs, "Depends")
        for name in (r"libfast(rtps|dds)[\d.]+", r"libopencv-highgui\d+", r"libyaml-cpp[\d.]+", "gnuplot-nox", "openssl"):
            self.assertRegex(depends, rf"(^|, ){name}( \(|,|$)")
        depends = output_of("dpkg-deb", "--field", PACKAGES.development, "Depends")
        self.assertIn("libeigen3-dev", depends)

    def test_every_program_is_there_without_debug_information(self):
        self.assertEqual({path.name for path in (self.programs / "usr/bin").iterdir()}, PROGRAMS)
        for path in (*(self.programs / "usr/bin").iterdir(), *(self.development / "usr/lib").glob("*.a")):
            self.assertNotIn(".debug_info", output_of("readelf", "--section-headers", "--wide", path), path)

    def test_every_file_is_where_debian_wants_it_and_roots(self):
        for path, place in self.files():
            self.assertRegex(str(place), r"^(usr(/(bin|include|lib|share)(/|$)|$)|etc(/security(/|$)|$))")
            mode = path.lstat().st_mode & 0o7777
            program = place.suffix == ".sh" or (place.suffix == ".py" and place.parts[1] == "share")
            executable = path.is_dir() or place.parts[:2] == ("usr", "bin") or program
            self.assertEqual(oct(mode), oct(0o755 if executable else 0o644), place)
        for package in (PACKAGES.programs, PACKAGES.development):
            for line in output_of("dpkg-deb", "--contents", package).splitlines():
                self.assertEqual(line.split()[1], "root/root", line)

    def test_no_file_names_the_trees_it_was_made_from(self):
        # But for the names of sources in failed assertions.
        paths = "|".join(re.escape(str(path)) for path in (SOURCE, BUILD))
        named = re.compile(rf"(?:{paths})(?![\w/.-]*\.[ch]pp\b)[\w/.-]*".encode())
        for path, place in self.files():
            if path.is_file():
                self.assertEqual(named.findall(path.read_bytes()), [], place)

    def test_every_program_and_verb_has_a_manual_page(self):
        pages = {path.name for path in (self.programs / "usr/share/man/man1").iterdir()}
        verbs = verbs_in(output_of(BUILD / "bin" / "stillhand", "--help"))
        self.assertIn("deploy", verbs)
        names = PROGRAMS | {f"stillhand-{verb}" for verb in verbs | SUBVERBS}
        self.assertEqual(pages, {f"{name}.1.gz" for name in names})
        page = output_of("gzip", "-dc", self.programs / "usr/share/man/man1/stillhand-record.1.gz")
        self.assertIn("\n.SH NAME\nstillhand\\-record \\- Records a running bus", page)
        self.assertIn("/usr/share/stillhand/qos/profiles.xml", page)

    def test_the_settings_are_those_of_the_sources(self):
        for folder in ("deploy/config", "deploy/experiments"):
            shipped = {path.name: path.read_bytes()
                       for path in (self.programs / "usr/share/stillhand" / folder).iterdir()}
            self.assertEqual(shipped, {path.name: path.read_bytes() for path in (SOURCE / folder).iterdir()})


class InstalledTest(unittest.TestCase):
    """Both packages at work, in a copy of this system without source and build tree."""

    @classmethod
    def setUpClass(cls):
        missing = why_not_installed()
        if missing:
            raise unittest.SkipTest(missing)
        cls.system = Installed(PACKAGES.folder)
        cls.addClassCleanup(cls.system.close)

    def good(self, *words, **options):
        run = self.system.run(*words, **options)
        self.assertEqual(run.returncode, 0, f"{words}: {run.stdout}{run.stderr}")
        return run.stdout

    def test_source_and_build_tree_are_hidden(self):
        left = self.system.run("find", SOURCE, "-mindepth", "1")
        self.assertEqual(left.stdout, "")
        self.assertTrue(left.returncode == 0 or "No such file" in left.stderr, left.stderr)
        self.assertNotEqual(self.system.run("test", "-e", BUILD / "bin").returncode, 0)

    def test_the_user_of_the_units_is_there(self):
        self.assertEqual(self.good("id", "--name", "--user", "stillhand"), "stillhand\n")
        self.assertEqual(self.good("id", "--name", "--groups", "stillhand"), "stillhand\n")

    def test_help_names_the_installed_profiles(self):
        for verb in ("lab", "record", "replay"):
            self.assertRegex(self.good("stillhand", verb, "--help-all"),
                             r"TEXT(=| \[)/usr/share/stillhand/qos/profiles\.xml\b")

    @lab_process.campaign
    def test_a_study_runs_as_an_ordinary_user(self):
        self.good("stillhand", "study", "--subjects", 2, "--trial-seconds", 40, "--identify-seconds", 20, "--seed", 5,
                  "--out", "/tmp/study", user="stillhand")
        self.assertIn("report.html", self.good("ls", "/tmp/study"))
        self.assertNotEqual(list((self.system.root / "tmp/study").glob("*.svg")), [])

    @lab_process.campaign
    def test_a_session_runs_with_every_process(self):
        self.good("cp", "-r", "/usr/share/stillhand/deploy/config", "/tmp/config")
        # As in lab_process.quick_session(): takes the model that 5 s give.
        (self.system.root / "tmp/config/identification.yaml").write_text("max_conversion_error: 1.0\n")
        self.good("stillhand", "lab", "--conditions", "C", "--identify-seconds", 5, "--trial-seconds", 10, "--seed", 2,
                  "--headless", "--config", "/tmp/config", "--out", "/tmp/run", "--domain", lab_process.next_domain(),
                  timeout=120)
        summary = json.loads((self.system.root / "tmp/run/summary.json").read_text())
        self.assertIn("C", summary["conditions"])
        self.good("stillhand", "verify", "/tmp/run/session.mcap")

    def test_generated_units_start_what_is_installed(self):
        (self.system.root / "tmp/lab.yaml").write_text(
            "lab: hall\nhosts:\n  - name: desk\n    address: 192.168.7.1\n    services: "
            f"[{', '.join((*lab_process.SERVICES, 'experiment'))}]\n")
        self.good("stillhand", "deploy", "generate", "/tmp/lab.yaml", "--out", "/tmp/generated")
        units = [path.read_text() for path in (self.system.root / "tmp/generated/desk").glob("*.service")]
        self.assertEqual(len(units), len(lab_process.SERVICES))
        for unit in units:
            program, = re.findall(r"^ExecStart=.*?(/\S*bin/stillhand-\w+)", unit, re.M)
            config, = re.findall(r"^Environment=STILLHAND_CONFIG=(.*)", unit, re.M)
            user, = re.findall(r"^User=(.*)", unit, re.M)
            self.good("test", "-x", program)
            self.good("test", "-f", f"{config}/rig.yaml")
            self.good("id", user)

    def test_keys_are_made(self):
        self.good("/usr/share/stillhand/deploy/security/make.sh", "/tmp/keys", "--lab", "hall")
        self.good("test", "-s", "/tmp/keys/rig/permissions.p7s")

    def test_the_shell_completes_verbs_options_and_choices(self):
        def completed(*words):
            script = ('source /usr/share/bash-completion/completions/stillhand; COMP_WORDS=("$@"); '
                      'COMP_CWORD=$(($# - 1)); _stillhand; echo "${COMPREPLY[@]}"')
            return self.good("bash", "-c", script, "bash", "stillhand", *words).split()

        self.assertEqual(set(completed("")), verbs_in(self.good("stillhand", "--help")))
        self.assertEqual(completed("clo"), ["close-the-loop"])
        self.assertEqual(set(completed("deploy", "")), {"generate", "check"})
        self.assertEqual(completed("study", "--sub"), ["--subjects"])
        self.assertEqual(completed("deploy", "check", "lab.yaml", "--j"), ["--json"])
        self.assertEqual(set(completed("lab", "--operator", "")), {"simulated", "mouse", "gamepad"})
        self.assertEqual(completed("lab", "--conditions", "A,no"), ["A,notch"])
        self.assertIn("low-pass", completed("lab", "--conditions", ""))
        self.assertIn("C+", completed("experiment", "new", "--conditions", "C"))
        self.assertEqual(set(completed("replay", "--remote", "s")), {"step", "stop"})
        self.assertEqual(completed("lab", "--out", ""), [])  # file names: readline's own

    @lab_process.campaign
    def test_another_project_finds_the_cores(self):
        include = self.system.root / "usr/include/stillhand"
        headers = sorted(str(path.relative_to(include)) for path in include.rglob("*.hpp"))
        project = self.system.root / "tmp/consumer"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(CONSUMER % " ".join(CORES))
        (project / "main.cpp").write_text(MAIN % "\n".join(f"#include <{header}>" for header in headers))
        self.good("cmake", "-S", "/tmp/consumer", "-B", "/tmp/consumer/build", timeout=300)
        self.good("cmake", "--build", "/tmp/consumer/build", timeout=300)
        self.assertEqual(self.good("/tmp/consumer/build/consumer"), "no model\n")


if __name__ == "__main__":
    MISSING = [program for program in sorted(PROGRAMS) if not (BUILD / "bin" / program).is_file()]
    if MISSING:
        lab_process.skip("not built: " + ", ".join(MISSING))
    PACKAGES = Packages()
    unittest.addModuleCleanup(PACKAGES.close)
    lab_process.run_cases()

// SPDX-License-Identifier: Apache-2.0
// What another host's shell is given, run by a shell of this machine: its start words begin one
// here, as ssh begins one there.
#include "apps/lab/remote.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>

#include "apps/lab/keys.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/refusal.hpp"
#include "tests/support/wait.hpp"
#include "tests/unit/deploy/sample_inventory.hpp"

namespace stillhand::lab::remote_test {
namespace {

using deploy::SampleFolder;
using support::text_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

deploy::Host host_by(std::vector<std::string> start) {
  return {"rig-pc", "10.0.0.2", std::move(start), "/opt/still hand", {}, "lab.yaml:5:5"};
}

// A login that greets, as ssh's banner and a shell's start-up file do, the last line unfinished.
deploy::Host talkative() {
  return host_by({"sh", "-c",
                  "echo /tmp/stillhand-of-a-banner; printf \"Permanently added\" >&2; "
                  "exec \"$@\"",
                  "login"});
}

/// What a script prints when it fails; "accepted" when it does not.
std::string complaint(const SampleFolder& folder, const std::string& script) {
  const deploy::Host host = host_by({"env"});
  RemoteHost sut(host, folder.path() / "complaint.log");
  return support::refusal([&] { sut.check(script, "what is wanted"); });
}

/// What the shell makes of `cat` with this behind it.
std::string read_back(const SampleFolder& folder, const std::string& behind) {
  const fs::path file = folder.path() / "read_back";
  EXPECT_EQ(complaint(folder, "cat > " + report::in_shell_quotes(file.string()) + " " + behind),
            "accepted");
  return text_of(file);
}

TEST(ShellWordTest, AShellReadsItBackAsOneWord) {
  const SampleFolder folder;
  for (const std::string word :
       {"plain", "two words", "it's", "$HOME `id` \"x\" \\ !", "a\nb", ""}) {
    const fs::path file = folder.path() / "word";
    EXPECT_EQ(complaint(folder, "printf '<%s>' " + report::in_shell_quotes(word) + " > " +
                                    report::in_shell_quotes(file.string()) + "\n"),
              "accepted");
    EXPECT_EQ(text_of(file), "<" + word + ">");
  }
}

TEST(HereDocumentTest, AShellReadsTheTextBackWhateverItsLinesAre) {
  const SampleFolder folder;
  for (const std::string text :
       {"one\ntwo\n", "", "END\n", "END\nEND_\nEND__", "$HOME `id` \\\n", "\n\n"}) {
    const bool whole = text.empty() || text.ends_with('\n');
    EXPECT_EQ(read_back(folder, here_document(text)), whole ? text : text + "\n");
  }
}

TEST(FolderToldTest, IsThatOfTheLineWhichTheScriptAlonePrints) {
  EXPECT_EQ(folder_made("\nstillhand made /tmp/stillhand-a1\n"), "/tmp/stillhand-a1");
  EXPECT_EQ(folder_made("Permanently added 'rig-pc'.\n/tmp/stillhand-of-a-banner\n"
                        "\nstillhand made /tmp/stillhand-a1\nbye\n"),
            "/tmp/stillhand-a1");
  EXPECT_EQ(folder_made("/tmp/stillhand-of-a-banner\n"), "");
  EXPECT_EQ(folder_made("\nstillhand made /tmp/stillhand-a1"), "");  // not the whole line
  EXPECT_EQ(folder_made("\nstillhand made \n"), "");
  EXPECT_EQ(folder_made(""), "");
}

TEST(RemoteHostTest, AFolderIsMadeFilledReadAndTakenAwayWhateverALoginPrints) {
  const SampleFolder here;
  const runtime::Stop stop;
  const deploy::Host host = talkative();
  RemoteHost sut(host, here.path() / "host.log");
  sut.open(stop);
  const fs::path there = sut.folder();
  ASSERT_THAT(there.string(), StartsWith("/tmp/stillhand-"));
  ASSERT_TRUE(fs::is_directory(there));
  sut.put({{"profiles.xml", "<dds/>"}, {"config/rig.yaml", "a: 1\n"}});
  EXPECT_EQ(text_of(there / "profiles.xml"), "<dds/>\n");
  EXPECT_EQ(text_of(there / "config/rig.yaml"), "a: 1\n");
  EXPECT_EQ(fs::status(there / "config/rig.yaml").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
  sut.close();
  EXPECT_FALSE(fs::exists(there));
}

TEST(RemoteHostTest, AFileIsFetchedWhole) {
  const SampleFolder here;
  const deploy::Host host = host_by({"env"});
  RemoteHost sut(host, here.path() / "host.log");
  const std::string bytes(
      "\0\n\xff"
      "END\n",
      8);
  std::ofstream(here.path() / "there") << bytes;
  sut.fetch((here.path() / "there").string(), here.path() / "copy");
  EXPECT_EQ(text_of(here.path() / "copy"), bytes);
  EXPECT_THROW(sut.fetch("/no/such/file", here.path() / "none"), std::runtime_error);
  EXPECT_FALSE(fs::exists(here.path() / "none"));
  EXPECT_FALSE(fs::exists(here.path() / "none.part"));
}

TEST(RemoteHostTest, AHostWithoutAShellIsNamedWithItsPlaceAndWords) {
  const SampleFolder here;
  const runtime::Stop stop;
  const deploy::Host host = host_by({"sh", "-c", "echo no route to it >&2; exit 255"});
  RemoteHost sut(host, here.path() / "host.log");
  EXPECT_THAT(support::refusal([&] { sut.open(stop); }),
              AllOf(HasSubstr("lab.yaml:5:5: host rig-pc"), HasSubstr("no route to it"),
                    HasSubstr("bash -s")));
}

TEST(RemoteHostTest, AStopEndsTheWaitForAHostThatIsSilent) {
  const SampleFolder here;
  runtime::Stop stop;
  stop.request();
  const deploy::Host host = host_by({"sh", "-c", "sleep 60"});
  RemoteHost sut(host, here.path() / "host.log");
  EXPECT_THROW(sut.open(stop), Interrupted);
}

// The program takes its place beside the host's others, its words reach it as they are, and what
// it is started with ends it.
TEST(RemoteHostTest, AProcessThereGetsItsWordsAndEndsWithItsInput) {
  const SampleFolder here;
  deploy::Host host = host_by({"env"});
  host.prefix = here.path() / "still hand";
  fs::create_directories(host.prefix / "bin");
  const fs::path program = host.prefix / "bin" / "stillhand-rig";
  std::ofstream(program)
      << "#!/bin/bash\nprintf '<%s>' \"$@\" $PPID > \"$1\"\nmv \"$1\" \"$1.all\"\n"
         "trap 'exit 7' TERM\nsleep 60 & wait\n";
  fs::permissions(program, fs::perms::owner_all);
  const fs::path told = here.path() / "told";
  Launch local;
  local.name = "rig";
  local.executable = "/elsewhere/stillhand-rig";
  local.arguments = {told.string(), "it's", "two words", "$HOME"};
  local.log = here.path() / "rig.log";

  const RemoteHost sut(host, here.path() / "host.log");
  const Launch launch = sut.on_it(local);
  EXPECT_EQ(launch.host, "rig-pc");
  EXPECT_EQ(launch.executable, "env");
  EXPECT_THAT(launch.arguments, ElementsAre("bash", "-s"));
  Processes processes;
  processes.start(launch);
  ASSERT_TRUE(support::eventually([&] { return fs::exists(told.string() + ".all"); }));
  const std::string words = text_of(told.string() + ".all");
  const std::string own = "<" + told.string() + "><it's><two words><$HOME>";
  EXPECT_EQ(words.substr(0, own.size()), own);
  // The shell is what it ends with, as the kernel says.
  EXPECT_TRUE(
      std::regex_match(words.substr(own.size()), std::regex("<--end-with-parent><([0-9]+)><\\1>")));
  EXPECT_FALSE(processes.reap());
  processes.end("rig", 20.0);  // closes its input
  EXPECT_EQ(text_of(local.log), "");
}

/// A host's folder of keys, as make.sh writes it.
void write_keys(const fs::path& folder, const std::string& authority) {
  fs::create_directories(folder / "rig");
  std::ofstream(folder / "authority.pem") << authority;
  for (const char* file :
       {"governance.p7s", "rig/certificate.pem", "rig/key.pem", "rig/permissions.p7s"}) {
    std::ofstream(folder / file) << "x";
  }
}

TEST(KeysScriptTest, FindsAKeyThatIsMissingAndAnotherAuthority) {
  const SampleFolder here;
  const fs::path keys = here.path() / "the keys";
  const std::string authority =
      "-----BEGIN CERTIFICATE-----\nMII(\")'$x\n-----END CERTIFICATE-----";
  write_keys(keys, authority + "\n");
  EXPECT_EQ(complaint(here, keys_script(keys, authority + "\n", {"rig"})), "accepted");
  EXPECT_EQ(complaint(here, keys_script(keys, authority, {"rig"})),
            "accepted");  // a last line without end
  EXPECT_THAT(complaint(here, keys_script(keys, "END\n" + authority, {"rig"})),
              HasSubstr("authority.pem is another"));
  EXPECT_THAT(complaint(here, keys_script(keys, authority, {"rig", "motion"})),
              HasSubstr("no " + (keys / "motion/certificate.pem").string() + " to read"));
  EXPECT_THAT(complaint(here, keys_script(here.path() / "none", authority, {"rig"})),
              AllOf(HasSubstr("none"), HasSubstr("what is wanted")));
}

}  // namespace
}  // namespace stillhand::lab::remote_test

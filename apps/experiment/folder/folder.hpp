// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/libraries/experiment/core/plan.hpp"
#include "apps/libraries/experiment/file/journal.hpp"

namespace stillhand::experiment {

/// The folder of an experiment:
///
///   experiment.yaml, experiment.sha256, assignment.sealed, journal.jsonl,
///   participants/P07/journal.jsonl, participants/P07/sessions/01/session.mcap,
///   participants/P07/planned/01/session.mcap
///
/// The constructor reads and checks the first three; nothing is changed by reading.
class Folder {
 public:
  /// @throws ConfigError for a folder that is no experiment, a changed assignment, and, once a
  ///         participant is there, a changed experiment.yaml or model of condition C+
  explicit Folder(std::filesystem::path path);

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] const Design& design() const noexcept { return design_; }
  [[nodiscard]] const Assignment& assignment() const noexcept { return assignment_; }
  /// SHA-256 of experiment.yaml.
  [[nodiscard]] const std::string& digest() const noexcept { return digest_; }
  [[nodiscard]] bool unblinded() const;

  /// Indices of the participants that have a folder, in order.
  /// @throws ConfigError for a folder whose name is no code of this experiment
  [[nodiscard]] std::vector<std::size_t> participants() const;
  [[nodiscard]] std::filesystem::path participant(std::size_t index) const;
  [[nodiscard]] std::filesystem::path journal(std::size_t index) const;
  /// "sessions/02" of a participant.
  [[nodiscard]] std::filesystem::path session(std::size_t index, std::int64_t number) const;
  /// "planned/01" of a participant: the next one that is not there yet.
  [[nodiscard]] std::filesystem::path next_planned(std::size_t index) const;
  [[nodiscard]] Plan plan(std::size_t index) const;
  /// Index of the participant of a code.  @throws ConfigError for one who has no session
  [[nodiscard]] std::size_t with_session(const std::string& code) const;

  /// What a participant's folder has against its journal: a missing recording, one of another
  /// participant, session or experiment, one that the journal does not know.  Empty: nothing.
  [[nodiscard]] std::vector<std::string> findings(std::size_t index,
                                                  const std::vector<Entry>& entries) const;

  /// What is wrong with assignment.json; empty: nothing, or nobody has unblinded.
  [[nodiscard]] std::string opening_finding() const;

  /// @throws ConfigError naming opening_finding(), or the first of findings() over all participants
  void refuse_findings() const;

  /// Writes the digests of experiment.yaml and of the model of condition C+ as they are now: before
  /// the first participant.
  void register_design() const;
  /// Makes the participant's folder; registers the design first if nobody has one.
  void open_participant(std::size_t index) const;

 private:
  std::filesystem::path path_;
  Design design_;
  Assignment assignment_;
  std::string digest_;
};

/// Makes the folder of a new experiment.
/// @throws ConfigError when the folder holds anything already
void make_folder(const std::filesystem::path& path, Design design, std::uint64_t order_seed);

}  // namespace stillhand::experiment

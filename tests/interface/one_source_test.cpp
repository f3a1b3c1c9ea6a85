// SPDX-License-Identifier: Apache-2.0
// The real bus on loopback: a rig takes motor commands from the participant that its session names.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <mutex>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
#include "places.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/sources_codec.hpp"
#include "tests/support/bus_options.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime {
namespace {

using support::eventually;

Bus::Options options_of(const std::string& service) {
  Bus::Options options = support::bus_options(service);
  options.one_source = true;
  return options;
}

/// Writes motor commands of rig 1.
struct Commander {
  explicit Commander(const std::string& service) : bus(options_of(service)) {
    motor = bus.publisher<stillhand_msgs::MotorCommand>(topics::kMotorCommand);
    bus.start();
  }
  void command(Tick tick) {
    stillhand_msgs::MotorCommand message;
    message.tick(tick);
    motor.write(message);
  }
  Bus bus;
  Publisher<stillhand_msgs::MotorCommand> motor;
};

/// Reads them, as the rig does, and the session's sources.
struct Rig {
  explicit Rig(Bus::Options options) : bus(complete(std::move(options))) {
    bus.subscribe<stillhand_msgs::MotorCommand>(
        topics::kMotorCommand, [this](const stillhand_msgs::MotorCommand& message, const Arrival&) {
          newest = message.tick();
        });
    bus.subscribe<stillhand_msgs::SessionSources>(
        topics::kSessionSources,
        [this](const stillhand_msgs::SessionSources& message, const Arrival& arrival) {
          named = bus.take_sources(arrival.participant, *from_idl(message)) ? 1 : -1;
        });
    bus.start();
  }
  Bus::Options complete(Bus::Options options) {
    options.on_incident = [this](const BusIncident& incident) {
      if (incident.kind != stillhand_msgs::EVENT_SECOND_WRITER) return;
      const std::lock_guard lock(mutex);
      second.push_back(std::string(incident.topic->name) + " " + incident.peer);
    };
    return options;
  }
  [[nodiscard]] std::vector<std::string> seconds() {
    const std::lock_guard lock(mutex);
    return second;
  }
  std::mutex mutex;
  std::vector<std::string> second;
  std::atomic<Tick> newest{-1};
  std::atomic<int> named{0};  // -1: refused
  Bus bus;
};

class OneSourceTest : public testing::Test {
 protected:
  OneSourceTest() {
    sources_ = experiment_.publisher<stillhand_msgs::SessionSources>(topics::kSessionSources);
    experiment_.start();
  }
  /// The participants of canceller and experiment; nobody for the other processes.
  void name_sources(const Commander& canceller) {
    std::vector<Source> sources;
    for (const std::string_view service : topics::kServices) {
      sources.push_back({std::string(service), {}});
      if (service == "cancellation") sources.back().participant = canceller.bus.participant();
      if (service == "experiment") sources.back().participant = experiment_.participant();
    }
    auto message = to_idl(sources);
    sources_.write(message);
  }

  Bus experiment_{options_of("experiment")};
  Publisher<stillhand_msgs::SessionSources> sources_;
};

TEST_F(OneSourceTest, ARigTakesCommandsOfItsSessionsCancellerAloneAndNamesTheOther) {
  Commander canceller("cancellation");
  Commander stranger("stranger");
  Rig rig(options_of("rig"));
  ASSERT_TRUE(eventually([&] { return rig.bus.report().front().matched == 2; }));
  // Before the session names its sources, nobody commands.
  constexpr Tick kEarly = 5, kGenuine = 7, kForeign = 9;
  for (int i = 0; i < 20; ++i) {
    canceller.command(kEarly);
    stranger.command(kEarly);
  }
  EXPECT_FALSE(rig.bus.peers_alive());
  EXPECT_STREQ(rig.bus.why_not_alive(), "the session has not named its sources");
  name_sources(canceller);
  ASSERT_TRUE(eventually([&] { return rig.named == 1; }));
  // A sample of the canceller comes after several of the stranger's each time.
  Tick tick = kGenuine;
  ASSERT_TRUE(eventually([&] {
    for (int i = 0; i < 5; ++i) stranger.command(kForeign * 1000);
    canceller.command(++tick);
    return rig.newest > kGenuine + 20;
  }));
  EXPECT_LE(rig.newest, tick);
  EXPECT_THAT(rig.seconds(), testing::ElementsAre("stillhand/motor_command stillhand/1/stranger"));
  EXPECT_FALSE(rig.bus.peers_alive());
  EXPECT_STREQ(rig.bus.why_not_alive(),
               "a second writer of stillhand/motor_command: stillhand/1/stranger");
}

/// Writes a status and an event of rig 1 in a process's name.
struct Reporter {
  explicit Reporter(const std::string& service) : bus(options_of(service)) {
    statuses = bus.publisher<stillhand_msgs::ServiceStatus>(topics::kServiceStatus);
    events = bus.publisher<stillhand_msgs::Event>(topics::kEvent);
    bus.start();
  }
  void report(const std::string& service, Tick tick) {
    stillhand_msgs::ServiceStatus status;
    status.service(service);
    status.tick(tick);
    statuses.write(status);
    stillhand_msgs::Event event;
    event.source(service);
    event.tick(tick);
    events.write(event);
  }
  Bus bus;
  Publisher<stillhand_msgs::ServiceStatus> statuses;
  Publisher<stillhand_msgs::Event> events;
};

TEST_F(OneSourceTest, AProcesssWordIsTakenFromItsParticipantAlone) {
  Commander canceller("cancellation");
  Reporter stranger("stranger"), genuine("rig");
  std::atomic<Tick> status{-1}, event{-1};
  std::atomic<int> foreign{0};
  constexpr Tick kForeign = 1'000'000'000;
  const auto take = [&](std::atomic<Tick>& newest) {
    return [&](const auto& message, const Arrival&) {
      newest = message.tick();
      if (message.tick() >= kForeign) ++foreign;
    };
  };
  Bus reader(options_of("experiment"));
  reader.subscribe<stillhand_msgs::ServiceStatus>(topics::kServiceStatus, take(status));
  reader.subscribe<stillhand_msgs::Event>(topics::kEvent, take(event));
  reader.start();
  std::vector<Source> sources;
  for (const std::string_view service : topics::kServices) {
    sources.push_back({std::string(service), canceller.bus.participant()});
    if (service == "rig") sources.back().participant = genuine.bus.participant();
    if (service == "experiment") sources.back().participant = reader.participant();
  }
  ASSERT_TRUE(eventually([&] { return reader.report().front().matched == 2; }));
  ASSERT_TRUE(reader.take_sources(reader.participant(), sources));
  Tick tick = 0;
  ASSERT_TRUE(eventually([&] {
    for (int i = 0; i < 5; ++i) stranger.report("rig", kForeign);
    genuine.report("motion", kForeign);  // one process for another
    genuine.report("rig", ++tick);
    return std::min(status.load(), event.load()) > 20;
  }));
  EXPECT_EQ(foreign, 0);
}

TEST_F(OneSourceTest, AProcessListensToTheExperimentThatStartedItAlone) {
  Commander canceller("cancellation");
  auto others = options_of("rig");
  others.experiment = canceller.bus.participant();  // not this test's experiment
  Rig rig(others);
  name_sources(canceller);
  ASSERT_TRUE(eventually([&] { return rig.named == -1; }));
  EXPECT_STREQ(rig.bus.why_not_alive(), "the session has not named its sources");
}

/// Writes a model of rig 1, then an event, which needs no name.
struct Modeller {
  explicit Modeller(std::string name) : service(std::move(name)), bus(options_of(service)) {
    models = bus.publisher<stillhand_msgs::FeedthroughModel>(topics::kFeedthroughModel);
    events = bus.publisher<stillhand_msgs::Event>(topics::kEvent);
    bus.start();
  }
  void write(std::int32_t number) {
    stillhand_msgs::FeedthroughModel model;
    model.model(number);
    models.write(model);
    stillhand_msgs::Event event;
    event.source(service);
    events.write(event);
  }
  std::string service;
  Bus bus;
  Publisher<stillhand_msgs::FeedthroughModel> models;
  Publisher<stillhand_msgs::Event> events;
};

// A model is written once.  A process that starts late may receive it before the sources.
TEST_F(OneSourceTest, AStateThatCameBeforeTheSourcesIsJudgedByThem) {
  Commander canceller("cancellation");
  Modeller stranger("stranger"), genuine("identification");
  std::mutex mutex;
  std::vector<std::int32_t> models;
  std::atomic<int> events{0};
  Bus reader(options_of("experiment"));
  reader.subscribe<stillhand_msgs::FeedthroughModel>(topics::kFeedthroughModel,
                                                     [&](const auto& message, const Arrival&) {
                                                       const std::lock_guard lock(mutex);
                                                       models.push_back(message.model());
                                                     });
  reader.subscribe<stillhand_msgs::Event>(topics::kEvent,
                                          [&](const auto&, const Arrival&) { ++events; });
  reader.start();
  const auto received = [&] {
    const std::lock_guard lock(mutex);
    return models;
  };
  ASSERT_TRUE(eventually([&] { return reader.report().front().matched == 2; }));
  stranger.write(7);
  genuine.write(3);
  ASSERT_TRUE(eventually([&] { return events == 2; }));
  EXPECT_THAT(received(), testing::IsEmpty());
  std::vector<Source> sources;
  for (const std::string_view service : topics::kServices) {
    sources.push_back({std::string(service), canceller.bus.participant()});
    if (service == "identification") sources.back().participant = genuine.bus.participant();
    if (service == "experiment") sources.back().participant = reader.participant();
  }
  ASSERT_TRUE(reader.take_sources(reader.participant(), sources));
  EXPECT_TRUE(eventually([&] { return !received().empty(); }));
  genuine.write(4);
  EXPECT_TRUE(eventually([&] { return received().back() == 4; }));
  EXPECT_THAT(received(), testing::ElementsAre(3, 4));
}

// A session that is complete waits for this name too.
TEST_F(OneSourceTest, AProcessIsNotReadyBeforeTheSourcesAreNamed) {
  Bus sensing(options_of("sensing"));
  sensing.start();
  EXPECT_THAT(sensing.missing_peers(),
              testing::ElementsAre("experiment (to name the session's sources)"));
  auto answers = options_of("sensing");
  answers.answers_replay = true;
  Bus of_a_replay(answers);
  of_a_replay.start();
  EXPECT_THAT(of_a_replay.missing_peers(), testing::IsEmpty());
}

}  // namespace
}  // namespace stillhand::runtime

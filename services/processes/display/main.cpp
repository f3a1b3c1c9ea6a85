// SPDX-License-Identifier: Apache-2.0
#include "services/processes/display/screen_loop.hpp"
#include "services/system/command_line/command_line.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  bool headless = false;
  display::ScreenOptions screen;
  return runtime::run_service(
      "display", argc, argv,
      [&](runtime::Service& service) {
        screen.window = !headless;
        display::Shell shell(service);
        display::ScreenLoop loop(shell, screen);
        service.run([&] { loop.run(); });
      },
      [&](command_line::Command& cli, runtime::ServiceOptions&) {
        cli.add_flag("--headless", headless, "no window");
        cli.add_option("--video", screen.video, "write the screen to this .avi file");
        cli.add_flag("--pointer", screen.pointer, "a person tracks with the mouse over the window");
        cli.add_option(
            "--gamepad", screen.gamepad,
            "with --pointer: input device of a gamepad or joystick, in place of the mouse");
        cli.add_option("--rig-parts", screen.rig,
                       "words on the screen's lower edge: which parts of the rig are devices");
      });
}

#pragma once

namespace etendue {

/// The documented exit code of an interrupted program.
inline constexpr int kInterruptedExitCode = 130;

/// From now on SIGINT, SIGTERM and SIGHUP only make interrupted() true, however often they come: what is being written
/// gets written. One that was ignored, as under nohup, stays ignored.
void catch_interrupts();

/// Whether the user asked the program to stop.
bool interrupted();

}  // namespace etendue

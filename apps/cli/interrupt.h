#pragma once

namespace etendue {

/// The documented exit code of an interrupted program.
inline constexpr int kInterruptedExitCode = 130;

/// From now on the first SIGINT or SIGTERM only makes interrupted() true; the second ends the program at once.
void catch_interrupts();

/// Whether the user asked the program to stop.
bool interrupted();

}  // namespace etendue

// The command line of the command sdm.
#pragma once

/// Runs the subcommand that the arguments name. Returns the exit code.
int run_command_line(int argc, char** argv);

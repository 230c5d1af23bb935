"""One file for each subcommand: `HELP`, `add_arguments(parser)`, `run(arguments) -> exit code`."""

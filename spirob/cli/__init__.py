"""The command `spirob`; each file in `commands/` is one subcommand."""

"""One file for each subcommand: `HELP`, `add_arguments(parser)`, `run(arguments) -> exit code`.

`ORDER` (60 if absent) is its place in the list of commands.  A file named like a keyword of Python
ends in an underscore: `import_.py` is `spirob import`.
"""

"""The command `spirob`: a file in `commands/` is a subcommand; these are its exit codes."""

DONE = 0  # whatever the verdict is
BUG = 1  # of ours: a traceback is shown
MISTAKE = 2  # of the user's: said in one sentence on stderr
STOPPED = 130  # by Ctrl-C or SIGTERM; nothing is left half-written

MEANINGS = {
    DONE: "done",
    BUG: "a bug of ours, with its traceback",
    MISTAKE: "a mistake, said in one sentence",
    STOPPED: "stopped by Ctrl-C",
}

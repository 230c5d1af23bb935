"""What the command's exit codes mean."""

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

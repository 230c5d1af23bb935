"""The command `spirob`: a file in `commands/` is a subcommand; all exit codes are defined here.

main.py        the entry: finds the subcommands, turns errors into sentences
project.py     the folder of the pipeline's commands, and the choices in params.yaml
reproduce.py   runs the pipeline
doc_tables.py  tables of the docs that are made from the program
"""

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

"""Plays logs in what was exported, by a player beside it; none imports anything of ours.

A player has `play(folder, about, given)`: the folder that was exported to, what is said of it, and
arrays by name; it returns arrays by name.

Run apart from the project: python -I alone.py PLAYER FOLDER GIVEN.npz RESULT.npz
"""
# mypy: ignore-errors

import argparse
import json
import runpy
from pathlib import Path

import numpy as np


def main():
    """Play what is given and keep the result."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("player", help="name of a file beside this one")
    parser.add_argument("folder", type=Path, help="that was exported to")
    parser.add_argument("given", type=Path, help="an .npz: logs to play")
    parser.add_argument("result", type=Path, help="an .npz: what was played")
    asked = parser.parse_args()
    given = dict(np.load(asked.given))
    about = json.loads(str(given.pop("about")))
    player = runpy.run_path(str(Path(__file__).with_name(f"{asked.player}.py")))
    np.savez(asked.result, **player["play"](asked.folder, about, given))


if __name__ == "__main__":
    main()

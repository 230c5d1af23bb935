"""Stage `ask`: play the trials that tell rivals apart or prove a name, on the robot itself.

It knows the robot and nothing of the models; the stage `decide` sees the logs and nothing of the
robot.  Real hardware is never driven from here: what to record is said.
"""

from pathlib import Path

from pipeline.robots import record_all
from pipeline.stage import ASKED, HIDDEN, entry, public_config, read_json, read_yaml, tell
from spirob.diagnosis.followup import Question


def stage(root: Path) -> None:
    """Record what the diagnosis asks for; data/asked stays empty where it asks for nothing."""
    config = public_config(root)
    question = Question.from_dict(read_json(root / "data/search/question.json", "diagnose"))
    (root / ASKED).mkdir(parents=True, exist_ok=True)
    trials = [t for one in question.wanted for t in one.trials]
    if not trials:
        tell("nothing to ask: nothing was found, or no experiment would show it")
    elif config.robot.kind == "can":
        first = question.wanted[0]
        names = ", ".join(t["name"] for t in first.trials)
        tell(
            f"to make sure, record '{first.name}' ({names}): next_trials in "
            "data/diagnosis/diagnosis.json, to add to the experiment's trials"
        )
    else:
        hidden = read_yaml(root / HIDDEN, "config") or {}
        record_all(root, config, hidden, trials, ASKED)


if __name__ == "__main__":
    entry("ask", stage, __doc__)

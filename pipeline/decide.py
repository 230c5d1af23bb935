"""Stage `decide`: judge again with the trials that were asked for; the diagnosis that stands.

Names that do not hold under a softer pull are taken away.  Where nothing was asked, nothing could
be played, or what was played tells nothing of those in question, the diagnosis stands as it is.
"""

import shutil
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from pipeline.diagnose import model_of, settings_of
from pipeline.model import plant, residual
from pipeline.overlay import motion, overlay
from pipeline.stage import ASKED, entry, public_config, read_json, tell, write_json
from pipeline.switches import laws
from spirob.diagnosis.again import decided_again, joined
from spirob.diagnosis.contest import Contestant, in_question
from spirob.diagnosis.document import described, document, metrics
from spirob.diagnosis.noise import noise_floor
from spirob.diagnosis.proof import FOUND, Proof, Proofs, disproved, put_to_proof, sifted
from spirob.diagnosis.rungs import Search, Settings
from spirob.diagnosis.survey import KEYS
from spirob.diagnosis.verdict import Verdict, judge
from spirob.identify.measurement import Measurement
from spirob.identify.residual import Residual
from spirob.logs import read_log

SEARCH, OUT = Path("data/search"), Path("data/diagnosis")
# what a diagnosis goes on saying once it is decided again
KEPT = ("vague", "asked")
DONE: dict[str, Any] = {"next_experiment": "", "next_trials": []}


def stage(root: Path) -> None:
    """Write data/diagnosis and its metrics."""
    config = public_config(root)
    read_json(root / SEARCH / "diagnosis.json", "diagnose")
    shutil.copytree(root / SEARCH, root / OUT, dirs_exist_ok=True)
    contest = read_json(root / SEARCH / "contest.json", "diagnose")
    found = read_json(root / SEARCH / "metrics.json", "diagnose")
    models: Sequence[Contestant] = [Contestant.from_dict(one) for one in contest["models"]]
    asked, proving = (_played(root, one) for one in (contest, contest["proof"]))
    if asked or proving:
        model = plant(config, list(dict.fromkeys(e for one in models for e in one.effects)))
        own = {r: residual(root, config, model, r) for r in ("train", "validate", "heldout")}
        settings = settings_of(config)
        if asked:
            again = _again(root, contest["experiment"], models, own, asked, settings)
            found, models = again or (found, models)
        if proving and found["verdict"] in FOUND:
            known = joined(own, proving)
            proofs = put_to_proof(contest["proof"]["experiment"], models, own, known, settings)
            found = _sifted(root, found, models, proofs, own, settings)
    write_json(root / "reports/metrics/diagnose.json", found)


def _played(root: Path, experiment: dict[str, Any]) -> dict[str, list[Measurement]]:
    """The logs of an experiment by role; none where it was not played, or not to its end."""
    logs = {root / ASKED / f"{t['name']}.mcap": t["role"] for t in experiment["trials"]}
    found: dict[str, list[Measurement]] = {}
    if all(log.exists() for log in logs):
        for log, role in logs.items():
            found.setdefault(role, []).append(Measurement.from_trace(read_log(log)))
    return found


def _again(
    root: Path,
    experiment: str,
    models: Sequence[Contestant],
    own: Mapping[str, Residual],
    further: Mapping[str, Sequence[Measurement]],
    settings: Settings,
) -> tuple[dict[str, Any], Sequence[Contestant]] | None:
    """Metrics once the contest is decided, and the models without any effect and with the winner's;
    none where the experiment tells nothing of the contestants."""
    before = read_json(root / SEARCH / "diagnosis.json", "diagnose")
    search = decided_again(models, own, joined(own, further), settings, before["verdict"])
    asked = {"experiment": experiment, "before": before["sentence"]}
    if search is None:
        aside = {**before, **DONE, "asked": {**asked, "aside": True}}
        write_json(root / OUT / "diagnosis.json", aside)
        tell(f"'{experiment}' does not tell which it is; the verdict stands")
        return None
    verdict = judge(search, own, settings)
    found = _written(root, search, verdict, own, {"asked": asked})
    tell(f"after '{experiment}': {verdict.sentence}")
    return found, in_question(search, verdict)


def _written(
    root: Path,
    search: Search,
    verdict: Verdict,
    own: Mapping[str, Residual],
    more: Mapping[str, Any],
) -> dict[str, Any]:
    """Metrics of a contest that was settled, which is the diagnosis from now on."""
    before = read_json(root / OUT / "diagnosis.json", "decide")
    kept = {key: before[key] for key in KEPT if key in before}
    effort = own["train"].effort
    where = {key: before[key] for key in KEYS if key in before}
    now = document(search, verdict, where, noise_floor(own["train"]), own)
    write_json(root / OUT / "diagnosis.json", {**now, **kept, **more})
    _model(root, own, search.rungs[0].fit.changes, model_of(search, verdict))
    if verdict.kind == "named":
        laws(root / OUT, own, search, True)
    return metrics(search, verdict, effort)


def _sifted(
    root: Path,
    found: dict[str, Any],
    models: Sequence[Contestant],
    proofs: Proofs,
    own: Mapping[str, Residual],
    settings: Settings,
) -> dict[str, Any]:
    """Metrics of what is left once every name was put to the proof."""
    search, name = sifted(models, proofs, own, settings), models[1].effects
    if search is not None:
        verdict, name = judge(search, own, settings), tuple(search.rungs[-1].effects)
        found = _written(root, search, verdict, own, {})
        tell(f"of those that hold: {verdict.sentence}")
    return _proved(root, found, models[0], proofs[frozenset(name)], own)


def _proved(
    root: Path,
    found: dict[str, Any],
    base: Contestant,
    proof: Proof,
    own: Mapping[str, Residual],
) -> dict[str, Any]:
    """Metrics once what was found was put to the proof; without its name where it did not hold."""
    before = read_json(root / OUT / "diagnosis.json", "decide")
    after = {**before, "proof": {**asdict(proof), "holds": proof.holds}}
    tell(f"'{proof.experiment}' shows {proof.share:.0%} of the squared error explained")
    if found["verdict"] == "named":
        after |= DONE
    if found["verdict"] == "named" and not proof.holds:
        found = {**found, "verdict": "unknown", "effect": "", "effects": "", "probability": 0.0}
        after |= {"verdict": "unknown", "effects": [], **disproved(before["sentence"], proof)}
        after["explanation"] = described("unknown", after["explanation"], before)
        _model(root, own, base.changes, {"effects": [], "changes": dict(base.changes)})
        tell(after["sentence"])
    write_json(root / OUT / "diagnosis.json", after)
    return found


def _model(
    root: Path, own: Mapping[str, Residual], base: Mapping[str, float], stands: dict[str, Any]
) -> None:
    """The model that stands, and what it does in the trials, beside the one without any effect."""
    write_json(root / OUT / "model.json", stands)
    overlay(root / OUT, own, base, stands["changes"])
    motion(root / OUT, own, stands["changes"])


if __name__ == "__main__":
    entry("decide", stage, __doc__)

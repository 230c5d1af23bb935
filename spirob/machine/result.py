"""What a diagnosis found: verdict, findings, tables, and the page that shows them."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd

from spirob.effects import Effect, all_effects
from spirob.files import may_hold_results, named, refusals_told, replacing, write_text
from spirob.machine.composed import Composed
from spirob.machine.laws import by_module


@dataclass(frozen=True)
class Finding:
    """An effect that is needed.

    probability  that the name is right;  together  that it or one of its rivals is
    equivalents  effects that say the same on this rig
    rivals       those that explain it as well, or that make most of what it makes
    numbers      name -> value, low, high (95 %), unit
    """

    name: str
    title: str
    probability: float
    together: float
    equivalents: tuple[str, ...]
    rivals: tuple[str, ...]
    numbers: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Sources:
    """What a diagnosis was made from: the description's text, files read, command to repeat it."""

    config: str = ""
    files: tuple[Path, ...] = ()
    command: str = ""


@dataclass(frozen=True)
class Diagnosis:
    """Everything that a diagnosis found.

    document    plain data, as `diagnosis.json` holds it
    overlay     rows of samples: trial, role, time, position, measured, base, named
    parameters  of the bare model, for the page;  identifiability  what the logs say of them
    laws        rows of held-out samples: what each named effect does there
    motion      measured and predicted motion; None where the rig does not ask for it
    law         composed for what no name explains; None where nothing is left, or nothing held
    heldout     the held-out logs and what the model that stands says of them; see `standing`
    strange     logs that fit no other, which alone make the verdict doubtful
    """

    document: dict[str, Any]
    overlay: pd.DataFrame
    parameters: dict[str, Any]
    identifiability: str
    laws: pd.DataFrame
    motion: pd.DataFrame | None = None
    law: Composed | None = None
    heldout: pd.DataFrame | None = None
    sources: Sources = field(default_factory=Sources)
    strange: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """named, undecided, nothing_missing or unknown."""
        return str(self.document["verdict"])

    @property
    def sentence(self) -> str:
        """The verdict in a sentence."""
        return str(self.document["sentence"])

    @property
    def explanation(self) -> str:
        """Why, with the figures."""
        return str(self.document["explanation"])

    @property
    def next_experiment(self) -> str:
        """What to measure next; empty where nothing would change the verdict."""
        return str(self.document["next_experiment"])

    @property
    def composed(self) -> pd.DataFrame | None:
        """Rows of held-out samples of a composed law, for the page."""
        return None if self.law is None else self.law.drawing

    @property
    def library(self) -> dict[str, type[Effect]]:
        """The library's laws, those of the model that stands as it holds them, for the page.

        The model of an arm names its effects alone, which are the library's.
        """
        known = by_module()
        held = self.document.get("model", {}).get("effects", [])
        own = (e for e in held if not isinstance(e, str) and e["source"] in known)
        return all_effects() | {e["name"]: known[e["source"]] for e in own}

    @property
    def notes(self) -> list[str]:
        """What was repaired, left out or found odd in logs and description."""
        return list(self.document["repairs"])

    @property
    def findings(self) -> list[Finding]:
        """The named effects, or those between which nothing is decided."""
        return [
            Finding(
                e["name"],
                e["title"],
                e["probability"],
                e.get("together", e["probability"]),
                tuple(e["equivalents"]),
                tuple(e["rivals"]),
                e["parameters"],
            )
            for e in self.document["effects"]
        ]

    @property
    def ladder(self) -> pd.DataFrame:
        """A row for each model: label, effects, and mae, rmse, r2 on train and test."""
        rows = []
        for rung in self.document["ladder"]:
            row = {"label": rung["label"], "effects": rung["effects"]}
            for role in ("train", "test"):
                row |= {f"{role}_{name}": rung[role][name] for name in ("mae", "rmse", "r2")}
            rows.append(row)
        return pd.DataFrame(rows)

    @property
    def candidates(self) -> pd.DataFrame:
        """A row for each effect that was considered, the most probable first."""
        return pd.DataFrame(self.document["candidates"])

    @property
    def atlas(self) -> pd.DataFrame:
        """A row for each regime of the motion: its share of time and of the error, bias, rmse."""
        return pd.DataFrame(self.document["atlas"])

    def save(self, folder: Path | str) -> Path:
        """Write `diagnosis.json`, `heldout.parquet`, the page and the file of a composed law.

        Each is written whole or not at all.  Raises DataError, in a sentence, where the system
        refuses it: the folder is a file or closed, or there is no room.
        """
        out = Path(named(folder))
        with refusals_told():
            self._write(out)
        return out

    def _write(self, out: Path) -> None:
        from spirob.report import build_rig_page

        may_hold_results(out)
        out.mkdir(parents=True, exist_ok=True)
        text = json.dumps(self.document, indent=2, ensure_ascii=False, allow_nan=False)
        write_text(out / "diagnosis.json", text + "\n")
        if self.heldout is not None:
            with replacing(out / "heldout.parquet") as temporary:
                self.heldout.to_parquet(temporary, compression="zstd", index=False)
        write_text(out / "index.html", build_rig_page(self))
        if self.law is not None:
            write_text(out / self.law.document["file"], self.law.text)

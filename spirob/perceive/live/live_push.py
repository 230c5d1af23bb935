"""Pushes of an arm whose motors hold their currents, from the samples of both as they come.

What is not heard is not guessed: after `PATIENCE` without a sample of either motor nothing is felt
any more, and the undisturbed current is learned anew.
"""

from collections import deque
from collections.abc import Sequence

import numpy as np
from sklearn.pipeline import Pipeline

from spirob.perceive.live.grid import Sample
from spirob.perceive.passive import PassiveDetector, Response
from spirob.perceive.passive_region import features
from spirob.robot import CYCLE_NS, MOTORS

PATIENCE = 10  # samples


class LivePush:
    """Pairs the motors' samples and tells pushes; `classifier` tells where (`passive_region`)."""

    def __init__(self, classifier: Pipeline):
        self._classifier = classifier
        self.forget()

    def forget(self) -> None:
        """Nothing is felt, nothing has been learned."""
        self._waiting: list[deque[Sample]] = [deque() for _ in MOTORS]
        self._detector = PassiveDetector(period=CYCLE_NS / 1e9)

    @property
    def felt(self) -> bool:
        """Whether a push is being felt."""
        return self._detector.felt

    def take(self, motor: int, samples: Sequence[Sample]) -> list[tuple[str, str]]:
        """Samples of one motor; kinds and words of what is told with them."""
        waiting = self._waiting
        waiting[motor].extend(samples)
        if len(samples) > PATIENCE or max(map(len, waiting)) > PATIENCE:
            told = [("no push", "feedback is missing; it listens anew")] if self.felt else []
            self.forget()
            return told
        found: list[tuple[str, str]] = []
        while all(waiting):
            pair = [one.popleft() for one in waiting]
            before = self.felt
            response = self._detector.update(
                [s.current for s in pair], [s.displacement for s in pair]
            )
            if self.felt and not before:
                found.append(("push", "felt"))
            if response is not None:
                found.append(("push", self._where(response)))
        return found

    def _where(self, response: Response) -> str:
        shares = self._classifier.predict_proba([features(response)])[0]
        k = int(np.argmax(shares))
        peak = 1e3 * float(response.peak.max())
        return f"{self._classifier.classes_[k]} ({shares[k]:.0%}), {peak:.0f} mA at most"

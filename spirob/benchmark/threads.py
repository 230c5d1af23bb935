"""Two threads that simulate in parallel over one: the compiled loop runs without the GIL."""

from concurrent.futures import ThreadPoolExecutor

from spirob.benchmark.trials import winding
from spirob.benchmark.turns import Size, in_turns, ratio
from spirob.plant import Plant, Rig
from spirob.robot import Scene

TRIALS = 8


def measure(size: Size) -> dict[str, float]:
    """`two_threads_over_one` [-]: throughput of two threads over that of one."""
    plant = Plant(Rig())
    schedule = winding(size.seconds)

    def play(_: int) -> None:
        plant.simulate(schedule, Scene())

    with ThreadPoolExecutor(1) as one, ThreadPoolExecutor(2) as two:
        work = {
            "one": lambda: list(one.map(play, range(TRIALS))),
            "two": lambda: list(two.map(play, range(TRIALS))),
        }
        taken = in_turns(work, size.repeats)
    return {"two_threads_over_one": ratio(taken, "one", "two")}

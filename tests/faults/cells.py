# SPDX-License-Identifier: Apache-2.0
"""The grid of the campaign: who is hit, by what, and when; and the order in which its cells run."""
import dataclasses
import fnmatch
import random

VICTIMS = ("rig", "sensing", "motion", "cancellation", "display", "human_operator", "identification", "recorder",
           "experiment")
KINDS = ("kill", "stop", "stop5", "stop50", "stop500", "busy", "restart")
PHASES = ("pegged", "ramp", "A", "B", "C", "C+", "fading", "pause")
# The victim does not come back by itself: the session cannot go on.
FATAL = ("kill", "stop", "busy", "restart")
PAIR_EVERY = 13  # among so many runs there is one with two faults
WHOLE_GRID = len(VICTIMS) * len(KINDS) * len(PHASES)  # 504
DEFAULT_RUNS = WHOLE_GRID + WHOLE_GRID // (PAIR_EVERY - 1)


@dataclasses.dataclass(frozen=True)
class Cell:
    victims: tuple
    kinds: tuple
    phase: str

    @property
    def name(self):
        return "/".join(("+".join(self.victims), "+".join(self.kinds), self.phase))

    @property
    def fatal(self):
        return any(kind in FATAL for kind in self.kinds)

    def hits(self, victim, *kinds):
        return any(hit == victim and kind in kinds for hit, kind in zip(self.victims, self.kinds))


def nth(number):
    """9, 7 and 8 have no factor in common: 504 numbers in a row give each cell once, and any few all of each axis."""
    return Cell((VICTIMS[number % len(VICTIMS)],), (KINDS[number % len(KINDS)],), PHASES[number % len(PHASES)])


def pair(number, rng):
    victims = tuple(rng.sample(VICTIMS, 2))
    return Cell(victims, tuple(rng.choice(KINDS) for _ in victims), PHASES[number % len(PHASES)])


def plan(runs, seed, pattern="*"):
    """The cells of a campaign, in order; those of a pattern alone, as often as `runs` asks for."""
    rng = random.Random(seed)
    cells = [pair(number, rng) if number % PAIR_EVERY == PAIR_EVERY - 1 else nth(number - number // PAIR_EVERY)
             for number in range(max(runs, DEFAULT_RUNS))]
    matching = [cell for cell in cells if fnmatch.fnmatchcase(cell.name, pattern)]
    if not matching:
        return []
    return (matching * (runs // len(matching) + 1))[:runs]

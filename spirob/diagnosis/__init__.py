"""Compare model and measurement, see where it fails, name the missing effect, add it.

What it works on:
    model.py                   fitted sets of effects, and what a search ends with; which are laws
                               of dry friction
    fitting.py, simulated.py   those of an arm, by simulation
The search:
    screen.py                  which absent effects could explain what is left, alone or together
    orders.py, spectrum.py     waves that come round with a turn
    regression.py              linear regression within bounds, fold by fold
    search.py                  what is added, taken back, exchanged
    rivals.py                  which laws could stand in the place of another
    criteria.py                when an effect is worth its place: errors on trials that no fit has
                               seen, above the sensors' noise, and what they have to show
The verdict:
    contest.py                 who stands beside what was found
    proposals.py, followup.py  which trial tells them apart; ask, play, decide
    certainty.py               how sure a name is, of the figures in `certainty.json`
    conclusion.py              what stands of a search, each effect so sure
    verdict.py                 one of four verdicts, in words
What is shown besides:
    atlas.py                   which regimes hold the error
    flexible.py                what any law could still explain, by boosted trees
    schema.py, document.py     what `diagnosis.json` holds, and how it is made
"""

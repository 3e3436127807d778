"""The fuzz covers the public surface: every public call is among those that are made with hostile values."""

import random

import pytest

import rigidarea as ra
from harness import hostile
from harness.texts import command_line, drawing, map_text, scene_text
from rigidarea import bring, flexible, shapes

#: Public callables that the fuzz does not make, and why.
LEFT_OUT = {
    "rigidarea.AreaContact": "made by attach",
    "rigidarea.Plan": "made by plan",
    "rigidarea.SimulationError": "is raised",
    "rigidarea.backend": "takes nothing",
    "shapes.Geneva": "a record of what geneva made",
    "bring.Element": "a record of what a drawing holds",
    "bring.Scene": "a record of what a file held",
    "flexible.Body": "a record; Simulation checks it",
    "flexible.Record": "a record of a run",
    "flexible.Simulation": "what Mechanism runs, with the same arguments",
    "flexible.recover": "of a run, by numbers from Record",
    "flexible.solve": "of two boundaries that elastic_body made",
}


def public():
    for name, module in (("rigidarea", ra), ("shapes", shapes), ("bring", bring), ("flexible", flexible)):
        for public_name in module.__all__:
            if callable(getattr(module, public_name)):
                yield f"{name}.{public_name}"


def test_every_public_call_is_made():
    trial = hostile.Trial(0)
    made = {name.split("(")[0] for name, _ in trial.calls()}
    heads = made | {f"rigidarea.{name}" for name in made} | {name.rpartition(".")[0] for name in made}
    missing = [name for name in public() if name not in heads and name.rpartition(".")[2] not in heads]
    assert set(missing) == set(LEFT_OUT)


@pytest.mark.parametrize(
    "name", ["step", "stiffness", "penetration", "ask", "refresh", "regions", "energy", "detach"]
)
def test_every_use_of_a_contact_is_made(name):
    assert any(made.startswith(f"contact.{name}") for made, _ in hostile.Trial(0).calls())
    assert hasattr(ra.AreaContact, name)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_calls_of_the_rest_of_the_surface(seed):
    rows = hostile.fuzz(1500, seed=seed)
    assert [text for row in rows for text in row["wrong"]] == []


def test_a_refusal_that_says_nothing_is_wrong(monkeypatch):
    """Python's own words do not say of which argument they speak; a call that changes the space must not be refused."""

    def says_nothing():
        raise TypeError("must be real number, not dict")

    def changes(trial):
        next(iter(trial.space.bodies)).mass = 3
        raise ValueError("expected something else")

    def spoils(trial):
        next(iter(trial.space.bodies)).velocity = float("nan"), 0

    for call, word in (
        (lambda t: says_nothing(), "TypeError"),
        (changes, "has changed"),
        (spoils, "not finite"),
    ):
        monkeypatch.setattr(hostile.Trial, "calls", lambda self, call=call: [("one", lambda: call(self))])
        (row,) = hostile.fuzz(3)
        assert len(row["wrong"]) >= 1 and word in row["wrong"][0]


def test_texts_are_drawn_from_the_seed():
    for make in (scene_text, map_text, drawing, command_line):
        assert make(random.Random(3)) == make(random.Random(3))
        assert len({str(make(random.Random(seed))) for seed in range(30)}) > 10

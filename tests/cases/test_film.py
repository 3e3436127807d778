"""``--film``: a still and a film of stresses, and what it refuses."""

import argparse

import numpy as np
import pytest

from rigidarea import cases
from rigidarea.cases import stress_film


def arguments(*words, out=None):
    parser = argparse.ArgumentParser()
    cases.add_arguments(parser)
    args = parser.parse_args(words)
    args.out = out
    return args


def test_refused(tmp_path):
    for words, out in (
        (("patch", "--film"), tmp_path),
        (("geneva", "--film", "--mode", "rigid"), tmp_path),
        (("geneva", "--film"), None),
    ):
        with pytest.raises(ValueError, match="--film draws stresses that change"):
            cases.run(arguments(*words, out=out))
    assert not list(tmp_path.iterdir())


def test_hertz_still_and_film(tmp_path):
    pytest.importorskip("imageio")
    scene = stress_film.hertz(None, division=4, frames=3)
    stress_film.still(scene, tmp_path)
    path = stress_film.film(scene, tmp_path)
    assert (tmp_path / "hertz_stress.png").stat().st_size > 20_000
    assert path.exists() and path.stat().st_size > 1000
    # the pressure drawn is that of the case: the force, over the deepest of the three
    states, loads = scene.states[-1], scene.loads[-1]
    assert loads[0][:, 2].sum() == pytest.approx(-10.0, rel=1e-3)
    assert loads[1][:, 2].sum() == pytest.approx(10.0, rel=1e-3)
    pictures = list(stress_film.frames(scene))
    assert len(pictures) == 3 and all(p.ndim == 3 for p in pictures)
    assert np.abs(pictures[0].astype(int) - pictures[2]).mean() > 1.0  # it moves
    assert len(states) == 2

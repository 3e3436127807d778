"""Which instant of the gearbox is drawn."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from rigidarea.cases.gearbox_figures import _three_pairs


def test_an_instant_with_three_pairs_is_looked_for_in_records_that_have_room_for_fewer():
    rows = [[5.0, 4.0], [9.0], [6.0, 0.5, 5.0], [6.0, 2.0, 5.0]]
    seen = iter(rows)

    def run(duration: float, h: float) -> SimpleNamespace:
        force = next(seen)
        return SimpleNamespace(regions=np.array([[[f, 0.0, 1.0, 0.0, 0.0] for f in force]]))

    found = _three_pairs(SimpleNamespace(run=run))
    assert found[:, 0].tolist() == rows[-1]

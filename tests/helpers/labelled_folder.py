"""A folder of recordings, of which only the names count, and a label table of made-up rows."""

from __future__ import annotations

import numpy as np

from noise.base.labels import LABELS
from noise.base.tables import write_table
from noise.labels.table import COLUMNS


def made_row(name, label="none", start=0.0, end=2.0, **more):
    """Return a row by the classifier."""
    found = dict.fromkeys(COLUMNS) | {"file": name, "channel": "all", "label": label}
    found |= {"start_s": start, "end_s": end, "label_source": "classifier", "p_creak": 0.25}
    return found | more


def write_folder(folder, names, rows=None):
    """Write what stands for recordings, and their label table where there are rows."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in names:
        (folder / name).write_bytes(b"no sound")
    if rows is not None:
        write_table(folder / "labels.csv", COLUMNS, rows)
    return folder


def many_rows(names, rng):
    """Two segments for each recording, with probabilities, frequencies and levels."""
    rows = []
    for name in names:
        for start, end in ((0.0, 2.0), (2.0, 5.0)):
            p = dict(
                zip(LABELS, rng.dirichlet(np.ones(len(LABELS))).round(6).tolist(), strict=True)
            )
            numbers = {
                "frequency_hz": float(rng.uniform(50.0, 3000.0)),
                "level_dba": float(rng.uniform(30.0, 90.0)),
                **{f"p_{label}": share for label, share in p.items()},
            }
            rows.append(made_row(name, max(p, key=p.get), start, end, **numbers))
    return rows

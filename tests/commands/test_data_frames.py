"""Every table object gives a data frame of pandas, in the columns of the file it is written to."""

import io
import sys

import numpy as np
import pytest

import noise
from features.modal.modes import Modes
from models.errors import ParameterError
from models.transfer_functions.files import write_transfer_function_csv
from models.transfer_functions.transfer_function import TransferFunction
from noise.diagnosis.findings import EffectFinding
from noise.diagnosis.outcome import Diagnosis
from noise.identification.outcome import Identification, Number
from noise.labels.segments import Segment
from noise.labels.table import COLUMNS
from noise.screening.design.design import Use

pytest.importorskip("pandas")

SEGMENT = Segment("all", 0.0, 1.0, "creak", {"creak": 0.9}, 152.0, 78.0, None)
MODES = Modes(np.ones(2), np.ones(2), np.ones((1, 2)), np.zeros((1, 4)), np.ones(2, int), 9.0)
NUMBER = Number("elastomer_stiffness", "Nm/rad", 665.0, 655.0, 675.0, 6, 0.279e-3)
HUM = EffectFinding("mains_hum", "measurement", 0.97)
DIAGNOSIS = Diagnosis(
    ("mains_hum",), (), None, {}, (HUM,), {"mains_hum": 0.97}, {}, "", (), 5.0, 1.0, 1e-6, 2.0
)
TABLES = {
    "labels": (noise.LabelTable([{"file": "a.wav", "label": "creak", "level_db": 70.0}] * 3), 3),
    "segments": (noise.Segments([SEGMENT, SEGMENT]), 2),
    "modes": (MODES, 2),
    "identification": (Identification("", (NUMBER,), (), "constant", ()), 1),
    "diagnosis": (DIAGNOSIS, 1),
    "response": (TransferFunction(np.arange(1.0, 6.0), np.ones(5) + 2j, np.ones(5)), 5),
}


@pytest.mark.parametrize("name", TABLES)
def test_a_table_is_a_frame_of_as_many_rows(name):
    table, rows = TABLES[name]
    frame = table.to_pandas()
    assert len(frame) == rows
    assert len(set(frame.columns)) == len(frame.columns)


def test_a_label_table_keeps_its_columns_and_its_numbers_are_numbers():
    frame = TABLES["labels"][0].to_pandas()
    assert tuple(frame.columns) == COLUMNS
    assert frame["level_db"].mean() == 70.0
    assert set(TABLES["segments"][0].to_pandas().columns) < set(COLUMNS)


def test_a_sweep_has_a_row_a_run_with_its_condition():
    sweep = noise.sweep(
        noise.load_material_rig("PDMS"), [1.0, 5.0], [[0.2e-3], [0.3e-3]], seconds=0.01
    )
    frame = sweep.to_pandas()
    assert frame["speed_rad_s"].tolist() == [1.0, 5.0, 1.0, 5.0]
    assert frame["interference_mm"].tolist() == [0.2, 0.2, 0.3, 0.3]
    assert frame["torque_mean"].to_numpy() == pytest.approx(sweep["torque_mean"].ravel())


def test_a_bolted_clamp_is_fixed_and_no_number_is_infinite():
    rig = noise.load_material_rig("PDMS")
    frame = noise.sweep(rig, [5.0], support_stiffness=[2214.0, noise.FIXED], seconds=0.01)
    assert frame.to_pandas()["support_stiffness_Nm_rad"].tolist() == [2214.0, "fixed"]


def test_a_response_has_the_columns_of_its_file():
    response, _ = TABLES["response"]
    file = io.StringIO()
    write_transfer_function_csv(file, response)
    assert file.getvalue().splitlines()[0].split(",") == [*response.to_pandas().columns]


def test_a_screening_gives_each_of_its_tables():
    found = noise.screen(["PDMS"], Use(speed=(1.0, 9.0), support_stiffness=(2214.0,)))
    assert found.to_pandas()["design"].tolist() == ["PDMS"]
    assert len(found.to_pandas("map")) == found.points
    with pytest.raises(ParameterError, match="there is no table 'maps'; there are map, "):
        found.to_pandas("maps")


def test_missing_pandas_is_told_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ParameterError, match=r'pip install "bushing-noise\[pandas\]"'):
        TABLES["labels"][0].to_pandas()

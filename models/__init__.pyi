from .calibration import (
    Calibration as Calibration,
)
from .condition import (
    FIXED as FIXED,
    Condition as Condition,
)
from .errors import (
    BushingNoiseError as BushingNoiseError,
    ParameterError as ParameterError,
    RecordingError as RecordingError,
)
from .radiation.sound_power_bands import (
    BandPower as BandPower,
    third_octave_power as third_octave_power,
)
from .recording import (
    CHANNEL_UNITS as CHANNEL_UNITS,
    Channel as Channel,
    Recording as Recording,
)
from .rig import (
    Beams as Beams,
    Fit as Fit,
    Floor as Floor,
    LawSpec as LawSpec,
    Microphone as Microphone,
    Plate as Plate,
    Rig as Rig,
)
from .rig_files.rig_file import (
    load_material_rig as load_material_rig,
    load_rig as load_rig,
)
from .rig_files.shipped import (
    material_names as material_names,
)
from .sensors import (
    Sensor as Sensor,
    Sensors as Sensors,
)
from .structure.beams_exact import (
    natural_frequencies as natural_frequencies,
)
from .structure.beams_fit import (
    AnchorFit as AnchorFit,
    fit_anchors as fit_anchors,
)
from .structure.beams_stiffness import (
    beam_length as beam_length,
    torsional_stiffness as torsional_stiffness,
)
from .structure.beams_waves import (
    ClampOnBeams as ClampOnBeams,
    RootMotion as RootMotion,
)
from .structure.plate import (
    PlateModes as PlateModes,
    plate_modes as plate_modes,
)
from .transfer_functions.files import (
    read_transfer_function as read_transfer_function,
    write_transfer_function as write_transfer_function,
)
from .transfer_functions.measured import (
    MeasuredResponse as MeasuredResponse,
)
from .transfer_functions.transfer_function import (
    TransferFunction as TransferFunction,
)

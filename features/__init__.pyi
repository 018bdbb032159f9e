from .kernels.harmonics import (
    Harmonics as Harmonics,
    analyse_harmonics as analyse_harmonics,
    pitch_track as pitch_track,
)
from .kernels.levels import (
    NOMINAL_THIRD_OCTAVES as NOMINAL_THIRD_OCTAVES,
    REFERENCES as REFERENCES,
    THESIS_BANDS as THESIS_BANDS,
    band_levels as band_levels,
    band_power as band_power,
    third_octave_levels as third_octave_levels,
)
from .kernels.lines import Lines as Lines, find_lines as find_lines
from .kernels.slips import (
    Pulses as Pulses,
    TorqueSlips as TorqueSlips,
    torque_slips as torque_slips,
)
from .kernels.spectra import (
    SpectralShape as SpectralShape,
    Spectrum as Spectrum,
    autospectrum as autospectrum,
    spectral_shape as spectral_shape,
)
from .kernels.weighting import (
    SoundLevels as SoundLevels,
    a_weighted as a_weighted,
    a_weighting as a_weighting,
    sound_levels as sound_levels,
)
from .modal.hammer import (
    Hit as Hit,
    check_hit as check_hit,
    estimate_transfer_function as estimate_transfer_function,
)
from .modal.modal_fit import Modes as Modes, fit_modes as fit_modes
from .table import (
    FEATURES as FEATURES,
    WINDOW_FEATURES as WINDOW_FEATURES,
    Feature as Feature,
    feature_names as feature_names,
    feature_vector as feature_vector,
    features_of as features_of,
    recording_feature_names as recording_feature_names,
    recording_features as recording_features,
)

"""What lies between a source and its recording: room, noise, microphone, recorder, codec, cut."""

from noise.training.classifier.augmentation.backgrounds import background, coloured_noise
from noise.training.classifier.augmentation.codecs import coded, quantised
from noise.training.classifier.augmentation.microphones import (
    clipped,
    levelled,
    through_a_microphone,
)
from noise.training.classifier.augmentation.recorder import (
    RATES,
    Heard,
    as_recorded,
    hear,
    resampled,
)
from noise.training.classifier.augmentation.rooms import in_a_room

__all__ = [
    "RATES",
    "Heard",
    "as_recorded",
    "background",
    "clipped",
    "coded",
    "coloured_noise",
    "hear",
    "in_a_room",
    "levelled",
    "quantised",
    "resampled",
    "through_a_microphone",
]

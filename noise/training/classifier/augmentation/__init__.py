"""Augmentation: the room, noise, microphone, recorder, codec and cut of a recording."""

from noise.training.classifier.augmentation.backgrounds import background, coloured_noise
from noise.training.classifier.augmentation.codecs import coded, quantised
from noise.training.classifier.augmentation.microphones import (
    clipped,
    levelled,
    through_a_microphone,
)
from noise.training.classifier.augmentation.recorder import (
    RATES,
    RecordedSound,
    augmented,
    recorded,
    resampled,
)
from noise.training.classifier.augmentation.rooms import in_a_room

__all__ = [
    "RATES",
    "RecordedSound",
    "augmented",
    "background",
    "clipped",
    "coded",
    "coloured_noise",
    "in_a_room",
    "levelled",
    "quantised",
    "recorded",
    "resampled",
    "through_a_microphone",
]

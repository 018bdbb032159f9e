"""What lies between a source and its recording: room, noise, microphone, recorder, codec, cut."""

from noise.classifier.hearing.backgrounds import background, coloured_noise
from noise.classifier.hearing.codecs import coded, quantised
from noise.classifier.hearing.microphones import clipped, levelled, through_a_microphone
from noise.classifier.hearing.recorder import RATES, Heard, as_recorded, hear, resampled
from noise.classifier.hearing.rooms import in_a_room

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

"""The classifier of noises as it is used: from features of windows to probabilities of labels."""

from noise.base.labels import LABELS
from noise.classifier.model import Classifier, load_classifier

__all__ = ["LABELS", "Classifier", "load_classifier"]

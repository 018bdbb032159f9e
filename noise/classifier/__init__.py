"""Classifier of noises: from features of windows to probabilities of labels."""

from noise.base.labels import LABELS
from noise.classifier.model import Classifier, load_classifier

__all__ = ["LABELS", "Classifier", "load_classifier"]

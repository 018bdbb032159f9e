"""The classifier of noises, and all that it is trained on."""

from noise.classifier.model import LABELS, Classifier, load_classifier

__all__ = ["LABELS", "Classifier", "load_classifier"]

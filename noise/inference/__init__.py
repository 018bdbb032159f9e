"""Conditions that were not logged, inferred from the signal, and all that it is trained on."""

from noise.inference.model import Inference, Inferred, Interval, load_inference

__all__ = ["Inference", "Inferred", "Interval", "load_inference"]

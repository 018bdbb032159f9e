"""Conditions that were not logged, inferred from the signal, and all that it is trained on."""

from noise.inference.model import Inference, Interval, load_inference

__all__ = ["Inference", "Interval", "load_inference"]

"""The inference of conditions that were not logged, as it is used on labelled segments."""

from noise.inference.model import Inference, Inferred, Interval, infer_stretch, load_inference

__all__ = ["Inference", "Inferred", "Interval", "infer_stretch", "load_inference"]

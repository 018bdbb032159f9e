"""Inference of operating conditions that were not logged, from labelled segments.

Values marked "assumed" were chosen by judgement, without a recorded measurement.
"""

from noise.inference.model import Inference, Interval, infer_stretch, load_inference

__all__ = ["Inference", "Interval", "infer_stretch", "load_inference"]

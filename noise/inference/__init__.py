"""The inference of conditions that were not logged, as it is used on labelled segments.

What is "assumed" was chosen by judgement, and no measurement of it is on record.
"""

from noise.inference.model import Inference, Inferred, Interval, infer_stretch, load_inference

__all__ = ["Inference", "Inferred", "Interval", "infer_stretch", "load_inference"]

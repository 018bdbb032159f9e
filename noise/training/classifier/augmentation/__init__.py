"""Augmentation: the room, noise, microphone, recorder, codec and cut of a recording."""

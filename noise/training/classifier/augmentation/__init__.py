"""Augmentation of sounds: room, noise, microphone, recorder, codec and cut."""

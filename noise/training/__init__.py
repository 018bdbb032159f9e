"""Recipes and fits of the shipped models; nothing that labels or diagnoses imports them."""

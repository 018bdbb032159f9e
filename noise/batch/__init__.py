"""Resumable batch processing of recordings, in one process or in several.

However often the work is interrupted, no result is lost or computed twice, and the table is
identical byte for byte to that of one uninterrupted process.
"""
